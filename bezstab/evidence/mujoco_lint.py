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

from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import partial

import numpy as np

from bezstab.engines import ENGINES, Point
from bezstab.evidence.mujoco_controllers import Controlled, MotorGains, controlled_motors, lifted_step
from bezstab.evidence.mujoco_models import DIGITS, LEAST_SIZE, Constraint, Feedback, ModelData, Motor, Unjudged
from bezstab.methods import Method, Verdict, lookup
from bezstab.rationals import ONE, ZERO, exact
from bezstab.stability import (
    BoolArray,
    FloatArray,
    Timing,
    drive_pole,
    drive_verdict,
    first_where,
    held_method,
)

Points = Callable[[Fraction], list[tuple[Point, str]]]
"""Of a factor on the step: the points of an element there, always as many, and what makes each of them."""

IMPLICIT_IN_VELOCITY = lookup("imex-euler")
"""What an integrator is for springs and drives whose damping is all implicit."""

DEFAULT_SOLREF = (0.02, 1.0)
"""What MuJoCo takes where one number of solref is positive and the other not."""

FACTORS = np.geomspace(1, 1e3, 120)
"""On the step, or its inverse, where an end of stability is looked for first: the maps here have no gap of 6 %."""

ROUNDING = 1e-9
"""Of |z|, which without damping is one but for it, or zero; and of shares: of less a direction has no mass."""

MOST_DOFS = 100
"""That are judged together: the eigenvalues of twice as many are found some two hundred times, within seconds."""

FREE = 1e-5
"""Of z: double poles at one, of joints that nothing holds, are split so far by the root of rounding, and masses."""

SEEN = 1e-3
"""Relative: by so much a share differs from the impedance where it is worth a word."""

SOFT = 5
"""Times slower than need be: then an equality or a limit is called soft."""

LEAST_HOLD = 0.1
"""Of d at the constraint: with less, a small error hardly feels it, and |z| says only that."""

SAFE_TOGETHER = "unsafe only alone: safe with what it is connected to, in the last row, which decides"

HARD = ("contact", "joint friction", "tendon friction")
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
    advice: str
    setting: str = ""
    judged: str = ""
    alpha_hat: float | None = None
    beta_hat: float | None = None
    map: str | None = None
    verdict: Verdict | None = None
    z_abs: float | None = None
    h_factor: float | None = None
    safe_together: bool = False

    @property
    def unsafe(self) -> bool:
        """Whether errors grow, or would at the smallest change; without damping they are only kept, at any step."""
        alone = self.verdict == "diverges" or (self.verdict == "marginal" and bool(self.alpha_hat))
        return alone and not self.safe_together

    @property
    def safe(self) -> bool | None:
        """Whether it is not unsafe; None where that was not judged."""
        return None if self.verdict is None else not self.unsafe

    def beside(self, together: "Linted | None") -> "Linted":
        """Return the same, whose safety is decided by what it was judged together with, if it was.

        That has the true inertia, as that of a closed loop. Where it neither grows nor decays, |z| = 1 to rounding, it
        says that nothing diverges, but no more.
        """
        if not self.unsafe or together is None or together.verdict in (None, "diverges", self.verdict):
            return self
        return replace(self, safe_together=True, advice=SAFE_TOGETHER)


def linted_model(model: ModelData, gains: Sequence[MotorGains], timing: Timing) -> Iterator[Linted]:
    """Yield what every constraint, spring, damper and drive of a model means, then all that hold both ways together.

    `gains` and `timing` are those of a controller that sets the model's motors; a motor without is not judged.
    InputError for gains of no motor, NumericalError where the mass matrix is singular, and where a pole leaves the
    range of float64.
    """
    groups = _along_one_direction(model.of(Feedback))
    bilateral = [constraint for constraint in model.of(Constraint) if constraint.active]
    controlled = {each.motor.element: each for each in controlled_motors(model, gains, timing)}
    together = None
    if len(bilateral) + len(groups) + len(controlled) > 1:
        together = _linted_together(model, bilateral, list(controlled.values()))
    for constraint in model.of(Constraint):
        yield _linted_constraint(model, constraint).beside(together if constraint.active else None)
    for group in groups:
        yield _linted_group(model, group).beside(together)
    for motor in model.of(Motor):
        if motor.element in controlled:
            yield _linted_motor(model, controlled[motor.element]).beside(together)
        else:
            reason = f"its control comes from outside: --pd '{motor.name}=KP,KD' judges it"
            yield _not_judged(motor.element, "motor", reason)
    for each in model.of(Unjudged):
        yield _not_judged(each.element, each.kind, each.reason)
    if together:
        yield together


