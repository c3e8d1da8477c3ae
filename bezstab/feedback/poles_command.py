"""The command that prints poles at a point: poles."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING, Any

import click

from bezstab.cli import shared_options as shared
from bezstab.cli.asking import say_each, say_if_units_were_mistaken
from bezstab.cli.grouped_help import GroupedCommand, grouped
from bezstab.cli.options import METHOD, SECONDS, EngineValues, TypedPoint
from bezstab.cli.output import for_reading, show_answers, worked_out

if TYPE_CHECKING:
    from bezstab.methods.schemes import Method

USUAL_METHODS = ("SYM", "B2", "B3", "B4", "AB2", "AB3", "AB4", "RK4@5", "SIE")
"""Without --method: what most engines have, the Bezier methods, and their alternatives in the paper."""


@click.command(cls=GroupedCommand)
@grouped("What is judged", shared.alpha, shared.beta, shared.physical, shared.engine_values, shared.as_typed)
@grouped(
    "Your simulation",
    click.option("--method", "methods", type=METHOD, multiple=True, help=f"{shared.METHOD_HELP} Repeatable [nine]."),
    click.option("--h", type=SECONDS, help="Step in s, for --physical, --engine and --scene."),
    shared.scene,
    shared.speed,
)
@grouped(
    "Output",
    click.option("--all-poles", is_flag=True, help="Print every pole, not only the dominant one."),
    shared.every_column,
    shared.form,
)
def poles(
    methods: tuple[Method, ...],
    alpha: Fraction | None,
    beta: Fraction | None,
    physical: bool,
    engine: EngineValues | None,
    as_typed: bool,
    all_poles: bool,
    every_column: bool,
    form: str,
    **simulation: Any,
) -> None:
    """Print each method's dominant pole at one point, and the verdict.

    converges: every |z| < 1, so errors shrink. marginal: errors stay bounded but do not shrink. diverges: errors
    grow. The verdict is proven in exact arithmetic on the numbers as typed (Schur-Cohn test).

    Example: bezstab poles --alpha 0.5 --beta 0.1
    """

    from bezstab.feedback.beside import say_what_the_engine_did, show_point
    from bezstab.feedback.checking import poles_at
    from bezstab.feedback.columns import POLES
    from bezstab.feedback.conditions import Setup, conditions
    from bezstab.methods.registry import lookup
    from bezstab.stability.forced_errors import OMEGA_H

    typed, (named, values) = TypedPoint(alpha, beta, physical), engine or (None, None)
    h = simulation["h"]
    if h and not (physical or engine or simulation["scene"]):
        raise click.UsageError("--h needs one of --physical, --engine, --scene: α̂ and β̂ have no unit")
    setup = Setup(
        engine=named,
        point=typed.at(h),
        values=values,
        as_typed=as_typed,
        omega_h=OMEGA_H,  # no errors on a motion are told
        margins=False,
        cost=False,
        **simulation,
    )
    if not methods and named is None:
        methods = tuple(map(lookup, USUAL_METHODS))
    asked = worked_out(lambda: conditions(setup), simulation["scene"])
    say_each(asked.warnings)
    found = poles_at(methods, asked, every=all_poles)
    say_if_units_were_mistaken(methods, typed, h)
    show_point(found)
    show_answers(POLES, found)
    if for_reading():
        say_what_the_engine_did(asked)
