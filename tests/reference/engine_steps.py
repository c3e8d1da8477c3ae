"""One step of one constraint as each engine takes it, in its own words: what its source does, not what we made of it.

A unit mass whose coordinate is the constraint's error c, with velocity v; the state is (c, v). Each function takes the
state, the step h in s and the engine's values. Sources: as the rows of the engines say. Nothing here knows alpha_hat or
beta_hat. Sweeps of one constraint that change nothing after the first are one.
"""

from collections.abc import Callable
from math import inf, pi

import numpy as np
from numpy.typing import NDArray

State = tuple[float, ...]
Step = Callable[..., State]


def matrix(step: Step, *values: float) -> NDArray[np.float64]:
    """Return the matrix of a step, which is linear: its columns are what becomes of (1, 0) and (0, 1).

    matter.js has three numbers in its state.
    """
    return np.array([step(*each, *values) for each in np.eye(3 if step is matter_js else 2)]).T


# Engines that move with the new velocity, which is


def mujoco(c: float, v: float, h: float, first: float, second: float, d0: float = 0.9, dmax: float = 0.95) -> float:
    """At a small error: a1 = (1 - d) a0 + d aref, without other forces a0 = 0."""
    impedance, full = np.clip([d0, dmax], 1e-4, 0.9999)
    stiffness, damping = -first * impedance / full**2, -second / full
    if first > 0:
        time_constant = max(first, 2 * h)
        stiffness = impedance / (full * time_constant * second) ** 2
        damping = 2 / (full * time_constant)
    return float(v - h * impedance * (damping * v + stiffness * c))


def two_gains(c: float, v: float, h: float, proportional: float, derivative: float) -> float:
    """With c'' = -kp c - kd c'."""
    return v - h * (proportional * c + derivative * v)


def spring(c: float, v: float, h: float, stiffness: float, damping: float, mass: float = 1.0) -> float:
    """By the force of the old state."""
    return two_gains(c, v, h, stiffness / mass, damping / mass)


def erp(c: float, v: float, h: float, share: float, mixing: float = 0.0, mass: float = 1.0) -> float:
    """By the force f for which J v1 = -(ERP / h) c - CFM f, solved for as one unknown."""
    return v - (share * c / h + v) / (h / mass + mixing) * h / mass


def soft(c: float, v: float, h: float, hertz: float, zeta: float) -> float:
    """By an impulse with Catto's bias rate and mass scale, as Box2D, bepuphysics2 and Jolt have it."""
    omega = 2 * pi * hertz
    bias_rate, softness = omega / (2 * zeta + h * omega), h * omega * (2 * zeta + h * omega)
    return v - softness / (1 + softness) * (v + bias_rate * c)


def drake_sap(
    c: float, v: float, h: float, stiffness: float = inf, relaxation_time: float = 0.0, inverse_mass: float = 1.0
) -> float:
    """By the impulse g = -(v1 - v_hat) / R with v1 = v + w g, near rigid where R is."""
    regularization = 1 / (h * (h + relaxation_time) * stiffness)
    near_rigid = 0.1**2 / (4 * pi**2) * inverse_mass
    if regularization < near_rigid:
        regularization, relaxation_time = near_rigid, h
    target = -c / (h + relaxation_time)
    return v - inverse_mass * (v - target) / (regularization + inverse_mass)


def cannon_es(
    c: float, v: float, h: float, stiffness: float, relaxation: float, time_step: float = 1 / 60, mass: float = 1.0
) -> float:
    """By SPOOK's three numbers, which were made for another step."""
    whole = 1 + 4 * relaxation
    a, b, epsilon = 4 / (time_step * whole), 4 * relaxation / whole, 4 / (time_step * time_step * stiffness * whole)
    return v - (c * a + v * b) / (1 / mass + epsilon) / mass


NEW_VELOCITIES: dict[str, Callable[..., float]] = {
    "mujoco": mujoco,
    # past solimp's width: critically damped, with one impedance for every error
    "genesis": lambda c, v, h, time_constant: mujoco(c, v, h, time_constant, 1, 0.95, 0.95),
    "crocoddyl": two_gains,
    "pinocchio": two_gains,
    "rigidbodydynamics.jl": two_gains,
    "rbdl": lambda c, v, h, time_constant: two_gains(c, v, h, time_constant**-2, 2 / time_constant),
    "maplesim": lambda c, v, h, alpha, beta: two_gains(c, v, h, beta**2, 2 * alpha),
    "drake": lambda c, v, h, alpha, beta: two_gains(c, v, h, beta**2, 2 * alpha),
    "chrono-explicit": lambda c, v, h: v,
    "brax-spring": spring,
    "newton-semi-implicit": spring,
    "bullet": erp,
    "ode": erp,
    "dart": erp,
    "brax-contact": erp,
    "godot": lambda c, v, h, bias: -bias * c / h,  # every sweep adds depth tau / h - velocity, with a damping of 1
    "chrono-linearized": lambda c, v, h: -c / h,  # takes back C / dt
    "sofa": lambda c, v, h: v - (c + h * v) / h,  # free motion, then the impulse that leaves no error
    "drake-sap": drake_sap,
    "jolt-spring": soft,
    "bepu": soft,
    "physx-drive": lambda c, v, h, stiffness, damping: (v - stiffness * h * c) / (1 + h * (h * stiffness + damping)),
    "p2": lambda c, v, h, stiffness, relaxation, mass=1: cannon_es(c, v, h, stiffness, relaxation, h, mass),
    "cannon-es": cannon_es,
}
"""By the engine's name. Where the integrator is the user's, symplectic Euler, as the simplest that moves last."""


