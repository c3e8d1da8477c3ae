"""The dominant pole in the log of somebody else's simulator, and which method and feedback it is the pole of.

    log ---> response ---> linear prediction ---> z +- error          probed_pole
                                                  |
             dominant pole of each method, z^k ---+---> distances     likenesses, told
             P(z; alpha_hat, beta_hat) = 0     ---+---> a point       point_like

k is the number of steps between two rows. What is allowed to a distance is the error of z and what the motion of the
mechanism may do: constraints whose directions turn by an angle a step shift each pole by about |chi| times that
(`stability.turning`), which one log does not tell from another method's pole. What counts is how fast the directions
turn at all, not against each other alone: a log is short.
"""

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from fractions import Fraction
from itertools import product

import numpy as np
from numpy.polynomial.polynomial import polyder, polyval2d, polyval3d
from numpy.typing import ArrayLike

from bezstab.errors import InputError, NumericalError
from bezstab.methods.derivation import closed_loop_table
from bezstab.methods.schemes import Method
from bezstab.runs.kicks import GROWN
from bezstab.runs.linear_prediction import Fit, fit_dominant_pole
from bezstab.runs.measured_poles import CLOSE
from bezstab.stability.arrays import ComplexArray, FloatArray
from bezstab.stability.closed_loop import dominant_pole, spectral_radius
from bezstab.stability.regions import region, window
from bezstab.stability.turning import moving_pole

ORDER = 8
"""Poles that are looked for: as many as four-step methods have. Of longer ones the lesser poles die out first."""

FEWEST = 12
"""Samples: two windows that differ, each with more equations than a pair of poles has unknowns."""

SHARES = (1.0, 1e-1, 1e-2, 1e-3, 1e-4)
"""Of the kick that a user gives, and of the largest sample of a response that grows: one is in the linear range."""

FORCED = 0.05
"""In the plane: of one run a pole that is nearer to 1 may be what a motion forces, which changes little in a row."""

TURNED = 3e-2
"""rad a step, where nobody has said how fast the mechanism turns: 300 revolutions a minute at 1 ms, or one in two
seconds at 100 Hz."""

SETTLED = 1e-6
"""Of a point's size, and of |z|: where Newton's method changes less, the next change would be about the square."""

SAME = 1e-9
"""Of poles: methods that differ by less have one polynomial there, but for factors of z."""

STARTS = 5
"""Of Newton's method along each side of the region's window."""

ITERATIONS = 40
"""Of Newton's method: it settles within some twenty, or nowhere."""


@dataclass(frozen=True)
class ProbedPole:
    """The dominant pole in one response, per row of the log; `pole` is None, and `reason` says why, if none is claimed.

    `uncertainty` is the error of the fit in the plane, `samples` the number of rows that it rests on; `poles` are all
    that are seen, by modulus, in the closed upper half plane.
    """

    pole: complex | None
    uncertainty: float
    samples: int
    poles: tuple[complex, ...]
    reason: str = ""


@dataclass(frozen=True)
class Likeness:
    """How far a probed pole is from a method's dominant one at a point, `predicted`, per row of the log.

    `allowed` is the error of the fit and what the motion of the mechanism may do; where the pole `fits` it is no
    farther, and the log may be the method's.
    """

    method: Method
    predicted: complex
    distance: float
    allowed: float
    fits: bool


@dataclass(frozen=True)
class LikePoint:
    """A point at which a method has the probed pole for its dominant one; errors by the error of the fit."""

    method: Method
    alpha_hat: float
    beta_hat: float
    alpha_hat_error: float
    beta_hat_error: float


def probed_pole(c: ArrayLike, minus: ArrayLike | None = None, differenced: bool = False) -> ProbedPole:
    """Return the dominant pole in samples of an error at equal distances in time, dimensionless, per sample.

    `c` has shape (samples,), or (samples, responses) for several of one linear system; its unit is the user's. `minus`,
    of the same shape, is another run to be subtracted: what both have in common, such as the forcing by truncation
    errors, goes. `differenced` says that this has been done. Else differences from row to row take off what a motion
    forces. No errors are raised for samples that show no pole: `reason` says so. InputError for arrays of other shapes.
    Method: linear prediction (`fit_dominant_pole`).
    """
    responses = _responses(c, minus)
    if len(responses) < FEWEST:
        return ProbedPole(None, np.nan, 0, (), f"{len(responses)} rows: at least {FEWEST} are needed")
    alone = minus is None and not differenced
    (fit, reason), (of_changes, _) = (_fitted(np.diff(responses, n=times, axis=0)) for times in (0, 1))
    if fit:
        reason = _forced(fit, np.abs(responses), alone)
        off = abs(fit.pole - of_changes.pole) if of_changes else 0.0
        if not reason and of_changes and abs(fit.pole - 1) < FORCED and off > fit.uncertainty + of_changes.uncertainty:
            reason = "what hardly changes from row to row is no pole that differences show too: two motions part"
    elif of_changes:
        fit, reason = of_changes, _forced(of_changes, np.abs(np.diff(responses, axis=0)), alone)
    else:
        reason += "; log more digits, or kick harder"
    if fit and not reason:
        return ProbedPole(fit.pole, fit.uncertainty, fit.samples, fit.poles)
    return ProbedPole(None, np.nan, 0, (), reason)


