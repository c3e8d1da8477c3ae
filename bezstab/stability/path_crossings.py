r"""Where a path through the plane of alpha_hat and beta_hat crosses the boundary: exactly, without sampling |z_p|.

Feedback that grows by a factor s, or a step that does, moves a point along a path (s^i alpha_hat, s^j beta_hat):

      beta_hat |          .--x             h:      (s alpha_hat, s^2 beta_hat), two rays of mu from zero
               |   arc .-'  /  .           alpha:  (s alpha_hat, beta_hat)
               |     .'    / .' x          beta:   (alpha_hat, s^2 beta_hat)
               |   .' ----o'---x----       x: a root z lies on the circle there
               |  '      /    /
               +----------------- alpha_hat

Of a method with mu the locus (locus_tracks) is followed to where it lies on the path, and lines on which one real mu
is held meet it in a quadratic of s. What float64 finds there is refined to DIGITS digits, because a weak feedback's mu
lies next to the imaginary axis, from which rounding cannot tell it. Of a second-order scheme the edges are exact
curves.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from functools import cache, partial

import mpmath as mp
import numpy as np

from bezstab.methods import (
    Method,
    SecondOrder,
    coefficient_table,
    crossing_factors_in_plane,
    feedback_matrix,
    first_order_form,
    without_shared_factor,
)
from bezstab.stability.arrays import FloatArray
from bezstab.stability.boundary_locus import feedback_coefficients, sign_changes
from bezstab.stability.line_slices import real_events
from bezstab.stability.locus_tracks import Track, tracks
from bezstab.stability.pencils import Pencil, pencil_of

DIGITS = 60  # three times those that a weak feedback's -Re mu = 1e-20 takes away
NEWTON_STEPS = 20  # from a start that is good to some digits five suffice
SETTLED = 1e-20  # relative: of the next step, the square of that
ON_THE_AXIS = 1e-9  # rad: a root that is so near to z = -1 is there, or Newton's method finds where it is
HALVINGS = 24  # of a sample's spacing: to 1e-10 rad, from where Newton's method goes on
NEARLY_DOUBLE = 1e-6  # relative: a double factor splits by the root of rounding into the complex plane


@dataclass(frozen=True)
class Path:
    """The points (s^i alpha_hat, s^j beta_hat), s > 0, (i, j) the powers: exact, dimensionless."""

    method: Method
    alpha_hat: Fraction
    beta_hat: Fraction
    powers: tuple[int, int]

    def at(self, factor: Fraction) -> tuple[Fraction, Fraction]:
        """Return the point at a factor s."""
        return self.alpha_hat * factor ** self.powers[0], self.beta_hat * factor ** self.powers[1]


@dataclass(frozen=True)
class _Start:
    """Where Newton's method begins: a root z = e^(i theta) at the factor, with one mu there."""

    theta: float
    factor: float
    mu: complex


@dataclass(frozen=True)
class _RealEvent:
    """A real mu, in DIGITS digits, at which a root z = e^(i theta) is on the circle; theta in rad, float64."""

    mu: mp.mpf
    theta: float


@dataclass(frozen=True)
class _Digits:
    """A method's pi(z, mu) and the feedback's p and q along a path, all in DIGITS digits.

    table[k][j] belongs to z^k mu^j; p and q are of_alpha s^i + of_beta s^j, each for (p, q), and (i, j) the powers.
    """

    table: list[list[mp.mpf]]
    of_alpha: tuple[mp.mpf, mp.mpf]
    of_beta: tuple[mp.mpf, mp.mpf]
    powers: tuple[int, int]


def crossing_factors(path: Path) -> list[float]:
    """Return, ascending, every factor s > 0 at which a root z may pass the circle |z| = 1 along the path.

    Good to rounding; there may be more than those at which the verdict turns, which an exact verdict tells.
    """
    if path.alpha_hat == 0 and path.powers[1] == 0:
        return []  # all of the path is one point
    method = first_order_form(path.method)
    if isinstance(method.scheme, SecondOrder):
        found = crossing_factors_in_plane(method, path.alpha_hat, path.beta_hat, path.powers)
    else:
        pencil = pencil_of(without_shared_factor(method))
        with mp.workdps(DIGITS):
            digits = _in_digits(path, pencil.method)
            found = [_refined(digits, start) for start in _on_the_locus(path, pencil)]
            for event in _real_mu_on_the_circle(pencil):
                found += _factors_with_one_mu(digits, event)
    return sorted({factor for factor in found if 0 < factor < np.inf})


