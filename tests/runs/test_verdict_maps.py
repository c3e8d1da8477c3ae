"""Simulated verdicts over the plane against the exact region, and how their agreement is counted."""

from typing import Any

import numpy as np
import pytest

from bezstab.mechanism.scene_files import load_scene
from bezstab.methods.registry import lookup
from bezstab.runs.exact_rates import exact_rates
from bezstab.runs.verdict_maps import VerdictMap, compared, map_rows, simulated_verdicts, verdict_map
from bezstab.stability.regions import region
from tests.runs.driven_four_bar import four_bar

H = 1e-3  # s


def whole_map(scene: str, name: str, h: float, count: int) -> VerdictMap:
    chunks = map_rows(load_scene(scene), lookup(name), h, count)
    return verdict_map(chunks, [simulated_verdicts(rows) for rows in chunks])


@pytest.mark.parametrize(
    ("name", "scene", "count"),
    [
        *((name, "slider_crank", 16) for name in ("B4", "AB4", "SYM")),
        ("verlet-old", "pendulum", 8),  # equations are solved
    ],
)
@pytest.mark.slow
def test_simulated_verdicts_agree_outside_the_band(name: str, scene: str, count: int) -> None:
    verdicts = whole_map(scene, name, H, count)
    assert not verdicts.undecided.any()
    assert (verdicts.farthest_disagreement or 0) < verdicts.band
    assert verdicts.disagreements_beyond_band == 0
    cell = (verdicts.alpha_hat[1] - verdicts.alpha_hat[0]) * (verdicts.beta_hat[1] - verdicts.beta_hat[0])
    crossed = 4 * count * cell  # by the boundary, at most
    assert cell * (~verdicts.diverges).sum() == pytest.approx(region(lookup(name)).area, abs=crossed)


@pytest.mark.parametrize("name", ["AB4"])
@pytest.mark.slow
def test_where_the_motion_turns_a_verdict_it_is_that_of_the_exact_rate(name: str) -> None:
    h = 1e-2
    verdicts = whole_map("driven_four_bar", name, h, 12)
    alpha_hat, beta_hat = np.meshgrid(verdicts.alpha_hat, verdicts.beta_hat)
    exact = exact_rates(four_bar(), lookup(name), h, alpha_hat.ravel(), beta_hat.ravel(), 1.0).reshape(alpha_hat.shape)
    assert verdicts.judged > 0.9 * exact.size
    assert verdicts.disagrees.any()  # with the map, which is of a mechanism at rest
    assert not ((verdicts.diverges != (exact > 1)) & ~verdicts.undecided).any()


def test_agreement_is_of_what_was_judged_and_beyond_the_band_of_what_the_motion_does_not_move() -> None:
    of_map: dict[str, Any] = {"scene": load_scene("pendulum"), "method": lookup("SYM"), "h": H, "run": 2000}
    of_map |= {"alpha_hat": np.arange(6.0), "beta_hat": np.ones(1)}
    made_up = compared(
        **of_map,
        z_abs=np.array([[0.9, 0.9, 1.1, 1.1, 1.004, 1.02]]),
        diverges=np.array([[False, True, True, False, False, False]]),
        undecided=np.array([[False, False, False, True, False, False]]),
        moved=np.array([[0, 0, 0, 0, 0, 0.03]]),
    )
    assert (made_up.judged, made_up.agreeing) == (5, 2)
    assert made_up.farthest_disagreement == pytest.approx(0.1)
    assert (made_up.band, made_up.too_close.sum(), made_up.disagreements_beyond_band) == (0.005, 2, 1)


@pytest.mark.parametrize("count", [3, 60])
def test_the_rows_are_the_whole_window_once(count: int) -> None:
    chunks = map_rows(load_scene("pendulum"), lookup("SYM"), H, count)
    beta_hat = np.concatenate([rows.beta_hat for rows in chunks])
    assert len(beta_hat) == len(chunks[0].alpha_hat) == count
    assert (np.diff(beta_hat) > 0).all()
    assert max(rows.beta_hat.size * rows.alpha_hat.size for rows in chunks) <= 2000
