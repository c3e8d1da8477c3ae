"""What poles, check and choose share when they say what accuracy a feedback costs: --omega, and what it is told by."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

import click

from bezstab.cli.options import POSITIVE
from bezstab.cli.output import say, show_text
from bezstab.cli.typed_points import typed_number
from bezstab.errors import InputError, NumericalError
from bezstab.rationals import exact
from bezstab.show import MISSING, Column, Row, column, formatted, times_words
from bezstab.units import from_dimensionless

if TYPE_CHECKING:
    from bezstab.mechanism import ConstraintMotion
    from bezstab.methods import Method
    from bezstab.stability import Choice, FeedbackCost, Goal

omega_option = click.option(
    "--omega",
    type=POSITIVE,
    help="How fast the motion is, in 1/s, for the errors that the feedback forces on it; needs --h [the scene's, else "
    "ωh = 0.01].",
)

COSTLY = 10.0
"""Times the least error: from here on `check` says in a sentence what the feedback costs."""

GAIN = 0.95
"""Of an error: what is not below is called no gain."""

SLOWER = 2
"""Times as long to settle, of what slower decay would gain."""


@dataclass(frozen=True)
class TypedMotion:
    """The motion on which errors are told: omega_h rad in a step, as `words` say; of a scene, its amplitude (m or rad).

    `omega_h_max` is the same at the longest step, where steps may be longer than h.
    """

    omega_h: Fraction
    omega_h_max: Fraction
    words: str
    amplitude: float | None = None


def typed_omega_h(
    omega: Fraction | None,
    scene: str | None,
    speed: Fraction,
    h: Fraction | None,
    h_max: Fraction | None = None,
    duration: Fraction | None = None,
) -> TypedMotion:
    """Return the motion that --omega says (1/s), else that of --scene, else one that is usual; h and h_max in s.

    A motion that does not begin anew is followed for a `duration` (s), by default the scene's own.
    UsageError for --omega without a step; InputError for a scene at rest, and unless 1e-6 <= omega_h < 1.
    """
    from bezstab.stability import OMEGA_H

    longer = h_max / h if h and h_max else Fraction(1)
    if omega is None and scene is None:
        at_longest = "" if longer == 1 else " at --h-max"
        whose = "--omega says" if h else "--omega and --h say"
        words = f"one with ωh = {float(OMEGA_H):g}{at_longest} ({whose} how fast yours is)"
        return _within_range(TypedMotion(OMEGA_H / longer, OMEGA_H, words), "--h and --h-max")
    if h is None:
        given = "--scene" if omega is None else "--omega"
        raise click.UsageError(f"{given} needs --h: the step in s, to make ωh of it")
    amplitude = None
    if omega is None:
        assert scene
        of_scene = _motion_of(scene, speed, duration)
        omega, amplitude = exact(of_scene.omega), of_scene.amplitude
        given, whose = f"--scene {scene} moves with ω = {float(omega):.3g} 1/s", f"that of {scene}"
    else:
        given, whose = f"--omega {typed_number(omega)}", "one"
    omega_h = omega * h
    words = f"{whose} with ω = {float(omega):.3g} 1/s, ωh = {float(omega_h):.3g}"
    return _within_range(TypedMotion(omega_h, omega_h * longer, words, amplitude), given)


def _motion_of(scene: str, speed: Fraction, duration: Fraction | None) -> "ConstraintMotion":
    """Return rate and amplitude of a scene's motion; InputError for one at rest, else as `load_scene` and `motion`."""
    from bezstab.mechanism import at_speed, compiled_mechanism, constraint_motion, load_scene

    moving = at_speed(load_scene(scene), float(speed))
    try:
        return constraint_motion(compiled_mechanism(moving), float(duration or moving.duration))
    except InputError as error:
        raise InputError(f"--scene {scene}: {error}; --omega gives one") from None


def _within_range(motion: TypedMotion, given: str) -> TypedMotion:
    """Return the motion; InputError, naming what was given, for one too slow or too fast for its steps."""
    from bezstab.stability import check_omega_h

    try:
        check_omega_h(motion.omega_h)
        check_omega_h(motion.omega_h_max)
    except InputError as error:
        raise InputError(f"{given}: {error}") from None
    return motion


