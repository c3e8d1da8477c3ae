"""A drive without stiffness: its velocity is judged, exactly."""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bezstab.methods.registry import lookup
from bezstab.stability.drive_poles import drive_pole, drive_verdict, velocity_poles

ZERO = Fraction(0)


@given(a=st.just(Fraction(2)) | st.fractions(Fraction(1, 1000), 6, max_denominator=1000))
def test_without_stiffness_the_velocity_decides(a: Fraction) -> None:
    """v' = v - a v, or v' = v - a v'."""
    expected = "marginal" if a == 2 else "converges" if a < 2 else "diverges"
    assert drive_verdict(lookup("SYM"), a, ZERO) == expected
    found = complex(drive_pole(lookup("SYM"), float(a), 0.0))
    assert found == pytest.approx(float(1 - a), rel=1e-14, abs=1e-15)
    assert np.angle(found) in (0, np.pi)  # it turns round
    for name in ("imex-euler", "stable-pd", "implicit-euler"):
        assert drive_verdict(lookup(name), a, ZERO) == "converges"
        assert drive_pole(lookup(name), float(a), 0.0) == pytest.approx(float(1 / (1 + a)), rel=1e-14)


@pytest.mark.parametrize("a", [1e-9, 0.3, 2.5])
def test_the_free_position_is_set_aside_exactly(a: float) -> None:
    """Runge-Kutta: e^-a to its order. Adams-Bashforth: rho + a sigma, beside the roots of rho other than one."""
    assert drive_pole(lookup("RK4"), a, 0.0) == pytest.approx(1 - a + a**2 / 2 - a**3 / 6 + a**4 / 24, rel=1e-14)
    of_two_steps = np.roots([1, 3 * a / 2 - 1, -a / 2])
    found = velocity_poles(lookup("AB2"), a)
    assert sorted(found.real) == pytest.approx(sorted([0, *of_two_steps]), rel=1e-12, abs=1e-15)
