"""What engines call the feedback, and what their parameters mean in alpha_hat and beta_hat.

Each engine is a pair of conversions, `read` from its parameters to a point and `write` back, and where they come from.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from typing import Literal

from bezstab.errors import InputError
from bezstab.rationals import within_float64
from bezstab.units import feedback_gains, from_dimensionless, from_feedback_gains, to_dimensionless

Point = tuple[Fraction, Fraction]
"""alpha_hat and beta_hat."""


@dataclass(frozen=True)
class Engine:
    """An engine's own constraint parameters and what they mean in (alpha_hat, beta_hat) at a step of h seconds.

    acceleration: true Baumgarte feedback, so that the integrator decides. velocity: an impulse engine, whose update of
    one constraint is symplectic Euler's at that point. `read(h, *values)` and `write(point, h)` raise InputError where
    the other has nothing. `marks` are the settings everybody meets: a label, and the point as a function of h.
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
        """Return (alpha_hat, beta_hat) for values of the parameters, in their order and the engine's units; h in s.

        InputError for another number of values, for those that mean nothing and for a point outside float64's range.
        """
        option = f"--engine {self.name}"
        if len(values) != len(self.parameters):
            raise InputError(f"{option}: {len(values)} values, expected {', '.join(self.parameters)}")
        alpha_hat, beta_hat = self.read(h, *values)
        return within_float64(alpha_hat, f"{option}: α̂"), within_float64(beta_hat, f"{option}: β̂")

    def setting(self, point: Point, h: Fraction) -> str:
        """Return what to write in the engine's own words for a point, h in s; InputError where there is nothing."""
        alpha_hat, beta_hat = point
        if alpha_hat < 0 or beta_hat < 0:
            raise InputError(
                f"{self.name}: negative feedback ({float(alpha_hat):g}, {float(beta_hat):g}) is not to be had"
            )
        try:
            return self.write(point, h)
        except OverflowError:
            raise InputError(f"{self.name}: its parameters would leave the range of float64") from None


# Engines whose parameters are the coefficients of c'' + 2 alpha c' + beta^2 c = 0, or alpha and beta themselves


def _read_gains(h: Fraction, stiffness: Fraction, damping: Fraction) -> Point:
    """Stiffness is beta^2 (1/s^2), damping 2 alpha (1/s)."""
    return from_feedback_gains(damping, stiffness, h)


def _write_gains(point: Point, h: Fraction) -> str:
    damping, stiffness = feedback_gains(*point, h)
    return f"gains = [{float(stiffness):.9g}, {float(damping):.9g}]"


CROCODDYL = Engine(
    name="crocoddyl",
    level="acceleration",
    parameters=("gains[0]", "gains[1]"),
    read=_read_gains,
    write=_write_gains,
    marks=(),
    source="Crocoddyl source, contact-3d.hxx",
    excludes="friction cones and impulses",
)


def _read_alpha_beta(h: Fraction, alpha: Fraction, beta: Fraction) -> Point:
    return to_dimensionless(alpha, beta, h)


def _write_alpha_beta(point: Point, h: Fraction) -> str:
    alpha, beta = from_dimensionless(float(point[0]), float(point[1]), float(h))
    return f"alpha = {alpha:.9g}, beta = {beta:.9g}"


def _engine_with_alpha_and_beta(name: str, source: str) -> Engine:
    return Engine(
        name=name,
        level="acceleration",
        parameters=("alpha", "beta"),
        read=_read_alpha_beta,
        write=_write_alpha_beta,
        marks=(),
        source=source,
        excludes="nothing: these are the coefficients of c'' + 2 alpha c' + beta^2 c = 0",
    )


# MuJoCo


def _read_solref(h: Fraction, first: Fraction, second: Fraction) -> Point:
    """Return the point of MuJoCo's solref: two positive numbers or two that are not mean different things."""
    if first > 0 and second > 0:
        time_constant, damping_ratio = first, second  # s, -: alpha = 1 / T and beta = 1 / (T zeta)
        alpha, beta = 1 / time_constant, 1 / (time_constant * damping_ratio)
        return from_feedback_gains(2 * alpha, beta**2, h)
    if first <= 0 and second <= 0:
        return _read_gains(h, stiffness=-first, damping=-second)
    raise InputError(f"--engine mujoco: solref = {float(first):g} {float(second):g}: expected two of one sign")


def _write_solref(point: Point, h: Fraction) -> str:
    damping, stiffness = feedback_gains(*point, h)
    return f'solref="{-float(stiffness):.9g} {-float(damping):.9g}"'


def _least_time_constant(h: Fraction) -> Point:
    return _read_solref(h, 2 * h, Fraction(1))


