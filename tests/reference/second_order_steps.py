"""Steps of second-order schemes from nothing but their equations: no order of them, no elimination, no determinant."""

from fractions import Fraction
from typing import Any

import sympy as sp
from sympy.polys.matrices import DomainMatrix

from bezstab.methods.second_order import SecondOrder
from bezstab.methods.step_equations import Assignment, Evaluation, Quantity


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

    Ascending powers, monic, exact. None where the new values are not determined.
    """
    new, kept = [equation.result for equation in scheme.equations], _kept(scheme)

    def coefficients(equation: Assignment | Evaluation, quantities: list[Quantity]) -> list[Any]:
        """Return those of quantities in an equation, its right side taken to the left."""
        if isinstance(equation, Assignment):
            right = list(equation.value)
        else:
            right = [(-beta_hat * c, q) for c, q in equation.position]
            right += [(-alpha_hat * c, q) for c, q in equation.velocity]
        of_each = (Fraction(q == equation.result) - sum(c for c, used in right if used == q) for q in quantities)
        return [sp.QQ(c.numerator, c.denominator) for c in of_each]

    left, right = (
        DomainMatrix([coefficients(each, quantities) for each in scheme.equations], (len(new), len(quantities)), sp.QQ)
        for quantities in (new, kept)
    )
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
