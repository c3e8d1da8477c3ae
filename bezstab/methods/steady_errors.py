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
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cache
from itertools import count
from math import ceil, factorial, lcm
from typing import Literal

import sympy as sp
from sympy.polys.rings import PolyElement, ring

from bezstab.methods.determinants import (
    RING,
    RING_ALPHA,
    RING_BETA,
    as_fraction,
    coefficient_rows,
    cramer,
    determinant,
)
from bezstab.methods.scheme_motions import evaluation_errors, evaluation_times
from bezstab.methods.schemes import Method
from bezstab.methods.second_order import SecondOrder
from bezstab.methods.step_equations import POSITION, VELOCITY, Quantity
from bezstab.rationals import ZERO

FORCED_RING, THETA, _, ALPHA, BETA = ring("theta, w, alpha_hat, beta_hat", sp.QQ)
"""Of the determinants, multiplied by what is forced: w is z^(-1) here, too."""

Part = Literal["x", "v"]

Powers = tuple[int, int]
"""Of alpha_hat and beta_hat."""

PlanePolynomial = dict[Powers, Fraction]
"""A polynomial in alpha_hat and beta_hat: its coefficients other than zero."""

ExponentialSum = dict[Powers, dict[tuple[Fraction, int], Fraction]]
"""By powers of alpha_hat and beta_hat: the coefficients of theta^m e^(k theta), by (k, m)."""


@dataclass(frozen=True, eq=False, repr=False)
class ForcedErrors:
    """The steady errors of position and velocity: two numerators over one denominator, exact, of the method's own step.

    `denominator` is P(z; alpha_hat, beta_hat) up to a factor, a polynomial in z = e^theta; `rounding` the share of its
    terms' sizes below which a sum is taken for zero: 0 where the coefficients are the method's own.
    """

    position: ExponentialSum
    velocity: ExponentialSum
    denominator: ExponentialSum
    rounding: Fraction

    def coefficient(self, terms: ExponentialSum, power: int) -> PlanePolynomial:
        """Return the coefficient of theta^power in one of the sums."""
        found: PlanePolynomial = {}
        for powers, of_powers in terms.items():
            parts = [c * k ** (power - m) / factorial(power - m) for (k, m), c in of_powers.items() if m <= power]
            total = sum(parts, ZERO)
            if abs(total) > self.rounding * sum(map(abs, parts), ZERO):
                found[powers] = total
        return found


@dataclass(frozen=True)
class LeadingTerm:
    """The first term of a sum in powers of h where alpha_hat and beta_hat are held: `numerator` / `denominator`.

    What it is multiplied by, and what `power` is, the function says that returns it.
    """

    power: int
    numerator: PlanePolynomial
    denominator: PlanePolynomial

    def at(self, alpha_hat: float, beta_hat: float) -> float:
        """Return numerator / denominator at a point."""
        above, below = (
            sum(float(c) * alpha_hat**i * beta_hat**j for (i, j), c in terms.items())
            for terms in (self.numerator, self.denominator)
        )
        return above / below


@cache
def forced_errors(method: Method) -> ForcedErrors:
    """Return the steady errors of a method, for any feedback and any motion e^(i omega t).

    InputError where the determinant of its equations would take too long. Source: the docstring of this file.
    """
    step = method.scheme.second_order
    forcing = THETA**2 + ALPHA * THETA + BETA
    alike = dict.fromkeys(evaluation_times(step), RING.one)
    position, velocity = (forcing * _determinant(step, (name, alike)) for name in (POSITION, VELOCITY))
    unforced = _determinant(step)
    lowest = max(k for _, k, _, _ in unforced)
    return ForcedErrors(
        position=_exponential_sum(position - unforced, step, lowest),
        velocity=_exponential_sum(velocity - THETA * unforced, step, lowest),
        denominator=_exponential_sum(unforced, step, lowest),
        rounding=method.rounding,
    )