def _not_judged(element: str, kind: str, reason: str) -> Linted:
    return Linted(element, kind, advice=f"not judged: {reason}")


# One element


def _moduli(method: Method, points: Sequence[Point]) -> FloatArray:
    """Return |z_p| a step of the model; where there is no stiffness, of the velocity alone."""
    alpha_hat, beta_hat = np.array(points, float).T
    return np.asarray(np.abs(drive_pole(method, alpha_hat, beta_hat)) ** (1 / float(method.step_multiple)))


def _linted(element: str, kind: str, setting: str, method: Method, points_at: Points) -> Linted:
    """Judge an element by the worst of its points; without advice."""
    points, reasons = zip(*points_at(ONE), strict=True)
    moduli = _moduli(method, points)
    worst = int(np.argmax(moduli))
    alpha_hat, beta_hat = points[worst]

    def unstable(factors: FloatArray) -> BoolArray:
        there = [point for factor in factors.tolist() for point, _ in points_at(exact(factor))]
        limit = 1.0 if all(point[0] for point in there) else 1 + ROUNDING
        return np.asarray((_moduli(method, there).reshape(len(factors), -1) >= limit).any(axis=-1))

    return Linted(
        element=element,
        kind=kind,
        advice="",
        setting=setting,
        judged=reasons[worst],
        alpha_hat=float(alpha_hat),
        beta_hat=float(beta_hat),
        map=method.name,
        verdict=drive_verdict(method, *points[worst]),
        z_abs=float(moduli[worst]),
        h_factor=_h_factor(unstable),
    )


def _h_factor(unstable: Callable[[FloatArray], BoolArray]) -> float | None:
    """Return the factor on the step at which stability ends, or, where it is lost already, begins; None for neither."""
    lost = bool(unstable(np.ones(1))[0])
    found = first_where(lambda factors: unstable(factors) != lost, 1 / FACTORS if lost else FACTORS)
    return found[lost] if found else None  # of the two next to each other the stable one


# Constraints


@dataclass(frozen=True)
class _Pull:
    """What a constraint does with one impedance if it gets all of its reference, and what makes it do so."""

    constraint: Constraint
    impedance: float
    reason: str
    point: Point

    @property
    def softening(self) -> FloatArray:
        """MuJoCo's R of the rows, from its estimate of the diagonal of J M^-1 J'."""
        return np.maximum(LEAST_SIZE, self.constraint.diagonal * (1 - self.impedance) / self.impedance)


def _pulls(model: ModelData, constraint: Constraint, factor: Fraction) -> list[_Pull]:
    """Return what a constraint does at the constraint, and past solimp's width, at a factor on the step."""
    h = model.h * factor
    solref, why = (
        (constraint.solref, "") if _of_one_sign(constraint.solref) else (DEFAULT_SOLREF, " as the signs differ")
    )
    first, second = map(exact, solref)
    if model.refsafe and 0 < first < 2 * h:
        first, why = 2 * h, why or " by refsafe"
    alpha_hat, beta_hat = ENGINES["mujoco"].read(h, first, second)
    at_rest, largest, width = constraint.solimp
    impedances = [at_rest, largest] if width > 0 else [(at_rest + largest) / 2]
    if not constraint.positional:  # friction has no position to be off
        impedances, beta_hat = impedances[:1], ZERO
    share = 1 / exact(largest)
    return [
        _Pull(
            constraint,
            impedance,
            f'solref="{_numbers((first, second))}"{why}, d = {impedance:g} {where}',
            (alpha_hat * share, beta_hat * exact(impedance) * share**2),
        )
        for impedance, where in zip(impedances, ("at the constraint", "past solimp's width"), strict=False)
    ]


def _linted_constraint(model: ModelData, constraint: Constraint) -> Linted:
    setting = f'solref="{_numbers(constraint.solref)}" solimp="{_numbers(constraint.solimp)}"'
    points_at = partial(_constraint_points, model, constraint)
    found = _linted(constraint.element, constraint.kind, setting, model.method, points_at)
    return replace(found, advice=_constraint_advice(model, constraint, found))


