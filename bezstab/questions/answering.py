"""The answers to a question: a verdict for each method and point, and more when it is asked for.

An answer is a point with its proven verdict, pole and margins. What takes longer is computed when it is first asked
for, and then kept:

    answers(question)  →  Answer (given, or chosen)  ·  cost  ·  moving  ·  setting
                            ├── instead              what `choose` gives in its place
                            └── faster, slower       what faster decay costs, and slower decay gains
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cached_property
from typing import Literal, cast

from bezstab.engines.conversions import READ_BACK, Curve, Engine, Point
from bezstab.engines.engine_list import engine_and_values
from bezstab.errors import InputError, NumericalError
from bezstab.goals import UP_TO_LONGEST, Goal
from bezstab.methods.rotation_torque import stage_torque
from bezstab.methods.schemes import Method
from bezstab.motion.modulated_circle import motion_energy, steps_to_breakdown
from bezstab.motion.spinning_bodies import spin_change
from bezstab.questions.chains import ALONE, SweptAnswer
from bezstab.questions.question import Question, usual_goal
from bezstab.questions.scene_runs import MOST_GAINED, SceneRun, scene_run
from bezstab.rationals import rational, typed_number
from bezstab.stability.choices import Choice, choose, describe_point, steps_to_settle
from bezstab.stability.closed_loop import Modulus
from bezstab.stability.damping_limits import stable_up_to
from bezstab.stability.feedback_costs import FeedbackCost, feedback_cost
from bezstab.stability.margins import largest_stable_step
from bezstab.stability.turning import LAW_HOLDS, MovingPole, moving_modulus, moving_pole
from bezstab.units import alpha_and_beta
from bezstab.words import (
    change_words,
    counted,
    decay_words,
    growth_words,
    point_words,
    seconds_words,
    times_words,
)

CheckedRole = Literal["given", "instead"]
Role = Literal[CheckedRole, "chosen"]
"""A point was given, or is to be taken instead of a given one, or was chosen by a goal."""

SHORTER = (2, 4)
"""A step may be so many times as short for a choice that is not safe: a mechanism then turns less in a step."""

KEPT = 5e-5
"""Of the largest kinetic energy in a run, or of a motion's in a second: less is no change that anybody sees."""

MOVED = 0.01
"""Of the energy, in a second: what a motion may gain or lose without a word."""

HARD = 0.999
"""Of an impedance: above it the energy of a closed four-bar is that of hard constraints, to some hundredths."""

SLOWER = 2
"""Slower decay takes this many times as long to settle."""


