"""The dominant pole in the log of somebody else's simulator, and which method and feedback it is the pole of.

A log knows nothing of mechanisms, methods or steps: what is asked of it is asked of samples alone, and what a log
cannot show is stated beside the answer:

    log ---> response ---> linear prediction ---> z_log +- fit        probed_pole
                                                    |
             poles of each method there, z^k  ------+---> distances   likenesses
             P(z; alpha_hat, beta_hat) = 0    ------+---> a point     points_like

k is the number of steps between two rows. Errors of the fit are one part of what is allowed to a distance. The other is
the motion of the mechanism: constraints whose directions turn by an angle a step shift each pole by about |chi| times
that (`stability.turning`), which the log of one run does not tell from another method's pole. What counts is how fast
the directions turn at all, not the law's kappa alone, the rate at which they turn against each other in the long run: a
log is short, and where kappa is zero, as that of a pendulum, or chi is, the next order of the law shifts poles still,
by about the square of that angle.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import product

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.polynomial.polynomial import polyder, polyval2d, polyval3d
from numpy.typing import ArrayLike

from bezstab.errors import InputError, NumericalError
from bezstab.evidence.kicks import GROWN
from bezstab.evidence.linear_prediction import NEGLIGIBLE, SAMPLES, SPREAD, Fit, fit_dominant_pole, fitted_powers
from bezstab.evidence.logs import decimal_place
from bezstab.evidence.measured_poles import CLOSE
from bezstab.evidence.noisy_prediction import ITERATIONS, RESOLVED, VISIBLE, NoisyFit, fit_in_noise
from bezstab.methods import Method, closed_loop_table
from bezstab.stability import EPS, ComplexArray, FloatArray, poles, region, spectral_radius, turning_shift, window

ORDER = 8
"""Poles that are looked for: as many as four-step methods have. Of longer ones the lesser poles die out first."""

FEWEST = 12
"""Samples: two windows that differ, each with more equations than a pair of poles has unknowns."""

SHARES = (1.0, 1e-1, 1e-2, 1e-3, 1e-4)
"""Of the kick that a user gives, and of the largest sample of a response that grows: one is in the linear range."""

STARTS = 9
"""Of Newton's method along each side of the region's window."""

SAME = 1e-6
"""Of a point's size, and of |z|: solutions nearer than that are one, which Newton's method reached from two places.
Where its last change is less it has settled: the next would be about the square."""

TURNED = 3e-2
"""rad a step, where nobody has said how fast the mechanism turns: 300 revolutions a minute at 1 ms, or one in two
seconds at 100 Hz."""

BEYOND_THE_LAW = 1.5
"""Times what the first-order law says of a motion: in the end of a blow-up the errors turn the directions besides. Of
2,237 random logs the true pole was off by 1.02 times at most."""

MOST_MOVED = 0.5
"""Of a pole's modulus: where a motion may move it by so much from row to row, poles of most methods are as near."""

LEFT_OVER = 0.3
"""Relative, of a window that a sum of powers follows: in 1,310 random logs powers of the 180 poles that were told of
one run left over 0.15 at most, those of what fast motions force 0.5 at least."""

DIFFERENCES = 3
"""Times that samples are differenced at most: each takes off a factor omega h of what a motion forces."""

ON_THE_CIRCLE = (
    "|z| is one as far as can be told: forced by the motion, or marginal; two runs, kicked and not, tell them apart"
)


@dataclass(frozen=True, repr=False)
class ProbedPole:
    """The dominant pole in one response, per row of the log; `pole` is None, and `reason` says why, if none is claimed.

    `uncertainty` is the error of the fit in the plane, `samples` the number of rows that it rests on, of `rows` that
    hold numbers; `poles` are all that are seen, by modulus, in the closed upper half plane. With a pole `reason` says
    what is to be kept in mind.
    """

    pole: complex | None
    uncertainty: float | None
    samples: int
    rows: int
    poles: tuple[complex, ...]
    reason: str

    def __repr__(self) -> str:
        if self.pole is None:
            return f"ProbedPole(none: {self.reason})"
        return f"ProbedPole({self.pole:.6g} to {self.uncertainty:.1g}, from {self.samples} of {self.rows} rows)"


