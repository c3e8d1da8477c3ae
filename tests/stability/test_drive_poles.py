"""A drive without stiffness: its velocity is judged, exactly."""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bezstab.engines.drives import DRIVE_METHODS
from bezstab.methods.registry import lookup
from bezstab.stability.drive_poles import drive_pole, drive_verdict, velocity_poles

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