@dataclass(frozen=True, repr=False, kw_only=True)
class Answer(Choice):
    """All that `Choice` says of a point, and what that means for the question.

    These are None if the question is not about them: `moving` without a scene, `setting` without an engine, `swept`
    without a chain or a scene in an engine that sweeps.
    """

    question: Question = field(compare=False)
    role: Role

    def __repr__(self) -> str:
        return f"{self.sentence} [{self.method.name}, {self.goal}, |z_p| = {abs(self.pole):.6g}]"

    def __bool__(self) -> bool:
        return self.safe

    @property
    def sentence(self) -> str:
        """The answer in words: what was judged, whether it is safe, how fast errors fall, what may grow."""
        return answer_sentence(self)

    @property
    def energy_sentence(self) -> str | None:
        """What a second does to the energy of a motion of rate --omega; None where that is little, or not known."""
        return "".join(map(_sentence, _on_a_motion(self))) or None

    @property
    def safe(self) -> bool:
        """Whether every error is proven to shrink, also while steps vary, if that is asked.

        Of a scene a run must go through as well, with constraints that hold and no energy gained. Where the bound on a
        moving mechanism settles nothing, the run decides.

        For constraints that an engine sweeps over this is computed and not proven: |z| is below one by more than its
        accuracy. Without a chain or a scene, safe means: safe for one constraint alone.
        """
        if self.swept and not self.swept.growth.decays:
            return False
        return self.verdict == "converges" and self._safe_in_motion

    @property
    def _safe_in_motion(self) -> bool:
        """Whether the motion of the scene leaves it safe: its run decides, unless the bound says that errors grow."""
        if self.moving is None or self.moving.verdict == "diverges":
            return self.moving is None
        return self.run.sound if self.run and self.run.decides else self.moving.verdict == "converges"

    @cached_property
    def run(self) -> SceneRun | None:
        """What a run of the scene shows; None without a scene, in an engine that sweeps, and where errors grow anyway.

        Steps are all h long.
        """
        mechanism, h, duration = self.question.mechanism, self.question.h, self.question.duration
        grows = self.verdict != "converges" or (self.moving is not None and self.moving.verdict == "diverges")
        if mechanism is None or h is None or self.swept or grows:
            return None
        return scene_run(mechanism, self.method, h, self.point, None if duration is None else float(duration))

    @property
    def h(self) -> float | None:
        """The step (s) that was asked about."""
        return None if self.question.h is None else float(self.question.h)

    @property
    def alpha(self) -> float | None:
        """Damping of the feedback (1/s); None without a step."""
        return alpha_and_beta(*self.point, self.question.h)[0]

    @property
    def beta(self) -> float | None:
        """Stiffness of the feedback as a rate (1/s); None without a step, and for a negative beta_hat."""
        return alpha_and_beta(*self.point, self.question.h)[1]

    @property
    def settle_seconds(self) -> float | None:
        """Time (s) in which the error falls a thousandfold; None without a step, and where it does not."""
        steps, step = self.settle_steps, self.method_step
        return None if steps is None or step is None else steps * step

    @property
    def method_step(self) -> float | None:
        """The step (s) of the method: some take several of h at once."""
        return None if self.h is None else self.h * float(self.method.step_multiple)

    @property
    def h_limit(self) -> float | None:
        """The largest step (s) that is stable at this alpha and beta: infinite where any is; None where not known."""
        return None if self.margins is None or self.h is None else self.margins.h * self.h

    @cached_property
    def moving(self) -> MovingPole | None:
        """How far the motion of the scene moves the poles."""
        if self.question.turning is None or self.h is None:
            return None
        return moving_pole(self.method, self.question.turning.kappa, self.h, self.alpha_hat, self.beta_hat)

    @property
    def spins(self) -> bool:
        """Whether `energy_rate` is that of a body on a pin: in an engine of a known class, by its own steps."""
        engine = self.question.engine
        if engine is None or engine.energy_class is None or self.method.name != engine.method:
            return False
        damped = self.method.name == "implicit-euler" and self.alpha_hat > 0  # XPBD's damping has no map
        return not (engine.energy_class == "projected" and damped)

    @property
    def impedance(self) -> float | None:
        """The share that soft constraints get of what they want, where the engine has such: MuJoCo's d."""
        engine, h = self.question.engine, self.question.h
        if engine is None or engine.impedances is None or h is None:
            return None
        at_no_error, at_large = engine.impedances(*self._engine_values(engine, h))
        return float(at_no_error if self.goal == "as given" and not self.question.as_typed else at_large)

    @cached_property
    def energy_rate(self) -> tuple[float, float] | None:
        """What a second adds to the energy of a motion of rate --omega, and its part by rotation alone: shares of it.

        Of a mass on a circle whose rate varies by MODULATION; in an engine, of a body that spins about a pin. None
        without that rate, and where it is not known.
        """
        omega, h, engine = self.question.omega, self.h, self.question.engine
        if omega is None or h is None or self.question.scene or self.verdict != "converges":
            return None
        if engine and engine.energy_class and self.spins:
            point, theta = (self.alpha_hat, self.beta_hat), float(omega) * h
            if self.method.name == "implicit-euler":  # what its step takes back, as shares of the step before
                point = (sum(point) / (1 + sum(point)), self.beta_hat / (1 + sum(point)))
            rate = 2 * spin_change(engine.energy_class, *point, theta, self.impedance or 1.0) / h
            return rate, rate
        if engine and engine.level != "acceleration":
            return None
        found = motion_energy(self.method, self.alpha_hat, self.beta_hat, float(omega) * h)
        growth, rotation = float(found.growth()), float(found.rotation)
        return (float(omega) * growth, float(omega) * rotation) if math.isfinite(growth) else None

    @property
    def compared(self) -> bool:
        """Whether errors are compared with the least: of a point that was given, if the motion's rate was, too."""
        return self.question.goal is not None or not self.question.motion.assumed

    @property
    def cost(self) -> FeedbackCost | None:
        """What accuracy the feedback costs on the motion of the question; None where that is not known."""
        return self.cost_or_reason[0]

    @cached_property
    def cost_or_reason(self) -> tuple[FeedbackCost | None, str | None]:
        """The same, and why it is not known."""
        omega_h = self.question.motion.omega_h
        try:
            return feedback_cost(self.method, *self.point, omega_h, least=self.compared), None
        except (InputError, NumericalError) as error:  # the verdict stands without it
            return None, f"what accuracy the feedback costs is not known: {error}"

    @property
    def setting(self) -> str | None:
        """The line to write in the engine for a point that was chosen; InputError if the engine cannot express it."""
        engine, h = self.question.engine, self.question.h
        return engine.setting(self.point, h) if engine and h is not None and self.role != "given" else None

    @cached_property
    def engine_h_limit(self) -> float | None:
        """The largest step (s) at which the engine's values are stable, as the engine reads them at each step.

        None if they are not stable, if every step is stable, and without an engine.
        """
        engine, h = self.question.engine, self.question.h
        if engine is None or h is None or self.verdict != "converges":
            return None
        values, as_typed = self._engine_values(engine, h), self.question.as_typed and self.role == "given"
        return largest_stable_step(
            self.method, lambda step: engine.applied(values, step, as_typed=as_typed).points, float(h)
        )

    def _engine_values(self, engine: Engine, h: Fraction) -> tuple[Fraction, ...]:
        """Return the engine's values at this point: those that were given, else those of `setting`."""
        if self.role == "given" and self.question.values is not None:
            return self.question.values
        return tuple(rational(value) for value in engine.values(self.point, h))

    @cached_property
    def swept(self) -> SweptAnswer | None:
        """What the engine's sweeps do to the errors of a chain, or of the scene's constraints."""
        swept = self.question.swept
        return None if swept is None else swept.answer(self._engine_values(swept.engine, swept.h))

    @property
    def swept_over(self) -> str | None:
        """The constraints that the answer is about, if the engine sweeps; None if it solves all of them together."""
        if self.question.engine is None or not self.question.engine.sweeps:
            return None
        return (self.question.swept.constraints if self.question.swept else ALONE).words

    @cached_property
    def alone(self) -> "Answer | None":
        """What the same goal chooses for one constraint alone; None if that is this choice."""
        if self.question.swept is None or self.role == "given":
            return None
        goal, settle = cast(Goal, self.goal), self.question.settle
        alone = _chosen_alone(self.question, self.role, self.method, goal, settle, margins=False)
        return None if alone.point == self.point else alone

    @cached_property
    def sweeps_to_spare(self) -> int | None:
        """The number of sweeps from which the choice is stable, even if it were stronger by the spread.

        None, too, where there is nothing to set, or the engine expresses all of the plane.
        """
        swept = self.question.swept
        if swept is None or not (swept.engine.curve and swept.engine.parameters):
            return None
        return swept.sweeps_to_spare(self.point, self.question.spread)

    @cached_property
    def instead(self) -> "Answer":
        """What `choose` gives for the same question by its usual goal.

        InputError where nothing is stable or the engine cannot express it, NumericalError where it cannot be found.
        """
        goal = usual_goal(self.question.engine, (self.method,))
        question = replace(self.question, chain=self.question.chain_to_choose_for)
        if goal == "accurate":
            replace(question, methods=(self.method,)).check_motion()
        found = _chosen(question, "instead", self.method, goal)
        _ = found.setting
        return found

    @cached_property
    def faster(self) -> "Answer | None":
        """The choice of robust, else of fastest, that decays faster than this one; None if neither does."""
        if self._robust is not None and abs(self._robust.pole) < abs(self.pole):
            return self._robust
        fastest = self._alternative("fastest")
        return fastest if fastest is not None and abs(fastest.pole) < abs(self.pole) else None

    @cached_property
    def safe_with(self) -> str | None:
        """The option with which a choice is safe that is not: --goal robust, else a shorter step; None if neither.

        None, too, past a singular configuration: no run decides there.
        """
        if self.safe or self.role == "given" or (self.run and not self.run.decides):
            return None
        if self.goal != "robust" and self._robust:
            return "--goal robust"
        question = self.question
        if question.scene is None or question.h is None or question.h_max or question.engine:
            return None
        for share in SHORTER:
            shorter = replace(question, h=question.h / share)
            found = self._alternative(cast(Goal, self.goal), question.settle, shorter)
            if found:
                return f"--h {typed_number(question.h / share)}"
        return None

    @property
    def slower_settle(self) -> Fraction | None:
        """SLOWER times the time (s, to two digits) in which this choice settles at worst; None if it does not."""
        steps, h = self.settle_steps_at_worst, self.question.h
        if steps is None or h is None:
            return None
        return Fraction(f"{float(SLOWER * steps * h * self.method.step_multiple):.2g}")

    @cached_property
    def slower(self) -> "Answer | None":
        """The choice of the goal accurate with `slower_settle` to settle; None if there is none."""
        return None if self.slower_settle is None else self._alternative("accurate", self.slower_settle)

    def times_the_errors(self, other: "Answer") -> tuple[float, float] | None:
        """Return the errors of constraint and velocity at another answer over those at this one; None if not known."""
        here, there = self.cost, other.cost
        if here and there and here.total_error and here.velocity_error and there.total_error and there.velocity_error:
            return there.total_error / here.total_error, there.velocity_error / here.velocity_error
        return None

    @cached_property
    def _robust(self) -> "Answer | None":
        return self._alternative("robust")

    def _alternative(
        self, goal: Goal, settle: Fraction | None = None, question: Question | None = None
    ) -> "Answer | None":
        """Return another choice; None if there is none or it cannot be found: this answer does not need it."""
        try:
            return _chosen(question or self.question, "chosen", self.method, goal, settle, margins=False)
        except (InputError, NumericalError):
            return None