def moves_last(velocity: Callable[..., float]) -> Step:
    def step(c: float, v: float, h: float, *values: float) -> State:
        v = velocity(c, v, h, *values)
        return c + h * v, v

    return step


# Engines that move otherwise


def rapier(c: float, v: float, h: float, natural_frequency: float, damping_ratio: float) -> State:
    """A substep: the relaxation removes the bias, and the softness stays."""
    angular = 2 * pi * natural_frequency
    erp_inv_dt = angular / (h * angular + 2 * damping_ratio)
    inverse_less_one = 1 / (h * erp_inv_dt) - 1
    softness = inverse_less_one**2 / ((1 + inverse_less_one) * 4 * damping_ratio**2)
    solved = v - (v + erp_inv_dt * c) / (1 + softness)
    return c + h * solved, solved - (solved - softness * (v - solved)) / (1 + softness)


def pbd(c: float, v: float, h: float, share: float, iterations: float = 1.0) -> State:
    """Predict, project, take the velocity of the whole move."""
    moved = (c + h * v) * (1 - share) ** iterations
    return moved, (moved - c) / h


def xpbd(c: float, v: float, h: float, compliance: float, damping: float = 0.0, inverse_mass: float = 1.0) -> State:
    """One iteration: Eq. 26 of XPBD, damping included."""
    scaled = compliance / h**2
    gamma = scaled * (h**2 * damping) / h
    moved = c + h * v
    moved -= inverse_mass * (moved + gamma * (moved - c)) / ((1 + gamma) * inverse_mass + scaled)
    return moved, (moved - c) / h


def matter_js(
    position: float, previous: float, warming: float, h: float, stiffness: float, iterations: float = 2.0
) -> State:
    """The state is a position, the one before and the impulse that a step starts with."""
    time_scale = min(h * 60, 1.0)
    share = stiffness * time_scale if stiffness >= 1 else stiffness * time_scale**2
    position, previous = position + (position - previous), position
    for _ in range(2):
        position += warming
        for _ in range(int(iterations)):
            change = -share * position
            position += change
            warming += change
        warming *= 0.4
    return position, previous, warming


STEPS: dict[str, Step] = {
    **{name: moves_last(velocity) for name, velocity in NEW_VELOCITIES.items()},
    # a substep, hertz clamped: solved with bias, moved, relaxed without bias until no velocity is left
    "box2d": lambda c, v, h, hertz, zeta: (c + h * soft(c, v, h, min(hertz, 0.25 / h), zeta), 0.0),
    "rapier": rapier,
    # positions first, then velocities against the error that is left
    "chipmunk": lambda c, v, h, error_bias: (c + h * v, -(1 - error_bias**h) * (c + h * v) / h),
    "jolt": lambda c, v, h, share, iterations=2: (c * (1 - share) ** iterations, 0.0),  # velocities zero, then moves
    "pbd": pbd,
    "brax-positional": pbd,
    "xpbd": xpbd,
    "godot-2d": lambda c, v, h, bias: (c - bias * c, 0.0),  # a bias velocity moves it, and is forgotten
    "physx": lambda c, v, h: (0.0, 0.0),  # PGS: the velocity that takes back all, a move, and none afterwards
    # four substeps that each take back erp of the error, 0.5 * 2 * sqrt(1 / 4), then a velocity iteration
    "physx-tgs": lambda c, v, h: (c * 0.5**4, 0.0),
    "box2d-v2": lambda c, v, h: (0.0, 0.0),  # the velocity made zero, a move, then positions put right
    # by Moreau: half a step, J v1 = -(alpha / h) r with the error there, the other half
    "kamino": lambda c, v, h, alpha: ((c + h / 2 * v) * (1 - alpha / 2), -alpha / h * (c + h / 2 * v)),
    "matter.js": matter_js,
}
