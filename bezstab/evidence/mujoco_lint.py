"""What the parameters of a MuJoCo model mean in (alpha_hat, beta_hat), and whether they are safe at its time step.

A constraint's reference is aref = -b c' - k d c, and MuJoCo gives the constraint the share d of it that solimp says:

    c'' = -d (b c' + k d c),   b = 2 / (dmax tc),   k = 1 / (dmax tc zeta)^2      (solref = tc, zeta)

so that with r = d / dmax alpha_hat = r 2h / tc and beta_hat = (r h / (tc zeta))^2 (MuJoCo documentation, Modeling,
Constraint parameters; source: mj_makeImpedance). Where MuJoCo's estimate of masses is off, the shares are not d but the
eigenvalues of A (A + R)^-1, A = J M^-1 J', of which the least and the largest are taken. Euler and the two implicit
integrators are symplectic Euler for constraints. They divide whatever accelerates by their implicit damping D, as
M' = M + h D stands for M: the shares are those of J M'^-1 J' (A + R)^-1. With one mass m and damping d that divides by
1 + h d / m.

A spring, damper or drive with stiffness kp and damping kv on inertia I is alpha_hat = kv h / I, beta_hat = kp h^2 / I:
IMEX-Euler where all damping is implicit, RK4 under RK4, else symplectic Euler, of a point that is divided likewise.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cache
from itertools import accumulate
from typing import TypeVar

import numpy as np

from bezstab.engines import ENGINES, Drive
from bezstab.errors import NumericalError
from bezstab.evidence.mujoco_controllers import Controlled, MotorGains, controlled_motors, lifted_step
from bezstab.evidence.mujoco_models import Constraint, Feedback, ModelData, Motor
from bezstab.methods import Method, Verdict, closed_loop_at, lookup, recursion_verdict
from bezstab.rationals import exact
from bezstab.stability import (
    BoolArray,
    FloatArray,
    Timing,
    first_where,
    held_spectral_radius,
    held_verdict,
    poles,
    spectral_radius,
)
from bezstab.units import feedback_gains

FRESH = Timing()
"""A controller as fast as the physics."""

Point = tuple[Fraction, Fraction]
"""alpha_hat and beta_hat."""

Number = TypeVar("Number", Fraction, FloatArray)
"""An exact one, or as many as there are steps that are looked at."""

Points = Callable[[FloatArray], tuple[FloatArray, FloatArray]]
"""Of factors on the step, shape (factors,): alpha_hat and beta_hat of each point, shape (factors, points)."""

Shares = Callable[[float, FloatArray], FloatArray]
"""Of impedance and steps (s): the least and the largest share of its reference that a constraint gets, (steps, 2)."""

DEFAULT_SOLREF = (0.02, 1.0)
"""What MuJoCo takes where one number of solref is positive and the other not."""

DIGITS = 12
"""Of a share: what linear algebra in float64 leaves of small matrices."""

MOVING = 1e-9
"""Least share: below, a direction has no mass, but for rounding."""

FURTHEST = 1e3
"""Factor on the step beyond which nobody asks, and its inverse."""

FACTORS = np.geomspace(1, FURTHEST, 120)
"""Where an end of stability is looked for first: the maps here have no gap of 6 %."""

UNDAMPED = 1e-9
"""Of |z|: without damping it is one to rounding, and only what is larger grows."""

MOST_DOFS = 100
"""That are judged together: the eigenvalues of twice as many are found some two hundred times, within seconds."""

LEAST_SOFTENING = 1e-15
"""MuJoCo's mjMINVAL, its least R: it keeps rows that move nothing from being singular."""

FREE = 1e-5
"""Of z: double poles at one, of joints that nothing holds, are split so far by the root of rounding, and masses."""

SEEN = 1e-3
"""Relative: by so much a share differs from the impedance where it is worth a word."""

SOFT = 5
"""Times slower than need be: then an equality or a limit is called soft."""

DEADBEAT = 1e-9
"""Of |z|: what is less is gone at once."""

LEAST_HOLD = 0.1
"""Of d at the constraint: with less, a small error hardly feels it, and |z| says only that."""

SAFE_TOGETHER = "unsafe only alone: safe with what it is connected to, in the last row, which decides"

HARD = ("contact", "contact pair", "joint friction", "tendon friction")
"""Kinds whose softness is a property of the material: nobody is told to change it."""