def known_cost(
    methods: "Sequence[Method]", points: Sequence[tuple[Fraction, Fraction]], motion: TypedMotion
) -> "list[FeedbackCost | None]":
    """Return what accuracy the feedback costs at each method's point; None where that is not known, which is said."""
    from bezstab.stability import feedback_cost

    costs: list[FeedbackCost | None] = []
    reasons: list[str] = []
    for method, point in zip(methods, points, strict=True):
        try:
            costs.append(feedback_cost(method, *point, motion.omega_h))
        except (InputError, NumericalError) as error:  # the verdict stands without it
            costs.append(None)
            reasons.append(f"bezstab: what accuracy the feedback costs is not known: {error}")
    for reason in dict.fromkeys(reasons):
        say(reason)
    return costs


def with_cost(rows: Sequence[Row], costs: "Sequence[FeedbackCost | None]", motion: TypedMotion) -> list[Row]:
    """Return rows with what accuracy each one's feedback costs, in the same order."""
    from bezstab.show import cost_row

    return [{**row, **cost_row(cost, float(motion.omega_h))} for row, cost in zip(rows, costs, strict=True)]


def _times_least(row: Row) -> str:
    times = row["times_least"]
    return times_words(times) if isinstance(times, float) else MISSING


def _both_times_least(row: Row) -> str:
    velocity = row["times_least_velocity"]
    return f"{_times_least(row)}; velocity: {times_words(velocity)}" if isinstance(velocity, float) else MISSING


def _both_errors(row: Row) -> str:
    error, velocity = row["total_error"], row["velocity_error"]
    return MISSING if error is None else f"{formatted(error, '.1e')}; velocity: {formatted(velocity, '.1e')}"


def accuracy_columns(motion: TypedMotion) -> list[Column]:
    """Return the columns that show what with_cost adds: all but the steady share, which is seldom another."""
    return [
        Column(f"error at ωh = {float(motion.omega_h):.3g}", _both_errors),
        column("order left", "order_left", "d"),
        Column("times the least error", _both_times_least),
    ]


NARROW_ACCURACY = [column("error", "total_error", ".1e"), Column("× least", _times_least)]
"""The same of the constraint beside the columns of poles, within 80 characters."""


def say_motion(motion: TypedMotion) -> None:
    """Print below a table what its errors are shares of, and what is called the least."""
    shares = f"Errors are shares of the amplitude of a motion, here {motion.words}."
    show_text(f"\n{shares} The least are those of --goal accurate.")


def say_cost(sentence: str | None) -> None:
    """Print below a table what accuracy a feedback costs, if there is something to say."""
    if sentence:
        show_text(f"\n{sentence}")


def say_trade(lines: Sequence[str], name: str = "") -> None:
    """Print below a table what faster decay would cost and slower decay gain, of several methods with the name."""
    if lines:
        show_text("\n" + "\n".join(f"{name}: {line}" if name else line for line in lines))


def cost_sentence(
    name: str, cost: "FeedbackCost | None", motion: TypedMotion, h: Fraction | None, *, in_own_words: bool = False
) -> str | None:
    """Return that a method's feedback costs accuracy, and how much; None where it costs little, or that is not known.

    With a step (s) the better point is given in 1/s; `in_own_words`, where an engine has words of its own, it is not.
    """
    if cost is None or cost.least_at is None:
        return None
    least = "the least" if in_own_words else f"that at {_point_words(cost.least_at, h)}"
    if _is_costly(cost.times_least):
        return f"This feedback costs accuracy: {_constraint_words(name, cost, motion, least)}"
    if _is_costly(cost.times_least_velocity):
        assert cost.times_least_velocity
        return (
            f"This feedback costs accuracy: with {name} the error it forces on velocities is "
            f"{times_words(cost.times_least_velocity)} times {least}. It is {cost.velocity_error:.1e} of their "
            "amplitude."
        )
    return None


def _is_costly(times: float | None) -> bool:
    return times is not None and times >= COSTLY


