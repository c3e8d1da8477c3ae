r"""Where a path through the plane of alpha_hat and beta_hat crosses the boundary: exactly, without sampling |z_p|.

Feedback that grows by a factor s, or a step that does, moves a point along a path (s^i alpha_hat, s^j beta_hat):

      beta_hat |          .--x             h:      (s alpha_hat, s^2 beta_hat), two rays of mu from zero
               |   arc .-'  /  .           alpha:  (s alpha_hat, beta_hat)
               |     .'    / .' x          beta:   (alpha_hat, s^2 beta_hat)
               |   .' ----o'---x----       x: a root z lies on the circle there
               |  '      /    /
               +----------------- alpha_hat

Of a method with mu the locus (locus_tracks) is followed to where it lies on the path, and lines on which one real mu is
held meet it in a quadratic of s. What float64 finds there is refined to DIGITS digits, because a weak feedback's mu lies
next to the imaginary axis, from which rounding cannot tell it. Of a second-order scheme the edges are exact curves.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction

import mpmath as mp
import numpy as np

from bezstab.methods import (
    Method,
    SecondOrder,
    coefficient_table,
    crossing_factors_in_plane,
    feedback_matrix,
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
NEARLY_DOUBLE = 1e-6  # of a factor: a double one splits by the root of rounding into the complex plane


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


def crossing_factors(path: Path) -> list[float]:
    """Return, ascending, every factor s > 0 at which a root z may pass the circle |z| = 1 along the path.

    Good to rounding; there may be more than those at which the verdict turns, which an exact verdict tells.
    """
    if path.alpha_hat == 0 and path.powers[1] == 0:
        return []  # all of the path is one point
    method = path.method
    if isinstance(method.scheme, SecondOrder):
        found = crossing_factors_in_plane(method, path.alpha_hat, path.beta_hat, path.powers)
    else:
        pencil = pencil_of(without_shared_factor(method))
        starts = [*_at_real_mu(path, pencil), *_on_the_locus(path, pencil)]
        found = [_refined(path, pencil.method, start) for start in starts]
    return sorted({factor for factor in found if 0 < factor < np.inf})


def _at_real_mu(path: Path, pencil: Pencil) -> Iterator[_Start]:
    """Yield where one real mu has a root on the circle: mu^2 + p mu + q = 0, a quadratic in s.

    Of a double factor, which rounding parts, the middle.
    """
    for mu in real_events(pencil, 1.0).tolist():
        of_alpha, of_beta = mu * pencil.to_feedback[0] + pencil.to_feedback[1]
        coefficients = np.zeros(3)
        coefficients[0] = mu * mu
        coefficients[path.powers[0]] += of_alpha * float(path.alpha_hat)
        coefficients[path.powers[1]] += of_beta * float(path.beta_hat)
        z = np.roots((pencil.table @ mu ** np.arange(pencil.table.shape[1]))[::-1])
        on_circle = z[np.argmin(np.abs(np.abs(z) - 1))] if z.size else 1.0
        for factor in np.roots(coefficients[::-1]):
            if factor.real > 0 and abs(factor.imag) <= NEARLY_DOUBLE * abs(factor):
                yield _Start(abs(float(np.angle(on_circle))), float(factor.real), mu)


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

    for track in tracks(pencil, 1.0, finer=1):
        theta = sign_changes(lambda at, track=track: beside_the_path(track, at), track.theta)  # type: ignore[misc]
        of_alpha, ratio = place(track, theta)
        factors = of_alpha / alpha_hat if path.powers == (1, 0) else np.sqrt(np.abs(ratio))
        for angle, factor, mu in zip(theta.tolist(), np.abs(factors).tolist(), track.at(theta).tolist(), strict=True):
            if factor > 0:
                yield _Start(angle, factor, mu)


def _refined(path: Path, method: Method, start: _Start) -> float:
    """Return the factor at which pi(e^(i theta), mu(s)) = 0 next to a start, by Newton's method in DIGITS digits.

    theta and s are real, the equation complex. Where it does not settle (next to a double mu, where float64 is as
    good): the start's factor.
    """
    with mp.workdps(DIGITS):
        table = [[_in_digits(c) for c in row] for row in coefficient_table(method)]
        feedback = [[_in_digits(c) for c in row] for row in feedback_matrix(method)]
        i, j = path.powers
        of_alpha, of_beta = ([row[0] * _in_digits(path.alpha_hat) for row in feedback],
                             [row[1] * _in_digits(path.beta_hat) for row in feedback])  # fmt: skip
        half_turns, s, mu = mp.mpf(start.theta) / mp.pi, mp.mpf(start.factor), mp.mpc(start.mu)
        if abs(start.theta - np.pi) < SETTLED:
            half_turns = mp.mpf(1)
        for _ in range(NEWTON_STEPS):
            p, q = (a * s**i + b * s**j for a, b in zip(of_alpha, of_beta, strict=True))
            by_s = [(i * a * s**i + j * b * s**j) / s for a, b in zip(of_alpha, of_beta, strict=True)]
            root = mp.sqrt(p * p / 4 - q)
            mu = min((-p / 2 + root, -p / 2 - root), key=lambda candidate: abs(candidate - mu))  # noqa: B023
            z = mp.expjpi(half_turns)
            value, by_z, by_mu = _value_and_slopes(table, z, mu)
            if root == 0:
                break
            along_theta = mp.pi * 1j * z * by_z
            along_s = -by_mu * (by_s[0] * mu + by_s[1]) / (2 * mu + p)
            determinant = along_theta.real * along_s.imag - along_theta.imag * along_s.real
            if determinant == 0:
                break
            step = (along_theta.imag * value.real - along_theta.real * value.imag) / determinant
            half_turns += (value.imag * along_s.real - value.real * along_s.imag) / determinant
            s += step
            if s <= 0:
                return 0.0  # on the other side of zero there is no path
            if abs(step) <= SETTLED * s:
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


def _in_digits(c: Fraction) -> mp.mpf:
    return mp.mpf(c.numerator) / c.denominator