@dataclass(frozen=True, repr=False)
class Likeness:
    """How far a measured pole is from a method's own at one point.

    `predicted` is the method's dominant pole, per row of the log; `distance` is that of the nearest of its poles, and
    `dominant` says whether that is the dominant one. It fits if the distance is at most `allowed`: the `error` of the
    fit and what the motion of the mechanism may do. `beyond_law` says that the motion may do more than a law of first
    order tells, as where two poles nearly meet: that is more than methods differ by, and a fit is no answer. Methods
    with the same polynomial there but for factors of z, which no log can tell from each other, have the same distance
    but for rounding.
    """

    method: Method
    predicted: complex
    distance: float
    error: float
    allowed: float
    dominant: bool
    beyond_law: bool = False

    def __repr__(self) -> str:
        fit = "fits" if self.told else "cannot be told" if self.fits else "does not fit"
        return f"Likeness({self.method.name} {fit}: {self.distance:.3g} of {self.allowed:.3g} allowed)"

    @property
    def fits(self) -> bool:
        """Whether the log may be this method's."""
        return self.distance <= self.allowed

    @property
    def told(self) -> bool:
        """Whether it fits, and that is an answer: not only because so much is allowed."""
        return self.fits and (not self.beyond_law or self.distance <= self.error)


@dataclass(frozen=True, repr=False)
class LikePoint:
    """A point at which a method has the measured pole for its dominant one; errors by the error of the fit."""

    method: Method
    alpha_hat: float
    beta_hat: float
    alpha_hat_error: float
    beta_hat_error: float

    def __repr__(self) -> str:
        return f"LikePoint({self.method.name}: alpha_hat = {self.alpha_hat:.6g}, beta_hat = {self.beta_hat:.6g})"


def probed_pole(c: ArrayLike, minus: ArrayLike | None = None, differenced: bool = False) -> ProbedPole:
    """Return the dominant pole in samples of an error at equal distances in time, dimensionless, per sample.

    `c` has shape (samples,), or (samples, responses) for several of one linear system, which are fitted jointly; its
    unit is the user's. `minus`, of the same shape, is another run to be subtracted: what both have in common, such as
    the forcing by truncation errors, goes. `differenced` says that this has been done. No errors are raised for samples
    that show no pole: `reason` says so. InputError for arrays of other shapes. Method: linear prediction
    (`fit_dominant_pole`); where noise covers the samples, nonlinear least squares (`fit_in_noise`).
    """
    samples, rounding, cut = _responses(c, minus)
    fit, reason = _told(samples, rounding, differenced or minus is not None)
    reason = "; ".join(filter(None, (reason, cut)))
    if fit is None:
        return ProbedPole(None, None, 0, len(samples), (), reason)
    return ProbedPole(fit.pole, fit.uncertainty, fit.samples, len(samples), fit.poles, reason)


def _responses(c: ArrayLike, minus: ArrayLike | None) -> tuple[FloatArray, float, str]:
    """Return the responses from the kick on, shape (samples, responses), their rounding, and what was cut off, if so.

    The rounding is the value of the last decimal, zero if it is not to be seen. InputError for arrays of other shapes.
    """
    samples = _columns(c, "c")
    other = np.zeros_like(samples) if minus is None else _columns(minus, "minus")
    if other.shape[1] != samples.shape[1]:
        raise InputError(f"minus has {other.shape[1]} responses, c has {samples.shape[1]}")
    rounding = sum(max(decimal_place(column) for column in run.T) for run in (samples, other))
    shared = min(len(samples), len(other))  # of two runs one may have ended early
    with np.errstate(invalid="ignore", over="ignore"):  # what is infinite is cut off
        samples = samples[:shared] - other[:shared]
    usable = np.logical_and.accumulate(np.isfinite(samples), axis=0)  # what is no number ends a response
    end = int(usable.any(axis=1).sum())
    cut = f"row {end + 1} holds no number: only what comes before is used" if end < len(samples) else ""
    samples = np.where(usable, samples, np.nan)[:end]
    answers = (np.abs(samples) > rounding).any(axis=1)  # two runs are the same until one is kicked
    return samples[int(answers.argmax()) if answers.any() else 0 :], rounding, cut


