"""The constraint error that a method forces on a mechanism, predicted in metres and held against runs.

The test equation has one frequency; a mechanism's motion q(t) has many, and normals that turn. To leading order what a
method forces is proportional to a derivative of q, the k-th, of which a constraint sees what lies along its normal:

    C_q q^(k)  ---  response of the method at each frequency  -->  c(t)

and, of a method such as Gauss's whose errors cancel along a normal that stands still, also the part of q^(k-1) that
does not lie along the normals, as far as they turn. No amplitude is fitted: measured over predicted should be one.

A motion that begins anew is a Fourier series. One that does not is followed for longer than the run, and fades in and
out beyond the stretch that is compared.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from bezstab.errors import InputError
from bezstab.mechanism import (
    Mechanism,
    Motion,
    Observation,
    along_normals,
    constraint_motion,
    motion,
    observe,
    simulate,
    turned_across,
)
from bezstab.methods import Method, leading_error, turning_error
from bezstab.stability import LARGEST_OMEGA_H, FloatArray, forced_response, spectral_radius
from bezstab.units import feedback_gains

COMPARED = 0.5
"""Of the run: from there on, the start has died away."""

FOLLOWED = 1.5
"""Times the run: how long a motion is followed that does not begin anew."""

FADED = 0.2
"""Of that, at either end; and of the frequencies that a step follows, the highest."""

SHARES = (0.2, 0.3, 0.5, 0.7, 1.0)
"""Of a point's alpha and beta: what is forced changes some hundredfold over them."""

DIED_AWAY = 1e-6
"""What may be left of the start where the comparison begins: it is some hundred times what is forced at most."""

HOLDS = 0.25
"""By how much measured over predicted may be off one: the next order in h, and the motion that the method itself makes,
account for less where steps follow the motion well."""


ROUNDED = 1e-14
"""m or rad: a run's |c| is some roundings of coordinates of the order of one."""


@dataclass(frozen=True)
class ForcedMotion:
    """Largest constraint errors (SI) in the later half of a run with steps of h (s): predicted, and measured.

    `measured` is nan where the run broke down: `failure` says when and why.
    """

    method: Method
    h: float
    alpha_hat: float
    beta_hat: float
    predicted: float
    measured: float
    failure: str | None

    @property
    def quotient(self) -> float:
        """Measured over predicted; nan where there is nothing to compare."""
        return math.nan if self.reason else self.measured / self.predicted

    @property
    def reason(self) -> str:
        """Why there is nothing to compare, in words; empty where there is."""
        if self.failure:
            return f"the run broke down {self.failure}"
        if self.predicted < ROUNDED:
            return f"below {ROUNDED:g} rounding is as large"
        return ""


@dataclass(frozen=True)
class HalvedStep:
    """Two runs at the same alpha_hat and beta_hat, with steps of h and of half of it.

    `share` is of the alpha and beta of the point that was asked for.
    """

    share: float
    whole: ForcedMotion
    half: ForcedMotion

    @property
    def predicted_order(self) -> float:
        """The order in h of what is predicted."""
        return math.log2(self.whole.predicted / self.half.predicted)

    @property
    def observed_order(self) -> float:
        """The order in h of what was measured; nan where there is nothing to compare."""
        return math.nan if self.holds is None else float(np.log2(self.whole.measured / self.half.measured))

    @property
    def holds(self) -> bool | None:
        """Whether what was measured is what was predicted, at both steps; None where that cannot be told."""
        if self.whole.reason or self.half.reason:
            return None
        return all(abs(run.quotient - 1) <= HOLDS for run in (self.whole, self.half))


def forced_sentence(pairs: Sequence[HalvedStep]) -> str:
    """Return in words whether a method forces what was predicted, and how that shrinks with the step."""
    name = pairs[0].whole.method.name
    kept = [pair for pair in pairs if pair.holds is not None]
    if not kept:
        return f"{name}: nothing could be compared."
    quotients = [run.quotient for pair in kept for run in (pair.whole, pair.half)]
    holds = "the prediction holds" if all(pair.holds for pair in kept) else "the prediction does NOT hold"
    predicted, seen = [pair.predicted_order for pair in kept], [pair.observed_order for pair in kept]
    left_out = len(pairs) - len(kept)
    without = f" {left_out} of {len(pairs)} points could not be compared." if left_out else ""
    return (
        f"{name}: measured over predicted is {min(quotients):.3f} to {max(quotients):.3f}: {holds}. The order "
        f"in h is {min(seen):.2f} to {max(seen):.2f}, predicted {min(predicted):.2f} to {max(predicted):.2f}.{without}"
    )


