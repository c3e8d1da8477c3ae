"""Engines that sweep over their constraints: how a step multiplies the errors of many constraints at once.

Sequential impulses solve one constraint after another (Gauss-Seidel) and start from the impulses of the last step. Then
the poles of one constraint say little about a chain. With A = J M^-1 J', the errors y = J x and u = h J v, one sweep
towards B p = b is, with D the diagonal of A and B = A + softness D,

    p <- S p + P b       P = ((1 + softness) D / relaxation + strictly lower part of A)^-1,  S = 1 - P B

so that k sweeps are p <- T p + G b with T = S^k and G = P + S P + ... + S^(k-1) P. Every stage of a step is linear in
(y, u, p), so a step is one matrix. It is exact where J is constant, as for a straight chain along its own line.
Where the constraints of a joint are solved together, D and what is below it are those of A in blocks, one a joint.
Motors are constraints with a share and a softness of their own.

Free motions are not in it, because y and u are errors, not coordinates.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from bezstab.engines.sweeping import MOST_SWEEPS, Motors, Move, Pass, SweptStep, VelocityOfMove
from bezstab.errors import InputError, NumericalError
from bezstab.rationals import bisected_integers
from bezstab.stability.arrays import EPS, FloatArray


@dataclass(frozen=True)
class Growth:
    """The factor by which a step multiplies the error in the long run, the spectral radius, and how far it may be off.

    The accuracy is to first order in rounding, so an estimate, no bound.
    """

    factor: float
    accuracy: float

    @property
    def decays(self) -> bool:
        """Whether errors decay, by more than the factor may be off."""
        return self.factor + self.accuracy < 1

    def check_settled(self) -> None:
        """Raise NumericalError where the accuracy leaves open whether errors decay or grow."""
        if abs(self.factor - 1) <= self.accuracy:
            raise NumericalError(
                f"each step multiplies the error by {self.factor:.12g}, which rounding moves by {self.accuracy:.1g}: "
                "too near 1 to tell"
            )


def chain(bodies: int, mass_ratio: float = 1.0) -> FloatArray:
    """Return J M^-1 J' of a straight chain of unit masses along its own line, the first body held by the world.

    Shape (bodies, bodies). The last body is `mass_ratio` times as heavy as the others.
    """
    masses = np.ones(bodies)
    masses[-1] = mass_ratio
    jacobian = np.eye(bodies) - np.eye(bodies, k=-1)  # each link: where its body is, less where the body before is
    return inverse_effective_masses(np.diag(masses), jacobian)


def inverse_effective_masses(mass: FloatArray, jacobian: FloatArray) -> FloatArray:
    """Return A = J M^-1 J', shape (m, m), for a mass matrix (n, n) and a Jacobian (m, n)."""
    return np.asarray(jacobian @ np.linalg.solve(mass, jacobian.T))


def swept_growth(inverse_masses: FloatArray, step: SweptStep, joints: Sequence[int] | None = None) -> Growth:
    """Return by what factor a step multiplies the errors of constraints with such inverse effective masses.

    `inverse_masses` is A = J M^-1 J', shape (m, m), of constraints in their order. One may follow from others, as the
    last of a straight chain between two walls: errors that no motion makes are left out. `joints` are the numbers of
    their joints, rising: those of one joint are solved together; None: each by itself. InputError where a constraint
    follows from others and impulses are softened. NumericalError where a number leaves float64's range.
    """
    return _spectral_radius(_matrix(_scaled_step(inverse_masses, step, joints)))


@dataclass(frozen=True)
class SlowestMotion:
    """What decays last, or grows: its pole, and sizes of errors and impulses at the end of a step, shape (m,) each.

    Both are of one motion of some size; impulses are times h.
    """

    pole: complex
    errors: FloatArray
    impulses: FloatArray


def slowest_motion(inverse_masses: FloatArray, step: SweptStep, joints: Sequence[int] | None = None) -> SlowestMotion:
    """Return the motion that grows by the factor that `swept_growth` has; arguments and errors as there.

    Where one constraint follows from others their impulses are the least ones.
    """
    swept = _scaled_step(inverse_masses, step, joints)
    values, vectors = np.linalg.eig(_matrix(swept))
    largest = int(np.argmax(np.abs(values)))
    errors, _, impulses = np.split(vectors[:, largest], [swept.seen.shape[1], -len(swept.root)])
    return SlowestMotion(
        complex(values[largest]),
        np.abs(swept.root.T @ swept.seen @ errors / swept.scale),
        np.abs(np.linalg.lstsq(swept.root, impulses, rcond=None)[0] * swept.scale),
    )


