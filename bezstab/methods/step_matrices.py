"""One step of a one-step method as an exact matrix, for steps that differ in length.

A step of length s takes the state (c, cdot, and the stored cddot of a scheme that carries one) to the next. The
equations of a scheme, in which h = 1, give the matrix of (c, h cdot, h^2 cddot); to compare steps of different length
the state is written in one fixed unit of time instead: entry (i, j) is multiplied by s^(j - i). With

    alpha and beta fixed:           alpha_hat and s, beta_hat and s^2 are proportional
    alpha_hat and beta_hat held:    as some engines do, whose alpha and beta follow 1/s

its entries are polynomials in s over one common denominator, which is a number for an explicit scheme.
"""

from dataclasses import dataclass
from fractions import Fraction
from functools import cache

from bezstab.errors import InputError
from bezstab.methods.plane_polynomials import ONE, Matrix, Terms, Work, determinant, product
from bezstab.methods.schemes import LinearMultistep, Method, PredictorCorrector, RungeKutta, steps
from bezstab.methods.second_order import (
    ACCELERATION,
    POSITION,
    VELOCITY,
    Assignment,
    Equation,
    Evaluation,
    Quantity,
    SecondOrder,
)
from bezstab.methods.second_order_forms import second_order_form

StepPolynomial = tuple[Fraction, ...]
"""A polynomial in the length s of a step, coefficients in ascending powers."""

STATE = (POSITION, VELOCITY, ACCELERATION)


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
        denominator = value_at(self.denominator, step)
        return [[value_at(entry, step) / denominator for entry in row] for row in self.entries]


def value_at(polynomial: StepPolynomial, step: Fraction) -> Fraction:
    """Return the value of a polynomial (by Horner's rule)."""
    value = Fraction(0)
    for coefficient in reversed(polynomial):
        value = value * step + coefficient
    return value


def step_matrix(method: Method, alpha_hat: Fraction, beta_hat: Fraction, hold: bool = False) -> StepMatrix:
    """Return the matrix of a step of s times the user's h, for which alpha_hat and beta_hat are given (dimensionless).

    alpha and beta stay as they are while s varies; with `hold` alpha_hat and beta_hat do. The method's step multiple is
    counted in. InputError for a method whose next state depends on more than one step.
    """
    multiple = method.step_multiple
    alpha_hat, beta_hat = alpha_hat * multiple, beta_hat * multiple**2
    state, entries, denominator = _plane_matrix(method, hold)
    power = 0 if hold else 1

    def along(terms: Terms, shift: int) -> Terms:
        """Return a polynomial in alpha_hat and beta_hat as one in s, times s^shift."""
        result: Terms = {}
        for (_, i, j), coefficient in terms.items():
            key = (power * (i + 2 * j) + shift, 0, 0)
            result[key] = result.get(key, Fraction(0)) + coefficient * alpha_hat**i * beta_hat**j
        return {key: coefficient for key, coefficient in result.items() if coefficient}

    size = range(len(state))
    scaled = [[along(entries[i][j], j - i) for j in size] for i in size]
    below = along(denominator, 0)
    if not below:
        raise InputError(f"{method.name}: a step has no solution at this point")
    powers = [key[0] for terms in (below, *(entry for row in scaled for entry in row)) for key in terms]
    lowest = min(powers)
    commuting = not hold and isinstance(method.scheme, LinearMultistep | PredictorCorrector | RungeKutta)
    return StepMatrix(
        entries=tuple(tuple(_ascending(entry, lowest) for entry in row) for row in scaled),
        denominator=_ascending(below, lowest),
        commuting=commuting,
    )


def _ascending(terms: Terms, lowest: int) -> StepPolynomial:
    """Return a polynomial in s, divided by s^lowest, by its coefficients; (0,) for zero."""
    highest = max((key[0] for key in terms), default=lowest)
    return tuple(terms.get((power, 0, 0), Fraction(0)) for power in range(lowest, highest + 1))


@cache
def _plane_matrix(method: Method, hold: bool) -> tuple[tuple[str, ...], list[list[Terms]], Terms]:
    """Return what a step carries, and numerators and denominator of its matrix as polynomials in alpha_hat, beta_hat.

    By Cramer's rule on the scheme's equations, which are linear in what a step finds.
    """
    scheme = second_order_form(method.scheme)
    check_one_step(method)
    equations = list(scheme.equations)
    results = {equation.result for equation in equations}
    known = {quantity for equation in equations for quantity in equation.used} - results
    stored = Quantity(ACCELERATION, 0)
    if stored in known and not hold and _ends_with_its_acceleration(scheme):
        # with alpha and beta fixed the stored acceleration is that of the state: it says nothing new
        at_start = ((ONE, Quantity(POSITION, 0)),), ((ONE, Quantity(VELOCITY, 0)),)
        equations.append(Evaluation(stored, *at_start))
        known.remove(stored)
    state = STATE if stored in known else STATE[:2]
    column = {equation.result: number for number, equation in enumerate(equations)}
    rows: Matrix = [[{} for _ in equations] for _ in equations]
    right_sides: dict[Quantity, list[Terms]] = {
        Quantity(name, 0): [{} for _ in equations] for name in state
    }  # fmt: skip
    for number, equation in enumerate(equations):
        for coefficient, quantity, powers in _left_side(equation):
            target = rows[number][column[quantity]] if quantity in column else right_sides[quantity][number]
            signed = coefficient if quantity in column else -coefficient
            target[powers] = target.get(powers, Fraction(0)) + signed
    rows = [[_without_zeros(entry) for entry in row] for row in rows]
    denominator = determinant(rows)
    entries = [
        [
            determinant(_with_column(rows, column[Quantity(name, 1)], [_without_zeros(e) for e in side]))
            for side in right_sides.values()
        ]
        for name in state
    ]
    return state, entries, denominator


