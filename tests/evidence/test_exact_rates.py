"""Exact rates of a moving mechanism: against the poles at rest, and the runner's own."""

import numpy as np
import pytest

from bezstab.evidence.exact_rates import find_own_motions, stepped_motion
from bezstab.mechanism import Mechanism, compiled_mechanism, load_scene
from bezstab.methods import lookup
from bezstab.stability import spectral_radius
from tests.evidence.driven_four_bar import four_bar, swinging_four_bar
from tests.evidence.exact_rates import floquet_rates
from tests.evidence.samples import of_campaign
from tests.reference.perturbed_revolutions import runner_motion, settled_multiplier

NEAR_ONE = {
    "B4": (0.25, 0.27),
    "AB4": (0.3, 0.115),
    "AB2": (0.54165581, 0.68299639),
    "RK4": (2.82590929, 6.83959742),
    "SYM": (1.92915854, 0.0186539),
}
"""The last three, at omega h = 0.105, are points where truncation errors change the side of one on which |z| is."""


@pytest.mark.promise(
    "Rates over the method's own motion",
    measured=("those of the runner, found by itself, to 1e-9, of explicit methods and of those that solve equations"),
)
@pytest.mark.promise("Rates where drivers turn and oscillate")
@pytest.mark.parametrize("name", of_campaign([*NEAR_ONE], ["AB4", "SYM"]))
@pytest.mark.parametrize("swinging", [False, True])
@pytest.mark.slow_except("AB4")
def test_the_runner_finds_the_same_motion_and_the_same_rate(name: str, swinging: bool) -> None:
    """Both by Newton's method; the runner's by differences of runs over a revolution. The mechanism's is another."""
    at = NEAR_ONE[name]
    mechanism = swinging_four_bar(2 * np.pi, 4 * np.pi) if swinging else four_bar()
    expected = runner_motion(mechanism, lookup(name), 60, *at)
    assert expected is not None
    own, on_the_motion = both_rates(name, 1 / 60, *at, mechanism)
    assert own == pytest.approx(expected[1], abs=1e-9)
    assert abs(on_the_motion - expected[1]) > 1e-6


def both_rates(
    name: str, h: float, alpha_hat: float, beta_hat: float, mechanism: Mechanism | None = None
) -> tuple[float, float]:
    """Return |z| on the method's own motion, and on that of the mechanism, by default the four-bar; h in s."""
    at = mechanism or four_bar(), lookup(name), h, np.array([alpha_hat]), np.array([beta_hat]), 1.0
    return float(find_own_motions(*at).rates[0]), float(floquet_rates(*at)[0])


@pytest.mark.promise("Rates over the method's own motion")
@pytest.mark.parametrize(
    "name", of_campaign(["trapezoid", "implicit-midpoint", "sdirk2", "implicit-euler", "gauss4"], ["sdirk2"])
)
@pytest.mark.slow
def test_methods_that_solve_equations_have_the_rate_of_the_motion_to_which_they_settle(name: str) -> None:
    """By differences of whole runs: 1e-8 of a multiplier of 0.4, and 60 steps."""
    own, _ = both_rates(name, 1 / 60, 0.03, 0.03)
    assert own == pytest.approx(settled_multiplier(four_bar(), lookup(name), 60, 0.03, 0.03), abs=1e-9)


def test_truncation_errors_decide_which_side_of_one_a_rate_is_on_and_fall_faster_than_the_step() -> None:
    for name in ("AB2", "RK4", "SYM"):
        own, on_the_motion = both_rates(name, 1 / 60, *NEAR_ONE[name])
        assert (own > 1) != (on_the_motion > 1)
    for name in ("ABM2", "RK2", "verlet-half"):
        coarse, fine = (np.subtract(*both_rates(name, h, 0.3, 0.1)) for h in (0.04, 0.01))
        assert 0 < abs(fine) < abs(coarse) / 4