def _columns(c: ArrayLike, name: str) -> FloatArray:
    samples = np.asarray(c, np.float64)
    if samples.ndim not in (1, 2):
        raise InputError(f"{name} has {samples.ndim} dimensions: expected (samples,) or (samples, responses)")
    return samples[:, np.newaxis] if samples.ndim == 1 else samples


Told = tuple[Fit | None, str]
"""The fit that shows the pole, and what is to be kept in mind; or none, and why."""


def _told(samples: FloatArray, rounding: float, of_two_runs: bool) -> Told:
    """Return what tells the pole in responses, shape (samples, responses), or in their differences if much is forced.

    What a motion forces changes slowly from row to row: differences take it off, all but what poles answer themselves.
    Two runs have it in common; in one run a pole near 1 is believed only if differences show no other.
    """
    if too_little := _too_little(samples, rounding):
        return None, too_little
    fits: list[Told] = []
    changes, floor = samples, rounding / 2
    for times in range(DIFFERENCES + 1):
        fit, reason = fit_dominant_pole(changes, ORDER, limits=_linear_limits(changes), floor=floor)
        fits.append((fit, reason))
        if fit and not _on_the_circle(fit) and (of_two_runs or _is_not_forced(fit, changes)):
            return fit, "what changes slowly or not at all was taken off by differences" if times else ""
        changes, floor = np.diff(changes, axis=0), 2 * floor  # each of two roundings adds to that of a difference
    (as_given, reason), (of_changes, _) = fits[:2]
    if as_given and of_two_runs:  # or it had been claimed
        return as_given, ON_THE_CIRCLE
    if as_given and of_changes and _is_slow_pole(as_given, of_changes, samples):
        # Only as far as differences, which are forced less, show the same pole, is it known to be none that is forced.
        uncertainty = max(as_given.uncertainty, abs(as_given.pole - of_changes.pole) + of_changes.uncertainty)
        believed = replace(as_given, uncertainty=uncertainty)
        return believed, "a pole so near to 1 may be forced by the motion; two runs, kicked and not, would tell"
    if len(_linear_limits(samples)) == 1:  # else it leaves the linear range: what is left over looks like noise
        in_noise = list(filter(None, (fit_in_noise(response, ORDER) for response in samples.T)))
        if in_noise:  # of several responses that which shows its pole best
            best = min(in_noise, key=lambda fit: next(iter(fit.poles.values()), np.inf))
            return _told_in_noise(best, of_two_runs)
    if as_given:
        slow = "what is left after the start hardly decays: forced by the motion, or a slow pole"
        reason = ON_THE_CIRCLE if _on_the_circle(as_given) else f"{slow}; two runs, kicked and not, tell them apart"
    return None, reason


def _too_little(samples: FloatArray, rounding: float) -> str:
    """Return why responses, shape (samples, responses), are too few or too coarse; nothing where they are not."""
    if len(samples) < FEWEST:
        return f"{len(samples)} samples: at least {FEWEST} are needed"
    if not np.ptp(samples, axis=0).any():
        return "nothing changes"
    answering = int((np.abs(samples) > 0).any(axis=1).sum())
    if answering < FEWEST // 2:
        return f"the error is gone after {answering} rows: too soon for a pole to be told"
    largest = float(np.nanmax(np.abs(samples)))
    if rounding > NEGLIGIBLE * largest:
        return f"rounded to {rounding:.3g}, which is more than {NEGLIGIBLE:g} of the largest, {largest:.3g}"
    return ""


