"""A witness from outside: the same mechanism in MuJoCo, whose own integrators must settle and diverge where P(z) says.

MuJoCo's constraint reference is aref = -b cdot - k c, Baumgarte's feedback, with k and b given as solref = (-k, -b)
(MuJoCo documentation, Modeling, Constraint parameters). Its Euler integrator is symplectic Euler, its RK4 Kutta's.
"""

import types
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product
from typing import Literal

import numpy as np

from bezstab.engines.acceleration_engines import MOST_IMPEDANCE
from bezstab.errors import InputError
from bezstab.mechanism.equations import Mechanism
from bezstab.mechanism.scenes import GROUND, Body, Revolute, Scene
from bezstab.mechanism.start import constraint_errors, perturbed_state
from bezstab.methods.registry import lookup
from bezstab.methods.schemes import Method
from bezstab.mujoco.reading import mujoco_module, silent
from bezstab.mujoco.solrefs import METHODS
from bezstab.stability.arrays import FloatArray
from bezstab.stability.closed_loop import spectral_radius
from bezstab.stability.regions import region
from bezstab.stability.searches import bisected
from bezstab.units import feedback_gains

Outcome = Literal["converges", "diverges", "neither"]

RUN_WITH = ("Euler", "RK4")
"""Those of MuJoCo's integrators that are run: the others are symplectic Euler for constraints, too."""

RAYS = (15.0, 30.0, 45.0, 60.0, 75.0)
"""Degrees, in the plane scaled by the region's extent."""

TIMES = (0.9, 1.1)
"""The boundary: nearer, growth takes thousands of steps."""

RUN = 3000
"""Steps."""

KICK = 1e-3
"""m: |z_p| <= 0.9 leaves nothing of it; what remains is truncation error and the leak."""

GROWN_TO = 1.0
"""m: |z_p| >= 1.1 takes the kick there within a hundred steps."""

OUTSIDE = 2.0
"""Times the region's extent: unstable. The two regions have one boundary on each ray up to there."""


@dataclass(frozen=True)
class Witnessed:
    """What MuJoCo's integrator did at a multiple of the boundary, and |z_p| of the method it implements there."""

    integrator: str
    method: Method
    alpha_hat: float
    beta_hat: float
    times_boundary: float
    predicted_z_abs: float
    outcome: Outcome


