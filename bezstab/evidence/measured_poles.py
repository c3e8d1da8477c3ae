"""Predicted poles against poles measured in a simulated mechanism.

A few steps into a run the first constraint is kicked, once up and once down, and half the difference of the two
histories of c_1 is followed: in it the forcing by truncation errors and everything quadratic in the kick cancel, and
the linear recursion whose characteristic polynomial is P(z) remains. Linear prediction (Prony) finds its poles.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import islice
from typing import Literal

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from bezstab.mechanism import (
    Mechanism,
    Scene,
    compiled_mechanism,
    constraint_errors,
    initial_state,
    march,
    perturbed_state,
    resume,
)
from bezstab.methods import Method, Verdict, steps
from bezstab.stability import FloatArray, dominant_pole, pole_map, poles, region, verdict, window
from bezstab.units import feedback_gains

MeasuredVerdict = Literal["converges", "diverges", "too close to call"]
BoolArray = NDArray[np.bool_]
Progress = Callable[[Sequence[int]], Iterable[int]]

RUN = 1000  # steps after the kick
KICKS = (1e-4, 1e-6, 1e-8, 1e-11)  # SI: decay is seen longest after the largest, growth after the smallest
LINEAR = (1e-3, 1e-4, 1e-5)  # largest |c| of a window, SI: up to here a mechanism of about a metre answers linearly
ABOVE_FORCED = (1e2, 1e3, 1e4, 1e5, 1e6)  # least |d| of a window, in units of the largest in the second half of the run
SETTLED = 1e-3  # of the largest |d|: what remains at the end is forced, not still decaying
SKIPPED = (0.5, 0.3, 0.0)  # part of a window left to the fast poles
SAMPLES = 400  # of a window at most: the mechanism moves on meanwhile
RESIDUAL = 1e-4  # of a linear prediction that is believed; the least order that reaches it fits no noise
CARRIES = 1e-3  # of the largest amplitude: a root with less is noise
SPREAD = 1e-3  # of |z|, and rad: fits that differ by more have not found one and the same pole
GROWN = 10.0  # times the kick, well before c leaves the linear range; else the mechanism itself broke down
CLOSE = 1e-3  # of |z|: nearer to the circle than the bias of a moving mechanism (0.01 omega h) no verdict is given

MAP_RUN = 2000  # steps after the kick
BATCH = 2000  # cells at a time: more make no step cheaper
MAP_KICK = 1e-6
TOO_CLOSE = 10.0  # over the number of steps: with | |z| - 1 | below this growth or decay may not show in a run

SURROUNDINGS = 0.1  # of the window that shows the region, added on every side
SEED = 2024


@dataclass(frozen=True)
class Measurement:
    """Predicted and measured dominant pole at one point; `measured` is None, and `reason` says why, if it cannot be."""

    method: Method
    alpha_hat: float
    beta_hat: float
    predicted: complex
    predicted_verdict: Verdict
    measured: complex | None
    measured_verdict: MeasuredVerdict
    reason: str


@dataclass(frozen=True)
class VerdictMap:
    """Predicted |z_p| and what `run` simulated steps did; shape (beta_hat.size, alpha_hat.size).

    `broken` is where the mechanism itself left the linear range, whatever the kick: no verdict.
    """

    scene: Scene
    method: Method
    h: float
    run: int
    alpha_hat: FloatArray
    beta_hat: FloatArray
    z_abs: FloatArray
    diverges: BoolArray
    broken: BoolArray

    @property
    def disagrees(self) -> BoolArray:
        """Where simulated and predicted verdict differ."""
        differs: BoolArray = (self.diverges != (self.z_abs >= 1)) & ~self.broken
        return differs

    @property
    def band(self) -> float:
        """How far |z_p| must be from one for a run of this length to show it."""
        return TOO_CLOSE / self.run


def random_points(method: Method, count: int) -> tuple[FloatArray, FloatArray]:
    """Return alpha_hat and beta_hat of random points over region and surroundings, always the same, to six decimals."""
    low, high = np.transpose(window(region(method)))
    margin = SURROUNDINGS * (high - low)
    points = np.random.default_rng(SEED).uniform(low - margin, high + margin, (count, 2))
    alpha_hat, beta_hat = np.round(points, 6).T
    return alpha_hat, beta_hat


def measure_poles(
    moving: Mechanism,
    method: Method,
    h: float,
    alpha_hat: FloatArray,
    beta_hat: FloatArray,
    progress: Progress = iter,
) -> list[Measurement]:
    """Return what is predicted and what is measured at each of a row of points; h in s.

    All points run as one batch. Where no pole can be measured the verdict still says whether the error grew or decayed.
    """
    shape = (RUN + 1, len(KICKS), alpha_hat.size)
    difference, size = np.full(shape, np.nan), np.full(shape, np.inf)
    with np.errstate(all="ignore"):  # what diverges runs into infinity, and is cut off there
        kicked = _kicked(moving, method, h, alpha_hat, beta_hat, KICKS)
        for k, c in zip(progress(range(RUN + 1)), kicked, strict=False):
            difference[k] = (c[0, 0] - c[0, 1]) / 2
            size[k] = np.abs(c).max(axis=(0, 1))
    size[~np.isfinite(size)] = np.inf
    measurements = []
    for i, point in enumerate(zip(alpha_hat.tolist(), beta_hat.tolist(), strict=True)):
        z = poles(method, *point)
        predicted = complex(dominant_pole(method, *point))
        rival = np.abs(z[np.abs(np.abs(np.angle(z)) - np.angle(predicted)) > SPREAD]).max(initial=0.0)
        if rival > (1 - 1 / SAMPLES) * abs(predicted):
            measured, reason = None, f"another pole, of modulus {rival:.6g}, is too near to tell them apart"
        else:
            measured, reason = _measured(difference[:, :, i], size[:, :, i], 2 * steps(method))
        judged = _judged(measured, difference[:, :, i], size[:, :, i])
        proven = verdict(method, *map(Fraction, map(repr, point)))
        measurements.append(Measurement(method, *point, predicted, proven, measured, judged, reason))
    return measurements


@dataclass(frozen=True)
class MapRows:
    """Some rows of a map of simulated verdicts, to be run as one batch."""

    scene: Scene
    method: Method
    h: float
    alpha_hat: FloatArray
    beta_hat: FloatArray


def map_rows(scene: Scene, method: Method, h: float, count: int) -> list[MapRows]:
    """Return the count x count cells of the window that shows the region, by rows (constant beta_hat)."""
    centres = (np.arange(count) + 0.5) / count
    alpha_hat, beta_hat = (low + (high - low) * centres for low, high in window(region(method)))
    each = max(1, BATCH // count)
    return [MapRows(scene, method, h, alpha_hat, beta_hat[k : k + each]) for k in range(0, count, each)]


def simulated_verdicts(rows: MapRows) -> dict[str, BoolArray]:
    """Return where runs diverge, and where they broke down; shape (beta_hat.size, alpha_hat.size).

    A run diverges if the difference after the kick grows until c leaves the linear range, or is larger in the last
    eighth of the run than in the eighth before its middle without having decayed to what is forced.
    """
    a, b = (axis.ravel() for axis in np.meshgrid(rows.alpha_hat, rows.beta_hat))
    eighth = MAP_RUN // 8
    largest, linear = np.zeros((9, a.size)), np.full(a.size, True)
    with np.errstate(all="ignore"):
        kicked = _kicked(compiled_mechanism(rows.scene), rows.method, rows.h, a, b, (MAP_KICK,))
        for k, c in zip(range(MAP_RUN + 1), kicked, strict=False):
            linear &= np.abs(c).max(axis=(0, 1, 2)) < LINEAR[0]  # not so where it is not a number
            part = largest[k // eighth]
            np.maximum(part, np.abs(c[0, 0, 0] - c[0, 1, 0]) / 2, out=part, where=linear)
    peak = largest.max(axis=0)
    grows = np.where(linear, (largest[7] > largest[3]) & (largest[7] > SETTLED * peak), peak > GROWN * MAP_KICK)
    shape = (rows.beta_hat.size, rows.alpha_hat.size)
    return {"diverges": grows.reshape(shape), "broken": (~linear & ~grows).reshape(shape)}


def verdict_map(chunks: Sequence[MapRows], found: Sequence[Mapping[str, NDArray[np.generic]]]) -> VerdictMap:
    """Return the map that these rows make up, with what is predicted."""
    first, beta_hat = chunks[0], np.concatenate([rows.beta_hat for rows in chunks])
    z_abs = np.concatenate([np.abs(block) for block in pole_map(first.method, first.alpha_hat, beta_hat)])
    diverges, broken = (np.concatenate([each[key] for each in found]) for key in ("diverges", "broken"))
    return VerdictMap(first.scene, first.method, first.h, MAP_RUN, first.alpha_hat, beta_hat, z_abs, diverges, broken)


def _kicked(
    moving: Mechanism, method: Method, h: float, alpha_hat: FloatArray, beta_hat: FloatArray, kicks: Sequence[float]
) -> Iterator[FloatArray]:
    """Yield c at each step from the kick on; shape (constraints, 2 for up and down, kicks, points).

    The kick comes after as many steps as the method has; what a multistep method remembers of before is left alone.
    """
    h_step = h * float(method.step_multiple)
    feedback = feedback_gains(alpha_hat, beta_hat, h)
    q, v = initial_state(moving)
    direction = (*(perturbed_state(moving, 1.0)[0] - q), *np.zeros_like(v))  # linear in the error
    amounts = np.multiply.outer([1.0, -1.0], kicks)[..., np.newaxis]
    history = [tuple(np.full(alpha_hat.shape, value) for value in (*q, *v))]
    slopes = []
    for y, slope, _ in islice(march(moving, method, h_step, feedback, history[0], "rk4", np), steps(method)):
        history.append(y)
        slopes.append(slope)
    y = history[-1] = tuple(value + amounts * step for value, step in zip(history[-1], direction, strict=True))
    run = resume(moving, method, h_step, feedback, history, slopes, np)
    k = len(history) - 1
    while True:
        yield constraint_errors(moving, k * h_step, y[: moving.size])
        y, _, _ = next(run)
        k += 1


def _measured(difference: FloatArray, size: FloatArray, order: int) -> tuple[complex | None, str]:
    """Return the dominant pole in the response of shape (steps, kicks), or why it cannot be had.

    Every window of every kick gives a fit. Of the half with the smaller residuals the one of median |z| is taken; if
    these differ, or stem from one window only, no pole is claimed.
    """
    windows = [(x, d[x]) for d, c in zip(difference.T, size.T, strict=True) for x in _windows(d, c)]
    fits = [(*fit, (x.start, x.stop)) for x, d in windows if (fit := _fit(d, order))]
    better = sorted(fits, key=lambda fit: fit[0])[: (len(fits) + 1) // 2]
    if len({window for _, _, window in better}) < 2:  # kicks alone are no two witnesses: they scale alike
        longest = max((len(d) for _, d in windows), default=0)
        return None, f"no linear recursion fits the {longest} samples between round-off and the linear range"
    z = np.array([pole for _, pole, _ in better])
    for differing, name in ((np.abs(z) / np.abs(z).max(), "|z| (relative)"), (np.angle(z), "angle (rad)")):
        if not np.ptp(differing) <= SPREAD:
            spread = f"{np.ptp(differing):.1g} in {name}"
            return None, f"fits differ by {spread}: poles of nearly equal modulus, or too much forced error"
    return complex(z[np.argsort(np.abs(z))[len(z) // 2]]), ""


def _windows(d: FloatArray, size: FloatArray) -> Iterator[slice]:
    """Yield the stretches of one response that lie within the linear range and above what is forced."""
    ends = set()
    for limit in LINEAR:
        within = np.abs(d[: np.append(np.flatnonzero(~(size < limit)), len(d))[0]])
        tail = within[len(within) // 2 :].max(initial=0.0)
        if tail < SETTLED * within.max(initial=0.0):
            ends |= {int(np.flatnonzero(within > factor * tail).max(initial=-1)) + 1 for factor in ABOVE_FORCED}
        else:
            ends.add(len(within))
    for end in sorted(ends):
        for skipped in SKIPPED:
            yield slice(int(skipped * end), min(end, int(skipped * end) + SAMPLES))


def _fit(d: FloatArray, order: int) -> tuple[float, complex] | None:
    """Return residual and dominant pole (upper half plane) of the shortest recursion that d obeys; None without one.

    Rows of the linear prediction are scaled to their largest entry, so that decay does not hide the later samples.
    """
    for p in range(1, order + 1):
        if len(d) < 2 * p + 2:
            return None
        rows = sliding_window_view(d, p + 1)
        largest = np.abs(rows).max(axis=1, keepdims=True)
        if not largest.all():
            return None
        rows = rows / largest
        coefficients = np.linalg.lstsq(rows[:, :p], rows[:, p], rcond=None)[0]
        error = np.linalg.norm(rows[:, :p] @ coefficients - rows[:, p])
        residual = float(error / np.linalg.norm(rows[:, p]))
        if residual < RESIDUAL:
            z = np.roots([1.0, *-coefficients[::-1]])
            k, growth = np.arange(len(d)), np.abs(z).max()
            powers = (z / growth) ** k[:, np.newaxis]  # scaled, and so is d: neither overflows
            amplitudes = np.abs(np.linalg.lstsq(powers, d * np.exp(-k * np.log(growth)), rcond=None)[0])
            carrying = z[amplitudes > CARRIES * amplitudes.max()]
            dominant = carrying[np.argmax(np.abs(carrying))]
            return residual, complex(dominant.real, abs(dominant.imag))
    return None


def _judged(measured: complex | None, difference: FloatArray, size: FloatArray) -> MeasuredVerdict:
    """Return whether the error grew or decayed: by the pole, else by the response, shape (steps, kicks)."""
    if measured is not None:
        excess = abs(measured) - 1
        return "too close to call" if abs(excess) < CLOSE else "diverges" if excess > 0 else "converges"
    beyond = np.flatnonzero(~(size[:, -1] < LINEAR[0]))
    if beyond.size:  # by growth, or because the mechanism itself broke down
        early = 1 + 3 * int(beyond[0]) // 4
        grown = np.abs(difference[:early, -1]).max() > GROWN * KICKS[-1]
        return "diverges" if grown else "too close to call"
    d = np.abs(difference[:, 0])
    return "converges" if d[len(d) // 2 :].max() < SETTLED * d.max() else "too close to call"
