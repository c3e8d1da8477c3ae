"""Steps of second-order schemes from nothing but their equations: no order of them, no elimination, no determinant."""

from collections.abc import Callable, Mapping
from fractions import Fraction
from typing import Any

import sympy as sp
from sympy.polys.matrices import DomainMatrix

from bezstab.methods import Assignment, Combination, Evaluation, Quantity, SecondOrder

Equation = Assignment | Evaluation

Values = Mapping[tuple[str, int], Any]
Force = Callable[[Any, Any], Any]


def _sum(combination: Combination, values: Values) -> Any:
    return sum(coefficient * values[quantity.name, quantity.step] for coefficient, quantity in combination)


def _right_side(equation: Equation, values: Values, force: Force) -> Any:
    if isinstance(equation, Assignment):
        return _sum(equation.value, values)
    return force(_sum(equation.position, values), _sum(equation.velocity, values))


def _kept(scheme: SecondOrder) -> list[Quantity]:
    """Return what a step starts from: of each quantity the values before its newest, as far back as they are used."""
    kept = []
    for equation in scheme.equations:
        newest = equation.result
        used = [q.step for each in scheme.equations for q in each.used if q.name == newest.name]
        kept += [Quantity(newest.name, step) for step in range(newest.step - 1, min([newest.step, *used]) - 1, -1)]
    return kept


def step_polynomial(scheme: SecondOrder, alpha_hat: Fraction, beta_hat: Fraction) -> list[Fraction] | None:
    """Return the characteristic polynomial of the matrix that takes what a step starts from to the next step's.

    Ascending powers, monic, exact. Each column of the equations is found by putting in a unit vector. None where the
    new values are not determined.
    """
    new, kept = [equation.result for equation in scheme.equations], _kept(scheme)

    def residuals(one: Quantity) -> list[Fraction]:
        values = {(q.name, q.step): Fraction(int(q == one)) for q in (*new, *kept)}
        return [
            values[equation.result.name, equation.result.step]
            - _right_side(equation, values, lambda x, v: -beta_hat * x - alpha_hat * v)
            for equation in scheme.equations
        ]

    by_new, by_kept = ([_exact(residuals(q)) for q in quantities] for quantities in (new, kept))
    size = len(new)
    left = DomainMatrix([list(row) for row in zip(*by_new, strict=True)], (size, size), sp.QQ)
    right = DomainMatrix([list(row) for row in zip(*by_kept, strict=True)], (size, len(kept)), sp.QQ)
    if not left.det():
        return None
    solution = (-left.lu_solve(right)).to_list()
    rows = []
    for quantity in kept:
        later = Quantity(quantity.name, quantity.step + 1)
        if later in new:
            rows.append(solution[new.index(later)])
        else:
            rows.append([sp.QQ(int(q == later)) for q in kept])
    polynomial = DomainMatrix(rows, (len(kept), len(kept)), sp.QQ).charpoly()
    return [Fraction(int(c.numerator), int(c.denominator)) for c in reversed(polynomial)]


def _exact(numbers: list[Fraction]) -> list[Any]:
    return [sp.QQ(number.numerator, number.denominator) for number in numbers]
