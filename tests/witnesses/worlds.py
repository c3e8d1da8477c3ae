"""One planar mechanism in engines that are not ours, made by their modules: pymunk (Chipmunk), Box2D 2.3, PyBullet."""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

FloatArray = NDArray[np.float64]


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


class Pymunk:
    """Steps of h (s); joints take back a share of their errors, None: as by default. `kick` gives each body its rates.

    Places and rates are x, y and angle, body by body.
    """

    def __init__(
        self,
        pymunk: Any,
        bodies: Sequence[Body],
        joints: Sequence[Joint],
        h: float,
        sweeps: int = 10,
        share: float | None = None,
        gravity: tuple[float, float] = (0, 0),
    ) -> None:
        self.space, self.h = pymunk.Space(), h
        self.space.iterations, self.space.gravity = sweeps, gravity
        self.bodies = [pymunk.Body(each.mass, each.inertia) for each in bodies]
        for body, each in zip(self.bodies, bodies, strict=True):
            *body.position, body.angle = each.place
        self.kick([each.rates for each in bodies])
        self.space.add(*self.bodies)
        ends = [self.space.static_body, *self.bodies]
        for kind, first, second, points, motor in joints:
            two = ends[first], ends[second]
            held = [(pymunk.PinJoint if kind == "link" else pymunk.PivotJoint)(*two, *map(tuple, points))]
            if kind == "link":
                held[0].distance = 1
            if motor:
                held.append(pymunk.GearJoint(*two, 0, 1) if motor == "angle" else pymunk.SimpleMotor(*two, 0))
            for joint in held:
                joint.error_bias = joint.error_bias if share is None else (1 - share) ** (1 / h)
                self.space.add(joint)

    def step(self) -> object:
        return self.space.step(self.h)

    def places(self) -> FloatArray:
        return np.array([(*body.position, body.angle) for body in self.bodies])

    def rates(self) -> FloatArray:
        return np.array([(*body.velocity, body.angular_velocity) for body in self.bodies])

    def kick(self, rates: ArrayLike) -> None:
        for body, (vx, vy, turn) in zip(self.bodies, np.array(rates).tolist(), strict=True):
            body.velocity, body.angular_velocity = (vx, vy), turn


class Box2d:
    """Velocities without error are swept first, then positions, as long as an error is above the slop of 5 mm.

    Its numbers have seven digits, and its joints no share.
    """

    def __init__(
        self,
        box2d: Any,
        bodies: Sequence[Body],
        joints: Sequence[Joint],
        h: float,
        sweeps: int = 8,
        share: float | None = None,
        gravity: tuple[float, float] = (0, 0),
    ) -> None:
        self.world = box2d.b2World(gravity=gravity)
        self.world.allowSleeping = False
        self.asked = h, sweeps, max(3, sweeps // 4)
        self.bodies = []
        for mass, inertia, (x, y, angle), _ in bodies:
            body = self.world.CreateDynamicBody(position=(x, y), angle=angle, allowSleep=False)
            body.massData = box2d.b2MassData(mass=mass, I=inertia, center=(0, 0))
            self.bodies.append(body)
        self.kick([each.rates for each in bodies])
        ends = [self.world.CreateStaticBody(position=(0, 0)), *self.bodies]
        for kind, first, second, points, motor in joints:
            both = {"bodyA": ends[first], "bodyB": ends[second]}
            near, far = (ends[body].GetWorldPoint(point) for body, point in zip((first, second), points, strict=True))
            if kind == "link":
                self.world.CreateDistanceJoint(**both, anchorA=near, anchorB=far, length=1)
            elif "," in motor:
                hertz, ratio = map(float, motor.split(","))
                self.world.CreateWeldJoint(**both, anchor=near, frequencyHz=hertz, dampingRatio=ratio)
            else:
                strength = 1e9 * bool(motor)
                self.world.CreateRevoluteJoint(
                    **both, anchor=near, enableMotor=bool(motor), motorSpeed=0, maxMotorTorque=strength
                )

    def step(self) -> object:
        return self.world.Step(*self.asked)

    def places(self) -> FloatArray:
        return np.array([(*body.position, body.angle) for body in self.bodies])

    def rates(self) -> FloatArray:
        return np.array([(*body.linearVelocity, body.angularVelocity) for body in self.bodies])

    def kick(self, rates: ArrayLike) -> None:
        for body, (vx, vy, turn) in zip(self.bodies, np.array(rates, float).tolist(), strict=True):
            body.linearVelocity, body.angularVelocity = (vx, vy), turn


class Bullet:
    """Several are rigid bodies, whose constraints btSequentialImpulseConstraintSolver sweeps in order.

    One alone is a multibody of one link, as is usual there; constraints of several are swept in another order.
    """

    def __init__(
        self,
        bullet_client: Any,
        bodies: Sequence[Body],
        joints: Sequence[Joint],
        h: float,
        sweeps: int = 10,
        share: float | None = None,
    ) -> None:
        self.client = bullet_client.BulletClient()
        self.client.setTimeStep(h)
        self.client.setPhysicsEngineParameter(erp=share, numSolverIterations=sweeps, solverResidualThreshold=0)
        self.bodies, rigid = [], {"useMaximalCoordinates": int(len(bodies) > 1)}
        for mass, inertia, (x, y, angle), _ in bodies:
            half = np.sqrt(1.5 * inertia / mass)  # of a cube with that moment of inertia
            shape = self.client.createCollisionShape(self.client.GEOM_BOX, halfExtents=[half] * 3)
            turn = self.client.getQuaternionFromEuler([0, 0, angle])
            body = self.client.createMultiBody(mass, shape, -1, [x, y, 0], turn, **rigid)
            self.client.changeDynamics(body, -1, linearDamping=0, angularDamping=0, maxJointVelocity=1e9)
            self.client.setCollisionFilterGroupMask(body, -1, 0, 0)
            self.bodies.append(body)
        self.kick([each.rates for each in bodies])
        ends = [self.client.createMultiBody(0, **rigid), *self.bodies]
        for _, first, second, points, _ in joints:
            two = ends[first], -1, ends[second], -1
            places = [(*point, 0) for point in points]
            held = self.client.createConstraint(*two, self.client.JOINT_POINT2POINT, [0, 0, 0], *places)
            self.client.changeConstraint(held, maxForce=1e12)

    def step(self) -> object:
        return self.client.stepSimulation()

    def places(self) -> FloatArray:
        found = (self.client.getBasePositionAndOrientation(body) for body in self.bodies)
        return np.array([(x, y, self.client.getEulerFromQuaternion(turn)[2]) for (x, y, _), turn in found])

    def rates(self) -> FloatArray:
        found = (self.client.getBaseVelocity(body) for body in self.bodies)
        return np.array([(vx, vy, turn) for (vx, vy, _), (_, _, turn) in found])

    def kick(self, rates: ArrayLike) -> None:
        for body, (vx, vy, turn) in zip(self.bodies, np.array(rates).tolist(), strict=True):
            self.client.resetBaseVelocity(body, [vx, vy, 0], [0, 0, turn])


World = Pymunk | Box2d | Bullet
