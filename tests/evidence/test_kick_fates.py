"""What becomes of the error that a kick has made: told from made-up responses, and from mechanisms at coarse steps."""

from collections.abc import Iterator

import numpy as np
import pytest

from bezstab.evidence import map_rows, simulated_verdicts, verdict_map
from bezstab.evidence.kick_fates import fates, follow
from bezstab.mechanism import load_scene
from bezstab.methods import lookup
from bezstab.stability import FloatArray
from tests.evidence.driven_four_bar import four_bar
from tests.evidence.exact_rates import floquet_rates
from tests.evidence.samples import of_campaign

KICK, RUN = 1e-8, 2000
STEPS: FloatArray = np.arange(RUN + 1.0)
STILL: FloatArray = np.zeros(RUN + 1)


def geometric(ratio: float) -> FloatArray:
    return np.asarray(ratio**STEPS, float)


def blocks(error: FloatArray, drift: FloatArray, size: float = 0.0) -> Iterator[tuple[FloatArray, FloatArray]]:
    """Yield c and q, step by step, of a mechanism whose first coordinate is the error and whose second drifts."""
    for own, free in zip(error * KICK, drift * KICK, strict=True):
        up_and_down = np.array([1.0, -1.0])[:, np.newaxis, np.newaxis]
        c = size + own * up_and_down
        yield c[np.newaxis, np.newaxis], np.stack([own * up_and_down, free * up_and_down])[np.newaxis]


def fate(error: FloatArray, drift: FloatArray, size: float = 0.0, calm: bool = True) -> str:
    followed = follow(blocks(error, drift, size), np.ones(2), KICK, RUN)
    (diverges,), (undecided,) = fates(followed, thrown_apart_is_growth=calm)
    assert not (diverges and undecided)
    return "none" if undecided else "diverges" if diverges else "converges"


def test_an_error_that_dies_has_converged_whatever_the_motions_do_afterwards() -> None:
    drift = 0.1 * STEPS  # apart, for good
    forced = 1e-3 * drift  # late differences are 1e5 times those after a hundred steps
    assert fate(geometric(0.9) + forced**2, drift) == "converges"
    assert fate(geometric(0.99), drift) == "converges"


def test_an_error_that_grows_tenfold_has_diverged() -> None:
    assert fate(geometric(1.005), 0.01 * STEPS) == "diverges"
    assert fate(geometric(1.2), STILL) == "diverges"  # out of the linear range in 60 steps


def test_an_error_that_rises_before_it_dies_has_converged() -> None:
    """Of a double pole at 0.97, as symplectic Euler's near alpha_hat = 0, beta_hat = 4, the rise is elevenfold."""
    assert np.max(STEPS * geometric(0.97)) > 10
    assert fate((1 + STEPS) * geometric(0.97), STILL) == "converges"


def test_an_error_that_dies_and_comes_back_as_a_constraint_error_has_no_verdict() -> None:
    """As of a growing mode that the kick hardly excites."""
    assert fate(geometric(0.9) + 1e-6 * geometric(1.01), STILL) == "none"


def test_a_difference_of_motions_that_grows_is_no_growth_of_an_error() -> None:
    drift = 1e4 * STEPS
    assert fate(np.maximum(geometric(0.999), 1e-3 * drift).astype(float), drift) == "none"


def test_what_lives_to_the_end_is_judged_by_its_halves() -> None:
    assert fate(geometric(0.9985), STILL) == "converges"
    assert fate(geometric(1.0005), STILL) == "diverges"
    assert fate(geometric(1.0005), 1.0 * STEPS) == "none"  # of the motion as likely


@pytest.mark.promise("Runs that break down")
def test_a_mechanism_that_breaks_down_gives_no_verdict_unless_feedback_throws_it_apart() -> None:
    """An error of 2 m at once is the feedback's doing if without feedback nothing happens; 2 mm may be forced."""
    assert fate(geometric(0.999), STILL, size=2e-3) == "none"
    assert fate(geometric(0.999), STILL, size=2.0) == "diverges"
    assert fate(geometric(0.999), STILL, size=2.0, calm=False) == "none"


@pytest.mark.promise("Maps of simulated verdicts")
@pytest.mark.parametrize("name", of_campaign(["AB4", "B4"], ["AB4"]))
@pytest.mark.slow
def test_where_the_motion_turns_a_verdict_it_is_that_of_the_exact_rate(name: str) -> None:
    h = 1e-2
    method = lookup(name)
    chunks = map_rows(load_scene("driven_four_bar"), method, h, 12)
    verdicts = verdict_map(chunks, [simulated_verdicts(rows) for rows in chunks])
    alpha_hat, beta_hat = np.meshgrid(verdicts.alpha_hat, verdicts.beta_hat)
    exact = floquet_rates(four_bar(), method, h, alpha_hat.ravel(), beta_hat.ravel(), 1.0).reshape(alpha_hat.shape)
    assert verdicts.judged > 0.9 * exact.size
    assert verdicts.disagrees.any()  # with the map, which is of a mechanism at rest
    assert not ((verdicts.diverges != (exact > 1)) & ~verdicts.undecided).any()


@pytest.mark.promise("Maps of simulated verdicts")
@pytest.mark.parametrize(
    ("scene", "name", "h", "judged"),
    [
        ("four_bar", "B4", 5e-3, 0.8),
        *of_campaign([("four_bar", "RK4", 5e-3, 0.9), ("four_bar", "rk45", 5e-3, 0.9)], []),
        *of_campaign([("slider_crank_light", "RK4", 1e-3, 0.99)], []),
        ("slider_crank_300rpm", "RK4", 5e-3, 0.6),  # forced by millimetres at once
    ],
)
@pytest.mark.slow
def test_free_mechanisms_at_coarse_steps_give_no_wrong_verdict(scene: str, name: str, h: float, judged: float) -> None:
    chunks = map_rows(load_scene(scene), lookup(name), h, of_campaign(9, 7))
    verdicts = verdict_map(chunks, [simulated_verdicts(rows) for rows in chunks])
    assert verdicts.disagreements_beyond_band == 0
    assert verdicts.judged >= judged * verdicts.undecided.size
    assert (verdicts.diverges & ~verdicts.undecided).any()
    assert (~verdicts.diverges & ~verdicts.undecided & ~verdicts.too_close).any()
