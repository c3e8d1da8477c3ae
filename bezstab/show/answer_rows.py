"""Answers to a question as rows, and in words: is it safe, how far may it go, what does it cost."""

from __future__ import annotations

from typing import TYPE_CHECKING

from bezstab.engines import DRIVE_METHODS
from bezstab.rationals import typed_number
from bezstab.show.fields import Row, Value, cells
from bezstab.show.row_kinds import (
    APPLIED,
    CHECKED,
    CHOICES,
    DRIVE,
    ENGINE_H_LIMIT,
    EXCLUDES,
    LARGEST_STEPS,
    MOVING,
    POLES,
    SETTING,
    SWEEPS,
    SWEPT_OVER,
    VARYING,
)
from bezstab.show.rows import pole_cells
from bezstab.show.words import counted, times_words
from bezstab.units import from_dimensionless

if TYPE_CHECKING:
    from collections.abc import Iterable
    from fractions import Fraction

    from bezstab.questions import Answer, LargestStep, Question, ReferenceMotion
    from bezstab.stability import FeedbackCost

COSTLY = 10.0
"""Times the least error: from here on a sentence says what the feedback costs."""

GAIN = 0.95
"""Of an error: what is not below is called no gain."""

WITHOUT_ACCURACY = ("total_error", "order_left", "times_least_velocity")
"""Columns that tables of a drive omit: nothing feeds the acceleration of its target forward."""

OF_ONE_ALONE = (
    *("worst", "settle_steps", "settle_seconds", "h_limit"),
    *("alpha_factor_min", "alpha_factor_max", "beta_factor_min", "beta_factor_max"),
)
"""Columns that tables omit for constraints that an engine sweeps over: they are about one constraint alone."""


def answer_row(answer: Answer) -> Row:
    """Return all that an answer has as a row; keys of an engine, a drive, a scene, a range of steps where asked for."""
    kind = CHOICES if answer.role == "chosen" else CHECKED
    return {**kind.row(answer), **_engine_cells(answer), **_added_cells(answer)}


def pole_rows(answer: Answer, poles: Iterable[complex]) -> list[Row]:
    """Return a row for each pole of a method at the point of an answer (dimensionless), angles in degrees.

    Keys of an engine, a drive, a scene where asked for.
    """
    added = {**_applied_cells(answer), **_added_cells(answer)}
    return [{**POLES.row(answer, **pole_cells(z)), **added} for z in poles]


def left_out(question: Question) -> tuple[str, ...]:
    """Return the keys that tables of a question leave out."""
    return (*(WITHOUT_ACCURACY if question.drive else ()), *(OF_ONE_ALONE if question.swept else ()))


def _added_cells(answer: Answer) -> dict[str, Value]:
    """Return what a drive, a scene and a range of steps add to a row of an answer's point."""
    added: dict[str, Value] = {}
    if answer.gains:
        added |= cells(DRIVE, answer, {"drive": DRIVE_METHODS.get(answer.method.name)})
    if answer.moving:
        added |= cells(MOVING, answer.moving)
    if answer.varying:
        from bezstab.questions import growing_run

        added |= cells(VARYING, answer.varying, {"shown_by": growing_run(answer)})
    return added


def _engine_cells(answer: Answer) -> dict[str, Value]:
    """Return what an engine makes of its values, or the line to paste for a point that it was not given."""
    if not answer.question.engine:
        return {}
    of_engine = _applied_cells(answer) if answer.role != "chosen" else _swept_cells(answer)
    return {**of_engine, **cells((ENGINE_H_LIMIT, SETTING), answer)}


def _swept_cells(answer: Answer) -> dict[str, Value]:
    """Return whether an engine sweeps, over what, and what its sweeps make of many constraints where they are asked."""
    return cells((SWEEPS, *SWEPT_OVER) if answer.swept else (SWEEPS, SWEPT_OVER[0]), answer)


def alone_words(answer: Answer) -> str | None:
    """Return what a choice would be for one constraint alone, and how many sweeps it takes; None where it is this."""
    alone = answer.alone
    if alone is None:
        return None
    needed = alone.sweeps_to_spare
    takes = "no number of sweeps that was tried" if needed is None else counted(needed, "sweep")
    return f"One constraint alone would get {alone.setting}: with the spread to spare that takes {takes}."


def _applied_cells(answer: Answer) -> dict[str, Value]:
    """Return what an engine does to its values, and what is left out; None for values that were not given."""
    if not answer.question.engine:
        return {}
    notes = answer.question.given.notes
    applied = "as typed" if notes is None else "; ".join(notes)
    untyped = answer.role != "given" or answer.goal != "as given"
    found = dict.fromkeys(("applied", "excludes")) if untyped else {"applied": applied}
    return {**cells((APPLIED, EXCLUDES), answer, found), **_swept_cells(answer)}


def largest_step_row(found: LargestStep) -> Row:
    """Return up to which step (s) alpha and beta (1/s) are stable: None where small steps are not."""
    return LARGEST_STEPS.row(found, role="given", h_limit=found.h_limit if found.safe else None)


def costs_words(answer: Answer) -> str | None:
    """Return that the feedback of an answer costs accuracy, and how much; None where that is little, or not known.

    The better point is given in 1/s where there is a step, and not at all where an engine has words of its own.
    """
    cost = answer.cost
    if cost is None or cost.least_at is None:
        return None
    name, h = answer.method.name, answer.question.h
    least = "the least" if answer.question.engine else f"that at {_point_words(cost.least_at, h)}"
    if _is_costly(cost.times_least):
        return f"This feedback costs accuracy: {_constraint_words(name, cost, answer.question.motion, least)}"
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


def _constraint_words(name: str, cost: FeedbackCost, motion: ReferenceMotion, least: str) -> str:
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


def trade_words(answer: Answer) -> list[str]:
    """Return what faster decay than a choice's costs, and what slower decay gains, where that is known."""
    if answer.cost is None or answer.cost.total_error is None:
        return []
    return [line for line in (_faster_words(answer), _slower_words(answer)) if line]


def _faster_words(answer: Answer) -> str | None:
    faster = answer.faster
    if faster is None:
        return "Faster decay: there is none."
    times = answer.times_the_errors(faster)
    if times is None:
        return None
    return (
        f"Faster decay: --goal {faster.goal} takes |z_p| from {abs(answer.pole):.4f} to {abs(faster.pole):.4f} a step, "
        f"and the feedback forces {_errors_words(times)}."
    )


def _slower_words(answer: Answer) -> str | None:
    slower, settle = answer.slower, answer.slower_settle
    times = None if slower is None else answer.times_the_errors(slower)
    if times is None or settle is None:
        return None
    gain = "Slower decay:" if min(times) < GAIN else "Slower decay gains nothing:"
    goal = "" if answer.goal == "accurate" else "--goal accurate "
    return f"{gain} with {goal}--settle {typed_number(settle)} the feedback forces {_errors_words(times)}."


def _errors_words(times: tuple[float, float]) -> str:
    """Return how many times as large the errors of constraint and velocity are."""
    of_constraint, of_velocity = times
    return f"{times_words(of_constraint)} times the error, {times_words(of_velocity)} times that of velocities"


def motion_words(motion: ReferenceMotion) -> str:
    """Return what errors are shares of, and what is called the least."""
    shares = f"Errors are shares of the amplitude of a motion, here {motion.words}."
    return f"{shares} The least are those of --goal accurate."


def combined_words(motion: ReferenceMotion) -> str:
    """Return what combined errors are shares of."""
    return (
        "\nErrors of position and velocity are shares of the amplitudes of a motion's own position and velocity, here "
        f"{motion.words}."
    )
