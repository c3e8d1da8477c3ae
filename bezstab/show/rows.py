"""Results as rows: what a command prints in JSON and CSV, and what the columns of its table show."""

from __future__ import annotations

from fractions import Fraction
from types import SimpleNamespace
from typing import TYPE_CHECKING

from bezstab.engines.engine_list import WITNESSES
from bezstab.errors import InputError
from bezstab.show.fields import Field, Row, Value, cells
from bezstab.show.row_kinds import (
    APPLIED,
    CHECKED,
    CHOICES,
    ENGINE_H_LIMIT,
    ENGINES_LISTED,
    EXCLUDES,
    LARGEST_STEPS,
    MOVING,
    POLE,
    POLES,
    SCENE_RUN,
    SETTING,
    SWEEPS,
    SWEPT_OVER,
)

OF_A_MOTION = ("total_error", "velocity_error", "times_least", "times_least_velocity")
OF_ONE_ALONE = (
    *("worst", "settle_steps", "settle_seconds", "h_limit"),
    *("alpha_factor_min", "alpha_factor_max", "beta_factor_min", "beta_factor_max"),
)
"""Columns that tables omit for constraints that an engine sweeps over: they are about one constraint alone."""

if TYPE_CHECKING:  # so that a small row does not load what makes the large ones
    from collections.abc import Iterable

    from bezstab.engines.conversions import Engine
    from bezstab.questions.answering import Answer, LargestStep
    from bezstab.questions.question import Question


def pole_cells(z: complex) -> dict[str, Value]:
    """Return the cells that show a pole: its real and imaginary part, its modulus, its angle in degrees."""
    return cells(POLE, SimpleNamespace(pole=complex(z)))


def engine_row(
    engine: Engine, point: tuple[Fraction, Fraction] | None, h: Fraction, omega: Fraction | None = None
) -> Row:
    """Return an engine's words, and its setting for (alpha_hat, beta_hat) at a step h (s), or why it has none.

    With a rate omega (1/s) also what that, or else its defaults, do to the energy of a motion.
    """
    from bezstab.questions.answering import engine_energy_rate

    setting = None
    if point:
        try:
            setting = engine.setting(point, h)
        except InputError as error:
            setting = str(error)
    units = tuple(engine.units.values())
    rate = None if omega is None else engine_energy_rate(engine, point, h, omega)
    known = {"units": units, "witness": WITNESSES.get(engine.name), "setting": setting, "energy_rate": rate}
    return ENGINES_LISTED.row(engine, **known)


def answer_row(answer: Answer) -> Row:
    """Return all that an answer has as a row; keys of an engine, a scene, a range of steps where asked for."""
    kind = CHOICES if answer.role == "chosen" else CHECKED
    return {**kind.row(answer), **_added_cells(answer, ENGINE_H_LIMIT, SETTING)}


def pole_rows(answer: Answer, poles: Iterable[complex]) -> list[Row]:
    """Return a row for each pole of a method at the point of an answer (dimensionless), angles in degrees.

    Keys of an engine, a scene where asked for.
    """
    added = _added_cells(answer)
    return [{**POLES.row(answer, **pole_cells(z)), **added} for z in poles]


def left_out(question: Question) -> tuple[str, ...]:
    """Return the keys that tables of a question leave out."""
    assumed = not question.goal and question.motion.assumed
    not_asked = OF_A_MOTION if assumed else ()
    return (*not_asked, *(OF_ONE_ALONE if question.swept else ()))


def _added_cells(answer: Answer, *of_engine: Field) -> dict[str, Value]:
    """Return what an engine and a scene add to a row of an answer's point.

    Of an engine it is what it does to its values and what is left out, which is null where the values were not given;
    over what it sweeps; and the fields `of_engine`.
    """
    added: dict[str, Value] = {}
    if answer.question.engine:
        if answer.role != "chosen":
            given = answer.role == "given" and answer.goal == "as given"
            added |= cells((APPLIED, EXCLUDES), answer if given else None)
        swept_over = SWEPT_OVER if answer.swept else SWEPT_OVER[:1]
        added |= cells((SWEEPS, *swept_over, *of_engine), answer)
    for fields, found in ((MOVING, answer.moving), (SCENE_RUN, answer.run)):
        if found:
            added |= cells(fields, found)
    return added


def largest_step_row(found: LargestStep) -> Row:
    """Return up to which step (s) alpha and beta (1/s) are stable: None where small steps are not."""
    return LARGEST_STEPS.row(found, role="given", h_limit=found.h_limit if found.safe else None)
