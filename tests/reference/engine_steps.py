"""One step of one constraint as each engine takes it, in its own words: what its source does, not what we made of it.

A unit mass whose coordinate is the constraint's error c, with velocity v; the state is (c, v). Each function takes the
state, the step h in s and the engine's values, and returns the next state. Sources: as the rows of the engines say.
Nothing here knows alpha_hat or beta_hat.
"""

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

State = tuple[float, float]


def matrix(step: Callable[..., tuple[float, ...]], *values: float) -> NDArray[np.float64]:
    """Return the matrix of a step, which is linear: its columns are what becomes of (1, 0) and (0, 1).

    matter.js has three numbers in its state.
    """
    return np.array([step(*each, *values) for each in np.eye(3 if step is matter_js else 2)]).T


def _symplectic(c: float, v: float, h: float, acceleration: float) -> State:
    v = v + h * acceleration
    return c + h * v, v


def mujoco(c: float, v: float, h: float, first: float, second: float, d0: float = 0.9, dmax: float = 0.95) -> State:
    """Take MuJoCo's step at a small error: a1 = (1 - d) a0 + d aref, without other forces a0 = 0."""
    impedance, full = min(max(d0, 1e-4), 0.9999), min(max(dmax, 1e-4), 0.9999)
    if first > 0:
        time_constant, zeta = max(first, 2 * h), second
        stiffness = impedance / (full**2 * time_constant**2 * zeta**2)
        damping = 2 / (full * time_constant)
    else:
        stiffness, damping = -first * impedance / full**2, -second / full
    return _symplectic(c, v, h, impedance * (-damping * v - stiffness * c))


def two_gains(c: float, v: float, h: float, proportional: float, derivative: float) -> State:
    """Take a step with c'' = -kp c - kd c', as Crocoddyl, Pinocchio and RigidBodyDynamics.jl have it."""
    return _symplectic(c, v, h, -proportional * c - derivative * v)


def rbdl(c: float, v: float, h: float, time_constant: float) -> State:
    """Take a step with RBDL's stabilisation, both parameters 1 / T."""
    parameter = 1 / time_constant
    return _symplectic(c, v, h, -2 * parameter * v - parameter * parameter * c)


def alpha_and_beta(c: float, v: float, h: float, alpha: float, beta: float) -> State:
    """Take a step with Baumgarte's own two parameters."""
    return _symplectic(c, v, h, -2 * alpha * v - beta**2 * c)


def nothing(c: float, v: float, h: float) -> State:
    """Take a step that keeps c'' = 0: Chrono's explicit integrators."""
    return _symplectic(c, v, h, 0.0)


def brax_spring(c: float, v: float, h: float, stiffness: float, damping: float, mass: float = 1.0) -> State:
    """Take the step of Brax's spring pipeline: the force of the old state, then the new velocity moves."""
    return _symplectic(c, v, h, (-c * stiffness - v * damping) / mass)


def erp(c: float, v: float, h: float, share: float, mixing: float = 0.0, mass: float = 1.0) -> State:
    """Take ODE's step: the force f for which J v1 = -(ERP / h) c - CFM f, solved for as one unknown."""

    # v + (h / m) f + CFM f = -(ERP / h) c
    force = (-share * c / h - v) / (h / mass + mixing)
    v = v + h * force / mass
    return c + h * v, v


def _soft(h: float, hertz: float, zeta: float) -> tuple[float, float, float]:
    """Return Catto's bias rate (1/s), mass scale and impulse scale."""
    omega = 2 * math.pi * hertz
    denominator = 2 * zeta + h * omega
    product = h * omega * denominator
    return omega / denominator, product / (1 + product), 1 / (1 + product)


def box2d(c: float, v: float, h: float, hertz: float, zeta: float) -> State:
    """Take Box2D's substep, hertz clamped: solved with bias, moved, relaxed without bias, impulses accumulated."""
    bias_rate, mass_scale, impulse_scale = _soft(h, min(hertz, 0.25 / h), zeta)

    impulse = 0.0
    for _ in range(3):  # repeated sweeps change nothing: the accumulated impulse is the solution
        change = -mass_scale * (v + bias_rate * c) - impulse_scale * impulse
        impulse, v = impulse + change, v + change
    c = c + h * v
    change = -v
    return c, v + change


