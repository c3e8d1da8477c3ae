"""A joint with a drive, stepped as engines step it: each torque written down, no alpha_hat, no beta_hat."""

from collections.abc import Callable

import numpy as np

DriveStep = Callable[[float, float, float, float, float, float], tuple[float, float]]
"""From (q, v, kp, kd, inertia, h) to the next (q, v)."""


def explicit(q: float, v: float, kp: float, kd: float, inertia: float, h: float) -> tuple[float, float]:
    """Return the state after a torque from the old state."""
    v = v + h * (-kp * q - kd * v) / inertia
    return q + h * v, v


def implicit_in_velocity(q: float, v: float, kp: float, kd: float, inertia: float, h: float) -> tuple[float, float]:
    """Return the state after a torque with the old position and the new velocity: I v1 = I v - h kp q - h kd v1."""
    v = (inertia * v - h * kp * q) / (inertia + h * kd)
    return q + h * v, v


def stable_pd(q: float, v: float, kp: float, kd: float, inertia: float, h: float) -> tuple[float, float]:
    """Return the state after the torque -kp (q + h v) - kd (v + h a), with a the acceleration that it gives."""
    acceleration = (-kp * (q + h * v) - kd * v) / (inertia + kd * h)
    v = v + h * acceleration
    return q + h * v, v


def fully_implicit(q: float, v: float, kp: float, kd: float, inertia: float, h: float) -> tuple[float, float]:
    """Return the state after the torque of the new position and the new velocity."""
    v = (inertia * v - h * kp * q) / (inertia + h * kd + h * h * kp)
    return q + h * v, v


DRIVE_STEPS: dict[str, DriveStep] = {
    "SYM": explicit,
    "imex-euler": implicit_in_velocity,
    "stable-pd": stable_pd,
    "implicit-euler": fully_implicit,
}


def growth(step: DriveStep, kp: float, kd: float, inertia: float, h: float) -> float:
    """Return the factor by which a step multiplies the largest of its two modes: its matrix's spectral radius."""
    columns = [step(q, v / h, kp, kd, inertia, h) for q, v in ((1.0, 0.0), (0.0, 1.0))]
    matrix = np.array([[q, v * h] for q, v in columns]).T
    half_trace, determinant = np.trace(matrix) / 2, np.linalg.det(matrix)
    root = np.sqrt(complex(half_trace**2 - determinant))
    return float(max(abs(half_trace + root), abs(half_trace - root)))