def answer_sentence(answer: Answer) -> str:
    """Return what was judged, whether it is safe, how fast an error falls, and how far each number alone may grow.

    With a scene also what happens over the motion; of an engine that solves its constraints one after another, for how
    many that is.
    """
    swept = answer.swept
    safe = "safe" if answer.safe else "not safe"
    if answer.swept_over:
        safe += f" {'in' if swept else 'for'} {answer.swept_over}"
    said = _swept(answer, swept) if swept else _errors(answer)
    if answer.safe and not answer.swept_over:  # more of one constraint alone means nothing for a chain of them
        said += _growth(answer)
    if answer.safe_with:
        said.append(f"with {answer.safe_with} it is safe")
    motion = answer.question.motion
    if answer.goal == "accurate" and motion.assumed:
        said.append(f"without --omega {_assumed(motion.omega_h, answer.h)} is assumed")
    return " ".join([f"{_judged(answer)}: {safe}.", *map(_sentence, said)])


def _sentence(said: str) -> str:
    return f"{said[0].upper()}{said[1:]}."


def _assumed(omega_h: Fraction, h: float | None) -> str:
    """Return the motion that a choice was made for, though nobody gave its rate."""
    turn = f"ωh = {float(omega_h):g}"
    return f"a motion with {turn}" if h is None else f"a motion of {float(omega_h) / h:.3g} rad/s ({turn})"