def check_one_step(method: Method) -> None:
    """Raise InputError unless the state at the end of a step follows from x, v and a at its start alone."""
    scheme = second_order_form(method.scheme)
    latest = {equation.result.name: equation.result.step for equation in scheme.equations}
    if steps(method) > 1 or latest[POSITION] != 1 or latest[VELOCITY] != 1:
        raise InputError(
            f"{method.name} uses values of several steps, and its coefficients assume that these are of equal length: "
            "nothing can be said of steps that vary"
        )
    results = {equation.result for equation in scheme.equations}
    for equation in scheme.equations:
        for quantity in equation.used:
            carried = quantity not in results
            if carried and (quantity.name not in STATE or quantity.step != 0):
                raise InputError(
                    f"{method.name} carries {quantity} from step to step: nothing is known of how it changes when the "
                    "step does"
                )


def _ends_with_its_acceleration(scheme: SecondOrder) -> bool:
    """Return whether the acceleration that is stored is the one at the state with which the step ends."""
    at_end = ((ONE, Quantity(POSITION, 1)),), ((ONE, Quantity(VELOCITY, 1)),)
    return Evaluation(Quantity(ACCELERATION, 1), *at_end) in scheme.equations


def _left_side(equation: Equation) -> list[tuple[Fraction, Quantity, tuple[int, int, int]]]:
    """Return what stands in `result - right-hand side = 0`: coefficient, quantity, powers of z, alpha_hat, beta_hat."""
    own = (ONE, equation.result, (0, 0, 0))
    if isinstance(equation, Assignment):
        return [own, *((-coefficient, quantity, (0, 0, 0)) for coefficient, quantity in equation.value)]
    by_position = [(coefficient, quantity, (0, 0, 1)) for coefficient, quantity in equation.position]
    by_velocity = [(coefficient, quantity, (0, 1, 0)) for coefficient, quantity in equation.velocity]
    return [own, *by_position, *by_velocity]


def _without_zeros(terms: Terms) -> Terms:
    return {powers: coefficient for powers, coefficient in terms.items() if coefficient}


def _with_column(rows: Matrix, number: int, column: list[Terms]) -> Matrix:
    """Return the matrix with another column in one place."""
    return [[column[i] if j == number else entry for j, entry in enumerate(row)] for i, row in enumerate(rows)]


def characteristic(matrix: list[list[Fraction]]) -> list[Fraction]:
    """Return the coefficients of det(z - matrix) in descending powers of z (Faddeev-LeVerrier), exact."""
    size = range(len(matrix))
    coefficients = [Fraction(1)]
    current = [[Fraction(int(i == j)) for j in size] for i in size]
    for number in range(1, len(matrix) + 1):
        current = matrix_product(matrix, current)
        coefficient = -sum((current[i][i] for i in size), Fraction(0)) / number
        coefficients.append(coefficient)
        current = [[current[i][j] + (coefficient if i == j else 0) for j in size] for i in size]
    return coefficients


def matrix_product(first: list[list[Fraction]], second: list[list[Fraction]]) -> list[list[Fraction]]:
    """Return the product of two square matrices, exact."""
    columns = list(zip(*second, strict=True))
    return [[sum((a * b for a, b in zip(row, c, strict=True)), Fraction(0)) for c in columns] for row in first]


def polynomial_product(first: StepPolynomial, second: StepPolynomial) -> StepPolynomial:
    """Return the product of two polynomials in s, exact, coefficients ascending."""
    terms = product(_terms(first), _terms(second), Work())
    return _ascending(terms, 0)


def _terms(polynomial: StepPolynomial) -> Terms:
    return {(power, 0, 0): coefficient for power, coefficient in enumerate(polynomial) if coefficient}


def polynomial_determinant(rows: list[list[StepPolynomial]]) -> StepPolynomial:
    """Return the determinant of a matrix of polynomials in s, exact, coefficients ascending."""
    return _ascending(determinant([[_terms(entry) for entry in row] for row in rows]), 0)