@dataclass(frozen=True)
class Linted:
    """What one element of a MuJoCo model means, and whether it is safe at the model's step.

    `setting` is what the model says, in its own words, `judged` which of it the point stands for, and why.
    (alpha_hat, beta_hat) is the point with the largest |z| of those that it takes, proven by `verdict`; both are None
    where several elements move together and no one point stands for them. `map` is the method, None where nothing was
    judged. `h_factor` is the factor on the step up to which it is stable at the same physical parameters (below one
    where it is not); None where there is no such end. `safe_together`: unsafe only without what it is connected to.
    """

    element: str
    kind: str
    setting: str
    judged: str
    alpha_hat: float | None
    beta_hat: float | None
    map: str | None
    verdict: Verdict | None
    z_abs: float | None
    h_factor: float | None
    advice: str
    safe_together: bool = False

    @property
    def unsafe(self) -> bool:
        """Whether errors grow, or would at the smallest change; without damping they are only kept, at any step."""
        return not self.safe_together and self._unsafe_alone

    @property
    def _unsafe_alone(self) -> bool:
        return self.verdict == "diverges" or (self.verdict == "marginal" and bool(self.alpha_hat))

    def beside(self, together: "Linted | None") -> "Linted":
        """Return the same, whose safety is decided by what it was judged together with, if it was.

        That has the true inertia, as that of a closed loop. Where it neither grows nor decays, |z| = 1 to rounding, it
        says that nothing diverges, but no more.
        """
        if not self._unsafe_alone or together is None or together.verdict in (None, "diverges", self.verdict):
            return self
        return replace(self, safe_together=True, advice=SAFE_TOGETHER)


def linted_model(model: ModelData, gains: Sequence[MotorGains] = (), timing: Timing = FRESH) -> Iterator[Linted]:
    """Yield what every constraint, spring, damper and drive of a model means, then all that hold both ways together.

    `gains` and `timing` are those of a controller that sets the model's motors; a motor without is not judged.
    InputError for gains of no motor, NumericalError where the mass matrix is singular,
    and where a pole leaves the range of float64.
    """
    modes = _damping_modes(model)
    groups = _along_one_direction(model.feedbacks)
    bilateral = [constraint for constraint in model.constraints if _is_bilateral(constraint)]
    controlled = controlled_motors(model, gains, timing)
    several = len(bilateral) + len(groups) + len(controlled) > 1
    together = _linted_together(model, modes, bilateral, controlled) if several else None
    for constraint in model.constraints:
        alone = _linted_constraint(model, modes, constraint)
        yield alone.beside(together) if _is_bilateral(constraint) else alone
    for group in groups:
        yield _linted_drive(model, modes, group).beside(together)
    for motor in model.motors:
        judged = [each for each in controlled if each.motor == motor]
        yield (
            _linted_motor(model, modes, judged[0]).beside(together)
            if judged
            else _not_judged(
                motor.element, "motor", f"its control comes from outside: --pd '{motor.name}=KP,KD' judges it"
            )
        )
    for each in model.unjudged:
        yield _not_judged(each.element, each.kind, each.reason)
    if together:
        yield together


def _not_judged(element: str, kind: str, reason: str) -> Linted:
    return Linted(
        element=element,
        kind=kind,
        setting="",
        judged="",
        alpha_hat=None,
        beta_hat=None,
        map=None,
        verdict=None,
        z_abs=None,
        h_factor=None,
        advice=f"not judged: {reason}",
    )


def _map(model: ModelData) -> Method:
    """Return the method that the model's integrator is for constraints."""
    return lookup("RK4" if model.integrator == "RK4" else "SYM")


# One point


def _verdict(method: Method, point: Point) -> Verdict:
    """Return the proven verdict; where there is no stiffness, that on the velocity alone."""
    polynomial = closed_loop_at(method, *point)
    if point[1] == 0:  # nothing holds the position: P = (z - 1) Q, and Q's coefficients are the running sums of P's
        polynomial = list(accumulate(polynomial))[:-1]
    return recursion_verdict(polynomial)


def _moduli(method: Method, alpha_hat: FloatArray, beta_hat: FloatArray) -> FloatArray:
    """Return |z_p|; where there is no stiffness, of the velocity alone: without the pole at one."""
    if beta_hat.any():
        return spectral_radius(method, alpha_hat, beta_hat)
    z = poles(method, alpha_hat, beta_hat)
    others = np.argsort(np.abs(z - 1), axis=-1)[..., 1:]
    moduli: FloatArray = np.abs(np.take_along_axis(z, others, axis=-1)).max(axis=-1)
    return moduli