def _in_digits(path: Path, method: Method) -> _Digits:
    of = _in_mpmath
    alpha_hat, beta_hat = of(path.alpha_hat), of(path.beta_hat)
    (p_alpha, p_beta), (q_alpha, q_beta) = feedback_matrix(method)
    return _Digits(
        table=_table_in_digits(method),
        of_alpha=(of(p_alpha) * alpha_hat, of(q_alpha) * alpha_hat),
        of_beta=(of(p_beta) * beta_hat, of(q_beta) * beta_hat),
        powers=path.powers,
    )


@cache
def _table_in_digits(method: Method) -> list[list[mp.mpf]]:
    with mp.workdps(DIGITS):
        return [[_in_mpmath(c) for c in row] for row in coefficient_table(method)]


def _in_mpmath(c: Fraction) -> mp.mpf:
    return mp.mpf(c.numerator) / c.denominator


@cache
def _real_mu_on_the_circle(pencil: Pencil) -> tuple[_RealEvent, ...]:
    """Return every real mu at which a root z has |z| = 1 (and perhaps others), in DIGITS digits, for every path."""
    table = _table_in_digits(pencil.method)
    with mp.workdps(DIGITS):
        return tuple(_refined_real_mu(table, pencil, mu) for mu in real_events(pencil, 1.0).tolist())


def _factors_with_one_mu(digits: _Digits, event: _RealEvent) -> list[float]:
    """Return the factors at which a real mu is one of the path's: mu^2 + p mu + q = 0, a quadratic in s.

    Where rounding alone makes that quadratic's roots a complex pair, so it makes the path's two mu one next to the real
    mu of the event. Their roots z pass the circle one before and one after the middle, as far apart as they are.
    """
    mu = event.mu
    coefficients = [mu * mu, mp.mpf(0), mp.mpf(0)]
    for power, (of_p, of_q) in zip(digits.powers, (digits.of_alpha, digits.of_beta), strict=True):
        coefficients[power] += of_p * mu + of_q
    constant, linear, square = coefficients
    if square == 0:
        return [float(-constant / linear)] if linear else []
    half = linear / square / 2
    discriminant = half * half - constant / square
    if discriminant < -(NEARLY_DOUBLE**2) * half * half:
        return []
    if discriminant < 0:
        middle, aside = float(-half), NEARLY_DOUBLE * abs(float(mu))
        return [_refined(digits, _Start(event.theta, middle, complex(mu, way))) for way in (-aside, aside)]
    root = mp.sqrt(discriminant)
    return [float(-half - root), float(-half + root)]


def _refined_real_mu(table: list[list[mp.mpf]], pencil: Pencil, mu: float) -> _RealEvent:
    """Return the real mu with a root on the circle next to one that float64 found, by Newton's method for both.

    What float64 found where that does not settle.
    """
    z = np.roots((pencil.table @ mu ** np.arange(pencil.table.shape[1]))[::-1])
    on_circle = z[np.argmin(np.abs(np.abs(z) - 1))] if z.size else 1.0
    theta = abs(float(np.angle(on_circle)))
    half_turns, better = _in_half_turns(theta), mp.mpf(mu)
    for _ in range(NEWTON_STEPS):
        z = mp.expjpi(half_turns)
        value, by_z, by_mu = _value_and_slopes(table, z, mp.mpc(better))
        steps = _real_steps(value, mp.pi * 1j * z * by_z, by_mu)
        if steps is None:
            break
        half_turns += steps[0]
        better += steps[1]
        if abs(steps[1]) <= SETTLED * abs(better):
            return _RealEvent(better, theta)
    return _RealEvent(mp.mpf(mu), theta)


def _in_half_turns(theta: float) -> mp.mpf:
    """Return an angle in units of pi; one exactly, where it is to rounding."""
    return mp.mpf(1) if abs(theta - np.pi) < ON_THE_AXIS else mp.mpf(theta) / mp.pi


def _real_steps(value: mp.mpc, along_first: mp.mpc, along_second: mp.mpc) -> tuple[mp.mpf, mp.mpf] | None:
    """Return the two real steps that take a complex value to zero, to first order; None if none do."""
    determinant = along_first.real * along_second.imag - along_first.imag * along_second.real
    if determinant == 0:
        return None
    first = (value.imag * along_second.real - value.real * along_second.imag) / determinant
    second = (along_first.imag * value.real - along_first.real * value.imag) / determinant
    return first, second


