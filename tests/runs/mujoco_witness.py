"""Scenes as MuJoCo's models: the same mechanism in an engine that is not ours.

MuJoCo's constraint reference is aref = -b cdot - k c, Baumgarte's feedback, with k and b given as solref = (-k, -b)
(MuJoCo documentation, Modeling, Constraint parameters). Its Euler integrator is symplectic Euler, its RK4 Kutta's.
"""

from bezstab.engines.acceleration_engines import MOST_IMPEDANCE
from bezstab.mechanism.scenes import GROUND, Body, Revolute, Scene
from bezstab.units import feedback_gains


def model_xml(scene: Scene, integrator: str, h: float, alpha_hat: float, beta_hat: float) -> str:
    """Return the scene as MuJoCo's XML: a joint per free coordinate, in their order, and a connection per revolute.

    Of scenes made of revolute joints and gravity alone; h in s, SI units.
    """
    assert not scene.forces
    assert not scene.springs
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