def _h_factor(unstable: Callable[[FloatArray], BoolArray]) -> float | None:
    """Return the factor on the step at which stability ends, or, where it is lost already, begins; None for neither."""
    if unstable(np.ones(1))[0]:
        found = first_where(lambda factors: ~unstable(factors), 1 / FACTORS)
        return found[1] if found else None
    found = first_where(unstable, FACTORS)
    return found[0] if found else None


def _end_of(points: Points, method: Method) -> float | None:
    """Return the factor on the step up to which all points stay stable, from the points at factors."""

    def unstable(factors: FloatArray) -> BoolArray:
        alpha_hat, beta_hat = points(factors)
        limit = 1.0 if alpha_hat.all() else 1 + UNDAMPED
        return np.asarray((_moduli(method, alpha_hat, beta_hat) >= limit).any(axis=-1))

    return _h_factor(unstable)


def _worst(method: Method, points: Sequence[Point]) -> tuple[Point, Verdict, float]:
    """Return the point with the largest |z|, its verdict, and |z|."""
    alpha_hat, beta_hat = np.array([[float(x) for x in point] for point in points]).T
    moduli = _moduli(method, alpha_hat, beta_hat)
    worst = int(np.argmax(moduli))
    return points[worst], _verdict(method, points[worst]), float(moduli[worst])


# Constraints


@dataclass(frozen=True)
class _DampingModes:
    """(M + h D)^-1 for every h at once: `basis` diag(1 / (1 + h rates)) `basis`'; the rates are in 1/s."""

    basis: FloatArray
    rates: FloatArray


def _damping_modes(model: ModelData) -> _DampingModes:
    """Return the modes of the damping D that the integrator treats implicitly: D B = M B diag(rates), B' M B = 1."""
    _, damping = _springs_and_dampers(model, [each for each in model.feedbacks if _implicit(model, each)])
    try:
        root = np.linalg.inv(np.linalg.cholesky(model.mass))
    except np.linalg.LinAlgError:
        raise NumericalError("the mass matrix at qpos0 is singular to rounding") from None
    rates, turned = np.linalg.eigh(root @ damping @ root.T)
    return _DampingModes(basis=root.T @ turned, rates=rates)


def _springs_and_dampers(model: ModelData, feedbacks: Sequence[Feedback]) -> tuple[FloatArray, FloatArray]:
    """Return the stiffness and the damping matrix of feedbacks; shape (dofs, dofs) each, SI."""
    stiffness, damping = np.zeros_like(model.mass), np.zeros_like(model.mass)
    for each in feedbacks:
        moved = np.flatnonzero(each.direction)  # one or a few of thousands
        squared = np.outer(each.direction[moved], each.direction[moved])
        stiffness[np.ix_(moved, moved)] += each.stiffness * squared
        damping[np.ix_(moved, moved)] += each.damping * squared
    return stiffness, damping


def _implicit(model: ModelData, feedback: Feedback) -> bool:
    """Return whether the integrator treats a damping implicitly."""
    if model.integrator == "Euler":
        return model.euler_damping and feedback.euler_implicit
    return model.integrator != "RK4"


def _linted_constraint(model: ModelData, modes: _DampingModes, constraint: Constraint) -> Linted:
    method = _map(model)
    shares = _shares(modes, constraint)
    taken = _constraint_points(model, constraint, shares, constraint.solref)
    point, verdict, z_abs = _worst(method, [each.point for each in taken])
    (why, *_) = [each.why for each in taken if each.point == point]
    return Linted(
        element=constraint.element,
        kind=constraint.kind,
        setting=f'solref="{_numbers(constraint.solref)}" solimp="{_numbers(constraint.solimp)}"',
        judged=f"{_solref_in_force(model, constraint)}, {why}",
        alpha_hat=float(point[0]),
        beta_hat=float(point[1]),
        map=method.name,
        verdict=verdict,
        z_abs=z_abs,
        h_factor=_end_of(_constraint_points_at(model, constraint, shares), method),
        advice=_constraint_advice(model, constraint, shares, verdict, z_abs),
    )


def _solref_in_force(model: ModelData, constraint: Constraint) -> str:
    """Return the solref that MuJoCo goes by, and why it is another than what the model says."""
    if not _of_one_sign(constraint.solref):
        return f'solref="{_numbers(DEFAULT_SOLREF)}" as the signs differ'
    first, second = constraint.solref
    if model.refsafe and 0 < first < 2 * model.h:
        return f'solref="{_numbers((2 * model.h, second))}" by refsafe'
    return f'solref="{_numbers(constraint.solref)}"'


