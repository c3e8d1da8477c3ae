r"""The error that a method makes anew in each step, with this feedback: an exact function of it and of the motion.

A constraint moves, q = phi(t), and the feedback holds q to it (Prothero and Robinson's test equation, 1974, carried to
Baumgarte's feedback):

    q'' = phi'' - 2 alpha (q' - phi') - beta^2 (q - phi),      phi = e^(i omega t),   theta = i omega h

Its solution is phi. The method's own steady answer is found from the equations of its step (second_order.py), whose
evaluations now see what is forced, at their times tau, in units in which h = 1:

    a = -alpha_hat v - beta_hat x + F e^(tau theta),      F = theta^2 + alpha_hat theta + beta_hat

A shift by one step is a factor z = e^theta, so that x and v follow by Cramer's rule: D is the determinant of the
equations' coefficients (it is P up to a factor), D_x the same with e^(tau theta) in place of the column of x.

    error of x  =  F D_x(z) / D(z) - 1      =  (F D_x - D) / D
    error of hv =  F D_v(z) / D(z) - theta  =  (F D_v - theta D) / D

Both numerators are sums of terms c theta^m e^(k theta) alpha_hat^i beta_hat^j with rational c and k: their power series
in theta is exact. It begins with the power at which errors vanish with h where alpha_hat and beta_hat are held; that
power's coefficient, over D at z = 1, is the error constant as a function of the feedback.

**Normals that turn.** A mechanism's C_q turns while it moves, and what a method makes of the motion along a constraint,
too, comes to lie across it. Where evaluations are off by rho theta^r and nu theta^r in position and velocity (h v) and
the errors they make cancel, so that x begins with a power above r only, as Gauss's two stages do, what cancels is
C_q q^(r); with the normals turned from one evaluation to the next, and with hcdot = C_q h v + h Cdot_q x, there is left

    h^(r+1) Cdot_q q_t^(r) T,      T = - R_1(alpha_hat nu + beta_hat rho) - R_0(alpha_hat rho),

of the order of theta^(r+1) itself. q_t is the part of q^(r) along the constraint, of which the test equation knows
nothing, and R_0 + R_1 theta + ... the response of x to accelerations of the evaluations: D_x / D with these in place of
what is forced.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cache
from itertools import count
from math import ceil, factorial, lcm
from types import MappingProxyType
from typing import Literal

from bezstab.methods.determinants import RING, as_fraction, coefficient_rows, determinant
from bezstab.methods.scheme_motions import evaluation_errors, evaluation_times
from bezstab.methods.schemes import Method
from bezstab.methods.second_order import SecondOrder
from bezstab.methods.step_equations import POSITION, VELOCITY, Quantity
from bezstab.rationals import ONE, ZERO

Part = Literal["x", "v"]

Powers = tuple[int, int]
"""Of alpha_hat and beta_hat."""

PlanePolynomial = dict[Powers, Fraction]
"""A polynomial in alpha_hat and beta_hat: its coefficients other than zero."""

ExponentialSum = dict[Powers, dict[tuple[Fraction, int], Fraction]]
"""By powers of alpha_hat and beta_hat: the coefficients of theta^m e^(k theta), by (k, m)."""

KEPT_DIGITS = 2
"""Of an irrational coefficient's rational, so many digits less than it has: what their sums leave over is not there."""


