"""The torque of stages on a uniform rotation in closed form; of every method: tests/motion/test_modulated_circle.py."""

import pytest
import sympy as sp

from bezstab.methods.registry import lookup
from bezstab.methods.rotation_torque import stage_torque

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