def _judged(answer: Answer) -> str:
    """Return the point that was judged."""
    return point_words(answer.alpha_hat, answer.beta_hat, answer.question.h)


def _change(answer: Answer, z_abs: float, verdict: str, bound: str = "") -> str:
    """Return how long an error takes to fall to a thousandth, or what a step does to one that does not fall."""
    steps = answer.settle_steps if z_abs == abs(answer.pole) else steps_to_settle(z_abs)
    if verdict != "converges" or steps is None:
        return change_words(z_abs, verdict, bound=bound)
    return decay_words(steps, answer.method_step, bound=bound)


def _errors(answer: Answer) -> list[str]:
    """Return what becomes of an error at rest, and over the motion of a scene."""
    at_rest = _change(answer, abs(answer.pole), answer.verdict)
    if answer.moving:
        return [f"at rest {at_rest}", _in_motion(answer, answer.moving), *_as_it_ran(answer)]
    return [at_rest, *_on_a_motion(answer)]


def _in_motion(answer: Answer, moving: MovingPole) -> str:
    """Return what becomes of an error as the mechanism moves, at most or at least, or why that is not settled."""
    if moving.verdict == "converges":
        return f"in motion {_change(answer, moving.at_most, 'converges', 'at most ')}"
    if moving.verdict == "diverges":
        return f"in motion {_change(answer, moving.at_least, 'diverges', 'at least ')}"
    if moving.at_most < 1:
        return "in motion it is not settled: the constraints turn too far in a step, or faster than the feedback works"
    bound = _finite(moving.at_most)
    how = "two poles nearly meet there" if bound is None else f"a step may multiply the error by {bound:.3g}"
    return f"in motion this may diverge: {how}"


