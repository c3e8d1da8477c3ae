"""Results as rows: what a command prints in JSON and CSV, and what the columns of its table show."""

from __future__ import annotations

from fractions import Fraction
from itertools import chain, compress
from types import SimpleNamespace
from typing import TYPE_CHECKING

from bezstab.engines.engine_list import WITNESSES
from bezstab.errors import InputError
from bezstab.methods.aliases import OTHER_NAMES
from bezstab.methods.schemes import Method, evaluations, implicit, steps
from bezstab.show.cells import LIMITS
from bezstab.show.fields import Field, Row, Value, cells
from bezstab.show.result_sentences import best_point_words, falling_words
from bezstab.show.row_kinds import (
    ACCURACY,
    APPLIED,
    CHECKED,
    CHOICES,
    ENGINE_H_LIMIT,
    ENGINES_LISTED,
    EXCLUDES,
    LARGEST_STEPS,
    LISTED_METHODS,
    MOVING,
    POLE,
    POLES,
    REGIONS,
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
    from bezstab.questions.regions import MapAnswer, RegionAnswer


def pole_cells(z: complex) -> dict[str, Value]:
    """Return the cells that show a pole: its real and imaginary part, its modulus, its angle in degrees."""
    return cells(POLE, SimpleNamespace(pole=complex(z)))


def method_row(method: Method) -> Row:
    """Return steps, evaluations per step, order of accuracy, error constant (as number, and exact as text) and source.

    The exact one is None where rationals stand for irrational coefficients; `digits` says to how many digits they do,
    None where they do not. `order_position_forces` and `order_velocity_forces` are the orders where forces
    depend on the position alone, and on the velocity alone; `implicit` is whether a step solves equations.
    """
    from bezstab.methods.orders import accuracy, accuracy_by_force  # loads sympy

    order, constant = accuracy(method)
    by_force = accuracy_by_force(method)
    found = {
        "method": method.name,
        "steps": steps(method),
        "evaluations": evaluations(method),
        "order": order,
        "error_constant": constant,
        "error_constant_exact": constant if method.digits is None else None,
        "implicit": implicit(method),
        "order_position_forces": by_force.position[0],
        "order_velocity_forces": by_force.velocity[0],
        "other_names": OTHER_NAMES.get(method.name, "").replace(" ", ", ") or None,
    }
    return cells(LISTED_METHODS.fields[:-1], method, found)  # those of a group are beside it in the list


def whole_row(answer: RegionAnswer, *, latex: bool) -> Row:
    """Return all that is known of one method: method_row, its formulas (as text or LaTeX), and region_row.

    They are the recursion, s->z mapping, characteristic polynomial (paper Tables 1 and 2), steady errors, stage torque.
    NumericalError as `region_row`.
    """
    from bezstab.methods.formulas import (
        characteristic_text,
        mapping_text,
        multiplier_law_text,
        recursion_text,
        stage_torque_text,
        steady_error_text,
    )
    from bezstab.stability.feedback_costs import order_left

    method = answer.region.method
    return {
        **method_row(method),
        "recursion": recursion_text(method, latex),
        "mapping": mapping_text(method, latex),
        "characteristic_polynomial": characteristic_text(method, latex),
        "steady_error": steady_error_text(method, "x", latex),
        "steady_velocity_error": steady_error_text(method, "v", latex),
        "stage_torque": stage_torque_text(method, latex),
        "multiplier_law": multiplier_law_text(method, latex),
        "order_left": order_left(method),
        **region_row(answer),
    }


def region_row(answer: RegionAnswer) -> Row:
    """Return area, axis limits, best point of the method and which steps are stable; all dimensionless.

    Area and limits are of |z_p| < level, None where that region is empty, or has none; `approached` names those that
    no edge attains, only comes near far out. NumericalError where a pole leaves the range of float64.
    """
    region, inside = answer.region, answer.inside
    reason = None if inside else _nowhere(answer)
    where = best_point_words(inside) if inside else reason
    approached = ", ".join(compress(LIMITS, chain(*region.approached))) or None
    islands = ", ".join(f"({alpha_hat:.4g}, {beta_hat:.4g})" for alpha_hat, beta_hat in region.islands) or None
    error = None if region.area is None else region.area_error
    return REGIONS.row(
        answer, area_error=error, approached=approached, islands=islands, best_where=where, best_reason=reason
    )


def map_rows(answer: MapAnswer) -> list[Row]:
    """Return a row for the stable region, or for it at each speed of the scene, and one for each level below 1."""
    stable, *faster = rows = [region_row(each) for each in answer.regions]
    if answer.question.motion:
        forced = cells(ACCURACY, answer)
        return [{**row, **forced} for row in rows]
    turnings = answer.question.turnings.values()
    at_speeds: list[Row] = [
        {**stable, "speed": speed, "kappa": turning.kappa, "area_moving": answer.moving.area(turned)}
        for (speed, turned), turning in zip(answer.question.turned.items(), turnings, strict=True)
    ]
    return [*(at_speeds or [stable]), *faster]


def _nowhere(answer: RegionAnswer) -> str | None:
    """Return why a region has no best point: not known, |z_p| is not so small, or falls on."""
    if answer.trouble:
        return f"not known: {answer.trouble}"
    if answer.best:
        return f"none: |z_p| is {answer.best.z_abs:.6g} at least"
    if answer.falls_towards is not None:
        return f"none: {falling_words(answer.falls_towards)}"
    return None


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