def _constraint_points(model: ModelData, constraint: Constraint, factor: Fraction) -> list[tuple[Point, str]]:
    """Return the points that a constraint takes, and what makes each of it."""
    points = []
    for pull in _pulls(model, constraint, factor):
        for share in _shares(model, pull, float(factor * model.h)):
            reason = pull.reason
            if share == 1 and not len(constraint.jacobian):
                reason += ", all of it where several contacts share it"
            elif abs(share - pull.impedance) >= SEEN * pull.impedance:
                reason += f", {share:.3g} by masses and damping"
            rounded = exact(round(share, DIGITS))
            points.append(((pull.point[0] * rounded, pull.point[1] * rounded), reason))
    return points


def _shares(model: ModelData, pull: _Pull, h: float) -> tuple[float, float]:
    """Return the least and the largest share of the reference that directions get at a step of h seconds.

    They are the eigenvalues of A' (A + R)^-1 of what moves: the impedance, but for MuJoCo's estimate of masses and for
    implicit damping. Contacts, whose rows nobody knows, may share a reference out: then the largest is all of it.
    """
    jacobian = pull.constraint.jacobian
    if not len(jacobian):
        return pull.impedance, 1.0
    regularized = jacobian @ model.inverse_mass(0.0) @ jacobian.T + np.diag(pull.softening)
    shares = np.linalg.eigvals(np.linalg.solve(regularized, jacobian @ model.inverse_mass(h) @ jacobian.T)).real
    moving = shares[shares > ROUNDING]  # a direction that moves nothing has no error either
    return (float(moving.min()), float(moving.max())) if moving.size else (pull.impedance,) * 2


def _constraint_advice(model: ModelData, constraint: Constraint, found: Linted) -> str:
    """Return what to write instead, and why: also where an equality or a limit is needlessly soft. Else nothing."""
    first, second = map(exact, constraint.solref)
    at_rest, _, width = constraint.solimp
    firm = replace(constraint, solref=(float(2 * model.h), 1.0))
    write_firm = f'solref="{_numbers(firm.solref)}"'
    if not _of_one_sign(constraint.solref):
        taken = _numbers(DEFAULT_SOLREF)
        return f'MuJoCo takes {taken}, as the signs differ: write solref="{taken}"'
    no_stiffness = "no stiffness: errors stay; " if constraint.positional and not first else ""
    if no_stiffness or found.verdict != "converges":
        return f"{no_stiffness}write {write_firm}"
    if model.refsafe and 0 < first < 2 * model.h:
        return f'relies on refsafe, which raises its timeconst to 2h: write solref="{_numbers((2 * model.h, second))}"'
    if constraint.kind in HARD:
        return ""
    if at_rest < LEAST_HOLD and width > 0:
        return f"solimp leaves small errors alone: d = {at_rest:g} at the constraint itself"
    points = [point for point, _ in _constraint_points(model, firm, ONE)]
    faster, now = np.log(np.maximum(ROUNDING, [_moduli(model.method, points).max(), found.z_abs]))
    times = faster / now
    return f"needlessly soft: {write_firm} settles {times:.0f} times as fast" if times > SOFT else ""


def _of_one_sign(solref: tuple[float, float]) -> bool:
    return (solref[0] > 0) == (solref[1] > 0)


def _numbers(values: Iterable[float | Fraction]) -> str:
    return " ".join(f"{float(value):.9g}" for value in values)


# Springs, dampers and drives


def _along_one_direction(feedbacks: Sequence[Feedback]) -> Collection[list[Feedback]]:
    """Return the feedbacks in groups that act along one joint or one tendon together."""
    groups: dict[tuple[float, ...], list[Feedback]] = {}
    for feedback in feedbacks:
        shape = feedback.direction / feedback.direction[np.flatnonzero(feedback.direction)[0]]
        groups.setdefault(tuple(shape.round(DIGITS).tolist()), []).append(feedback)
    return groups.values()