def _on_a_motion(answer: Answer) -> list[str]:
    """Return what a second does to the energy of a motion whose rate was given; nothing if that is a hundredth.

    Of a choice that does not weigh it, it is said anyway.
    """
    unweighed = answer.role == "chosen" and answer.goal != "accurate"
    if answer.energy_rate is None or not (abs(answer.energy_rate[0]) >= MOVED or unweighed):
        return []
    rate, by_rotation = answer.energy_rate
    omega = float(answer.question.omega or 0)
    what = "gains" if rate > 0 else "loses"
    motion = f"a body that spins about a pin at {omega:.3g} rad/s" if answer.spins else f"a motion of {omega:.3g} rad/s"
    if answer.spins and answer.impedance:
        motion += f", with an impedance d of {answer.impedance:g},"
    if abs(rate) < KEPT:
        return [f"{motion} keeps its energy"]
    said = f"{motion} {what} {100 * abs(rate):.2g} % of its energy a second"
    # stages' torque grows as the cube of the rate
    if not answer.spins and by_rotation > MOVED and stage_torque(answer.method).power == 2:
        h = cast(float, answer.h)
        end = h * steps_to_breakdown(answer.method, answer.alpha_hat, answer.beta_hat, omega * h)
        said += f" and breaks down after about {seconds_words(end)}" if end < math.inf else ""
        said += ": take heun or RK4, or gentler feedback"
    return [said]


def _as_it_ran(answer: Answer) -> list[str]:
    """Return what a run of the scene showed, and what helps if it is not safe; nothing if it was not run."""
    run = answer.run
    if run is None:
        return []
    time = seconds_words(run.duration)
    if run.failure:
        return [f"a run breaks down {run.failure}"]
    said = [f"in a run of {time}: |c| at most {run.c_max:.1e}, {_energy_text(run.gained)}"]
    if not run.decides:
        return [*said, "it passes a singular configuration, and decides nothing"]
    if run.grown:
        said.append("there the constraint error grows")
    if run.gained > MOST_GAINED and run.culprit == "multipliers":
        said.append("the feedback pumps the motion: take --goal accurate, or a shorter step")
    elif run.gained > MOST_GAINED:
        end = f", and breaks down after about {seconds_words(run.breakdown)}" if run.breakdown else ""
        said.append(f"the method speeds the motion up{end}: take heun or RK4, or gentler feedback")
    elif run.gained < -MOST_GAINED:
        said.append(
            "the method takes that, whatever the feedback" if run.culprit == "method" else "the feedback brakes"
        )
    if answer.impedance and answer.impedance < HARD:
        said.append(f"the run is of hard constraints: an impedance d of {answer.impedance:g} brakes besides")
    if run.sound and answer.moving and answer.moving.verdict != "converges":
        said.append("the prediction settles nothing, but the run went through")
    return said


def _energy_text(gained: float) -> str:
    """Return what became of the energy of a run, from the share that it gained."""
    if abs(gained) < KEPT:
        return "energy kept"
    return f"energy {100 * gained:+.2g} %" if gained < 1 else f"energy grown by {times_words(gained)} times its largest"


def _swept(answer: Answer, swept: SweptAnswer) -> list[str]:
    """Return what becomes of an error of many constraints in an engine that sweeps, and how many sweeps are enough.

    What else was asked, of a scene that moves, is said of constraints that are solved exactly.
    """
    z_abs, stable = swept.growth.factor, swept.stable_iterations
    change = _change(answer, z_abs, "converges" if z_abs < 1 else "diverges")
    enough = "no number of sweeps that was tried is stable"
    if stable is not None:
        enough = f"stable from {counted(stable, 'sweep')}"
    alone = f"{change}; of one constraint alone, each step multiplies it by {swept.alone:.2f}"
    said = [alone, enough, *_on_a_motion(answer)]
    if answer.moving:
        said.append(f"that is at rest. Solved exactly: {_in_motion(answer, answer.moving)}")
    return said


def _growth(answer: Answer) -> list[str]:
    """Return how far the step, α and β may grow: each alone, at rest; nothing if not asked."""
    margins = answer.margins
    if answer.margins_reason:
        return [f"how far the step, α and β may grow is not known: {answer.margins_reason}"]
    if margins is None:
        return []
    others = {"α": growth_words(_finite(margins.alpha[1])), "β": growth_words(_finite(margins.beta[1]))}
    of_engine = answer.question.engine is not None
    step = growth_words(_finite(margins.h))
    if answer.h is not None:
        step = _up_to(answer.engine_h_limit if of_engine else answer.h_limit, seconds_words)
    limits = {"the step": step, **others}
    each = "at rest each" if answer.moving else "each"
    if set(limits.values()) == {growth_words(None)}:
        return [f"{each} alone may grow without limit"]
    return [f"{each} alone may grow: {', '.join(f'{name} {limit}' for name, limit in limits.items())}"]