@dataclass(frozen=True)
class _Taken:
    """A point that a constraint takes, and what makes that of its solref."""

    point: Point
    why: str


def _constraint_points(
    model: ModelData, constraint: Constraint, shares: Shares, solref: tuple[float, float]
) -> list[_Taken]:
    """Return the points that a constraint takes with that solref, at the constraint and past solimp's width, exactly.

    Where rows that nobody knows share out a reference, also with all of it, which is the most.
    """
    reference, held_from = _reference(model, constraint, solref)
    reached = Fraction(1) if held_from is None else min(Fraction(1), held_from)
    largest = exact(constraint.solimp[1])
    found: list[_Taken] = []
    for impedance, where in zip(_impedances(constraint), ("at the constraint", "past solimp's width"), strict=False):
        of_directions = shares(impedance, np.array([model.h]))[0].tolist()
        taken = [(share, _share_text(share, impedance)) for share in of_directions]
        if _is_shared_out(constraint):
            taken.append((1.0, ", all of it where several contacts share it"))
        for share, text in taken:
            point = _taken(reference, reached, exact(impedance), exact(round(share, DIGITS)), largest)
            found.append(_Taken(point, f"d = {impedance:g} {where}{text}"))
    return found


def _share_text(share: float, impedance: float) -> str:
    """Return the share of its reference that a direction gets, where that is not the impedance."""
    return "" if abs(share - impedance) < SEEN * impedance else f", {share:.3g} by masses and damping"


def _constraint_points_at(model: ModelData, constraint: Constraint, shares: Shares) -> Points:
    """Return a function of factors on the step: what `_constraint_points` returns there, in float64."""
    reference, held_from = _reference(model, constraint, constraint.solref)
    at_one = np.array([float(reference[0])]), np.array([float(reference[1])])
    largest = np.array([constraint.solimp[1]])

    def points(factors: FloatArray) -> tuple[FloatArray, FloatArray]:
        reached = factors if held_from is None else np.minimum(factors, float(held_from))
        alpha_hats: list[FloatArray] = []
        beta_hats: list[FloatArray] = []
        for impedance in _impedances(constraint):
            taken = list(shares(impedance, model.h * factors).T)
            if _is_shared_out(constraint):
                taken.append(np.ones_like(factors))
            for share in taken:
                alpha_hat, beta_hat = _taken(at_one, reached, np.array([impedance]), share, largest)
                alpha_hats.append(alpha_hat)
                beta_hats.append(beta_hat)
        return np.stack(alpha_hats, axis=-1), np.stack(beta_hats, axis=-1)

    return points


def _reference(model: ModelData, constraint: Constraint, solref: tuple[float, float]) -> tuple[Point, Fraction | None]:
    """Return the point of a solref at the model's step if nothing changed it, and from which factor refsafe holds it.

    As timeconst is 2h from there on, alpha_hat and beta_hat no longer grow with h.
    """
    first, second = (exact(value) for value in (solref if _of_one_sign(solref) else DEFAULT_SOLREF))
    h = exact(model.h)
    alpha_hat, beta_hat = ENGINES["mujoco"].read(h, first, second)
    if not constraint.positional:  # friction has no position to be off
        beta_hat = Fraction(0)
    return (alpha_hat, beta_hat), first / (2 * h) if model.refsafe and first > 0 else None


def _impedances(constraint: Constraint) -> tuple[float, ...]:
    """Return d at the constraint and past solimp's width; friction, which has no position to be off, stays at rest."""
    at_rest, largest, width = constraint.solimp
    impedances = (at_rest, largest) if width > 0 else ((at_rest + largest) / 2,)
    return impedances if constraint.positional else impedances[:1]


def _is_shared_out(constraint: Constraint) -> bool:
    """Return whether an unknown number of rows share a reference: contacts do, and a flex of very many edges."""
    return constraint.jacobian is None and constraint.kind != "joint limit"


def _taken(
    reference: tuple[Number, Number], reached: Number, impedance: Number, share: Number, largest: Number
) -> tuple[Number, Number]:
    """Return the point that is left of a reference at `reached` times the step, by impedance, share and dmax."""
    alpha_hat, beta_hat = reference
    return alpha_hat * reached * share / largest, beta_hat * reached**2 * impedance * share / largest**2