def mujoco_witnesses(mechanism: Mechanism, h: float) -> Iterator[Witnessed]:
    """Yield what each of MuJoCo's integrators does at 0.9 and 1.1 times the boundary along several rays; h in s.

    InputError without MuJoCo, or for a scene that is not made of revolute joints and gravity alone.
    """
    mujoco = mujoco_module()
    for integrator in RUN_WITH:
        method = lookup(METHODS[integrator])
        for boundary, times in product(_boundary_points(method), TIMES):
            alpha_hat, beta_hat = (times * boundary).tolist()
            model = mujoco.MjModel.from_xml_string(model_xml(mechanism.scene, integrator, h, alpha_hat, beta_hat))
            c = _run(mujoco, model, mechanism)
            ended_early, settled = len(c) < RUN, c[-RUN // 10 :].max() < KICK
            yield Witnessed(
                integrator=integrator,
                method=method,
                alpha_hat=alpha_hat,
                beta_hat=beta_hat,
                times_boundary=times,
                predicted_z_abs=float(spectral_radius(method, alpha_hat, beta_hat)),
                outcome="diverges" if ended_early else "converges" if settled else "neither",
            )


def model_xml(scene: Scene, integrator: str, h: float, alpha_hat: float, beta_hat: float) -> str:
    """Return the scene as MuJoCo's XML: a joint per free coordinate, in their order, and a connection per revolute.

    It holds numbers and names made here, nothing else of the scene; h in s, SI units. InputError for a scene that is
    not made of revolute joints and gravity alone.
    """
    if scene.forces or scene.springs or not all(isinstance(joint, Revolute) for joint in scene.joints):
        raise InputError(f"{scene.name} has more than revolute joints and gravity: not supported")
    two_alpha, beta_squared = feedback_gains(alpha_hat, beta_hat, h)
    impedance = float(MOST_IMPEDANCE)  # the rest of the unconstrained acceleration leaks into the constraint
    feedback = f'solref="{-beta_squared!r} {-two_alpha!r}" solimp="{impedance} {impedance} 1 0.5 1"'
    sites: dict[str, str] = dict.fromkeys([GROUND, *(body.name for body in scene.bodies)], "")
    connections = ""
    for number, joint in enumerate(scene.joints):
        assert isinstance(joint, Revolute)
        for end, (name, (x, y)) in enumerate(zip(joint.bodies, joint.points, strict=True)):
            sites[name] += f'<site name="point{number}_{end}" pos="{x!r} {y!r} 0"/>'
        connections += f'<connect site1="point{number}_0" site2="point{number}_1" {feedback}/>'
    bodies = "".join(_body_xml(body, sites[body.name]) for body in scene.bodies)
    gx, gy = scene.gravity
    return f"""<mujoco>
        <compiler angle="radian"/>
        <option timestep="{h!r}" integrator="{integrator}" gravity="{gx!r} {gy!r} 0" tolerance="0" iterations="100">
          <flag contact="disable" refsafe="disable" autoreset="disable"/>
        </option>
        <worldbody>{sites[GROUND]}{bodies}</worldbody>
        <equality>{connections}</equality>
    </mujoco>"""


def _body_xml(body: Body, sites: str) -> str:
    axes = {"x": 'type="slide" axis="1 0 0"', "y": 'type="slide" axis="0 1 0"', "theta": 'type="hinge" axis="0 0 1"'}
    x, y, theta = (body.locked.get(axis, 0.0) for axis in axes)
    center_x, center_y = body.center
    mass = body.mass or 1.0  # of a body about its centre on a fixed pivot, where it does not matter
    if "theta" in body.free:
        offset_squared = center_x * center_x + center_y * center_y
        inertia = body.inertia - body.mass * offset_squared  # about the centre of mass (parallel axes)
    else:
        inertia = 1.0  # of a body that does not turn: it does not matter
    joints = "".join(f"<joint {axes[axis]}/>" for axis in body.free)
    return f"""<body pos="{x!r} {y!r} 0" euler="0 0 {theta!r}">
        <inertial pos="{center_x!r} {center_y!r} 0" mass="{mass!r}" diaginertia="{inertia!r} {inertia!r} {inertia!r}"/>
        {joints}{sites}
    </body>"""


def _boundary_points(method: Method) -> FloatArray:
    """Return the point with |z_p| = 1 on each ray from the origin, as (alpha_hat, beta_hat); shape (rays, 2)."""
    view = region(method).view
    assert view
    angles = np.radians(RAYS)
    rays = np.stack([np.cos(angles), np.sin(angles)], axis=-1) * [largest for _, largest in view]
    unstable = np.full(len(RAYS), OUTSIDE)
    _, met = bisected(lambda times: spectral_radius(method, *(times * rays.T)) >= 1, 0 * unstable, unstable)
    return np.asarray(met[:, np.newaxis] * rays)


def _run(mujoco: types.ModuleType, model: object, mechanism: Mechanism) -> FloatArray:
    """Return the largest |c| (m) after each step from a kicked state, to where it passes GROWN_TO or is no number."""
    data = mujoco.MjData(model)
    data.qpos[:], data.qvel[:] = perturbed_state(mechanism, KICK)
    c: list[float] = []
    with silent(mujoco):  # it would print, and write a file, where a run diverges
        while len(c) < RUN and (not c or c[-1] < GROWN_TO):
            mujoco.mj_step(model, data)
            c.append(float(np.abs(constraint_errors(mechanism, 0.0, list(data.qpos))).max()))
    return np.array(c)