@dataclass(frozen=True, eq=False)
class ForcedErrors:
    """The steady errors of position and velocity: two numerators over one denominator, exact, of the method's own step.

    `denominator` is P(z; alpha_hat, beta_hat) up to a factor; `rounding` the share of its terms' sizes below which a
    sum is taken for zero: 0 where the coefficients are the method's own.
    """

    method: Method
    position: ExponentialSum = field(repr=False)
    velocity: ExponentialSum = field(repr=False)
    denominator: ExponentialSum = field(repr=False)
    rounding: Fraction = field(repr=False)

    def numerator(self, part: Part) -> ExponentialSum:
        """Return the numerator of the error of x or of h v."""
        return self.position if part == "x" else self.velocity

    def coefficient(self, terms: ExponentialSum, power: int) -> PlanePolynomial:
        """Return the coefficient of theta^power in one of the sums."""
        found = {powers: self.series_coefficient(of_powers, power) for powers, of_powers in terms.items()}
        return {powers: c for powers, c in found.items() if c}

    def series_coefficient(self, of_powers: dict[tuple[Fraction, int], Fraction], power: int) -> Fraction:
        """Return the coefficient of theta^power in a sum of c theta^m e^(k theta)."""
        parts = [c * Fraction(k) ** (power - m) / factorial(power - m) for (k, m), c in of_powers.items() if m <= power]
        total = sum(parts, ZERO)
        return ZERO if abs(total) <= self.rounding * sum(map(abs, parts), ZERO) else total


@dataclass(frozen=True)
class LeadingError:
    """What is left of a steady error as h shrinks: E theta^power where alpha_hat and beta_hat are held.

    E = numerator / denominator, polynomials in alpha_hat and beta_hat. `order_left` is the order in h of the error, of
    q itself or of its velocity, where alpha_hat and beta_hat are held; `order` where alpha and beta are.
    """

    power: int
    numerator: PlanePolynomial
    denominator: PlanePolynomial
    order_left: int
    order: int


@dataclass(frozen=True)
class TurningError:
    """What normals that turn add to the leading error: T h^(power + 1) Cdot_q q_t^(power), T = numerator / denominator.

    q_t^(power) is the part of a derivative of the motion that lies along the constraint (docstring of this file).
    """

    power: int
    numerator: PlanePolynomial
    denominator: PlanePolynomial


@cache
def forced_errors(method: Method) -> ForcedErrors:
    """Return the steady errors of a method, for any feedback and any motion e^(i omega t).

    InputError where the determinant of its equations would take too long. Source: the docstring of this file.
    """
    step = method.scheme.second_order
    alike: dict[Quantity, PlanePolynomial] = {result: {(0, 0): ONE} for result in evaluation_times(step)}
    unforced = _determinant(step)
    return ForcedErrors(
        method=method,
        position=_forced_less(_determinant(step, POSITION, alike), unforced, power=0),
        velocity=_forced_less(_determinant(step, VELOCITY, alike), unforced, power=1),
        denominator=unforced,
        rounding=ZERO if method.digits is None else Fraction(1, 10 ** (method.digits - KEPT_DIGITS)),
    )


def _determinant(
    step: SecondOrder, name: str | None = None, forced: Mapping[Quantity, PlanePolynomial] = MappingProxyType({})
) -> ExponentialSum:
    """Return the determinant D of the equations, or D_name: with what is forced in place of the column of a quantity.

    `forced` is what each evaluation adds to its acceleration, by its result, at its own time: times e^(time theta).
    """
    times = evaluation_times(step)
    parts = lcm(*(time.denominator for time in times.values()))  # of a step, so that all times are whole
    rows = coefficient_rows(step.equations, parts)
    steps = {equation.result.name: equation.result.step for equation in step.equations}
    if name is not None:
        column, latest = list(steps).index(name), ceil(max(times.values()))
        for row, equation in zip(rows, step.equations, strict=True):
            earlier = int((latest - times.get(equation.result, ZERO)) * parts)
            added = forced.get(equation.result, {})
            row[column] = RING.from_dict({(earlier, i, j): c for (i, j), c in added.items()})
        steps[name] = latest
    found: ExponentialSum = {}
    for (k, i, j), c in determinant(rows).terms():
        found.setdefault((i, j), {})[sum(steps.values()) - Fraction(k, parts), 0] = as_fraction(c)
    return found


