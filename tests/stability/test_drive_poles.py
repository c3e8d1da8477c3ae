"""A drive without stiffness: its velocity is judged, exactly, and its limits are where that turns."""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bezstab.engines import DRIVE_METHODS
from bezstab.methods import lookup
from bezstab.stability import drive_pole, drive_verdict, gain_stretches, velocity_poles

ZERO = Fraction(0)
EXPLICIT, IMPLICIT = "SYM", ("imex-euler", "stable-pd", "implicit-euler")


@given(a=st.fractions(Fraction(1, 1000), 6, max_denominator=1000))
def test_without_stiffness_the_velocity_decides(a: Fraction) -> None:
    """v' = v - a v, or v' = v - a v'."""
    expected = "marginal" if a == 2 else "converges" if a < 2 else "diverges"
    assert drive_verdict(lookup(EXPLICIT), a, ZERO) == expected
    assert drive_pole(lookup(EXPLICIT), float(a), 0.0) == pytest.approx(float(1 - a), rel=1e-14, abs=1e-15)
    for name in IMPLICIT:
        assert drive_verdict(lookup(name), a, ZERO) == "converges"
        assert drive_pole(lookup(name), float(a), 0.0) == pytest.approx(float(1 / (1 + a)), rel=1e-14)


def test_at_its_limit_a_damper_turns_its_velocity_round() -> None:
    assert drive_verdict(lookup("SYM"), Fraction(2), ZERO) == "marginal"
    assert drive_verdict(lookup("SYM"), ZERO, ZERO) == "marginal"  # nothing acts at all
    assert np.angle(complex(drive_pole(lookup("SYM"), 4.0, 0.0))) == np.pi


@pytest.mark.parametrize("a", [1e-9, 0.3, 2.5])
def test_the_free_position_is_set_aside_exactly(a: float) -> None:
    """Runge-Kutta: e^-a to its order. Adams-Bashforth: rho + a sigma, beside the roots of rho other than one."""
    assert drive_pole(lookup("RK4"), a, 0.0) == pytest.approx(1 - a + a**2 / 2 - a**3 / 6 + a**4 / 24, rel=1e-14)
    of_two_steps = np.roots([1, 3 * a / 2 - 1, -a / 2])
    found = velocity_poles(lookup("AB2"), a)
    assert sorted(found.real) == pytest.approx(sorted([0, *of_two_steps]), rel=1e-12, abs=1e-15)


@pytest.mark.parametrize("name", DRIVE_METHODS)
def test_with_both_gains_it_is_the_pole_of_the_method(name: str) -> None:
    point = Fraction(1, 2), Fraction(1, 4)
    z_abs = abs(complex(drive_pole(lookup(name), *map(float, point))))
    assert drive_verdict(lookup(name), *point) == "converges"
    assert z_abs < 1


STRETCHES = [
    ("SYM", "1", "0", (0, 2), (0, 2)),
    ("SYM", "4", "0", (0, 2), None),
    ("SYM", "0", "1", (0, 1.5), None),
    ("imex-euler", "1", "8", (2, np.inf), (0, 6)),  # beta_hat < 4 + 2 alpha_hat: more damping helps
    ("stable-pd", "0", "1", (0, np.inf), (0, 4 / 3)),
]


@pytest.mark.parametrize(("name", "a", "b", "of_alpha", "of_beta"), STRETCHES)
def test_each_gain_is_told_from_where_to_where_it_is_stable(
    name: str, a: str, b: str, of_alpha: tuple[float, float], of_beta: tuple[float, float] | None
) -> None:
    found = gain_stretches(lookup(name), Fraction(a), Fraction(b))
    assert found[0] == pytest.approx(of_alpha)
    assert found[1] == (of_beta and pytest.approx(of_beta))
