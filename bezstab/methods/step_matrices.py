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

import numpy as np
from numpy.polynomial.polynomial import polyval

from bezstab.errors import InputError
from bezstab.methods.determinants import (
    RING,
    RING_ALPHA,
    RING_BETA,
    RING_W,
    ExactArray,
    as_fraction,
    coefficient_rows,
    cramer,
    determinant,
)
from bezstab.methods.schemes import Method, check_one_step
from bezstab.methods.second_order import SecondOrder
from bezstab.methods.step_equations import ACCELERATION, POSITION, STATE, VELOCITY, Evaluation, Quantity
from bezstab.rationals import ONE, ZERO, whole_multiples

LENGTH = RING_W  # s, where no w is left


@dataclass(frozen=True, eq=False)
class StepMatrix:
    """The matrix M = N / d of a step of length s: `numerators` and `denominator`, whole, by ascending powers of s.

    Their shapes are (powers, n, n) and (powers,). The state is (c, cdot) or, of a scheme that carries an acceleration,
    (c, cdot, cddot), in the unit of time in which s is given. `commuting`: the matrices of any two steps commute,
    whatever their lengths.
    """

    numerators: ExactArray
    denominator: ExactArray
    commuting: bool

    @property
    def size(self) -> int:
        """The number of quantities in the state: 2 or 3."""
        return len(self.numerators[0])

    def at(self, step: Fraction) -> ExactArray:
        """Return the matrix of one step, exact; ZeroDivisionError where the step has no solution."""
        return np.asarray(polyval(step, self.numerators) / polyval(step, self.denominator))


def step_matrix(method: Method, alpha_hat: Fraction, beta_hat: Fraction, hold: bool = False) -> StepMatrix:
    """Return the matrix of a step of s times the user's h, for which alpha_hat and beta_hat are given (dimensionless).

    alpha and beta stay as they are while s varies; with `hold` alpha_hat and beta_hat do. The method's step multiple is
    counted in. InputError for a method whose next state depends on more than one step.

    By Cramer's rule on the scheme's equations, which are linear in what a step finds: in their rows that has the power
    w^0, what the step begins with has w^1.
    """
    check_one_step(method)
    scheme, multiple = method.scheme.second_order, method.step_multiple
    along_s = RING.one if hold else LENGTH
    alpha, beta = along_s * (alpha_hat * multiple), along_s**2 * (beta_hat * multiple**2)
    found, known = (
        [[entry.coeff_wrt(0, power).compose([(RING_ALPHA, alpha), (RING_BETA, beta)]) for entry in row] for row in rows]
        for rows, power in ((coefficient_rows(scheme.equations), power) for power in (0, 1))
    )
    place = {equation.result.name: column for column, equation in enumerate(scheme.equations)}
    stored = Quantity(ACCELERATION, 0)
    results = {equation.result for equation in scheme.equations}
    carried = stored not in results and any(stored in equation.used for equation in scheme.equations)
    state = STATE if carried else STATE[:2]
    below = determinant(found)
    if not below:
        raise InputError(f"{method.name}: a step has no solution at this point")
    entries = [[cramer(found, place[name], [-row[place[side]] for row in known]) for side in state] for name in state]
    if carried and not hold and _ends_with_its_acceleration(scheme):
        # the stored acceleration is that of the state: it says nothing new
        entries = [[by_x - beta * by_a, by_v - alpha * by_a] for by_x, by_v, by_a in entries[:2]]
    size = len(entries)
    in_s = [below * LENGTH ** (size - 1)]  # all times so much, lest powers be negative
    for i, row in enumerate(entries):
        in_s += [entry * LENGTH ** (size - 1 + j - i) for j, entry in enumerate(row)]
    powers = [power for polynomial in in_s for power, _, _ in polynomial]
    whole, _ = whole_multiples([
        as_fraction(polynomial.get((power, 0, 0), ZERO))
        for power in range(min(powers), max(powers) + 1)
        for polynomial in in_s
    ])  # fmt: skip
    table = np.array(whole, object).reshape(-1, len(in_s))
    return StepMatrix(
        numerators=table[:, 1:].reshape(-1, size, size),
        denominator=table[:, 0],
        commuting=not hold and bool(method.scheme.mu_table),
    )


def _ends_with_its_acceleration(scheme: SecondOrder) -> bool:
    """Return whether the acceleration that is stored is the one at the state with which the step ends."""
    at_end = ((ONE, Quantity(POSITION, 1)),), ((ONE, Quantity(VELOCITY, 1)),)
    return Evaluation(Quantity(ACCELERATION, 1), *at_end) in scheme.equations