@pytest.mark.parametrize(
    ("scene", "name", "alpha_hat", "beta_hat"),
    [
        ("driven_four_bar", "AB4", 1.5, 2.0),  # errors grow beyond all numbers in a revolution
        ("four_bar", "B4", 0.3, 0.1),  # no driver
        ("driven_four_bar", "SYM", 2.053533, -0.021667),  # a run is hundreds of metres off after a revolution
    ],
)
def test_without_such_a_motion_the_rate_is_that_on_the_motion(
    scene: str, name: str, alpha_hat: float, beta_hat: float
) -> None:
    at = compiled_mechanism(load_scene(scene)), lookup(name), 0.005, np.array([alpha_hat]), np.array([beta_hat]), 0.2
    assert find_own_motions(*at).rates == floquet_rates(*at)


def test_a_batch_gives_what_single_points_give() -> None:
    """Of points of which some need more corrections, and the last has no such motion; to the square of 1e-9."""
    alpha_hat, beta_hat = np.array([0.3, 0.05, 0.2, 1.5]), np.array([0.115, 0.01, 0.08, 2.0])
    together = find_own_motions(four_bar(), lookup("AB4"), 1 / 60, alpha_hat, beta_hat, 1.0).rates
    alone = [both_rates("AB4", 1 / 60, *point)[0] for point in zip(alpha_hat, beta_hat, strict=True)]
    assert together == pytest.approx(alone, rel=1e-11)


@pytest.mark.parametrize(("name", "count"), [("B8", 1), ("AB4", 3), ("SYM", 7), ("RK4", 30), ("ABM4", 30)])
def test_no_point_and_no_step_is_too_extreme_for_a_number(name: str, count: int) -> None:
    """No feedback, hardly any, and so much that a step multiplies errors by 1e38; fewer steps than are carried."""
    gains = np.array([0.0, 1e-8, 0.3, 1e3, 1e10])
    assert np.isfinite(find_own_motions(four_bar(), lookup(name), 1 / count, gains, gains, 1.0).rates).all()


@pytest.mark.parametrize("name", ["B4", "RK4", "SYM", "ABM3", "trapezoid", "verlet-half", "newmark(1/4,1/2)"])
def test_a_mechanism_that_hardly_moves_has_the_poles_at_rest(name: str) -> None:
    """What the motion does to a pole falls with omega h, like it or like its square: here from 0.13 to 0.013."""
    method = lookup(name)
    alpha_hat, beta_hat = np.array([0.3, 0.4]), np.array([0.1, 0.08])
    at_rest = spectral_radius(method, alpha_hat, beta_hat)
    moved = [
        np.abs(floquet_rates(four_bar(), method, h, alpha_hat, beta_hat, 1.0) - at_rest).max() for h in (2e-2, 2e-3)
    ]
    assert moved[1] < 0.2 * moved[0] < 0.2 * 2e-2


def test_a_run_without_a_driver_has_the_rate_of_its_constraint_errors() -> None:
    """On the slider-crank, which is hardly turned, the error of 1000 steps decays as the pole at rest says."""
    mechanism = compiled_mechanism(load_scene("slider_crank"))
    rates = floquet_rates(mechanism, lookup("B4"), 1e-3, np.array([0.1, 0.5]), np.array([0.1, 0.1]), 0.2)
    at_rest = spectral_radius(lookup("B4"), np.array([0.1, 0.5]), np.array([0.1, 0.1]))
    assert rates == pytest.approx(at_rest, rel=2e-2)  # a conjugate pair is seen at several phases


def test_a_step_before_the_revolution_is_its_last_but_for_a_turn() -> None:
    """The crank has turned by 2 pi, nothing else has moved; the motion is known to 1e-11 of a turn."""
    stepped = stepped_motion(four_bar(), lookup("bdf2"), 0.01, 1.0)
    older, newest = [k for k, quantity in enumerate(stepped.memory.carried) if quantity.name == "x"][-2:]
    moved = stepped.starts[-2, newest] - stepped.starts[0, older]
    assert moved == pytest.approx([2 * np.pi, *np.zeros(len(moved) - 1)], abs=1e-10)


def test_an_own_motion_is_beside_that_of_the_mechanism_as_each_step_begins() -> None:
    """A step later the crank has turned by a tenth of a radian."""
    motions = find_own_motions(four_bar(), lookup("B4"), 1 / 60, np.array([0.25]), np.array([0.27]), 1.0)
    q, _, _ = motions.stepped.along.at(np.linspace(0, 1, 60, endpoint=False))
    assert motions.states[:, 0, 0] == pytest.approx(q, abs=0.02)
