"""A joint with a drive, from (q, v) to the next, stepped as engines step it: each torque written down, no alpha_hat."""

from tests.reference.engine_steps import State


def explicit(q: float, v: float, h: float, kp: float, kd: float, inertia: float) -> State:
    """Return the state after a torque from the old state."""
    v = v + h * (-kp * q - kd * v) / inertia
    return q + h * v, v


def implicit_in_velocity(q: float, v: float, h: float, kp: float, kd: float, inertia: float) -> State:
    """Return the state after a torque with the old position and the new velocity: I v1 = I v - h kp q - h kd v1."""
    v = (inertia * v - h * kp * q) / (inertia + h * kd)
    return q + h * v, v


def stable_pd(q: float, v: float, h: float, kp: float, kd: float, inertia: float) -> State:
    """Return the state after the torque -kp (q + h v) - kd (v + h a), with a the acceleration that it gives."""
    acceleration = (-kp * (q + h * v) - kd * v) / (inertia + kd * h)
    v = v + h * acceleration
    return q + h * v, v


def fully_implicit(q: float, v: float, h: float, kp: float, kd: float, inertia: float) -> State:
    """Return the state after the torque of the new position and the new velocity."""
    v = (inertia * v - h * kp * q) / (inertia + h * kd + h * h * kp)
    return q + h * v, v


DRIVE_STEPS = {
    "SYM": explicit,
    "imex-euler": implicit_in_velocity,
    "stable-pd": stable_pd,
    "implicit-euler": fully_implicit,
}
