"""The constraint error that a method forces on a mechanism, predicted in metres.

The test equation has one frequency; a mechanism's motion q(t) has many, and normals that turn. To leading order what a
method forces is proportional to a derivative of q, the k-th, of which a constraint sees what lies along its normal:

    C_q q^(k)  ---  response of the method at each frequency  -->  c(t)

and, of a method such as Gauss's whose errors cancel along a normal that stands still, also the part of q^(k-1) that
does not lie along the normals, as far as they turn. No amplitude is fitted: measured over predicted should be one.

A motion that begins anew is a Fourier series. One that does not is followed for longer than the run, and fades in and
out beyond the stretch that is compared.
"""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from bezstab.mechanism.constraint_normals import along_normals, turned_across
from bezstab.mechanism.equations import Mechanism
from bezstab.mechanism.motions import Motion, motion
from bezstab.mechanism.observation import Observation, multiplier_work, observe
from bezstab.mechanism.start import constraint_jacobian
from bezstab.methods.schemes import Method
from bezstab.methods.steady_errors import leading_error, turning_error
from bezstab.stability.arrays import FloatArray
from bezstab.stability.forced_errors import LARGEST_OMEGA_H, forced_response

COMPARED = 0.5
"""Of the run: from there on, the start has died away."""

FOLLOWED = 1.5
"""Times the run: how long a motion is followed that does not begin anew."""

FADED = 0.2
"""Of that, at either end; and of the frequencies that a step follows, the highest."""


def settled_error(seen: Observation, t: FloatArray) -> float:
    """Return the largest |c| (SI) in the later half of a run with these times (s), where the start has died away."""
    return float(seen.largest_c[t >= COMPARED * t[-1]].max())


def settled_work(seen: Observation, t: FloatArray) -> float:
    """Return the work of the multipliers on the constraint errors in the same half of a run (J)."""
    work = multiplier_work(seen)
    return float(work[-1] - work[np.searchsorted(t, COMPARED * t[-1])])


class Forced(NamedTuple):
    """What a point forces in the later half of a run: the largest constraint error and trajectory error (SI), and work.

    The work (J) of the motion's own multipliers on the error, -lambda dc/dt, is what the energy gains by the feedback.
    The trajectory's is known of a mechanism without a freedom of its own, C_q^-1 c; else None.
    """

    error: float
    work: float
    trajectory: float | None


def predicted_errors(
    mechanism: Mechanism, method: Method, h: float, points: Sequence[tuple[float, float]], duration: float
) -> list[Forced]:
    """Return what each point forces in a run over `duration` (s); InputError and NumericalError as `motion`."""
    along = motion(mechanism, FOLLOWED * duration)
    times = along.t[:-1]
    later_half = (times >= COMPARED * duration) & (times <= duration)
    compared = np.ones(times.shape, dtype=bool) if along.closed else later_half
    errors = _errors_along(mechanism, method, h, points, along)
    multipliers = observe(mechanism, times, along.q[:-1], along.v[:-1], 0.0, 0.0).multipliers
    later = np.linspace(COMPARED * duration, duration, len(times))
    driven = mechanism.size == len(mechanism.constraints)
    jacobians = [constraint_jacobian(mechanism, t, q) for t, q in zip(times, along.q, strict=False)] if driven else []
    found = []
    for error in errors:
        power = -(multipliers * np.gradient(error, along.t[1], axis=0)).sum(axis=1)
        mean = np.interp(later, times, power, period=along.duration if along.closed else None).mean()
        off = np.linalg.solve(jacobians, error[:, :, np.newaxis])[compared] if driven else None
        found.append(
            Forced(
                error=float(np.abs(error[compared]).max()),
                work=float(mean * (1 - COMPARED) * duration),
                trajectory=None if off is None else float(np.abs(off).max()),
            )
        )
    return found


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
