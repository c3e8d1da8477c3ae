"""One planar mechanism in engines that are not ours, made by their modules: pymunk (Chipmunk), Box2D 2.3, PyBullet."""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]

H = 1 / 60  # s, of a step


class Body(NamedTuple):
    """Mass and inertia (kg, kg m2), x, y and angle, and their rates."""

    mass: float
    inertia: float
    place: Sequence[float]
    rates: Sequence[float] = (0.0, 0.0, 0.0)


class Joint(NamedTuple):
    """A link of length 1 or a pin from one body to another; 0 is the world.

    `motor` holds the angle or the rate between them, or is a spring of a frequency (Hz) and a damping ratio.
    """

    kind: str
    first: int
    second: int
    points: Sequence[Sequence[float]]
    motor: str = ""


class Asked(NamedTuple):
    """A mechanism, how often its joints are swept, and which share of errors they take back; None: as by default."""

    bodies: Sequence[Body]
    joints: Sequence[Joint]
    sweeps: int | None = None
    share: float | None = None
    gravity: tuple[float, float] = (0, 0)


class Pymunk:
    """`states` are x, y, angle and their rates, body by body: here and in the other engines."""

    def __init__(self, pymunk: Any, asked: Asked) -> None:
        self.space = pymunk.Space()
        self.space.iterations, self.space.gravity = asked.sweeps or 10, asked.gravity
        self.bodies = [self.space.static_body]
        for mass, inertia, place, rates in asked.bodies:
            body = pymunk.Body(mass, inertia)
            *body.position, body.angle = place
            *body.velocity, body.angular_velocity = rates
            self.space.add(body)
            self.bodies.append(body)
        for kind, first, second, points, motor in asked.joints:
            two = self.bodies[first], self.bodies[second]
            held = [(pymunk.PinJoint if kind == "link" else pymunk.PivotJoint)(*two, *map(tuple, points))]
            if kind == "link":
                held[0].distance = 1
            if motor:
                held.append(pymunk.GearJoint(*two, 0, 1) if motor == "angle" else pymunk.SimpleMotor(*two, 0))
            for joint in held:
                joint.error_bias = joint.error_bias if asked.share is None else (1 - asked.share) ** (1 / H)
                self.space.add(joint)

    def step(self) -> object:
        return self.space.step(H)

    def states(self) -> FloatArray:
        return np.array([
            (*body.position, body.angle, *body.velocity, body.angular_velocity) for body in self.bodies[1:]
        ])  # fmt: skip


class Box2d:
    """Velocities without error are swept first, then positions, as long as an error is above the slop of 5 mm.

    Its numbers have seven digits, and its joints no share.
    """

    def __init__(self, box2d: Any, asked: Asked) -> None:
        self.world = box2d.b2World(gravity=asked.gravity)
        self.world.allowSleeping = False
        sweeps = asked.sweeps or 8
        self.sweeps = sweeps, max(3, sweeps // 4)
        self.bodies = [self.world.CreateStaticBody(position=(0, 0))]
        for mass, inertia, (x, y, angle), (vx, vy, turn) in asked.bodies:
            body = self.world.CreateDynamicBody(position=(x, y), angle=angle, allowSleep=False)
            body.massData = box2d.b2MassData(mass=mass, I=inertia, center=(0, 0))
            body.linearVelocity, body.angularVelocity = (vx, vy), turn
            self.bodies.append(body)
        for kind, first, second, points, motor in asked.joints:
            one, other = self.bodies[first], self.bodies[second]
            both = {"bodyA": one, "bodyB": other}
            near, far = one.GetWorldPoint(points[0]), other.GetWorldPoint(points[1])
            if kind == "link":
                self.world.CreateDistanceJoint(**both, anchorA=near, anchorB=far, length=1)
            elif "," in motor:
                hertz, ratio = map(float, motor.split(","))
                self.world.CreateWeldJoint(**both, anchor=near, frequencyHz=hertz, dampingRatio=ratio)
            else:
                held = {"enableMotor": True, "motorSpeed": 0, "maxMotorTorque": 1e9} if motor else {}
                self.world.CreateRevoluteJoint(**both, anchor=near, **held)

    def step(self) -> object:
        return self.world.Step(H, *self.sweeps)

    def states(self) -> FloatArray:
        return np.array([
            (*body.position, body.angle, *body.linearVelocity, body.angularVelocity) for body in self.bodies[1:]
        ])  # fmt: skip


class Bullet:
    """Several are rigid bodies, whose constraints btSequentialImpulseConstraintSolver sweeps in order.

    One alone is a multibody of one link, as is usual there; constraints of several are swept in another order.
    """

    def __init__(self, bullet_client: Any, asked: Asked) -> None:
        self.client = client = bullet_client.BulletClient()
        client.setTimeStep(H)
        client.setPhysicsEngineParameter(
            erp=asked.share, numSolverIterations=asked.sweeps or 10, solverResidualThreshold=0
        )
        rigid = {"useMaximalCoordinates": int(len(asked.bodies) > 1)}
        self.bodies = [client.createMultiBody(0, **rigid)]
        for mass, inertia, (x, y, angle), (vx, vy, turn) in asked.bodies:
            half = np.sqrt(1.5 * inertia / mass)  # of a cube with that moment of inertia
            shape = client.createCollisionShape(client.GEOM_BOX, halfExtents=[half] * 3)
            body = client.createMultiBody(
                mass, shape, -1, [x, y, 0], client.getQuaternionFromEuler([0, 0, angle]), **rigid
            )
            client.changeDynamics(body, -1, linearDamping=0, angularDamping=0, maxJointVelocity=1e9)
            client.setCollisionFilterGroupMask(body, -1, 0, 0)
            client.resetBaseVelocity(body, [vx, vy, 0], [0, 0, turn])
            self.bodies.append(body)
        for _, first, second, points, _ in asked.joints:
            two = self.bodies[first], -1, self.bodies[second], -1
            places = [(*point, 0) for point in points]
            held = client.createConstraint(*two, client.JOINT_POINT2POINT, [0, 0, 0], *places)
            client.changeConstraint(held, maxForce=1e12)

    def step(self) -> object:
        return self.client.stepSimulation()

    def states(self) -> FloatArray:
        client, states = self.client, []
        for body in self.bodies[1:]:
            ((x, y, _), turned), ((vx, vy, _), (_, _, turn)) = (
                of(body) for of in (client.getBasePositionAndOrientation, client.getBaseVelocity)
            )
            states.append((x, y, client.getEulerFromQuaternion(turned)[2], vx, vy, turn))
        return np.array(states)


World = Pymunk | Box2d | Bullet