@dataclass(frozen=True)
class _Drive:
    """Gains along one direction, the inertia there with all other joints free (SI), and the method that it is.

    `implicit` is what the integrator treats implicitly of kd.
    """

    kp: Fraction
    kd: Fraction
    implicit: Fraction
    inertia: Fraction
    method: Method

    def point(self, h: Fraction) -> Point:
        """Return its point at a step of h seconds."""
        inertia = self.inertia
        if self.method is not IMPLICIT_IN_VELOCITY:  # else the method itself has what is implicit
            inertia += self.implicit * h
        return self.kd * h / inertia, self.kp * h**2 / inertia

    def linted(self, model: ModelData, element: str, kind: str, setting: str, reason: str) -> Linted:
        """Judge it, without advice; `reason` is what makes its point."""
        judged = f"{reason} with all other joints free"
        return _linted(element, kind, setting, self.method, lambda factor: [(self.point(model.h * factor), judged)])


def _linted_group(model: ModelData, group: Sequence[Feedback]) -> Linted:
    drive = _drive(model, group)
    if any(feedback.kind == "drive" for feedback in group):
        kind = "position drive" if drive.kp else "velocity drive"
    else:
        kind = f"{group[0].kind} {'spring' if drive.kp else 'damping'}"
    setting = f"kp {float(drive.kp):.6g}, kv {float(drive.kd):.6g}, inertia {float(drive.inertia):.6g}"
    element = ", ".join(dict.fromkeys(feedback.element for feedback in group))
    found = drive.linted(model, element, kind, setting, setting)
    return replace(found, advice=_drive_advice(model, drive, found))


def _drive(model: ModelData, group: Sequence[Feedback]) -> _Drive:
    """Return what acts along the direction of a group, per unit of its one joint, else of its first element."""
    direction = group[0].direction
    if np.count_nonzero(direction) == 1:
        direction = np.sign(np.abs(direction))
    kp = kd = implicit = 0.0
    for feedback in group:
        arm = float(feedback.direction @ direction / (direction @ direction))
        kp += arm**2 * feedback.stiffness
        kd += arm**2 * feedback.damping
        implicit += arm**2 * feedback.damping * feedback.implicit
    method = IMPLICIT_IN_VELOCITY if implicit and implicit == kd else model.method
    return _Drive(exact(kp), exact(kd), exact(implicit), model.inertia_along(direction), method)


def _drive_advice(model: ModelData, drive: _Drive, found: Linted) -> str:
    """Return what to write instead where a drive is unsafe, and which gain uses up the limit of its map."""
    if drive.kp < 0 or drive.kd < 0:
        return "pushes away at any step: a gain has the wrong sign"
    smaller_step = _smaller_step(model, found.h_factor)
    if not drive.kd:
        return "undamped" if found.verdict != "diverges" else f"undamped; {smaller_step}"
    if found.verdict == "converges":
        return ""
    used = ""
    if model.integrator != "RK4":  # of symplectic Euler's limit, 2 alpha_hat + beta_hat < 4
        alpha_hat, beta_hat = replace(drive, method=model.method).point(model.h)
        used = f"kv takes {float(alpha_hat / 2):.0%} of the limit, kp {float(beta_hat / 4):.0%}; "
    all_implicit = replace(drive, method=IMPLICIT_IN_VELOCITY).point(model.h)
    if drive.method is not IMPLICIT_IN_VELOCITY and drive_verdict(IMPLICIT_IN_VELOCITY, *all_implicit) == "converges":
        return f'{used}write integrator="implicitfast"'
    return f"{used}{smaller_step}"


def _smaller_step(model: ModelData, end: float | None) -> str:
    """Return the line with a step that leaves a tenth to the limit."""
    if end is None:
        return "no step is small enough"
    return f'write timestep="{0.9 * end * model.h:.2g}"'


def _linted_motor(model: ModelData, controlled: Controlled) -> Linted:
    """Judge a motor with its controller on the inertia along its direction: all other joints are free."""
    motor, timing = controlled.motor, controlled.timing
    inertia = model.inertia_along(motor.direction)
    method = held_method(model.method.name, timing)
    drive = _Drive(controlled.kp, controlled.kd, ZERO, inertia, method)
    gains = f"kp {float(drive.kp):.6g}, kd {float(drive.kd):.6g}"
    setting = f"{gains}, every {timing.every}, late {float(timing.late):g}"
    found = drive.linted(model, motor.element, "motor", setting, f"{setting} on inertia {float(inertia):.6g}")
    return found if found.verdict == "converges" else replace(found, advice=_smaller_step(model, found.h_factor))