def _fitted(responses: FloatArray) -> tuple[Fit | None, str]:
    sizes = np.abs(responses)
    floor = sizes[sizes > 0].min(initial=np.inf) / 2  # of decimals; a response that decays is never below it
    return fit_dominant_pole(responses, ORDER, limits=_linear_limits(sizes), floor=floor)


def _responses(c: ArrayLike, minus: ArrayLike | None) -> FloatArray:
    """Return the responses from the kick on, shape (samples, responses). InputError for arrays of other shapes."""
    runs = [np.asarray(each, np.float64) for each in (c, minus) if each is not None]
    if any(each.ndim not in (1, 2) or each.shape[1:] != runs[0].shape[1:] for each in runs):
        shapes = " and ".join(str(each.shape) for each in runs)
        raise InputError(f"shape {shapes}: expected (samples,), or (samples, responses), for c and minus")
    shared = min(map(len, runs))  # of two runs one may have ended early
    with np.errstate(invalid="ignore"):  # what is infinite ends a response
        samples = np.subtract(*(each[:shared] for each in runs)) if len(runs) == 2 else runs[0]
    samples = np.where(np.isfinite(samples), samples, np.nan).reshape(shared, -1)
    return samples[int((samples != 0).any(axis=1).argmax()) :]  # two runs are the same until one is kicked