def _shares(modes: _DampingModes, constraint: Constraint) -> Shares:
    """Return a function of impedance and steps: the least and largest share of the reference that directions get.

    They are the impedance, but for MuJoCo's estimate of masses and for implicit damping.
    """
    jacobian, diagonal = constraint.jacobian, constraint.diagonal
    if jacobian is None or diagonal is None:
        return lambda impedance, h: np.full((len(h), 2), impedance)
    touched = np.flatnonzero(jacobian.any(axis=0))
    moved = jacobian[:, touched] @ modes.basis[touched]
    moving = moved.any(axis=0)
    moved, rates = moved[:, moving], modes.rates[moving]

    def shares(impedance: float, h: FloatArray) -> FloatArray:
        softening = np.maximum(LEAST_SOFTENING, diagonal * (1 - impedance) / impedance)
        regularized = moved @ moved.T + np.diag(softening)
        if len(moved) == 1 and moved[0] @ moved[0] > MOVING * regularized[0, 0]:
            share = (1 / (1 + h[:, np.newaxis] * rates)) @ moved[0] ** 2 / regularized[0, 0]
            return np.stack([share, share], axis=-1)
        if not rates.any():
            return np.tile(_extremes(regularized, moved @ moved.T, impedance), (len(h), 1))
        return np.array([_extremes(regularized, (moved / (1 + step * rates)) @ moved.T, impedance) for step in h])

    return shares


def _extremes(regularized: FloatArray, damped: FloatArray, impedance: float) -> tuple[float, float]:
    """Return the least and the largest eigenvalue of A' (A + R)^-1 that belongs to a direction that moves."""
    found = np.linalg.eigvals(np.linalg.solve(regularized, damped)).real
    moving = found[found > MOVING]  # a direction that moves nothing has no error either
    return (float(moving.min()), float(moving.max())) if moving.size else (impedance, impedance)


def _constraint_advice(model: ModelData, constraint: Constraint, shares: Shares, verdict: Verdict, z_abs: float) -> str:
    """Return what to write instead, and why; nothing where all is well."""
    first, second = constraint.solref
    least = 2 * model.h
    firm = (least, 1.0)
    if not _of_one_sign(constraint.solref):
        taken = _numbers(DEFAULT_SOLREF)
        return f'MuJoCo takes {taken}, as the signs differ: write solref="{taken}"'
    if constraint.positional and not first:
        return f'no stiffness: errors stay; write solref="{_numbers(firm)}"'
    if verdict != "converges":
        return f'write solref="{_numbers(firm)}"'
    if model.refsafe and 0 < first < least:
        return f'relies on refsafe, which raises its timeconst to 2h: write solref="{_numbers((least, second))}"'
    return "" if constraint.kind in HARD else _softness(model, constraint, shares, z_abs)


def _softness(model: ModelData, constraint: Constraint, shares: Shares, z_abs: float) -> str:
    """Return whether a safe equality or limit is needlessly soft, and what would be firm."""
    if constraint.solimp[0] < LEAST_HOLD and constraint.solimp[2] > 0:
        return f"solimp leaves small errors alone: d = {constraint.solimp[0]:g} at the constraint itself"
    firm = (2 * model.h, 1.0)
    taken = _constraint_points(model, constraint, shares, firm)
    faster = _worst(_map(model), [each.point for each in taken])[2]
    times = float(np.log(max(DEADBEAT, faster)) / np.log(max(DEADBEAT, z_abs)))
    return f'needlessly soft: solref="{_numbers(firm)}" settles {times:.0f} times as fast' if times > SOFT else ""


def _of_one_sign(solref: tuple[float, float]) -> bool:
    return (solref[0] > 0) == (solref[1] > 0)


def _numbers(values: Sequence[float]) -> str:
    return " ".join(f"{value:.9g}" for value in values)


# Springs, dampers and drives


def _along_one_direction(feedbacks: Sequence[Feedback]) -> list[list[Feedback]]:
    """Return the feedbacks in groups that act along one joint or one tendon together."""
    groups: dict[tuple[float, ...], list[Feedback]] = {}
    for feedback in feedbacks:
        if feedback.direction.any():
            moved = np.flatnonzero(feedback.direction)
            shape = feedback.direction[moved] / feedback.direction[moved[0]]
            groups.setdefault((*moved.tolist(), *shape.round(DIGITS).tolist()), []).append(feedback)
    return list(groups.values())


@dataclass(frozen=True)
class _Drive:
    """Stiffness and damping along one direction, and the inertia there with all other joints free (SI)."""

    stiffness: Fraction
    explicit_damping: Fraction
    implicit_damping: Fraction
    inertia: Fraction