def _default_solref(h: Fraction) -> Point:
    return _read_solref(h, Fraction("0.02"), Fraction(1))


MUJOCO = Engine(
    name="mujoco",
    level="acceleration",
    parameters=("solref[0]", "solref[1]"),
    read=_read_solref,
    write=_write_solref,
    marks=(("MuJoCo: timeconst = 2h", _least_time_constant), ("MuJoCo: solref = 0.02 1", _default_solref)),
    source="MuJoCo documentation, Modeling, Constraint parameters: Reference",
    excludes="solimp with d0 = dmax (else r = d0 / dmax, 0.947 by default, scales damping and r^2 stiffness); the soft "
    "bias of 1 - d; contacts; refsafe, which raises a timeconst below 2h",
)


# Impulse engines: ERP is the share of the error that one step removes, so with CFM = 0 the point is (1, ERP)


def _engine_with_erp(name: str, default: str, source: str) -> Engine:
    def read(h: Fraction, erp: Fraction) -> Point:
        return Fraction(1), erp

    def write(point: Point, h: Fraction) -> str:
        alpha_hat, beta_hat = point
        if alpha_hat != 1:
            raise InputError(f"{name} with CFM = 0 is α̂ = 1, not {float(alpha_hat):g}")
        return f"ERP = {float(beta_hat):.9g}"

    def default_point(h: Fraction) -> Point:
        return read(h, Fraction(default))

    return Engine(
        name=name,
        level="velocity",
        parameters=("ERP",),
        read=read,
        write=write,
        marks=((f"{name}: ERP = {default}", default_point),),
        source=source,
        excludes="CFM = 0; contacts, clamps, warm starts and the error of iterative solvers are left out",
    )


# Box2D: a soft constraint, implicit in its spring and damper. With its turn per step, t = 2 pi hertz h, and
# x = t (2 zeta + t), its velocity update is symplectic Euler's at alpha_hat = x / (1 + x), beta_hat = t^2 / (1 + x)


def _read_box2d(h: Fraction, hertz: Fraction, zeta: Fraction) -> Point:
    if hertz < 0 or zeta < 0:
        raise InputError(
            f"--engine box2d: hertz = {float(hertz):g}, dampingRatio = {float(zeta):g}: expected none below 0"
        )
    turn = Fraction(2 * math.pi) * hertz * h
    x = turn * (2 * zeta + turn)
    return x / (1 + x), turn**2 / (1 + x)


def _write_box2d(point: Point, h: Fraction) -> str:
    alpha_hat, beta_hat = float(point[0]), float(point[1])
    if not 0 < beta_hat <= alpha_hat < 1:
        raise InputError(f"box2d reaches 0 < β̂ <= α̂ < 1 only, not ({alpha_hat:g}, {beta_hat:g})")
    turn = math.sqrt(beta_hat / (1 - alpha_hat))  # as 1 + x = 1 / (1 - alpha_hat)
    x = alpha_hat / (1 - alpha_hat)
    hertz = turn / (2 * math.pi * float(h))
    zeta = max(0.0, x / turn - turn) / 2  # where beta_hat = alpha_hat rounding may leave less than 0
    return f"hertz = {hertz:.9g}, dampingRatio = {zeta:.9g}"


def _default_joint(h: Fraction) -> Point:
    return _read_box2d(h, Fraction(60), Fraction(2))


BOX2D = Engine(
    name="box2d",
    level="velocity",
    parameters=("hertz", "dampingRatio"),
    read=_read_box2d,
    write=_write_box2d,
    marks=(("Box2D joints: 60 Hz, 2", _default_joint),),
    source="Box2D v3 source, solver.h: b2MakeSoft; types.c",
    excludes="contacts, warm starts, relaxation and the error of Gauss-Seidel sweeps",
)


ALL_ENGINES = (
    MUJOCO,
    CROCODDYL,
    _engine_with_alpha_and_beta("maplesim", "MapleSim documentation, Multibody Dynamic Exports: SetBaumgarte"),
    _engine_with_alpha_and_beta("drake", "Drake documentation, constraint stabilization (the older constraint solver)"),
    _engine_with_erp("bullet", default="0.2", source="Bullet source, btContactSolverInfo.h"),
    _engine_with_erp("ode", default="0.2", source="ODE wiki, Manual: Concepts"),
    _engine_with_erp("dart", default="0.01", source="DART issue 317"),
    BOX2D,
)

ENGINES = {engine.name: engine for engine in ALL_ENGINES}
"""Those whose formula has a source. RBDL and Pinocchio are left out: their sources do not settle sign and order."""