@cache
def leading_error(method: Method, part: Part = "x") -> LeadingError:
    """Return the first term of the steady error of x (or of h v) in powers of h, and the orders that it leaves.

    The error of v itself is that of h v divided by h: its orders are less by one. Errors as `forced_errors`.
    """
    errors = forced_errors(method)
    terms = errors.numerator(part)
    power = next(power for power in count() if errors.coefficient(terms, power))
    by_h = 0 if part == "x" else 1
    return LeadingError(
        power=power,
        numerator=_in_h(errors.coefficient(terms, power), method.step_multiple, power),
        denominator=_in_h(errors.coefficient(errors.denominator, 0), method.step_multiple, 0),
        order_left=power - by_h,
        order=_least_weight(errors, terms) - _least_weight(errors, errors.denominator) - by_h,
    )


@cache
def turning_error(method: Method) -> TurningError | None:
    """Return what normals that turn add to the leading error of x; None where nothing of its order.

    Errors as `forced_errors`. Source: the docstring of this file.
    """
    errors, step = forced_errors(method), method.scheme.second_order
    for power in range(2, leading_error(method).power):
        off = evaluation_errors(step, power)
        if max(max(map(abs, pair)) for pair in off.values()) <= errors.rounding:
            continue
        normal = {result: {(0, 1): position, (1, 0): velocity} for result, (position, velocity) in off.items()}
        across = {result: {(1, 0): position} for result, (position, _) in off.items()}
        by_normal = errors.coefficient(_determinant(step, POSITION, normal), 1)  # at 0 they cancel
        by_across = errors.coefficient(_determinant(step, POSITION, across), 0)
        sums = {
            powers: -by_normal.get(powers, ZERO) - by_across.get(powers, ZERO) for powers in {*by_normal, *by_across}
        }
        numerator = {powers: c for powers, c in sums.items() if abs(c) > errors.rounding}
        return TurningError(
            power=power,
            numerator=_in_h(numerator, method.step_multiple, power + 1),
            denominator=_in_h(errors.coefficient(errors.denominator, 0), method.step_multiple, 0),
        )
    return None


def _least_weight(errors: ForcedErrors, terms: ExponentialSum) -> int:
    """Return the lowest power of h in a sum where alpha and beta are held: alpha_hat counts one, beta_hat two."""

    def has_terms(weight: int) -> bool:
        low = [(i, j) for i, j in terms if i + 2 * j <= weight]
        return any(errors.series_coefficient(terms[i, j], weight - i - 2 * j) for i, j in low)

    return next(weight for weight in count() if has_terms(weight))


def _in_h(polynomial: PlanePolynomial, multiple: Fraction, power: int) -> PlanePolynomial:
    """Return the coefficient of theta^power of a step of `multiple` h, theta and the parameters being those of h."""
    return {(i, j): c * multiple ** (power + i + 2 * j) for (i, j), c in polynomial.items()}


def _forced_less(forced: ExponentialSum, unforced: ExponentialSum, power: int) -> ExponentialSum:
    """Return F times one sum, F = theta^2 + alpha_hat theta + beta_hat, less theta^power times another.

    Like terms are added up, and those that cancel are left out.
    """
    by_forcing = [(forced, 2, (0, 0), ONE), (forced, 1, (1, 0), ONE), (forced, 0, (0, 1), ONE)]
    total: ExponentialSum = {}
    for terms, by_theta, (by_alpha, by_beta), factor in [*by_forcing, (unforced, power, (0, 0), -ONE)]:
        for (i, j), of_powers in terms.items():
            sum_so_far = total.setdefault((i + by_alpha, j + by_beta), {})
            for (k, m), c in of_powers.items():
                sum_so_far[k, m + by_theta] = sum_so_far.get((k, m + by_theta), ZERO) + factor * c
    present = {powers: {key: c for key, c in of_powers.items() if c} for powers, of_powers in total.items()}
    return {powers: of_powers for powers, of_powers in present.items() if of_powers}
