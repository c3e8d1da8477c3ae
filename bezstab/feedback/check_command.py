"""The command that tells whether a choice is safe: check."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import click

from bezstab.cli import shared_options as shared
from bezstab.cli.asking import say_each, say_if_units_were_mistaken, show_sentences
from bezstab.cli.grouped_help import GroupedCommand, grouped
from bezstab.cli.options import SECONDS, EngineValues, TypedPoint
from bezstab.cli.output import for_reading, show_answers, show_text, worked_out

if TYPE_CHECKING:
    from bezstab.methods.schemes import Method


@click.command(cls=GroupedCommand)
@grouped("What is judged", shared.alpha, shared.beta, shared.physical, shared.engine_values, shared.as_typed)
@grouped(
    "Your simulation",
    shared.methods,
    click.option("--h", type=SECONDS, help="Step in s; --engine, --scene and --omega need it."),
    shared.omega,
    shared.scene,
    shared.speed,
    shared.time,
    shared.load,
)
@grouped(
    "Output",
    click.option("--instead", is_flag=True, help="Also print what `choose` gives, not only if unsafe."),
    shared.every_column,
    shared.form,
)
def check(
    methods: tuple[Method, ...],
    alpha: Fraction | None,
    beta: Fraction | None,
    physical: bool,
    engine: EngineValues | None,
    as_typed: bool,
    instead: bool,
    every_column: bool,
    form: str,
    **simulation: Any,
) -> bool:
    """Tell whether α and β are safe: exit status 0 if so, 1 if not.

    Safe means: bezstab proves that errors shrink, with every method named. With --scene it also runs the mechanism: its
    constraints must hold, and its energy may grow by a tenth of the largest kinetic energy.

    Given α and β in 1/s (--physical) without --h, it finds the largest safe step.

    bezstab/feedback/README.md explains the answers. For steps that vary see `bezstab steps`, for a joint's drive
    `bezstab drive`, for chains of bodies in a game engine `bezstab chain`.

    Example: bezstab check --method RK2 --h 0.01 --alpha 9 --beta 9 --physical
    """

    from bezstab.feedback import beside, columns, sentences
    from bezstab.feedback.checking import checks, step_answer
    from bezstab.feedback.conditions import Setup, conditions
    from bezstab.questions.methods import methods_for

    typed, (named, values) = TypedPoint(alpha, beta, physical), engine or (None, None)
    setup = Setup(engine=named, values=values, as_typed=as_typed, **simulation)
    if physical and typed.numbers and setup.h is None and not (engine or setup.scene or setup.omega):
        found = [step_answer(method, *typed.numbers) for method in methods_for(methods, None)]
        show_answers(columns.STEPS, found)
        return all(found)
    setup = replace(setup, point=typed.at(setup.h))
    asked = worked_out(lambda: conditions(setup), simulation["scene"])
    say_each(asked.warnings)
    answers = checks(methods, asked, instead=instead or None)
    say_if_units_were_mistaken(methods, typed, setup.h)
    better = [each.instead for each in answers if each.instead is not None]
    if for_reading():
        beside.show_point(answers)
        show_answers(columns.CHECKED, answers)
        if len(answers) > 1:  # a single one has said so
            said = ((each, sentences.energy_sentence(each)) for each in answers)
            show_sentences(f"{each.method.name}, {each.goal}: {sentence}" for each, sentence in said if sentence)
        show_sentences(map(sentences.costs_words, answers))
        if better:
            show_text("\nWhat `choose` gives instead:\n")
            show_answers(columns.CHECKED, better)
        if every_column and not asked.motion.assumed:
            show_sentences([sentences.motion_words(asked.motion)])
    else:
        show_answers(columns.CHECKED, [*answers, *better])
    say_each(each.instead_reason and f"nothing instead: {each.instead_reason}" for each in answers)
    say_each(each.cost_reason for each in answers)
    if for_reading():
        beside.say_what_the_engine_did(asked)
    return all(answers)
