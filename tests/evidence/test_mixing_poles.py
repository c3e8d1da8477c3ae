"""How far two poles that are near each other can come: against roots found exactly, and against exact rates."""

from collections.abc import Sequence

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bezstab.evidence.mixing_poles import nearest_poles
from bezstab.evidence.moving_mechanisms import moving_poles
from bezstab.methods import lookup
from bezstab.stability import FloatArray, region
from tests.evidence.driven_four_bar import four_bar, turning
from tests.evidence.exact_rates import floquet_rates
from tests.methods.kinds import sampled


def moved_poles(alpha_hat: float, beta_hat: float, eps: complex) -> Sequence[complex]:
    """Return symplectic Euler's poles of a motion frozen at eps = h eig K (theory, section 9)."""
    slower, faster = 1 - eps, alpha_hat * (1 + eps)
    roots: Sequence[complex] = np.roots([slower, -2 * slower + faster + beta_hat, slower - faster]).tolist()
    return roots


def on_the_double_curve(alpha_hat: float) -> float:
    """Return the beta_hat at which symplectic Euler's poles are both sqrt(1 - alpha_hat)."""
    return float((1 - np.sqrt(1 - alpha_hat)) ** 2)


@given(
    st.floats(0.05, 0.95),
    st.floats(-0.1, 0.1),
    st.floats(1e-6, 1e-3),
    st.floats(0, 2 * np.pi),
)
def test_symplectic_eulers_poles_stay_within_reach(alpha_hat: float, off: float, turned: float, phase: float) -> None:
    """Whatever the phase of eps, up to terms of second order: turned by 1e-3 at most, those are below turned."""
    beta_hat = on_the_double_curve(alpha_hat) * (1 + off)
    nearest = nearest_poles(lookup("SYM"), np.array([alpha_hat]), np.array([beta_hat]))
    furthest = max(abs(z) for z in moved_poles(alpha_hat, beta_hat, turned * np.exp(1j * phase)))
    assert furthest <= nearest.reach(turned).max() + turned


@pytest.mark.parametrize("alpha_hat", [0.1, 0.75, 1.0])
def test_a_double_pole_comes_as_far_as_it_can(alpha_hat: float) -> None:
    """Symplectic Euler's: the reach is met, but for terms of the order of kappa h, a thousandth of its root."""
    beta_hat, turned = on_the_double_curve(alpha_hat), 1e-6
    nearest = nearest_poles(lookup("SYM"), np.array([alpha_hat]), np.array([beta_hat]))
    middle = np.sqrt(1 - alpha_hat)
    furthest = max(abs(z) for eps in (turned, -turned) for z in moved_poles(alpha_hat, beta_hat, eps))
    assert nearest.reach(turned).max() - middle == pytest.approx(furthest - middle, rel=5e-3)


def test_poles_far_apart_come_as_far_as_the_first_order_law_says() -> None:
    """SYM at (1, 1/2), poles 1/2 and 0: half the gap, and the larger of the two shifts."""
    nearest = nearest_poles(lookup("SYM"), np.array([1.0]), np.array([0.5]))
    first_order = 0.5 + 1e-6 * np.abs(nearest.shift).max()
    assert not nearest.mix(1e-6).any()
    assert nearest.mixing_from() * np.abs(nearest.shift) == pytest.approx(1 / 4)  # half of the gap between them
    assert nearest.reach(1e-6)[0, 0] == pytest.approx(first_order, abs=1e-10)


def test_where_both_mu_are_the_same_poles_move_like_kappa_h_not_like_its_root() -> None:
    """On beta_hat = alpha_hat^2 / 4 every pole of B4 is double: 2 |z chi| kappa h is all that it can move by."""
    nearest = nearest_poles(lookup("B4"), np.array([1.0]), np.array([0.25]))
    assert nearest.mix(1e-3)[0, 0]
    moved = nearest.reach(1e-3)[0, 0] - nearest.z_abs[0]
    assert moved == pytest.approx(2e-3 * np.abs(nearest.shift[0, 0]), rel=0.02)


def near_a_double_pole(name: str, random: np.random.Generator, count: int) -> tuple[FloatArray, FloatArray]:
    """Return random points on and beside the curve on which a method's leading poles are double."""
    extent = region(lookup(name)).extent
    assert extent
    alpha_hat = random.uniform(0.05, 0.95, count) * min(extent[0][1], 1.0 if name == "SYM" else np.inf)
    beta_hat = (1 - np.sqrt(1 - alpha_hat)) ** 2 if name == "SYM" else alpha_hat**2 / 4
    off = random.choice([0, 1e-4, -1e-4, 1e-3, -1e-3, 1e-2, -1e-2, 0.1, -0.1], count)
    return alpha_hat, beta_hat * (1 + off)


@pytest.mark.promise("Where the law of the motion fails")
@pytest.mark.parametrize("count", [203, 60])
@pytest.mark.parametrize("name", sampled(["B4", "AB2", "AB4", "RK2", "RK4", "SYM"], quick=["B4", "SYM"]))
def test_exact_rates_are_within_reach_and_settled_verdicts_right(name: str, count: int) -> None:
    """On the driven four-bar at kappa h = 0.016 and 0.054; 2e-3 for terms of second order and the frozen motion."""
    method, h = lookup(name), 1 / count
    alpha_hat, beta_hat = near_a_double_pole(name, np.random.default_rng(7), 12)
    exact = floquet_rates(four_bar(), method, h, alpha_hat, beta_hat, 1.0)
    found = moving_poles(method, turning(), h, alpha_hat, beta_hat)
    assert count > 60 or any(pole.double for pole in found)
    for pole, rate in zip(found, exact, strict=True):
        assert pole.z_abs >= 1 or rate < pole.z_abs_worst * (1 + 2e-3)
        assert not pole.settled or (pole.z_abs_moving < 1) == (rate < 1)
