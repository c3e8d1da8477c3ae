"""The torque of stages on a uniform rotation, against closed forms, and steps in fifty digits."""

from fractions import Fraction

import numpy as np
import pytest
import sympy as sp

from bezstab.methods.registry import REGISTRY, lookup
from bezstab.methods.rotation_torque import stage_torque
from bezstab.methods.second_order import SecondOrder
from bezstab.stability.closed_loop import spectral_radius
from tests.reference.circle_steps import last_gain

A, B = sp.symbols("alpha_hat beta_hat")


@pytest.mark.parametrize(
    ("name", "power", "coefficient"),
    [
        ("RK2", 2, B / (4 * (4 + B - 2 * A))),
        ("heun", 4, (A - 2) * (A - B - 2) / (2 * A - B - 4) ** 2),
        ("B4", 4, sp.Rational(5, 27)),
        ("SYM", None, 0),
    ],
)
def test_the_leading_term(name: str, power: int | None, coefficient: sp.Expr) -> None:
    found = stage_torque(lookup(name))
    assert found.power == power
    assert sp.simplify(found.coefficient - coefficient) == 0


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