# All together


def _linted_together(model: ModelData, constraints: Sequence[Constraint], controlled: Sequence[Controlled]) -> Linted:
    """Judge what holds both ways, as one linear system at qpos0: what is safe alone need not be safe together.

    Nor is what is unsafe alone unsafe in a closed loop, where it has to move more. Without gravity, limits and
    contacts; in float64, so nothing is proven.
    """
    dofs = len(model.mass)
    if dofs > MOST_DOFS:
        return _not_judged("all at qpos0", "together", f"{dofs} degrees of freedom, at most {MOST_DOFS}")

    def modulus(factor: float) -> float:
        """Return |z| with impedances at the constraints or past solimp's width, whichever is worse."""
        pulls = [_pulls(model, each, exact(factor)) for each in constraints]
        ends = {tuple(of_each[end] for of_each in pulls) for end in (0, -1)}
        return max(_modulus(model, held, controlled, factor) for held in ends)

    def unstable(factors: FloatArray) -> BoolArray:
        return np.array([modulus(factor) > 1 + ROUNDING for factor in factors.tolist()])

    z_abs = modulus(1.0)
    verdict: Verdict = "marginal"
    if abs(z_abs - 1) > ROUNDING:
        verdict = "diverges" if z_abs > 1 else "converges"
    end = _h_factor(unstable)
    return Linted(
        element="all at qpos0",
        kind="together",
        judged="all that hold both ways, as they are connected",
        map=model.method.name,
        verdict=verdict,
        z_abs=z_abs,
        h_factor=end,
        advice=_smaller_step(model, end) if verdict == "diverges" else "",
    )


def _modulus(model: ModelData, held: Sequence[_Pull], controlled: Sequence[Controlled], factor: float) -> float:
    """Return the largest |z| of a step of all that holds, so many times the model's; 0 where nothing holds."""
    step, every = _step(model, held, controlled, factor), 1
    if controlled:
        step, every = lifted_step(step, controlled, factor * model.h), controlled[0].timing.every
    z = np.linalg.eigvals(step)
    moduli = np.abs(z[np.abs(z - 1) > FREE]) ** (1 / every)
    return float(moduli.max(initial=0.0))


def _step(model: ModelData, held: Sequence[_Pull], controlled: Sequence[Controlled], factor: float) -> FloatArray:
    """Return the matrix of one step, from (x, h v, forces of motors) to (x, h v); shape (2 dofs, 2 dofs + motors)."""
    h, dofs, motors = factor * model.h, len(model.mass), len(controlled)
    inverse = model.inverse_mass(0.0)
    arms = np.array([each.motor.direction for each in controlled]).reshape(motors, dofs)
    stiffness, damping, _ = model.springs_and_dampers()
    # Times h^2, by positions, velocities times h, and forces.
    acceleration = inverse @ np.hstack([-stiffness * h * h, -damping * h, arms.T * h * h])
    # What constraints ask of it, J a = -alpha_hat J v - beta_hat J x, softened by R.
    jacobian = np.vstack([np.zeros((0, dofs)), *(pull.constraint.jacobian for pull in held)])
    points = [pull.point for pull in held for _ in pull.constraint.diagonal]  # of each row
    alpha_hat, beta_hat = np.array(points, float).reshape(-1, 2, 1).swapaxes(0, 1)
    asked = np.hstack([-beta_hat * jacobian, -alpha_hat * jacobian, np.zeros((len(jacobian), motors))])
    regularized = jacobian @ inverse @ jacobian.T + np.diag(np.hstack([[], *(pull.softening for pull in held)]))
    acceleration += inverse @ jacobian.T @ np.linalg.solve(regularized, asked - jacobian @ acceleration)
    slower = model.inverse_mass(h) @ model.mass  # what implicit damping leaves of it
    whole = np.eye(2 * dofs + motors)
    change = np.zeros_like(whole)
    change[dofs : 2 * dofs] = slower @ acceleration
    if model.integrator == "RK4":
        change[:dofs, dofs : 2 * dofs] = np.eye(dofs)
        for part in (4, 3, 2, 1):
            whole = np.eye(len(whole)) + change / part @ whole
    else:  # the velocity first, then the position with it
        whole += change
        whole[:dofs] += whole[dofs : 2 * dofs]
    return np.asarray(whole[: 2 * dofs])
