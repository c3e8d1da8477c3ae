"""What engines call the feedback, and what their parameters mean in alpha_hat and beta_hat."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from typing import Literal

from bezstab.errors import InputError
from bezstab.rationals import within_float64
from bezstab.units import to_dimensionless

Point = tuple[Fraction, Fraction]


@dataclass(frozen=True)
class Engine:
    """An engine's own constraint parameters and what they mean in (alpha_hat, beta_hat) at a step of h seconds.

    acceleration: true Baumgarte feedback, so that the integrator decides. velocity: an impulse engine, whose update of
    one constraint is symplectic Euler's at that point. `read` and `write` raise InputError where the other has nothing.
    """

    name: str
    level: Literal["acceleration", "velocity"]
    parameters: tuple[str, ...]
    read: Callable[..., Point]
    write: Callable[[Point, Fraction], str]
    marks: tuple[tuple[str, Callable[[Fraction], Point]], ...]
    source: str
    excludes: str

    def point(self, values: tuple[Fraction, ...], h: Fraction) -> Point:
        """Return (alpha_hat, beta_hat) for values of the parameters, in their order."""
        if len(values) != len(self.parameters):
            raise InputError(f"--engine {self.name}: {len(values)} values, expected {', '.join(self.parameters)}")
        a, b = self.read(h, *values)
        return within_float64(a, f"--engine {self.name}: α̂"), within_float64(b, f"--engine {self.name}: β̂")

    def setting(self, point: Point, h: Fraction) -> str:
        """Return what to write in the engine's own words for a point; InputError where there is nothing."""
        if min(point) < 0:
            raise InputError(
                f"{self.name}: negative feedback ({float(point[0]):g}, {float(point[1]):g}) is not to be had"
            )
        try:
            return self.write(point, h)
        except OverflowError:
            raise InputError(f"{self.name}: its parameters would leave the range of float64") from None


def _mujoco(h: Fraction, first: Fraction, second: Fraction) -> Point:
    if first > 0 and second > 0:  # time constant and damping ratio
        return 2 * h / first, (h / (first * second)) ** 2
    if first <= 0 and second <= 0:  # minus stiffness, minus damping
        return -second * h, -first * h * h
    raise InputError(f"--engine mujoco: solref = {float(first):g} {float(second):g}: expected two of one sign")


def _box2d(h: Fraction, hertz: Fraction, zeta: Fraction) -> Point:
    if hertz < 0 or zeta < 0:
        raise InputError(
            f"--engine box2d: hertz = {float(hertz):g}, dampingRatio = {float(zeta):g}: expected none below 0"
        )
    turn = Fraction(2 * math.pi) * hertz * h
    x = turn * (2 * zeta + turn)
    return x / (1 + x), turn**2 / (1 + x)


def _write_box2d(point: Point, h: Fraction) -> str:
    a, b = map(float, point)
    if not 0 < b <= a < 1:
        raise InputError(f"box2d reaches 0 < β̂ <= α̂ < 1 only, not ({a:g}, {b:g})")
    turn = math.sqrt(b / (1 - a))
    return (
        f"hertz = {turn / (2 * math.pi * float(h)):.9g}, dampingRatio = {max(0.0, a / (1 - a) / turn - turn) / 2:.9g}"
    )


def _write_erp(name: str) -> Callable[[Point, Fraction], str]:
    def write(point: Point, h: Fraction) -> str:
        if point[0] != 1:
            raise InputError(f"{name} with CFM = 0 is α̂ = 1, not {float(point[0]):g}")
        return f"ERP = {float(point[1]):.9g}"

    return write


def _erp(name: str, default: str, source: str) -> Engine:
    marks = ((f"{name}: ERP = {default}", lambda h: (Fraction(1), Fraction(default))),)
    excludes = "CFM = 0; contacts, clamps, warm starts and the error of iterative solvers are left out"
    return Engine(
        name, "velocity", ("ERP",), lambda h, erp: (Fraction(1), erp), _write_erp(name), marks, source, excludes
    )


def _direct(name: str, source: str) -> Engine:
    def read(h: Fraction, alpha: Fraction, beta: Fraction) -> Point:
        return to_dimensionless(alpha, beta, h)

    def write(point: Point, h: Fraction) -> str:
        return f"alpha = {float(point[0] / h) / 2:.9g}, beta = {math.sqrt(point[1]) / float(h):.9g}"

    excludes = "nothing: these are the coefficients of c'' + 2 alpha c' + beta^2 c = 0"
    return Engine(name, "acceleration", ("alpha", "beta"), read, write, (), source, excludes)


ENGINES = {
    engine.name: engine
    for engine in (
        Engine(
            "mujoco",
            "acceleration",
            ("solref[0]", "solref[1]"),
            _mujoco,
            lambda point, h: f'solref="{-float(point[1] / h**2):.9g} {-float(point[0] / h):.9g}"',
            (
                ("MuJoCo: timeconst = 2h", lambda h: (Fraction(1), Fraction(1, 4))),
                ("MuJoCo: solref = 0.02 1", lambda h: _mujoco(h, Fraction("0.02"), Fraction(1))),
            ),
            "MuJoCo documentation, Modeling, Constraint parameters: Reference",
            "solimp with d0 = dmax (else r = d0 / dmax, 0.947 by default, scales damping and r^2 stiffness); the soft "
            "bias of 1 - d; contacts; refsafe, which raises a timeconst below 2h",
        ),
        Engine(
            "crocoddyl",
            "acceleration",
            ("gains[0]", "gains[1]"),
            lambda h, stiffness, damping: (damping * h, stiffness * h * h),
            lambda point, h: f"gains = [{float(point[1] / h**2):.9g}, {float(point[0] / h):.9g}]",
            (),
            "Crocoddyl source, contact-3d.hxx",
            "friction cones and impulses",
        ),
        _direct("maplesim", "MapleSim documentation, Multibody Dynamic Exports: SetBaumgarte"),
        _direct("drake", "Drake documentation, constraint stabilization (the older constraint solver)"),
        _erp("bullet", "0.2", "Bullet source, btContactSolverInfo.h"),
        _erp("ode", "0.2", "ODE wiki, Manual: Concepts"),
        _erp("dart", "0.01", "DART issue 317"),
        Engine(
            "box2d",
            "velocity",
            ("hertz", "dampingRatio"),
            _box2d,
            _write_box2d,
            (("Box2D joints: 60 Hz, 2", lambda h: _box2d(h, Fraction(60), Fraction(2))),),
            "Box2D v3 source, solver.h: b2MakeSoft; types.c",
            "contacts, warm starts, relaxation and the error of Gauss-Seidel sweeps",
        ),
    )
}
"""Those whose formula has a source. RBDL and Pinocchio are left out: their sources do not settle sign and order."""