def swept_rest(
    inverse_masses: FloatArray, step: SweptStep, pull: FloatArray, joints: Sequence[int] | None = None
) -> FloatArray:
    """Return the errors at which constraints rest that a steady acceleration pulls at, shape (m,).

    `pull` (m,) is what it adds to their errors' rates in a step, times h: h^2 J a. The others and errors as
    `swept_growth`. Only where errors decay is there such a place.
    """
    swept = _scaled_step(inverse_masses, step, joints)
    pulled = np.asarray(np.linalg.lstsq(swept.root.T, swept.scale * pull, rcond=None)[0], dtype=np.float64)[:, None]
    matrix = _matrix(swept)
    nothing = np.zeros((3 * len(pulled), 1))
    at_rest = np.linalg.solve(np.eye(len(matrix)) - matrix, _seen(swept, swept.take(nothing, pulled)))[:, 0]
    return np.asarray(swept.root.T @ swept.seen @ at_rest[: swept.seen.shape[1]] / swept.scale)


Taking = Callable[[FloatArray, FloatArray], FloatArray]
"""What a step makes of states, columns of shape (3 r, k), and of what is added to their rates, (r, k) or (r, 1)."""


@dataclass(frozen=True)
class _ScaledStep:
    """A step of constraints whose errors are multiplied by `scale` (m,) first, so that the diagonal of A is one.

    `root` (r, m) is that of this A, root' root = A. `seen` (r, f) spans the errors that some pass takes back, which are
    the state; those of motors that hold a rate are not. `take` is the step.
    """

    scale: FloatArray
    root: FloatArray
    seen: FloatArray
    take: Taking


def _scaled_step(inverse_masses: FloatArray, step: SweptStep, joints: Sequence[int] | None) -> _ScaledStep:
    """Return the step of constraints with such inverse effective masses; errors as `swept_growth`."""
    scale = 1 / np.sqrt(np.diag(inverse_masses))
    scaled = scale[:, None] * inverse_masses * scale  # sweeps do the same; its diagonal is one
    values, vectors = np.linalg.eigh(scaled)
    made = values > ROUNDINGS * EPS * len(values)  # by motions
    softened = step.motors and step.motors.softness
    softened = softened or any(isinstance(stage, Pass) and stage.softness for stage in step.stages)
    if softened and not made.all():
        raise InputError("constraints that follow from others are not judged where the engine softens impulses")
    root = np.sqrt(values[made])[:, None] * vectors.T[made]  # root' root = A
    number = np.arange(len(scaled)) if joints is None else np.array(joints)
    seen = np.eye(len(root))
    if step.motors and not step.motors.share:
        seen = np.linalg.qr(root[:, ~np.array(step.motors.rows)])[0]
    return _ScaledStep(scale, root, seen, partial(_take_step, scaled, root, number, step))


def _matrix(swept: _ScaledStep) -> FloatArray:
    """Return the matrix of a step on the errors that are seen, rates and impulses; errors as `swept_growth`."""
    size, seen = len(swept.root), swept.seen
    states = np.eye(3 * size)
    states = np.hstack([states[:, :size] @ seen, states[:, size:]])
    matrix = _seen(swept, swept.take(states, np.zeros((size, 1))))
    if not np.isfinite(matrix).all():
        raise NumericalError("the matrix of a step with such sweeps leaves the range of float64")
    return matrix


def _seen(swept: _ScaledStep, states: FloatArray) -> FloatArray:
    """Return of states (3 r, k) the errors that are seen, rates and impulses."""
    size = len(swept.root)
    return np.vstack([swept.seen.T @ states[:size], states[size:]])