def _finite(number: float | None) -> float | None:
    return None if number is None or math.isinf(number) else number


def _up_to(limit: float | None, text: Callable[[float], str]) -> str:
    """Return up to where something may grow."""
    return growth_words(None) if limit is None or math.isinf(limit) else f"to {text(limit)}"


def answers(question: Question, *, margins: bool = True) -> Iterator[Answer]:
    """Yield the answers for each method: at the point that is given and at those an engine also takes, or the choice.

    Without `margins` none are found. InputError if nothing stable meets the goal, or an engine cannot express it;
    NumericalError as `describe_point` and `choose`.
    """
    for method in question.methods:
        if question.goal:
            found = _chosen(question, "chosen", method, question.goal, question.settle, margins=margins)
            try:
                _ = found.setting
            except InputError as error:
                asked = f"{question.engine.name}={question.engine.words()}" if question.engine else ""
                raise InputError(f"{error}: ask `check --engine {asked}` about values of yours") from None
            yield found
            continue
        for label, point in (("as given", question.given.point), *question.given.also):
            yield _answer(question, "given", describe_point(method, label, *point, question.spread, margins))


def engine_energy_rate(engine: Engine, point: Point | None, h: Fraction, omega: Fraction) -> float | None:
    """Return what a second adds to the energy of a motion (rate omega, 1/s) at a point, without one at the defaults.

    As `Answer.energy_rate`; None, too, where an engine has no such values, or no integrator of its own. InputError for
    a motion that turns too far in a step, or hardly.
    """
    try:
        values = tuple(map(rational, engine.values(point, h))) if point else engine_and_values(engine.name)[1]
        question = Question(engine=engine, values=values, h=h, omega=omega)
    except InputError:
        return None
    _ = question.motion  # is checked
    rate = next(answers(question, margins=False)).energy_rate
    return None if rate is None else rate[0]


def _answer(question: Question, role: Role, choice: Choice) -> Answer:
    return Answer(question=question, role=role, **vars(choice))


def _chosen(
    question: Question, role: Role, method: Method, goal: Goal, settle: Fraction | None = None, *, margins: bool = True
) -> Answer:
    """Return the choice of a goal; if an engine sweeps over constraints, at most the strongest that they allow."""
    found = _chosen_alone(question, role, method, goal, settle, margins=margins)
    swept = question.swept
    if swept is None or not (swept.engine.parameters and _curve(question, goal)):
        return found
    strongest = swept.strongest(question.spread)
    if strongest is None:
        words = f"no feedback is stable in {swept.constraints.words}"
        raise InputError(f"{swept.engine.name}: {words}")
    if found.beta_hat <= strongest[1] * (1 + READ_BACK):  # as is all of the curve but its end, which is not tried
        return found
    return _answer(question, role, describe_point(method, goal, *strongest, question.spread, margins))


def _chosen_alone(
    question: Question, role: Role, method: Method, goal: Goal, settle: Fraction | None, *, margins: bool
) -> Answer:
    """Return the choice of a goal for one constraint; if the question has a goal, for all steps up to h_max."""
    modulus: Modulus | None = None
    if question.turning and question.h:
        turned = question.turning.kappa * float(question.h_max or question.h)
        modulus = moving_modulus(method, turned) if turned <= LAW_HOLDS else None
    choice = choose(
        method,
        goal,
        h=question.h,
        h_max=question.h_max if goal in UP_TO_LONGEST else None,
        settle=settle,
        spread=question.spread,
        equal=question.equal,
        modulus=modulus,
        along=_curve(question, goal),
        omega_h=question.motion.omega_h_max,
        margins=margins,
    )
    return _answer(question, role, choice)


def _curve(question: Question, goal: Goal) -> Curve | None:
    """Return the curve of points that the engine can express; None if the goal does not search along it."""
    return question.engine.curve if question.engine and goal != "critical" and not question.equal else None


@dataclass(frozen=True)
class LargestStep:
    """The largest step with a method, and alpha and beta (1/s)."""

    method: Method
    alpha: Fraction
    beta: Fraction

    @cached_property
    def h_limit(self) -> float:
        """The step (s) up to which every step is stable: infinite if all are, zero if none is. As `stable_up_to`."""
        return stable_up_to(self.method, self.alpha, self.beta)

    @property
    def safe(self) -> bool:
        """Whether small steps are stable at all."""
        return self.h_limit > 0