def _determinant(step: SecondOrder, forced: tuple[str, Mapping[Quantity, PolyElement]] | None = None) -> PolyElement:
    """Return the determinant D of the equations, or D_x: with what is forced in place of the column of x.

    `forced` is that quantity's name, and what each evaluation adds to its acceleration, by its result, at its own time:
    times e^(time theta). The power of z that is left out is the same in all of them.
    """
    times, parts = evaluation_times(step), _parts(step)
    rows = coefficient_rows(step.equations, parts)
    latest = max(1, ceil(max(times.values())))  # of a step; x and v are those of its end
    if forced is None:
        return determinant(rows).mul_monom((parts * (latest - 1), 0, 0)).set_ring(FORCED_RING)
    name, added = forced
    side = [
        added[result].mul_monom((int((latest - times[result]) * parts), 0, 0)) if result in times else RING.zero
        for result in (equation.result for equation in step.equations)
    ]
    column = [equation.result.name for equation in step.equations].index(name)
    return cramer(rows, column, side).set_ring(FORCED_RING)


def _parts(step: SecondOrder) -> int:
    """Return into how many parts a step is divided, so that all times of evaluations are whole."""
    return lcm(*(time.denominator for time in evaluation_times(step).values()))


def _exponential_sum(polynomial: PolyElement, step: SecondOrder, lowest: int = 0) -> ExponentialSum:
    """Return a polynomial in w = e^(-theta / parts) as a sum, w^lowest being e^0."""
    found: ExponentialSum = {}
    for (m, k, i, j), c in polynomial.terms():
        found.setdefault((i, j), {})[Fraction(lowest - k, _parts(step)), m] = as_fraction(c)
    return found


@cache
def leading_error(method: Method, part: Part = "x") -> LeadingTerm:
    """Return the first term of the steady error of x (or of v), as a share of the motion's own x (or v).

    It is E theta^power, E = numerator / denominator: `power` is the order in h of the error where alpha_hat and
    beta_hat are held. Errors as `forced_errors`.
    """
    errors = forced_errors(method)
    terms, by_theta = (errors.position, 0) if part == "x" else (errors.velocity, 1)  # h v of the motion is theta
    return next(
        _in_h(method, power, numerator)
        for power in count()
        if (numerator := errors.coefficient(terms, power + by_theta))
    )


@cache
def velocity_lag(method: Method) -> Fraction:
    """Return s where velocities are off by a share of a step whatever the feedback, v = phi' + s h phi''; else 0.

    Symplectic Euler's are those of half a step earlier, s = -1/2. Errors as `forced_errors`.
    """
    term = leading_error(method, "v")
    shares = {term.numerator.get(powers, ZERO) / c for powers, c in term.denominator.items()}
    alike = term.power == len(shares) == 1 and term.numerator.keys() == term.denominator.keys()
    return shares.pop() if alike else ZERO


@cache
def turning_error(method: Method) -> LeadingTerm | None:
    """Return what normals that turn add to the leading error of x; None where nothing of its order.

    It is T h^(power + 1) Cdot_q q_t^(power), T = numerator / denominator, q_t^(power) the part of a derivative of the
    motion that lies along the constraint. Errors as `forced_errors`. Source: the docstring of this file.
    """
    errors, step = forced_errors(method), method.scheme.second_order
    for power in range(2, leading_error(method).power):
        off = evaluation_errors(step, power)
        if max(max(map(abs, pair)) for pair in off.values()) <= errors.rounding:
            continue
        normal = {result: RING_BETA * position + RING_ALPHA * velocity for result, (position, velocity) in off.items()}
        across = {result: RING_ALPHA * position for result, (position, _) in off.items()}
        by_normal, by_across = (
            errors.coefficient(_exponential_sum(_determinant(step, (POSITION, forced)), step), by_theta)
            for forced, by_theta in ((normal, 1), (across, 0))  # at theta^0 those along the normal cancel
        )
        sums = {at: -by_normal.get(at, ZERO) - by_across.get(at, ZERO) for at in {*by_normal, *by_across}}
        numerator = {at: c for at, c in sums.items() if abs(c) > errors.rounding}
        return replace(_in_h(method, power + 1, numerator), power=power)
    return None


def _in_h(method: Method, power: int, numerator: PlanePolynomial) -> LeadingTerm:
    """Return the coefficient of theta^power over D at z = 1, both in theta and the parameters of h.

    They are given in those of the method's own step, which is `step_multiple` h.
    """
    errors, multiple = forced_errors(method), method.step_multiple
    of_numerator = {(i, j): c * multiple ** (power + i + 2 * j) for (i, j), c in numerator.items()}
    of_denominator = {
        (i, j): c * multiple ** (i + 2 * j) for (i, j), c in errors.coefficient(errors.denominator, 0).items()
    }
    return LeadingTerm(power, of_numerator, of_denominator)