def _take_step(
    inverse_masses: FloatArray,
    root: FloatArray,
    joints: NDArray[np.intp],
    step: SweptStep,
    states: FloatArray,
    pulled: FloatArray,
) -> FloatArray:
    """Return what a step makes of states (3 r, k) for a root (r, m), root' root = A, and of what pulls at their rates.

    Errors and rates are root' of its first two thirds, impulses p with root p the last: there A is the identity.
    """
    errors, rates, impulses = np.split(states, 3)
    impulses = step.kept * impulses
    rates = rates + impulses + pulled
    before = errors
    for stage in step.stages:
        match stage:
            case Move(part):
                before, errors = errors, errors + part * rates
            case VelocityOfMove():
                rates = errors - before
            case Pass("velocity"):
                share, of_old, of_wanted = _sweeps(inverse_masses, root, joints, stage, step.motors)
                taken = stage.damping * rates + (1 - stage.damping) * pulled  # of what forces did, all
                wanted = root.T @ (impulses - taken) - share * (root.T @ errors)
                new = of_old @ impulses + of_wanted @ wanted
                rates, impulses = rates + new - impulses, new
            case Pass("position"):
                share, _, of_wanted = _sweeps(inverse_masses, root, joints, stage, step.motors)
                errors = errors - of_wanted @ (share * (root.T @ errors))
    return np.vstack([errors, rates, impulses])


def _sweeps(
    inverse_masses: FloatArray, root: FloatArray, joints: NDArray[np.intp], one_pass: Pass, motors: Motors | None
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the share of each error that is wanted (m, 1), T and G root'^-1: k sweeps make T p + G b of p.

    T is in the coordinates of root; b is as it is. One sweep takes (p, b) to (S p + P b, b); the matrix of that to the
    power k has T and G in its upper half.
    """
    driven = np.array(motors.rows if motors else [False] * len(inverse_masses))
    share, softness = np.full(driven.shape, one_pass.share), np.full(driven.shape, one_pass.softness)
    if motors:
        share[driven] = motors.share
        softness[driven] = one_pass.softness if motors.softness is None else motors.softness
    over = ~driven if one_pass.kind == "position" else np.full(driven.shape, True)
    apart = np.where(over[:, None] & over, inverse_masses, np.eye(len(over)))  # others stay as they are
    diagonal = np.where(joints[:, None] == joints, apart, 0.0)  # D, in blocks
    below = np.where(joints[:, None] > joints, apart, 0.0)
    triangle = diagonal * (1 + softness[:, None]) / one_pass.relaxation + below
    added = (root * over) @ np.linalg.inv(triangle)  # P
    back = root.T.copy()  # B
    if softness.any():
        back += softness[:, None] * diagonal @ np.linalg.inv(root)
    count, others = added.shape
    one_sweep = np.block([[np.eye(count) - added @ back, added], [np.zeros((others, count)), np.eye(others)]])
    of_old, of_wanted = np.hsplit(np.linalg.matrix_power(one_sweep, one_pass.sweeps)[:count], [count])
    return share[:, None], of_old, of_wanted


ROUNDINGS = 10
"""Of sums as long as the matrix, before and within LAPACK: its errors are those of a matrix so near."""


def _spectral_radius(matrix: FloatArray) -> Growth:
    """Return the largest modulus of the eigenvalues, and how far rounding may have moved it, to first order.

    An eigenvalue moves by at most its condition |x| |y| / |y' x| times the perturbation, x and y its right and left
    eigenvectors: a column of V, of length one, and the row of V^-1. Others may be found worse, as 1 - share is, and 0,
    which sweeps make multiple: they are not largest where that matters, and where they are, their own condition says
    so.
    """
    values, vectors = np.linalg.eig(matrix)
    largest = int(np.argmax(np.abs(values)))
    condition = float(np.linalg.norm(np.linalg.pinv(vectors)[largest]))
    perturbation = ROUNDINGS * EPS * len(matrix) * float(np.linalg.norm(matrix))
    most = perturbation ** (1 / len(matrix))  # of one that is all of the matrix's, as 0 may be
    return Growth(float(np.abs(values[largest])), min(perturbation * condition, most))


def fewest_sweeps(growth: Callable[[int], Growth]) -> int | None:
    """Return from how many sweeps errors decay, None if that is not so up to MOST_SWEEPS.

    `growth` is the growth with so many sweeps. Twice as many are looked at until errors decay and do so with twice as
    many again; the first number is then found by halving. Where stability comes and goes between, that is not seen:
    in none of the chains tried did it.
    """
    enough = 1
    while not (growth(enough).decays and growth(min(2 * enough, MOST_SWEEPS)).decays):
        if enough == MOST_SWEEPS:
            return None
        enough = min(2 * enough, MOST_SWEEPS)
    _, fewest = bisected_integers(lambda sweeps: growth(sweeps).decays, enough // 2, enough)
    return fewest