@cache
def _branches(pencil: Pencil) -> tuple[Track, ...]:
    """Return the branches of the locus of |z| = 1, the same for every path."""
    return tuple(tracks(pencil, 1.0, finer=1))


def _on_the_locus(path: Path, pencil: Pencil) -> Iterator[_Start]:
    """Yield where a pair of mu on the locus is the path's: a zero of a function of theta along each branch."""
    alpha_hat, beta_hat = float(path.alpha_hat), float(path.beta_hat)

    def place(track: Track, theta: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return alpha_hat, and beta_hat in units of the path's, of the locus."""
        mu = track.at(theta)
        of_locus = feedback_coefficients(mu, mu.conj()) @ pencil.to_user.T
        return of_locus[:, 0], of_locus[:, 1] / beta_hat

    def beside_the_path(track: Track, theta: FloatArray) -> FloatArray:
        of_alpha, ratio = place(track, theta)
        if path.powers == (1, 0):
            return ratio - 1
        if path.powers == (0, 2):
            return of_alpha - alpha_hat
        return of_alpha - alpha_hat * np.sqrt(np.maximum(ratio, 0))

    unit = 1.0 if path.powers == (1, 0) else abs(alpha_hat)
    for track in _branches(pencil):
        ends = track.theta[[0, -1]]  # where branches meet their conjugates a zero may be without a change of sign
        touched = ends[np.abs(beside_the_path(track, ends)) <= NEARLY_DOUBLE * unit]
        crossed = sign_changes(partial(beside_the_path, track), track.theta, HALVINGS)
        theta = np.append(crossed, touched)
        of_alpha, ratio = place(track, theta)
        factors = of_alpha / alpha_hat if path.powers == (1, 0) else np.sqrt(np.abs(ratio))
        for angle, factor, mu in zip(theta.tolist(), np.abs(factors).tolist(), track.at(theta).tolist(), strict=True):
            if factor > 0:
                yield _Start(angle, factor, mu)


def _refined(digits: _Digits, start: _Start) -> float:
    """Return the factor at which pi(e^(i theta), mu(s)) = 0 next to a start, by Newton's method in DIGITS digits.

    theta and s are real, the equation complex. Where it does not settle (next to a double mu, where float64 is as
    good): the start's factor. Zero where it leads to a factor below zero, as there is no path.
    """
    i, j = digits.powers
    half_turns, s, mu = _in_half_turns(start.theta), mp.mpf(start.factor), mp.mpc(start.mu)
    for _ in range(NEWTON_STEPS):
        of_p_and_q = list(zip(digits.of_alpha, digits.of_beta, strict=True))
        p, q = (a * s**i + b * s**j for a, b in of_p_and_q)
        p_by_s, q_by_s = ((i * a * s**i + j * b * s**j) / s for a, b in of_p_and_q)
        root = mp.sqrt(p * p / 4 - q)
        if root == 0:
            break
        one, other = -p / 2 + root, -p / 2 - root
        mu = one if abs(one - mu) < abs(other - mu) else other
        z = mp.expjpi(half_turns)
        value, by_z, by_mu = _value_and_slopes(digits.table, z, mu)
        steps = _real_steps(value, mp.pi * 1j * z * by_z, -by_mu * (p_by_s * mu + q_by_s) / (2 * mu + p))
        if steps is None:
            break
        half_turns += steps[0]
        s += steps[1]
        if s <= 0:
            return 0.0
        if abs(steps[1]) <= SETTLED * s:
            return float(s)
    return start.factor


def _value_and_slopes(table: list[list[mp.mpf]], z: mp.mpc, mu: mp.mpc) -> tuple[mp.mpc, mp.mpc, mp.mpc]:
    """Return pi(z, mu) and its derivatives by z and by mu; table[k][j] belongs to z^k mu^j."""
    value, by_z, by_mu = mp.mpc(0), mp.mpc(0), mp.mpc(0)
    for row in reversed(table):
        of_row, slope_of_row = mp.mpc(0), mp.mpc(0)
        for c in reversed(row):
            slope_of_row = slope_of_row * mu + of_row
            of_row = of_row * mu + c
        by_z = by_z * z + value
        value = value * z + of_row
        by_mu = by_mu * z + slope_of_row
    return value, by_z, by_mu
