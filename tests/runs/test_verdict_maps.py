"""Simulated verdicts over the plane against the exact region, and how their agreement is counted."""

import numpy as np
import pytest

from bezstab.mechanism.scene_files import load_scene
from bezstab.methods.registry import lookup
from bezstab.runs.exact_rates import exact_rates
from bezstab.runs.verdict_maps import VerdictMap, compared, map_rows, simulated_verdicts, verdict_map
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
    assert {True, False} == set(verdicts.diverges.ravel().tolist())


@pytest.mark.slow
def test_where_the_motion_turns_a_verdict_it_is_that_of_the_exact_rate() -> None:
    verdicts = whole_map("driven_four_bar", "AB4", 1e-2, 12)
    alpha_hat, beta_hat = np.meshgrid(verdicts.alpha_hat, verdicts.beta_hat)
    exact = exact_rates(four_bar(), lookup("AB4"), 1e-2, alpha_hat.ravel(), beta_hat.ravel(), 1.0).reshape(12, 12)
    assert verdicts.judged > 0.9 * exact.size
    assert verdicts.disagrees.any()  # with the map, which is of a mechanism at rest
    assert not ((verdicts.diverges != (exact > 1)) & ~verdicts.undecided).any()


MADE_UP = compared(
    scene=load_scene("pendulum"),
    method=lookup("SYM"),
    h=H,
    run=2000,
    alpha_hat=np.arange(3.0),
    beta_hat=np.arange(2.0),
    z_abs=np.array([[0.9, 0.9, 1.1], [1.1, 1.004, 1.02]]),
    diverges=np.array([[False, True, True], [False] * 3]),
    undecided=np.array([[False] * 3, [True, False, False]]),
    moved=np.array([[0, 0, 0], [0, 0, 0.03]]),
)


def test_agreement_is_of_what_was_judged_and_beyond_the_band_of_what_the_motion_does_not_move() -> None:
    assert (MADE_UP.judged, MADE_UP.agreeing) == (5, 2)
    assert MADE_UP.farthest_disagreement == pytest.approx(0.1)
    assert (MADE_UP.band, MADE_UP.too_close.sum(), MADE_UP.disagreements_beyond_band) == (0.005, 2, 1)


def test_the_rows_are_the_whole_window_once() -> None:
    chunks = map_rows(load_scene("pendulum"), lookup("SYM"), H, 60)
    beta_hat = np.concatenate([rows.beta_hat for rows in chunks])
    assert len(beta_hat) == len(chunks[0].alpha_hat) == 60
    assert (np.diff(beta_hat) > 0).all()