def _linted_drive(model: ModelData, modes: _DampingModes, group: Sequence[Feedback]) -> Linted:
    drive = _drive(model, modes, group)
    h = exact(model.h)
    own = _drive_map(model, drive)
    point, verdict, z_abs = _worst(own.method, [own.point])
    end = _end_of(own.points, own.method)
    damping = drive.explicit_damping + drive.implicit_damping
    setting = f"kp {float(drive.stiffness):.6g}, kv {float(damping):.6g}, inertia {float(drive.inertia):.6g}"
    return Linted(
        element=", ".join(dict.fromkeys(feedback.element for feedback in group)),
        kind=_drive_kind(group, drive),
        setting=setting,
        judged=f"{setting} with all other joints free",
        alpha_hat=float(point[0]),
        beta_hat=float(point[1]),
        map=own.method.name,
        verdict=verdict,
        z_abs=z_abs,
        h_factor=end,
        advice=_drive_advice(model, drive, verdict, end, h),
    )


def _drive(model: ModelData, modes: _DampingModes, group: Sequence[Feedback]) -> _Drive:
    """Return what acts along the direction of a group, per unit of its one joint, else of its first element."""
    direction = group[0].direction
    moved = np.flatnonzero(direction)
    if moved.size == 1:
        direction = direction / direction[moved[0]]
    stiffness = damping = implicit = 0.0
    for feedback in group:
        arm_squared = float(feedback.direction[moved[0]] / direction[moved[0]]) ** 2
        stiffness += arm_squared * feedback.stiffness
        if _implicit(model, feedback):
            implicit += arm_squared * feedback.damping
        else:
            damping += arm_squared * feedback.damping
    return _Drive(exact(stiffness), exact(damping), exact(implicit), _inertia_along(modes, direction))


def _inertia_along(modes: _DampingModes, direction: FloatArray) -> Fraction:
    """Return the inertia along a direction u with all else free, 1 / (u M^-1 u'), to DIGITS."""
    moved = np.flatnonzero(direction)
    inertia = 1 / float(np.sum((direction[moved] @ modes.basis[moved]) ** 2))
    return exact(float(f"{inertia:.{DIGITS}g}"))


