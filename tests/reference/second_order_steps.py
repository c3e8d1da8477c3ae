"""Steps of second-order schemes from nothing but their equations: no order of them, no elimination, no determinant."""

from fractions import Fraction
from typing import Any, NamedTuple

from sympy import QQ
from sympy.polys.matrices import DomainMatrix

from bezstab.methods.second_order import SecondOrder
from bezstab.methods.step_equations import Assignment, Equation, Quantity


class LinearStep(NamedTuple):
    """What a step gives, what it starts from, and exact matrices: new = of_kept kept + of_forces forces."""

    new: list[Quantity]
    kept: list[Quantity]
    of_kept: DomainMatrix
    of_forces: DomainMatrix


def linear_step(scheme: SecondOrder, alpha_hat: Fraction, beta_hat: Fraction) -> LinearStep | None:
    """Return the step of a feedback alone; None where the new values are not determined.

    `kept` are of each quantity the values before its newest, as far back as they are used.
    """
    new, kept = [equation.result for equation in scheme.equations], []
    for newest in new:
        used = [q.step for each in scheme.equations for q in each.used if q.name == newest.name]
        kept += [Quantity(newest.name, step) for step in range(newest.step - 1, min([newest.step, *used]) - 1, -1)]

    def coefficient(equation: Equation, quantity: Quantity) -> Any:
        """Return that of a quantity in an equation, its right side taken to the left."""
        if isinstance(equation, Assignment):
            right = [(Fraction(1), equation.value)]
        else:
            right = [(-beta_hat, equation.position), (-alpha_hat, equation.velocity)]
        c = Fraction(quantity == equation.result) - sum(
            f * c for f, terms in right for c, used in terms if used == quantity
        )
        return QQ(c.numerator, c.denominator)

    left, right = (
        DomainMatrix([[coefficient(each, q) for q in quantities] for each in scheme.equations], shape, QQ)
        for quantities in (new, kept)
        for shape in [(len(new), len(quantities))]
    )
    return LinearStep(new, kept, -left.inv() * right, left.inv()) if left.det() else None


def step_polynomial(scheme: SecondOrder, alpha_hat: Fraction, beta_hat: Fraction) -> list[Fraction] | None:
    """Return the characteristic polynomial of the matrix that takes what a step starts from to the next step's.

    Ascending powers, monic, exact. None where the new values are not determined.
    """
    step = linear_step(scheme, alpha_hat, beta_hat)
    if step is None:
        return None
    size = len(step.kept)
    rows = dict(zip(step.kept, DomainMatrix.eye(size, QQ).to_list(), strict=True))
    rows |= zip(step.new, step.of_kept.to_list(), strict=True)
    matrix = DomainMatrix([rows[Quantity(q.name, q.step + 1)] for q in step.kept], (size, size), QQ)
    return [Fraction(int(c.numerator), int(c.denominator)) for c in reversed(matrix.charpoly())]
