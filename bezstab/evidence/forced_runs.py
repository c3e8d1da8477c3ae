"""The constraint error that a method forces on a mechanism, predicted in metres and held against runs.

The test equation has one frequency; a mechanism's motion q(t) has many, and normals that turn. To leading order what a
method forces is proportional to a derivative of q, the k-th, of which a constraint sees what lies along its normal:

    C_q q^(k)  ---  response of the method at each frequency  -->  c(t)

No amplitude is fitted: measured over predicted should be one.

A motion that begins anew is a Fourier series. One that does not is followed for longer than the run, and fades in and
out beyond the stretch that is compared.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bezstab.mechanism import Mechanism, Motion, along_normals, motion, observe, simulate
from bezstab.methods import Method, leading_error
from bezstab.stability import LARGEST_OMEGA_H, FloatArray, forced_response
from bezstab.units import feedback_gains

COMPARED = 0.5
"""Of the run: from there on, the start has died away."""

FOLLOWED = 1.25
"""Times the run: how long a motion is followed that does not begin anew."""

FADED = 0.12
"""Of that, at either end."""


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
        """Measured over predicted."""
        return self.measured / self.predicted


def forced_motions(
    mechanism: Mechanism, method: Method, h: float, points: Sequence[tuple[float, float]], duration: float
) -> list[ForcedMotion]:
    """Return predicted and measured constraint errors of runs over `duration` (s) at some points of the plane.

    InputError and NumericalError as `motion`.
    """
    along = motion(mechanism, FOLLOWED * duration)
    power = leading_error(method).power
    driving = _driving_derivative(mechanism, along, power, h)
    spectrum = np.fft.fft(driving, axis=0)
    omega_h = 2 * np.pi * np.fft.fftfreq(len(driving), along.t[1]) * h
    times = along.t[:-1]
    later_half = (times >= COMPARED * duration) & (times <= duration)
    compared = np.ones(times.shape, dtype=bool) if along.closed else later_half
    found = []
    for alpha_hat, beta_hat in points:
        response = forced_response(method, alpha_hat, beta_hat, omega_h)[:, np.newaxis]
        error = np.fft.ifft(spectrum * response * h**power, axis=0).real
        measured, failure = _measured(mechanism, method, h, (alpha_hat, beta_hat), duration)
        found.append(
            ForcedMotion(
                method=method,
                h=h,
                alpha_hat=alpha_hat,
                beta_hat=beta_hat,
                predicted=float(np.abs(error[compared]).max()),
                measured=measured,
                failure=failure,
            )
        )
    return found


def _driving_derivative(mechanism: Mechanism, along: Motion, power: int, h: float) -> FloatArray:
    """Return C_q q^(power) along a motion, its last time left out: SI units, shape (times, m)."""
    fading = np.ones(len(along.t) - 1) if along.closed else _fading(len(along.t) - 1)
    omega = 2 * np.pi * np.fft.fftfreq(len(along.t) - 1, along.t[1])
    followed = (1j * omega) ** (power - 2) * (np.abs(omega * h) < LARGEST_OMEGA_H)  # beyond, derivatives are noise
    spectrum = np.fft.fft(along.a[:-1] * fading[:, np.newaxis], axis=0)
    derivative = np.fft.ifft(spectrum * followed[:, np.newaxis], axis=0).real
    return along_normals(mechanism, along, derivative)


def _fading(count: int) -> FloatArray:
    """Return factors that rise smoothly from zero to one at the start of a stretch, and fall at its end."""
    from_an_end = np.minimum(np.arange(count), np.arange(count)[::-1]) / (FADED * count)
    return np.asarray(0.5 - 0.5 * np.cos(np.pi * np.minimum(from_an_end, 1.0)))


def _measured(
    mechanism: Mechanism, method: Method, h: float, point: tuple[float, float], duration: float
) -> tuple[float, str | None]:
    """Return the largest |c| in the later half of a run, or nan and why it broke down."""
    gains = feedback_gains(*point, h)
    run = simulate(mechanism, method, h, duration, gains)
    if run.failure:
        return np.nan, run.failure
    seen = observe(mechanism, run.t, run.q, run.v, *gains)
    return float(np.abs(seen.c[run.t >= COMPARED * duration]).max()), None