def rapier(c: float, v: float, h: float, natural_frequency: float, damping_ratio: float) -> State:
    """Take Rapier's substep: the relaxation removes the bias, and the softness stays."""
    angular = 2 * math.pi * natural_frequency
    erp_inv_dt = angular / (h * angular + 2 * damping_ratio)
    inverse_less_one = 1 / (h * erp_inv_dt) - 1
    softness = inverse_less_one**2 / ((1 + inverse_less_one) * 4 * damping_ratio**2)

    impulse = 0.0
    for moves in (True, False):
        right_side = v + (erp_inv_dt * c if moves else 0.0)
        total = impulse + (right_side - softness * impulse) / (1 + softness)
        v -= total - impulse
        impulse = total
        if moves:
            c += h * v
    return c, v


def chipmunk(c: float, v: float, h: float, error_bias: float) -> State:
    """Take Chipmunk's step: positions first, then velocities against the error that is left."""

    c = c + h * v
    return c, -(1 - error_bias**h) * c / h


def chrono_linearized(c: float, v: float, h: float) -> State:
    """Take Chrono's linearised implicit Euler: the new velocity takes back C / dt."""

    v = -c / h
    return c + h * v, v


def drake_sap(
    c: float, v: float, h: float, stiffness: float = math.inf, relaxation_time: float = 0.0, inverse_mass: float = 1.0
) -> State:
    """Take Drake's SAP step: the impulse g = -(v1 - v_hat) / R with v1 = v + w g, near rigid where R is."""
    regularization = 1 / (h * (h + relaxation_time) * stiffness)
    near_rigid = 0.1**2 / (4 * math.pi**2) * inverse_mass
    if regularization < near_rigid:
        regularization, relaxation_time = near_rigid, h

    target = -c / (h + relaxation_time)
    impulse = -(v - target) / (regularization + inverse_mass)
    v = v + inverse_mass * impulse
    return c + h * v, v


def jolt_spring(c: float, v: float, h: float, frequency: float, damping_ratio: float) -> State:
    """Take Jolt's step with a spring: softness and bias of k and c, no relaxation."""
    omega = 2 * math.pi * frequency
    stiffness, damping = omega**2, 2 * damping_ratio * omega
    softness = 1 / (h * (damping + h * stiffness))

    impulse = -(v + h * stiffness * softness * c) / (1 + softness)
    v = v + impulse
    return c + h * v, v


def physx_drive(c: float, v: float, h: float, stiffness: float, damping: float) -> State:
    """Take PhysX's step with an acceleration drive: one impulse from the old state."""

    a = h * (h * stiffness + damping)
    x = 1 / (1 + a)
    v = v + stiffness * x * h * -c - x * a * v
    return c + h * v, v


def jolt(c: float, v: float, h: float, share: float, position_steps: float = 2.0) -> State:
    """Take Jolt's step with a hard constraint: velocity zero, then moves that leave the velocity alone."""

    v = 0.0
    c = c + h * v
    for _ in range(int(position_steps)):
        c = c - share * c
    return c, v


def pbd(c: float, v: float, h: float, share: float, iterations: float = 1.0) -> State:
    """Take the step of position based dynamics: predict, project, take the velocity of the whole move."""

    moved = c + h * v
    for _ in range(int(iterations)):
        moved -= share * moved
    return moved, (moved - c) / h


def xpbd(c: float, v: float, h: float, compliance: float, damping: float = 0.0, inverse_mass: float = 1.0) -> State:
    """Take the step of XPBD with one iteration: its Eq. 26, damping included."""
    scaled = compliance / h**2
    gamma = scaled * (h**2 * damping) / h

    moved = c + h * v
    multiplier = (-moved - gamma * (moved - c)) / ((1 + gamma) * inverse_mass + scaled)
    moved += inverse_mass * multiplier
    return moved, (moved - c) / h


def genesis(c: float, v: float, h: float, time_constant: float) -> State:
    """Take Genesis' step past solimp's width: MuJoCo's, critically damped, with one impedance for every error."""
    return mujoco(c, v, h, max(time_constant, 2 * h), 1.0, 0.95, 0.95)


def godot(c: float, v: float, h: float, bias: float) -> State:
    """Take the step of Godot's PinJoint3D with a damping of 1: every sweep adds depth tau / h - velocity."""

    for _ in range(16):
        v += -c * bias / h - v
    return c + h * v, v


def godot_2d(c: float, v: float, h: float, bias: float) -> State:
    """Take the step of Godot's PinJoint2D: no velocity left, and a bias velocity that is forgotten."""

    bias_velocity = 0.0
    for _ in range(16):
        v -= v
        bias_velocity += -c * bias / h - bias_velocity
    return c + h * (v + bias_velocity), v


def physx(c: float, v: float, h: float) -> State:
    """Take the step of a PhysX joint with PGS: the velocity that takes back all, a move, and none afterwards."""

    for _ in range(4):
        v += -c / h - v
    return c + h * v, 0.0