def halved_steps(
    mechanism: Mechanism, method: Method, h: float, point: tuple[float, float], duration: float
) -> Iterator[HalvedStep]:
    """Yield predicted and measured errors at shares of a point's alpha and beta, with steps of h (s) and of half of it.

    Runs take `duration` (s), or longer where what the start has left takes longer to die away. InputError where a
    share of the point is not stable, and of a mechanism at rest; else errors as `forced_motions`.
    """
    points = [(share * point[0], share**2 * point[1]) for share in SHARES]
    z_abs = [float(spectral_radius(method, *at)) for at in points]
    for share, decay in zip(SHARES, z_abs, strict=True):
        if decay >= 1:
            raise InputError(
                f"{method.name} is not stable at {share:g} times the gains of α̂ = {point[0]:g}, β̂ = {point[1]:g}"
            )
    constraint_motion(mechanism, FOLLOWED * duration)  # one at rest forces nothing, and is refused
    steps = math.log(DIED_AWAY) / math.log(max(z_abs)) / COMPARED
    duration = max(duration, steps * h * float(method.step_multiple))
    whole = forced_motions(mechanism, method, h, points, duration)
    half = forced_motions(mechanism, method, h / 2, points, duration)
    for share, of_whole, of_half in zip(SHARES, whole, half, strict=True):
        yield HalvedStep(share, of_whole, of_half)


def forced_motions(
    mechanism: Mechanism, method: Method, h: float, points: Sequence[tuple[float, float]], duration: float
) -> list[ForcedMotion]:
    """Return predicted and measured constraint errors of runs over `duration` (s) at some points of the plane.

    InputError and NumericalError as `motion`.
    """
    found = []
    for point, predicted in zip(points, predicted_errors(mechanism, method, h, points, duration), strict=True):
        gains = feedback_gains(*point, h)
        run = simulate(mechanism, method, h, duration, gains)
        measured = math.nan if run.failure else settled_error(observe(mechanism, run.t, run.q, run.v, *gains), run.t)
        found.append(ForcedMotion(method, h, *point, predicted, measured, run.failure))
    return found


def settled_error(seen: Observation, t: FloatArray) -> float:
    """Return the largest |c| (SI) in the later half of a run with these times (s), where the start has died away."""
    return float(seen.largest_c[t >= COMPARED * t[-1]].max())


def predicted_errors(
    mechanism: Mechanism, method: Method, h: float, points: Sequence[tuple[float, float]], duration: float
) -> list[float]:
    """Return the largest constraint errors (SI) that points force in the later half of runs over `duration` (s).

    InputError and NumericalError as `motion`.
    """
    along = motion(mechanism, FOLLOWED * duration)
    times = along.t[:-1]
    later_half = (times >= COMPARED * duration) & (times <= duration)
    compared = np.ones(times.shape, dtype=bool) if along.closed else later_half
    errors = _errors_along(mechanism, method, h, points, along)
    return [float(np.abs(error[compared]).max()) for error in errors]


def _errors_along(
    mechanism: Mechanism, method: Method, h: float, points: Sequence[tuple[float, float]], along: Motion
) -> Iterator[FloatArray]:
    """Yield the constraint errors along a motion at each point, its last time left out: SI, shape (times, m)."""
    power = leading_error(method).power
    spectrum = np.fft.fft(along_normals(mechanism, along, _derivative(along, power, h)), axis=0)
    omega_h = 2 * np.pi * np.fft.fftfreq(len(spectrum), along.t[1]) * h
    turned = turning_error(method)
    if turned:
        derivative = _derivative(along, turned.power, h)
        turning = turned_across(mechanism, along, derivative) * h ** (turned.power + 1)
    for alpha_hat, beta_hat in points:
        response = forced_response(method, alpha_hat, beta_hat, omega_h)[:, np.newaxis]
        error = np.fft.ifft(spectrum * response * h**power, axis=0).real
        if turned:
            error = error + turned.at(alpha_hat, beta_hat) * turning
        yield error


def _derivative(along: Motion, power: int, h: float) -> FloatArray:
    """Return q^(power) along a motion, its last time left out: SI units, shape (times, n)."""
    count = len(along.t) - 1
    from_an_end = np.minimum(np.arange(count), np.arange(count)[::-1])
    fading = np.ones(count) if along.closed else _rising(from_an_end / (FADED * count))
    omega = 2 * np.pi * np.fft.fftfreq(count, along.t[1])
    followed = _rising((1 - np.abs(omega * h) / LARGEST_OMEGA_H) / FADED)  # beyond, derivatives are noise
    spectrum = np.fft.fft(along.a[:-1] * fading[:, np.newaxis], axis=0)
    factors = followed * (1j * omega) ** (power - 2)
    return np.fft.ifft(spectrum * factors[:, np.newaxis], axis=0).real


def _rising(x: FloatArray) -> FloatArray:
    """Return a function that is zero up to x = 0, and one from x = 1 on, with all its derivatives continuous.

    What fades so, in time and in frequency, is seen nearby only: an edge would ring through the whole of a motion.
    """
    inside = np.clip(x, 0.002, 0.998)  # from there on it is 0 and 1 to rounding
    return 1 / (1 + np.exp(1 / inside - 1 / (1 - inside)))