def _constraint_words(name: str, cost: "FeedbackCost", motion: TypedMotion, least: str) -> str:
    """Return which order is left and how large the constraint's error is, `least` being what it is compared with."""
    assert cost.times_least is not None
    assert cost.total_error is not None
    keeps = f"order {cost.order_left} of {cost.order}" if cost.order_left < cost.order else f"its order {cost.order}"
    in_units = "" if motion.amplitude is None else f", {cost.total_error * motion.amplitude:.1e} m or rad"
    return (
        f"{name} keeps {keeps}; the error it forces is {times_words(cost.times_least)} times {least}. "
        f"It is {cost.total_error:.1e} of the motion's amplitude{in_units}."
    )


def _point_words(point: tuple[float, float], h: Fraction | None) -> str:
    """Return a point in 1/s, or without a step (s) as it is."""
    if h is None:
        return "α̂ = {:.3g}, β̂ = {:.3g}".format(*point)
    return "α = {:.3g} 1/s, β = {:.3g} 1/s".format(*from_dimensionless(*point, float(h)))


Chosen = Callable[..., "Choice"]
"""What chooses for the same method, step and engine: another goal, or another time to settle (s)."""


def trade_lines(
    choice: "Choice", cost: "FeedbackCost | None", motion: TypedMotion, h: Fraction, chosen: Chosen
) -> list[str]:
    """Return what faster decay than this choice's would cost, and what slower decay would gain, where that is known."""
    if cost is None or cost.total_error is None:
        return []
    return [line for line in (_faster(choice, cost, motion, chosen), _slower(choice, cost, motion, h, chosen)) if line]


def _faster(choice: "Choice", cost: "FeedbackCost", motion: TypedMotion, chosen: Chosen) -> str | None:
    """Return what the first of two goals would cost that is faster; None where that is not known."""
    goals: tuple[Goal, ...] = ("robust", "fastest")
    for goal in goals:
        found = _alternative(chosen, goal)
        if found is None or abs(found.pole) >= abs(choice.pole):
            continue
        times = _times_the_errors(found, cost, motion)
        if times is None:
            return None
        before, after = abs(choice.pole), abs(found.pole)
        return (
            f"Faster decay: --goal {goal} takes |z_p| from {before:.4f} to {after:.4f} a step, and the feedback "
            f"forces {_errors_words(times)}."
        )
    return "Faster decay: there is none."


def _slower(choice: "Choice", cost: "FeedbackCost", motion: TypedMotion, h: Fraction, chosen: Chosen) -> str | None:
    """Return what the goal accurate would gain that may take SLOWER times as long as this choice at worst."""
    steps = choice.settle_steps_at_worst
    if steps is None:
        return None
    settle = Fraction(f"{float(SLOWER * steps * h * choice.method.step_multiple):.2g}")
    found = _alternative(chosen, "accurate", settle)
    times = None if found is None else _times_the_errors(found, cost, motion)
    if times is None:
        return None
    gain = "Slower decay:" if min(times) < GAIN else "Slower decay gains nothing:"
    goal = "" if choice.goal == "accurate" else "--goal accurate "
    return f"{gain} with {goal}--settle {typed_number(settle)} the feedback forces {_errors_words(times)}."


def _alternative(chosen: Chosen, goal: "Goal", settle: Fraction | None = None) -> "Choice | None":
    """Return another choice; None where there is none, or it cannot be found: what was asked for stands without it."""
    try:
        return chosen(goal, settle=settle)
    except (InputError, NumericalError):
        return None


def _times_the_errors(found: "Choice", cost: "FeedbackCost", motion: TypedMotion) -> tuple[float, float] | None:
    """Return the errors of constraint and velocity at another choice over those at this one; None if not known."""
    from bezstab.stability import feedback_cost

    other = feedback_cost(found.method, exact(found.alpha_hat), exact(found.beta_hat), motion.omega_h)
    if not (cost.total_error and cost.velocity_error) or other.total_error is None or other.velocity_error is None:
        return None
    return other.total_error / cost.total_error, other.velocity_error / cost.velocity_error


def _errors_words(times: tuple[float, float]) -> str:
    """Return how many times as large the errors of constraint and velocity are."""
    of_constraint, of_velocity = times
    return f"{times_words(of_constraint)} times the error, {times_words(of_velocity)} times that of velocities"