def _linear_limits(sizes: FloatArray) -> Sequence[float]:
    """Return the sizes up to which samples are tried as linear: those of a response that grows may leave it."""
    largest = np.nan_to_num(sizes).max(axis=1)
    grows = largest[4 * len(largest) // 5 :].max() > GROWN * largest[:3].max()  # one row may be next to zero
    return [share * float(largest.max()) for share in SHARES] if grows else (np.inf,)


def _forced(fit: Fit, sizes: FloatArray, alone: bool) -> str:
    """Return why a pole may be what a motion forces, or how two motions part; "" where it is not."""
    tell = "; a second run, without the kick or with the opposite one, would tell (--minus)" if alone else ""
    if abs(abs(fit.pole) - 1) < max(CLOSE, fit.uncertainty):
        return f"what shows neither decays nor grows: forced by the motion, or a pole on the unit circle{tell}"
    if alone and abs(fit.pole - 1) < FORCED:
        return f"what shows hardly changes from row to row: forced by the motion, or a pole near 1{tell}"
    before, within = np.split(np.nan_to_num(sizes).max(axis=1)[: fit.start + fit.samples], [fit.start])
    half = len(within) // 2
    with np.errstate(over="ignore"):
        traced_back = within.max() * np.minimum(abs(fit.pole), 1.0) ** -fit.start  # what grows was no larger
        grown = within[:half].max() * abs(fit.pole) ** half if abs(fit.pole) > 1 else 0.0
    if grown > GROWN * within[half:].max() or before.max(initial=0.0) > GROWN * traced_back:
        return f"no pole accounts for what shows all through the log: forced by the motion{tell}"
    return ""


def likenesses(
    probed: ProbedPole, methods: Sequence[Method], every: int, alpha_hat: Fraction, beta_hat: Fraction, turned: float
) -> list[Likeness]:
    """Return how far a probed pole is from that of each method at a point (dimensionless), the nearest first.

    A row comes `every` steps. A method whose poles overflow at the point is left out: it has made no log. `turned`
    is the angle (rad) by which the directions of the constraints turn in a step, at most. No likenesses without a pole.
    Roots of paper Eq. 17; the motion by the first-order law, and the square of the angle for the next order.
    """
    point = float(alpha_hat), float(beta_hat)
    found: list[Likeness] = []
    if probed.pole is None:
        return found
    for method in methods:
        with suppress(NumericalError, OverflowError):
            steps = every / float(method.step_multiple)
            predicted = complex(dominant_pole(method, *point)) ** steps
            predicted = complex(predicted.real, abs(predicted.imag))
            moving = moving_pole(method, turned, 1.0, *point)
            moved = steps * (
                moving.z_abs ** (steps - 1) * (moving.z_abs - moving.at_least) + abs(predicted) * turned**2
            )
            distance, allowed = abs(predicted - probed.pole), probed.uncertainty + moved
            found.append(Likeness(method, predicted, distance, allowed, distance <= allowed))
    return sorted(found, key=lambda one: one.distance)


def kicked_responses(
    step: Callable[[FloatArray], FloatArray],
    state: ArrayLike,
    constraint: Callable[[FloatArray], float],
    kick: ArrayLike,
    steps: int,
) -> FloatArray:
    """Return half the difference of constraint errors after kicks up and down, shape (steps + 1, kicks).

    `step` takes a state, an array of any shape, to the next; `constraint` is the error in a state. The state is kicked
    by `kick`, of its shape, and by small parts of it (SHARES): decay is seen longest after the largest, growth after
    the smallest. From where an error is not finite all is nan, and no step is taken. InputError for a kick of another
    shape.
    """
    start, change = np.asarray(state, np.float64), np.asarray(kick, np.float64)
    if start.shape != change.shape:
        raise InputError(f"kick has shape {change.shape}, the state has {start.shape}")
    responses = np.full((steps + 1, len(SHARES)), np.nan)
    with np.errstate(all="ignore"):  # what diverges runs into infinity, and is cut off there
        for place, share in enumerate(SHARES):
            states = [start + share * change, start - share * change]
            for k in range(steps + 1):
                up, down = (float(constraint(each)) for each in states)
                responses[k, place] = (up - down) / 2
                if not np.isfinite(responses[k, place]):
                    break
                states = [np.asarray(step(each)) for each in states]
    return responses


def told(found: Sequence[Likeness]) -> list[Likeness]:
    """Return the methods that have the pole; none where more is allowed than they differ by from another.

    Several have it if they have one pole there, which no log tells from each other.
    """
    fitting = [one for one in found if one.fits]
    if not fitting:
        return []
    allowed = max(one.allowed for one in fitting)
    apart = [(abs(one.predicted - fitting[0].predicted), one.fits) for one in found]
    return [] if any(distance > SAME and (fits or distance <= allowed) for distance, fits in apart) else fitting


def point_like(probed: ProbedPole, method: Method, every: int = 1) -> LikePoint | None:
    """Return the point at which a method has the probed pole for its dominant one, nearest to an exact integrator's.

    A complex pole and its conjugate are two equations P(z; alpha_hat, beta_hat) = 0 for the two unknowns, and so are
    two real poles; None where one real pole leaves a curve of points, and where there is no such point. A row comes
    `every` steps: the root per step of least angle is taken. NumericalError as `region`.
    """
    if probed.pole is None:
        return None
    steps = every / float(method.step_multiple)
    poles = [pole ** (1 / steps) for pole in probed.poles]
    error = probed.uncertainty / (steps * abs(poles[0]) ** (steps - 1))
    pair = [poles[0], poles[0].conjugate()]
    if poles[0].imag <= error:
        pair = [complex(pole.real) for pole in poles if pole.imag <= error][:2]
    if len(pair) < 2 or not all(pair):
        return None
    z = np.array(pair)
    mu = np.log(z)  # of an exact integrator
    exact = -float(mu.sum().real), float(mu.prod().real)
    starts = product(*(np.linspace(low, high, STARTS) for low, high in window(region(method))))
    found = _points_with(method, z, error, np.array([exact, *starts]).T)
    return min(found, key=lambda one: abs(one.alpha_hat - exact[0]) + abs(one.beta_hat - exact[1]), default=None)


def _points_with(method: Method, z: ComplexArray, error: float, starts: FloatArray) -> list[LikePoint]:
    """Return the points to which Newton's method leads from starts, (2, starts), and at which z, (2,), is dominant."""
    table = np.array(closed_loop_table(method), float)  # by powers of z, alpha_hat and beta_hat
    equations = np.moveaxis(np.tensordot(z[:, np.newaxis] ** np.arange(len(table)), table, axes=1), 0, -1)
    by_each = [equations, polyder(equations, axis=0), polyder(equations, axis=1)]
    a, b = starts
    with np.errstate(all="ignore"):  # what leaves the range is left out, and a curve of points, which has no slope
        for _ in range(ITERATIONS):
            (first, second), (first_a, second_a), (first_b, second_b) = (polyval2d(a, b, each) for each in by_each)
            slope = first_a * second_b - first_b * second_a
            change = np.array([first * second_b - second * first_b, second * first_a - first * second_a]) / slope
            a, b = a - change[0].real, b - change[1].real
        slopes = np.abs([polyval3d(pole + 0 * a, a, b, polyder(table)) for pole in z]) * error  # each pole may be off
        errors = np.abs([[second_b, first_b], [second_a, first_a]] / slope)
        off = np.einsum("ijk,jk->ik", errors, slopes)
    size = 1 + np.abs(a) + np.abs(b)
    settled = (np.abs(change).max(axis=0) < SETTLED * size) & (off.max(axis=0) < size)
    points = [LikePoint(method, *each) for each in np.array([a, b, *off]).T[settled].tolist()]
    largest = abs(z[0]) + 10 * error + SETTLED
    return [each for each in points if spectral_radius(method, each.alpha_hat, each.beta_hat) <= largest]
