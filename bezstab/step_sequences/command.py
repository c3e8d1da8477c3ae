"""The command that judges steps that vary: steps."""

from fractions import Fraction

import click

from bezstab.cli import shared_options as shared
from bezstab.cli.asking import say_what_is_left_out
from bezstab.cli.grouped_help import GroupedCommand, grouped
from bezstab.cli.options import ENGINE_VALUES, NUMBER, SECONDS, EngineValues
from bezstab.cli.output import for_reading, show_answers, show_command, show_text
from bezstab.methods.schemes import Method


@click.command(cls=GroupedCommand)
@grouped(
    "The feedback [that of `choose`]",
    click.option("--alpha", type=NUMBER, help="Damping α in 1/s; with --hold α̂."),
    click.option("--beta", type=NUMBER, help="Stiffness β in 1/s; with --hold β̂."),
    click.option("--engine", type=ENGINE_VALUES, help="An engine with its values, such as bullet=0.2."),
    click.option("--hold", is_flag=True, help="α̂ and β̂ are constant, as engines with an ERP do."),
)
@grouped(
    "Your simulation",
    shared.methods,
    click.option("--h-min", type=SECONDS, required=True, help="The shortest step in s."),
    click.option("--h-max", type=SECONDS, required=True, help="The longest step in s."),
)
@grouped("Output", shared.every_column, shared.form)
def steps(
    methods: tuple[Method, ...],
    alpha: Fraction | None,
    beta: Fraction | None,
    engine: EngineValues | None,
    h_min: Fraction,
    h_max: Fraction,
    hold: bool,
    **_: object,
) -> bool:
    """Judge steps that vary: 0 if every sequence of them is safe, else 1.

    Steps that are each stable alone may still let errors grow in turn. The answer is "proven" for every sequence of
    steps in the range; "refuted", with a sequence that grows and the line of `simulate` that shows it; or "not known".

    Without --alpha and --beta it finds feedback that is proven for these steps: `choose` with --goal robust, then
    fastest, at --h-max.

    Example: bezstab steps --method SYM --h-min 0.009 --h-max 1/60
    """
    from bezstab.step_sequences.answer import answers
    from bezstab.step_sequences.columns import COLUMNS
    from bezstab.step_sequences.varying_steps import Steps

    named, values = engine or (None, None)
    found = answers(methods, Steps(h_min, h_max, hold), alpha, beta, engine=named, values=values)
    show_answers(COLUMNS, found)
    for answer in found if for_reading() else ():
        if answer.shown_by:
            show_text("\nThis shows errors grow:\n")
            show_command(answer.shown_by)
    if named and for_reading():
        say_what_is_left_out(named)
    return all(found)