def _told_in_noise(fit: NoisyFit, of_two_runs: bool) -> Told:
    """Return the pole that stands out of noise, or that none does.

    In one run a pole near 1 is what the motion forces, and one on the circle may be.
    """
    noise = f"noise of {fit.noise:.2g}"
    if not fit.poles:
        return None, f"{noise}: nothing that decays or grows stands out of it for {VISIBLE} rows"
    poles = {z: error for z, error in fit.poles.items() if of_two_runs or abs(z - 1) > RESOLVED}
    if not poles:
        slow = "beside what hardly changes: forced by the motion, or a slow pole"
        return None, f"{noise}, {slow}; two runs, kicked and not, tell them apart"
    (dominant, uncertainty), *_ = poles.items()
    if uncertainty > RESOLVED:
        return None, f"{noise} hides the pole: it may be {dominant:.4g}, but off by {uncertainty:.1g}"
    no_recursion = np.nan
    found = Fit(tuple(poles), no_recursion, 0, fit.samples, uncertainty)
    seen = f"in {noise}, which shows two poles very close together as one"
    if not _on_the_circle(found):
        return found, seen
    return (found, f"{seen}; {ON_THE_CIRCLE}") if of_two_runs else (None, ON_THE_CIRCLE)


def _is_not_forced(fit: Fit, samples: FloatArray) -> bool:
    """Return whether one run's pole is none that a motion could force, and nothing larger has decayed before it."""
    return abs(fit.pole - 1) > RESOLVED and _explains_the_start(fit, samples) and _follows(fit, samples)


def _is_slow_pole(fit: Fit, of_changes: Fit, samples: FloatArray) -> bool:
    """Return whether one run's pole near 1 may be one: it decays or grows, and differences of the samples have it."""
    agree = abs(fit.pole - of_changes.pole) < max(SPREAD, fit.uncertainty + of_changes.uncertainty)
    return agree and not _on_the_circle(fit) and _explains_the_start(fit, samples)


def _on_the_circle(fit: Fit) -> bool:
    return abs(abs(fit.pole) - 1) < max(CLOSE, fit.uncertainty)


def _explains_the_start(fit: Fit, samples: FloatArray) -> bool:
    """Return whether samples before the fit's window are no larger than its pole makes them, traced back.

    Ten times as large ones belong to something that has decayed since.
    """
    sizes = np.nanmax(np.abs(samples), axis=1)
    before, within = sizes[: fit.start], sizes[fit.start : fit.start + fit.samples]
    with np.errstate(over="ignore"):
        traced_back = within.max() * np.minimum(abs(fit.pole), 1.0) ** -fit.start  # what grows was no larger
    return bool(before.max(initial=0.0) <= GROWN * traced_back)


def _follows(fit: Fit, samples: FloatArray) -> bool:
    """Return whether powers of the fit's poles follow the responses all through the window.

    A recursion goes from sample to sample through whatever is smooth, such as what a fast motion forces, but what it
    leaves open adds up. Each sample counts in units of the largest near it, so that none is hidden by others.
    """
    window = samples[fit.start : fit.start + fit.samples]
    window = window[:, np.isfinite(window).all(axis=0)]
    around = np.pad(np.abs(window).max(axis=1), ORDER)
    near = sliding_window_view(around, 2 * ORDER + 1).max(axis=1)
    with np.errstate(divide="ignore"):  # the samples may be zero for a while
        _, left_over = fitted_powers(window, np.array([*fit.poles, *np.conjugate(fit.poles)]), np.log(near))
    return left_over < LEFT_OVER


