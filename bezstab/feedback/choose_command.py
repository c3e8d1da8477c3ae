"""The command that recommends α and β: choose."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from bezstab.cli import shared_options as shared
from bezstab.cli.asking import say_each, say_what_is_left_out, show_sentences
from bezstab.cli.grouped_help import GroupedCommand, grouped
from bezstab.cli.options import ENGINE, POSITIVE, REAL, SECONDS
from bezstab.cli.output import for_reading, progress, show_answers, worked_out
from bezstab.goals import GOALS, SETTLING, UP_TO_LONGEST, Goal, one_of

if TYPE_CHECKING:
    from bezstab.methods.schemes import Method


GOALS_IN_LINES = "\b\nGoals:\n" + "\n".join(f"  {goal:<9} {asked}" for goal, asked in GOALS.items())
"""Each goal with what it asks for, below the help."""


@click.command(cls=GroupedCommand, epilog=GOALS_IN_LINES)
@grouped(
    "What is chosen",
    click.option(
        "--goal",
        type=click.Choice(list(GOALS)),
        metavar="GOAL",
        help="One of those below [accurate; robust in most engines].",
    ),
    click.option("--settle", type=SECONDS, help=f"{one_of(SETTLING)}: time to a thousandth."),
    click.option("--spread", type=REAL, default="0.1", help="Share by which α and β may be wrong."),
    click.option("--keep", "equal", type=click.Choice(["alpha=beta"]), help="Only points with α = β."),
    click.option("--engine", type=ENGINE, help="Only settings that this engine has."),
    click.option("--sag", type=POSITIVE, help="Instead of --goal: the weakest that sags by so many m."),
)
@grouped(
    "Your simulation",
    shared.methods,
    click.option("--h", type=SECONDS, help="Step in s; RK4 and others need none with --omega."),
    click.option("--h-max", type=SECONDS, help=f"{one_of(UP_TO_LONGEST)}: the longest step [--h]."),
    shared.omega,
    shared.scene,
    shared.speed,
    shared.time,
    shared.load,
)
@grouped("Output", shared.every_column, shared.form)
def choose(
    methods: tuple[Method, ...],
    goal: Goal | None,
    equal: str | None,
    every_column: bool,
    form: str,
    **simulation: Any,
) -> bool:
    """Recommend α and β for an integrator and its step size.

    The answer is proven stable. With --scene it must also be safe as that mechanism moves: exit status 1 if it is not.

    Most Runge-Kutta methods need --omega or --scene with the goal accurate: their best α and β are multiples of that
    rate. Others assume ωh = 0.01 without it. bezstab/feedback/README.md explains the goals and the numbers.

    Example: bezstab choose --method SYM --h 0.001 --omega 10
    """

    from bezstab.feedback import columns, sentences
    from bezstab.feedback.checking import step_answer
    from bezstab.feedback.choosing import asked_to_choose, choose_answer
    from bezstab.feedback.conditions import Setup
    from bezstab.rationals import exact

    whole = simulation["h"] is not None
    setup = Setup(equal=bool(equal), margins=whole, cost=whole, **simulation)
    methods, asked = worked_out(lambda: asked_to_choose(methods, setup, goal), simulation["scene"])
    if asked.h is None:
        raise click.MissingParameter(param_hint="'--h'", param_type="option")
    say_each(asked.warnings)
    answers = (choose_answer(method, asked, trades=whole and for_reading()) for method in methods)
    chosen = list(progress(answers, asked.goal, len(methods)))
    if not whole:
        at_any_step = [step_answer(each.method, exact(each.alpha or 0), exact(each.beta or 0)) for each in chosen]
        show_answers(columns.STEPS, at_any_step)
        return all(chosen)
    show_answers(columns.CHOSEN, chosen)
    if for_reading() and not asked.swept:
        for answer in chosen:
            name = f"{answer.method.name}: " if len(chosen) > 1 else ""
            show_sentences(["\n".join(f"{name}{line}" for line in columns.trade_words(answer))])
    if every_column:
        show_sentences([sentences.motion_words(asked.motion)])
    say_each(answer.cost_reason for answer in chosen)
    if setup.engine and for_reading():
        say_what_is_left_out(setup.engine, many=asked.swept is not None)
    return all(chosen)
