"""The torque of stages on a uniform rotation, against closed forms, Butcher's D(1), and steps in fifty digits."""

from fractions import Fraction

import numpy as np
import pytest
import sympy as sp
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from bezstab.methods.registry import REGISTRY, lookup
from bezstab.methods.rotation_torque import stage_torque
from bezstab.methods.second_order import SecondOrder
from bezstab.stability.closed_loop import spectral_radius
from tests.reference.circle_steps import last_gain
from tests.reference.made_methods import runge_kutta

A, B = sp.symbols("alpha_hat beta_hat")


@pytest.mark.parametrize(
    ("name", "power", "coefficient"),
    [
        ("RK2", 2, B / (4 * (4 + B - 2 * A))),
        ("SIE", 2, -(A - 1) / (A - B - 1)),
        ("bs3", 2, 3 * B * (2 * A + B - 12) / (32 * (6 * A**2 - 3 * A * B - 18 * A + B**2 - 3 * B + 36))),
        ("heun", 4, (A - 2) * (A - B - 2) / (2 * A - B - 4) ** 2),
        ("AB2", 4, sp.Rational(1, 2)),
        ("B4", 4, sp.Rational(5, 27)),
        ("SYM", None, 0),
        ("verlet-half", None, 0),
        ("trapezoid", None, 0),
    ],
)
def test_the_leading_term(name: str, power: int | None, coefficient: sp.Expr) -> None:
    found = stage_torque(lookup(name))
    assert found.power == power
    assert sp.simplify(found.coefficient - coefficient) == 0


def test_a_point_is_answered_as_the_formula_answers_it() -> None:
    at = Fraction(1), Fraction(1, 4)
    assert stage_torque(lookup("bs3"), at).coefficient == Fraction(-117, 11552)


POINTS = [(Fraction(1, 2**k), Fraction(1, 4 ** (k + 1))) for k in range(5)] + [(Fraction(1, 32), Fraction(1, 2000))]
"""Critically damped, and one where AB8 is stable while the mass goes round."""

SETTLING = 25
"""By e to so many what the start has made dies: to 1e-11 of what is of the size of a torque."""


@pytest.mark.slow
@pytest.mark.parametrize("name", [name for name in REGISTRY if not isinstance(lookup(name).scheme, SecondOrder)])
def test_it_is_what_the_step_itself_gives_in_fifty_digits(name: str) -> None:
    method = lookup(name)
    multiple = float(method.step_multiple)
    radius = {at: float(spectral_radius(method, float(at[0]) / multiple, float(at[1]) / multiple**2)) for at in POINTS}
    point = next(at for at in POINTS if radius[at] < 1)
    found = stage_torque(method, point)
    rate, gain = last_gain(method, point, Fraction(1, 100), count=int(SETTLING / -np.log(radius[point])))
    expected = float(found.coefficient) * float(rate) ** found.power if found.power else 0.0
    assert float(gain) == pytest.approx(expected, rel=0.01, abs=1e-14 if found.power is None else 0)


fractions = st.fractions(-2, 2, max_denominator=6)


@pytest.mark.slow
@settings(max_examples=10, deadline=None)
@given(b2=fractions, b3=fractions, c3=fractions, c2=fractions, a32=fractions, d1=st.booleans())
def test_there_is_no_torque_of_second_order_where_d1_holds(
    b2: Fraction, b3: Fraction, c2: Fraction, c3: Fraction, a32: Fraction, d1: bool
) -> None:
    """D(1), sum_i b_i a_ij = b_j (1 - c_j), asks of three stages of order two: c_3 = 1 and b_3 a_32 = b_2 (1 - c_2)."""
    if d1:
        b3, c3 = Fraction(1, 2) - b2 * c2, Fraction(1)
        assume(b3 != 0)
        a32 = b2 * (1 - c2) / b3
    else:
        assume(c2 != 0)
        b2 = (Fraction(1, 2) - b3 * c3) / c2
        assume(b3 * (1 - c3) != 0 or b3 * a32 != b2 * (1 - c2))
    method = runge_kutta("three stages", f"{c2};{c3 - a32} {a32}", f"{1 - b2 - b3} {b2} {b3}")
    point = (Fraction(3, 7), Fraction(2, 11)) if d1 else None  # one is enough for no torque, none for some
    assert (stage_torque(method, point).power != 2) == d1