@dataclass(frozen=True)
class _DriveMap:
    """The method that the integrator is for a drive, and its point: at the model's step, exact.

    At a factor f on the step it is (alpha_hat f, beta_hat f^2) / (1 + divisor f).
    """

    method: Method
    alpha_hat: Fraction
    beta_hat: Fraction
    divisor: Fraction

    @property
    def point(self) -> Point:
        """The point at the model's step."""
        return self.alpha_hat / (1 + self.divisor), self.beta_hat / (1 + self.divisor)

    def points(self, factors: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the one point at factors on the step, in float64; shape (factors, 1) each."""
        f = factors[:, np.newaxis]
        divided = f / (1 + float(self.divisor) * f)
        return float(self.alpha_hat) * divided, float(self.beta_hat) * f * divided


def _drive_map(model: ModelData, drive: _Drive) -> _DriveMap:
    """Return the method that the integrator is for a drive, and its point."""
    h = exact(model.h)
    alpha_hat = (drive.explicit_damping + drive.implicit_damping) * h / drive.inertia
    beta_hat = drive.stiffness * h**2 / drive.inertia
    if drive.implicit_damping and not drive.explicit_damping:
        return _DriveMap(lookup("imex-euler"), alpha_hat, beta_hat, divisor=Fraction(0))
    return _DriveMap(_map(model), alpha_hat, beta_hat, divisor=drive.implicit_damping * h / drive.inertia)


def _drive_kind(group: Sequence[Feedback], drive: _Drive) -> str:
    if any(feedback.kind == "drive" for feedback in group):
        return "position drive" if drive.stiffness else "velocity drive"
    return f"{group[0].kind} {'spring' if drive.stiffness else 'damping'}"


def _drive_advice(model: ModelData, drive: _Drive, verdict: Verdict, end: float | None, h: Fraction) -> str:
    """Return what to write instead where a drive is unsafe, and which gain uses up the limit of its map."""
    damping = drive.explicit_damping + drive.implicit_damping
    if drive.stiffness < 0 or damping < 0:
        return "pushes away at any step: a gain has the wrong sign"
    if not damping:
        return "undamped" if verdict != "diverges" else f"undamped; {_smaller_step(end, h)}"
    if verdict == "converges":
        return ""
    used = _used_up(model, drive, h)
    all_implicit = _Drive(drive.stiffness, Fraction(0), damping, drive.inertia)
    imex = lookup("imex-euler")
    if drive.explicit_damping and _verdict(imex, _drive_map(model, all_implicit).point) == "converges":
        return f'{used}write integrator="implicitfast"'
    return f"{used}{_smaller_step(end, h)}"


def _used_up(model: ModelData, drive: _Drive, h: Fraction) -> str:
    """Return which share of symplectic Euler's limit, 2 alpha_hat + beta_hat < 4, damping and stiffness take."""
    if model.integrator == "RK4":
        return ""
    divisor = 4 * (drive.inertia + drive.implicit_damping * h)
    damping = 2 * (drive.explicit_damping + drive.implicit_damping) * h / divisor
    stiffness = drive.stiffness * h**2 / divisor
    return f"kv takes {float(damping):.0%} of the limit, kp {float(stiffness):.0%}; "


def _smaller_step(end: float | None, h: Fraction) -> str:
    """Return the line with a step that leaves a tenth to the limit."""
    if end is None:
        return "no step is small enough"
    return f'write timestep="{0.9 * end * float(h):.2g}"'


# Motors whose control comes from outside


def _linted_motor(model: ModelData, modes: _DampingModes, controlled: Controlled) -> Linted:
    """Judge a motor with its controller on the inertia along its direction: all other joints are free."""
    motor, timing = controlled.motor, controlled.timing
    inertia = _inertia_along(modes, motor.direction)
    kp, kd = exact(motor.gain) * controlled.kp, exact(motor.gain) * controlled.kd
    drive, method = Drive(kp, kd, inertia), _map(model)
    point = drive.point(exact(model.h))

    def unstable(factors: FloatArray) -> BoolArray:
        steps = (exact(model.h * factor) for factor in factors.tolist())
        return np.array([held_spectral_radius(method.name, *drive.point(h), timing) >= 1 for h in steps])

    verdict = held_verdict(method.name, *point, timing)
    end = _h_factor(unstable)
    setting = f"kp {float(kp):.6g}, kd {float(kd):.6g}, every {timing.every}, late {float(timing.late):g}"
    return Linted(
        element=motor.element,
        kind="motor",
        setting=setting,
        judged=f"{setting} on inertia {float(inertia):.6g} with all other joints free",
        alpha_hat=float(point[0]),
        beta_hat=float(point[1]),
        map=method.name,
        verdict=verdict,
        z_abs=held_spectral_radius(method.name, *point, timing),
        h_factor=end,
        advice="" if verdict == "converges" else _smaller_step(end, exact(model.h)),
    )


# All together


def _linted_together(
    model: ModelData, modes: _DampingModes, constraints: Sequence[Constraint], controlled: Sequence[Controlled]
) -> Linted:
    """Judge what holds both ways, as one linear system at qpos0: what is safe alone need not be safe together.

    Nor is what is unsafe alone unsafe in a closed loop, where it has to move more. Without gravity, limits and
    contacts; in float64, so nothing is proven.
    """
    if len(model.mass) > MOST_DOFS:
        return _not_judged("all at qpos0", "together", f"{len(model.mass)} degrees of freedom, at most {MOST_DOFS}")

    @cache
    def modulus(factor: float) -> float:
        return _together_modulus(model, modes, constraints, controlled, factor)

    def unstable(factors: FloatArray) -> BoolArray:
        return np.array([modulus(float(factor)) > 1 + UNDAMPED for factor in factors])

    z_abs = modulus(1.0)
    if z_abs > 1 + UNDAMPED:
        verdict: Verdict = "diverges"
    else:
        verdict = "converges" if z_abs < 1 - UNDAMPED else "marginal"
    end = _h_factor(unstable)
    return Linted(
        element="all at qpos0",
        kind="together",
        setting="",
        judged="all that hold both ways, as they are connected",
        alpha_hat=None,
        beta_hat=None,
        map=_map(model).name,
        verdict=verdict,
        z_abs=z_abs,
        h_factor=end,
        advice=_smaller_step(end, exact(model.h)) if verdict == "diverges" else "",
    )


def _together_modulus(
    model: ModelData,
    modes: _DampingModes,
    constraints: Sequence[Constraint],
    controlled: Sequence[Controlled],
    factor: float,
) -> float:
    """Return the largest |z| of a step of all equalities, springs, dampers, drives and motors; 0 where none holds.

    With the equalities' impedances at the constraint, or past solimp's width, whichever is worse.
    """
    choices = {tuple(_impedances(each)[which] for each in constraints) for which in (0, -1)}
    return max(
        _modulus_with_impedances(model, modes, constraints, controlled, impedances, factor) for impedances in choices
    )


def _is_bilateral(constraint: Constraint) -> bool:
    """Return whether a constraint holds both ways from the start, by rows that are known."""
    return constraint.active and constraint.positional and constraint.jacobian is not None


def _modulus_with_impedances(
    model: ModelData,
    modes: _DampingModes,
    constraints: Sequence[Constraint],
    controlled: Sequence[Controlled],
    impedances: Sequence[float],
    factor: float,
) -> float:
    h = factor * model.h
    step, forces = _one_step(model, modes, constraints, [each.motor for each in controlled], impedances, factor)
    every = controlled[0].timing.every if controlled else 1
    z = np.linalg.eigvals(lifted_step(step, forces, controlled, h) if controlled else step)
    held = np.abs(z[np.abs(z - 1) > FREE]) ** (1 / every)
    return float(held.max(initial=0.0))


def _one_step(
    model: ModelData,
    modes: _DampingModes,
    constraints: Sequence[Constraint],
    motors: Sequence[Motor],
    impedances: Sequence[float],
    factor: float,
) -> tuple[FloatArray, FloatArray]:
    """Return the matrices of one step: of (x, h v), shape (2 dofs, 2 dofs), and of motors' forces, (2 dofs, motors)."""
    stiffness, damping = _springs_and_dampers(model, model.feedbacks)
    h = factor * model.h
    inverse = modes.basis @ modes.basis.T  # of the mass
    arms = np.array([motor.direction for motor in motors]).reshape(-1, len(inverse)).T
    # of the acceleration: what positions, velocities and forces make of it
    by_position, by_velocity, by_force = -inverse @ stiffness, -inverse @ damping, inverse @ arms
    if constraints:
        jacobian = np.vstack([each.jacobian for each in constraints if each.jacobian is not None])
        regularization, damper, spring = _regularized(model, constraints, impedances, factor)
        inverted = np.linalg.inv(jacobian @ inverse @ jacobian.T + np.diag(regularization))
        to_acceleration = inverse @ jacobian.T @ inverted
        by_position = by_position - to_acceleration @ (spring[:, np.newaxis] * jacobian + jacobian @ by_position)
        by_velocity = by_velocity - to_acceleration @ (damper[:, np.newaxis] * jacobian + jacobian @ by_velocity)
        by_force = by_force - to_acceleration @ jacobian @ by_force
    slower = (modes.basis / (1 + h * modes.rates)) @ modes.basis.T @ model.mass  # what implicit damping leaves of it
    # velocities in units of 1/h: (h v)' = h^2 by_position x + h by_velocity (h v) + h^2 by_force f
    to_velocity = slower @ np.hstack([h * h * by_position, h * by_velocity, h * h * by_force])
    dofs, columns = len(inverse), to_velocity.shape[1]
    if model.integrator == "RK4":
        rates = np.zeros((columns, columns))
        rates[:dofs, dofs : 2 * dofs] = np.eye(dofs)
        rates[dofs : 2 * dofs] = to_velocity
        identity = np.eye(columns)
        whole = identity + rates @ (identity + rates / 2 @ (identity + rates / 3 @ (identity + rates / 4)))
    else:  # the velocity first, then the position with it
        whole = np.eye(columns)
        whole[dofs : 2 * dofs] += to_velocity
        whole[:dofs] += whole[dofs : 2 * dofs]
    return whole[: 2 * dofs, : 2 * dofs], whole[: 2 * dofs, 2 * dofs :]


def _regularized(
    model: ModelData, constraints: Sequence[Constraint], impedances: Sequence[float], factor: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return R, b and k d of the constraints' rows: what softens them, their damping (1/s) and stiffness (1/s^2)."""
    softening: list[float] = []
    damper: list[float] = []
    spring: list[float] = []
    h = model.h * factor
    for constraint, d in zip(constraints, impedances, strict=True):
        assert constraint.diagonal is not None
        first, second = constraint.solref if _of_one_sign(constraint.solref) else DEFAULT_SOLREF
        if model.refsafe and first > 0:
            first = max(first, 2 * h)
        alpha_hat, beta_hat = ENGINES["mujoco"].read(exact(h), exact(first), exact(second))
        largest = constraint.solimp[1]
        softening += np.maximum(LEAST_SOFTENING, constraint.diagonal * (1 - d) / d).tolist()
        two_alpha, beta_squared = feedback_gains(float(alpha_hat), float(beta_hat), h)
        damper += [two_alpha / largest] * len(constraint.diagonal)
        spring += [beta_squared * d / largest**2] * len(constraint.diagonal)
    return np.array(softening), np.array(damper), np.array(spring)
