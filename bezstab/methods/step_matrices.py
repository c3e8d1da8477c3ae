"""One step of a one-step method as an exact matrix, for steps that differ in length.

A step of length s takes the state (c, cdot, and the stored cddot of a scheme that carries one) to the next. The
equations of a scheme, in which h = 1, give the matrix of (c, h cdot, h^2 cddot); to compare steps of different length
the state is written in one fixed unit of time instead: entry (i, j) is multiplied by s^(j - i). With

    alpha and beta fixed:           alpha_hat and s, beta_hat and s^2 are proportional
    alpha_hat and beta_hat held:    as some engines do, whose alpha and beta follow 1/s

its entries are polynomials in s over one common denominator, which is a number for an explicit scheme.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cache

from sympy.polys.rings import PolyElement

from bezstab.errors import InputError
from bezstab.methods.determinants import RING, Matrix, as_fraction, determinant, in_field
from bezstab.methods.polynomials import horner
from bezstab.methods.schemes import STATE, Method, check_one_step
from bezstab.methods.second_order import SecondOrder
from bezstab.methods.step_equations import ACCELERATION, POSITION, VELOCITY, Evaluation, Quantity
from bezstab.rationals import ONE, ZERO

StepPolynomial = tuple[Fraction, ...]
"""A polynomial in the length s of a step, coefficients in ascending powers."""


@dataclass(frozen=True)
class StepMatrix:
    """The matrix of a step of length s: `entries[i][j]` / `denominator`, polynomials in s.

    The state is (c, cdot) or, of a scheme that carries an acceleration, (c, cdot, cddot), in the unit of time in which
    s is given. `commuting`: the matrices of any two steps commute, whatever their lengths.
    """

    entries: tuple[tuple[StepPolynomial, ...], ...]
    denominator: StepPolynomial
    commuting: bool

    @property
    def size(self) -> int:
        """The number of quantities in the state: 2 or 3."""
        return len(self.entries)

    def at(self, step: Fraction) -> list[list[Fraction]]:
        """Return the matrix of one step, exact; ZeroDivisionError where the step has no solution."""
        denominator = horner(self.denominator, step)
        return [[horner(entry, step) / denominator for entry in row] for row in self.entries]


def step_matrix(method: Method, alpha_hat: Fraction, beta_hat: Fraction, hold: bool = False) -> StepMatrix:
    """Return the matrix of a step of s times the user's h, for which alpha_hat and beta_hat are given (dimensionless).

    alpha and beta stay as they are while s varies; with `hold` alpha_hat and beta_hat do. The method's step multiple is
    counted in. InputError for a method whose next state depends on more than one step.
    """
    multiple = method.step_multiple
    alpha_hat, beta_hat = alpha_hat * multiple, beta_hat * multiple**2
    entries, denominator = _plane_matrix(method, hold)
    power = 0 if hold else 1

    def along(polynomial: PolyElement, shift: int) -> dict[int, Fraction]:
        """Return a polynomial in alpha_hat and beta_hat as one in s, times s^shift."""
        result: dict[int, Fraction] = {}
        for (_, i, j), coefficient in polynomial.terms():
            key = power * (i + 2 * j) + shift
            result[key] = result.get(key, ZERO) + as_fraction(coefficient) * alpha_hat**i * beta_hat**j
        return {key: coefficient for key, coefficient in result.items() if coefficient}

    size = range(len(entries))
    scaled = [[along(entries[i][j], j - i) for j in size] for i in size]
    below = along(denominator, 0)
    if not below:
        raise InputError(f"{method.name}: a step has no solution at this point")
    lowest = min(key for terms in (below, *(entry for row in scaled for entry in row)) for key in terms)
    return StepMatrix(
        entries=tuple(tuple(_ascending(entry, lowest) for entry in row) for row in scaled),
        denominator=_ascending(below, lowest),
        commuting=not hold and bool(method.scheme.mu_table),
    )


def _ascending(terms: Mapping[int, Fraction], lowest: int) -> StepPolynomial:
    """Return a polynomial in s, divided by s^lowest, by its coefficients; (0,) for zero."""
    return tuple(terms.get(power, ZERO) for power in range(lowest, max(terms, default=lowest) + 1))


@cache
def _plane_matrix(method: Method, hold: bool) -> tuple[Matrix, PolyElement]:
    """Return numerators and denominator of the matrix of what a step carries, as polynomials in alpha_hat, beta_hat.

    By Cramer's rule on the scheme's equations, which are linear in what a step finds.
    """
    check_one_step(method)
    scheme = method.scheme.second_order
    equations = list(scheme.equations)
    known = {quantity for equation in equations for quantity in equation.used}
    known -= {equation.result for equation in equations}
    stored = Quantity(ACCELERATION, 0)
    if stored in known and not hold and _ends_with_its_acceleration(scheme):
        # with alpha and beta fixed the stored acceleration is that of the state: it says nothing new
        at_start = ((ONE, Quantity(POSITION, 0)),), ((ONE, Quantity(VELOCITY, 0)),)
        equations.append(Evaluation(stored, *at_start))
        known.remove(stored)
    state = STATE if stored in known else STATE[:2]
    found = [equation.result for equation in equations]
    place = {quantity: column for column, quantity in enumerate([*found, *(Quantity(name, 0) for name in state)])}
    rows = [[RING.zero for _ in place] for _ in equations]
    for number, equation in enumerate(equations):
        rows[number][number] += RING.one
        for coefficient, quantity, (by_velocity, by_position) in equation.terms:
            rows[number][place[quantity]] -= RING.term_new((0, by_velocity, by_position), in_field(coefficient))

    def cramer(number: int, side: int) -> PolyElement:
        """Return the determinant with minus the column of what is known in place of one of what a step finds."""
        return determinant([
            [-row[side] if column == number else row[column] for column in range(len(found))] for row in rows
        ])  # fmt: skip

    entries = [[cramer(place[Quantity(name, 1)], place[Quantity(side, 0)]) for side in state] for name in state]
    return entries, determinant([row[: len(found)] for row in rows])


def _ends_with_its_acceleration(scheme: SecondOrder) -> bool:
    """Return whether the acceleration that is stored is the one at the state with which the step ends."""
    at_end = ((ONE, Quantity(POSITION, 1)),), ((ONE, Quantity(VELOCITY, 1)),)
    return Evaluation(Quantity(ACCELERATION, 1), *at_end) in scheme.equations