def physx_tgs(c: float, v: float, h: float) -> State:
    """Take the step with TGS: four substeps that each take back erp of the error, then a velocity iteration."""
    substep, erp_of_a_substep = h / 4, 0.5 * 2 * math.sqrt(1 / 4)

    for _ in range(4):
        v += -erp_of_a_substep * c / substep - v
        c += substep * v
    return c, 0.0


def box2d_v2(c: float, v: float, h: float) -> State:
    """Take the step of a Box2D 2.4 joint: the velocity made zero, a move, then positions put right."""

    v -= v
    c += h * v
    for _ in range(3):
        c -= c
    return c, v


def kamino(c: float, v: float, h: float, alpha: float) -> State:
    """Take Kamino's step by Moreau: half a step, J v1 = -(alpha / h) r with the error there, the other half."""

    middle = c + h / 2 * v
    v = -alpha / h * middle
    return middle + h / 2 * v, v


def p2(c: float, v: float, h: float, stiffness: float, relaxation: float, mass: float = 1.0) -> State:
    """Take the step of p2: SPOOK's three numbers, ten sweeps over the impulse, which starts at none."""
    whole = 1 + 4 * relaxation
    a, b, epsilon = 4 / (h * whole), 4 * relaxation / whole, 4 / (h * h * stiffness * whole)

    right_side, inverse_c, impulse = -c * a - v * b, 1 / (1 / mass + epsilon), 0.0
    for _ in range(10):
        impulse += inverse_c * (right_side - impulse / mass - epsilon * impulse)
    v += impulse / mass
    return c + h * v, v


def cannon_es(
    c: float, v: float, h: float, stiffness: float, relaxation: float, time_step: float = 1 / 60, mass: float = 1.0
) -> State:
    """Take the step of cannon-es: the same with numbers that were made for another step."""
    whole = 1 + 4 * relaxation
    a, b, epsilon = 4 / (time_step * whole), 4 * relaxation / whole, 4 / (time_step * time_step * stiffness * whole)

    impulse = (-c * a - v * b) / (1 / mass + epsilon)
    v += impulse / mass
    return c + h * v, v


def bepu(c: float, v: float, h: float, frequency: float, damping_ratio: float) -> State:
    """Take the step of bepuphysics2: springiness, then iterations that add to an accumulated impulse."""
    omega = 2 * math.pi * frequency
    error_to_velocity = omega / (omega * h + 2 * damping_ratio)
    extra = 1 / (omega * h * (omega * h + 2 * damping_ratio))
    effective_mass = 1 / (1 + extra)
    softness = extra * effective_mass

    impulse = 0.0
    for _ in range(3):
        change = (-error_to_velocity * c - v) * effective_mass - impulse * softness
        impulse, v = impulse + change, v + change
    return c + h * v, v


def sofa(c: float, v: float, h: float) -> State:
    """Take the step of SOFA's FreeMotionAnimationLoop: free motion, then the impulse that leaves no error."""
    free = c + h * v
    correction = -free / h
    return free + h * correction, v + correction


def matter_js(
    position: float, previous: float, warming: float, h: float, stiffness: float, iterations: float = 2.0
) -> tuple[float, float, float]:
    """Take the step of matter.js, whose state is a position, the one before and the impulse that it starts with."""
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


STEPS: dict[str, Callable[..., tuple[float, ...]]] = {
    "mujoco": mujoco,
    "crocoddyl": two_gains,
    "pinocchio": two_gains,
    "rigidbodydynamics.jl": two_gains,
    "rbdl": rbdl,
    "maplesim": alpha_and_beta,
    "drake": alpha_and_beta,
    "chrono-explicit": nothing,
    "brax-spring": brax_spring,
    "bullet": erp,
    "ode": erp,
    "dart": erp,
    "brax-contact": erp,
    "box2d": box2d,
    "rapier": rapier,
    "chipmunk": chipmunk,
    "chrono-linearized": chrono_linearized,
    "drake-sap": drake_sap,
    "jolt-spring": jolt_spring,
    "physx-drive": physx_drive,
    "jolt": jolt,
    "pbd": pbd,
    "xpbd": xpbd,
    "brax-positional": pbd,
    "genesis": genesis,
    "godot": godot,
    "godot-2d": godot_2d,
    "physx": physx,
    "physx-tgs": physx_tgs,
    "box2d-v2": box2d_v2,
    "kamino": kamino,
    "p2": p2,
    "cannon-es": cannon_es,
    "bepu": bepu,
    "sofa": sofa,
    "newton-semi-implicit": brax_spring,
    "matter.js": matter_js,
}
"""By the engine's name. Where the integrator is the user's, symplectic Euler, as the simplest that moves last."""