def _linear_limits(samples: FloatArray) -> Sequence[float]:
    """Return the sizes up to which the samples are tried as linear: those of a response that grows may leave it."""
    sizes = np.nanmax(np.abs(samples), axis=1)
    start = sizes[:3].max()  # of an oscillation one row may be next to zero
    end = sizes[4 * len(sizes) // 5 :].max()
    return [share * float(sizes.max()) for share in SHARES] if end > GROWN * start else (np.inf,)


def likenesses(
    probed: ProbedPole,
    own_steps: Mapping[Method, int],
    alpha_hat: Fraction,
    beta_hat: Fraction,
    turned: float | None = None,
) -> list[Likeness]:
    """Return how far a probed pole is from that of each method at a point (dimensionless), the nearest first.

    So many of a method's `own_steps` lie between two rows of the log. A method whose poles are infinite at the point is
    left out: it has made no log. `turned` is the angle (rad) by which the directions of the constraints turn in a step
    of the user's, at most; None takes TURNED. No likenesses without a pole. Roots of paper Eq. 17; the motion by the
    first-order law.
    """
    if probed.pole is None:
        return []
    found = []
    for method, between in own_steps.items():
        with suppress(NumericalError):
            found.append(_likeness(probed, method, between, (float(alpha_hat), float(beta_hat)), turned))
    # of those that the fit does not tell apart, first what is seen: the dominant pole
    return sorted(found, key=lambda one: (max(one.distance, one.error), not one.dominant, one.distance))


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


def _likeness(
    probed: ProbedPole, method: Method, between: int, point: tuple[float, float], turned: float | None
) -> Likeness:
    assert probed.pole is not None
    assert probed.uncertainty is not None
    z = poles(method, *point)
    with np.errstate(over="ignore", invalid="ignore"):  # a pole far outside the circle, over many steps
        per_row = z**between
    per_row = per_row.real + 1j * np.abs(per_row.imag)
    leading = np.abs(z) > (1 - 1 / SAMPLES) * np.abs(z[0])
    # Another pole answers only if the kick has hardly excited the dominant one, and that has not grown out of the
    # rounding of float64.
    distances = np.abs(per_row - probed.pole)
    if probed.rows * np.log(max(np.abs(per_row[0]), 1.0)) > -np.log(EPS):
        distances[~leading] = np.inf
    nearest = int(np.argmin(distances))
    shift, beyond_law = _motion_shift(method, point, z, nearest, turned)
    moved = between * shift * float(np.abs(per_row[nearest]))
    return Likeness(
        method=method,
        predicted=complex(per_row[0]),
        distance=float(distances[nearest]),
        error=probed.uncertainty,
        allowed=probed.uncertainty + moved,
        dominant=bool(leading[nearest]),
        beyond_law=beyond_law or between * shift >= MOST_MOVED,
    )


def _motion_shift(
    method: Method, point: tuple[float, float], z: ComplexArray, which: int, turned: float | None
) -> tuple[float, bool]:
    """Return by which share of itself, a step, the motion may shift one of a method's poles z; `turned` as above.

    Also whether poles meet, where the first-order law does not hold.
    """
    angle = (TURNED if turned is None else turned) * float(method.step_multiple)
    with np.errstate(divide="ignore", invalid="ignore"):  # a pole at zero, and a double one, where it is infinite
        chi = float(np.abs(turning_shift(method, *point, z[which]) / z[which]))
    others = np.delete(z, which)
    apart = np.abs(others - z[which])[others != z[which].conj()]
    # The square of the angle is the size of the law's next order.
    root = math.sqrt(angle)
    shift = BEYOND_THE_LAW * (chi if np.isfinite(chi) else 0.0) * angle + angle**2
    meet = bool((apart < root * np.abs(z[which])).any()) or not np.isfinite(chi) or shift > root
    return (min(shift, root) + root if meet else shift), meet  # at a double pole the change is like a root


def points_like(probed: ProbedPole, method: Method, between: int = 1) -> tuple[list[LikePoint], str]:
    """Return the points at which a method has the probed pole for its dominant one, and why there are none.

    A complex pole and its conjugate are two equations P(z; alpha_hat, beta_hat) = 0 for the two unknowns, and so are
    two real poles; there may be several solutions, that nearest to what an exact integrator would have first, or none.
    So many steps lie `between` two rows: of z per row the root per step of least angle is taken. One real pole leaves a
    curve of points, and so do poles that belong to one mu. Newton's method, from places all over the method's region;
    NumericalError as `region`.
    """
    if probed.pole is None or probed.uncertainty is None:
        return [], ""
    step_poles = [z ** (1 / between) for z in probed.poles]
    error = probed.uncertainty / (between * abs(step_poles[0]) ** (between - 1))
    pairs = [(step_poles[0], step_poles[0].conjugate())]
    if step_poles[0].imag <= error:
        real = [complex(z.real) for z in step_poles if z.imag <= error]
        pairs = [(real[0], other) for other in real[1:]]
    solutions = [point for pair in pairs for point in _solutions(method, np.array(pair), error)]
    found = [point for point in solutions if np.isfinite(point.alpha_hat_error)]
    if found:
        exact_alpha, exact_beta = _exact_integrators_point(np.array(pairs[0]))
        return sorted(found, key=lambda one: abs(one.alpha_hat - exact_alpha) + abs(one.beta_hat - exact_beta)), ""
    if solutions or not pairs:
        return [], f"what shows of {method.name}'s poles leaves a curve of points (α̂, β̂): another pole is needed."
    return [], f"{method.name} has this pole for its dominant one nowhere."


def _solutions(method: Method, z: ComplexArray, error: float) -> list[LikePoint]:
    """Return the points at which both z are poles, the first the dominant one; shape of z (2,), `error` of each.

    Where there is a curve of such points instead, some of it are returned, with infinite errors.
    """
    table = np.array(closed_loop_table(method), float)  # by powers of z, alpha_hat and beta_hat
    equations = np.moveaxis(np.tensordot(z[:, np.newaxis] ** np.arange(len(table)), table, axes=1), 0, -1)
    largest = abs(z[0]) + 10 * error + SAME  # of a point at which the first z is the dominant pole
    found: list[LikePoint] = []
    for point, slopes in filter(None, (_common_zero(equations, start) for start in _starting_points(method, z))):
        a, b = point.tolist()
        known = any(abs(a - one.alpha_hat) + abs(b - one.beta_hat) < SAME * (1 + abs(a) + abs(b)) for one in found)
        if known or spectral_radius(method, a, b) > largest:
            continue
        inverse = np.full((2, 2), np.inf)
        if np.linalg.cond(slopes) < 1 / SAME:  # where one mu, a real one, has both z, so has all its straight line
            inverse = np.linalg.inv(slopes)
        by_pole = np.abs([polyval3d(pole, a, b, polyder(table)) for pole in z])  # each may be off
        errors = (np.abs(inverse.real) + np.abs(inverse.imag)) @ (by_pole * error)
        found.append(LikePoint(method, a, b, *errors.tolist()))
    return found


def _common_zero(equations: ComplexArray, point: FloatArray) -> tuple[FloatArray, ComplexArray] | None:
    """Return the point, (2,), to which Newton's method leads, and the slopes there, (2, 2); None if to none.

    Two `equations` hold there: polynomials in alpha_hat and beta_hat, shape (powers, powers, 2). Along a curve of
    points the slopes are singular: there the least change is taken.
    """
    derivatives = [polyder(equations, axis=axis) for axis in range(2)]
    with suppress(np.linalg.LinAlgError), np.errstate(all="ignore"):  # what leaves the range is left out
        for _ in range(ITERATIONS):
            a, b = point.tolist()
            values, *by_each = (np.asarray(polyval2d(a, b, each)) for each in (equations, *derivatives))
            slopes = np.stack(by_each, axis=1)
            change = (np.linalg.pinv(slopes, rcond=SAME) @ values).real
            point = point - change
            if np.abs(change).max() < SAME * (1 + np.abs(point).max()):
                return point, slopes
    return None


def _starting_points(method: Method, z: ComplexArray) -> FloatArray:
    """Return points, shape (starts, 2): that of an exact integrator, z = e^mu, and some over a method's region."""
    axes = (np.linspace(low, high, STARTS) for low, high in window(region(method)))
    return np.array([_exact_integrators_point(z), *product(*axes)])


def _exact_integrators_point(z: ComplexArray) -> tuple[float, float]:
    """Return alpha_hat and beta_hat for which an integrator without errors, z = e^mu, had both z; real parts only."""
    with np.errstate(divide="ignore"):  # a pole at zero is that of no such integrator
        mu = np.log(z)
    return -float(mu.sum().real), float(mu.prod().real)
