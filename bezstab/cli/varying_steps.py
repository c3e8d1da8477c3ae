"""What check and choose share when they are asked about steps that vary: --h-min, --h-max and --hold."""

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

import click

from bezstab.cli.options import SECONDS
from bezstab.cli.output import for_reading, show_text
from bezstab.errors import InputError
from bezstab.methods import check_one_step
from bezstab.show import Column, Format, Row, column

if TYPE_CHECKING:
    from bezstab.methods import Method
    from bezstab.stability import VaryingSteps

h_min_option = click.option(
    "--h-min", type=SECONDS, help="The shortest step in s of a range: is every sequence of steps up to --h-max safe?"
)
hold_option = click.option(
    "--hold", is_flag=True, help="With --h-min: α̂ and β̂ stay as steps vary, as in engines with ERP; not α and β."
)


@dataclass(frozen=True)
class StepRange:
    """A range of steps (s), and whether alpha_hat and beta_hat, given for steps of h (s), are held in it."""

    h: Fraction
    h_min: Fraction
    h_max: Fraction
    hold: bool


def step_range(
    methods: "Sequence[Method]", h: Fraction | None, h_min: Fraction | None, h_max: Fraction | None, hold: bool
) -> StepRange | None:
    """Return the range that --h-min begins, up to --h-max, by default --h; None without --h-min.

    UsageError for --hold without it; InputError unless the range is one, and each method takes one step at a time.
    """
    if h_min is None:
        if hold:
            raise click.UsageError("--hold goes with --h-min: it is about steps that vary")
        return None
    highest = h_max or h
    if highest is None:
        raise click.UsageError("--h-min needs --h-max or --h: the longest step in s")
    if highest < h_min:
        raise InputError(f"--h-min {float(h_min):g}: expected at most the longest step, {float(highest):g} s")
    for method in methods:
        check_one_step(method)
    return StepRange(h or highest, h_min, highest, hold)


def varying_results(
    steps: StepRange | None, methods: "Sequence[Method]", points: Sequence[tuple[Fraction, Fraction]]
) -> "list[VaryingSteps]":
    """Return what sequences of steps of the range do, for each method at its point; none without a range."""
    if steps is None:
        return []
    from bezstab.stability import varying_steps

    return [
        varying_steps(method, *point, h=steps.h, h_min=steps.h_min, h_max=steps.h_max, hold=steps.hold)
        for method, point in zip(methods, points, strict=True)
    ]


def with_varying(rows: Sequence[Row], results: "Sequence[VaryingSteps]") -> list[Row]:
    """Return rows with what is known of steps that vary, safe only where proven; as they are without results."""
    from bezstab.show import varying_row

    if not results:
        return list(rows)
    return [
        {**row, **varying_row(varying), "safe": row["safe"] and varying.varying == "proven"}
        for row, varying in zip(rows, results, strict=True)
    ]


def varying_columns(steps: StepRange | None) -> list[Column]:
    """Return the column that with_varying adds; none without a range."""
    return [] if steps is None else [column("varying steps", "varying")]


def say_varying(methods: "Sequence[Method]", results: "Sequence[VaryingSteps]", form: Format) -> None:
    """Print a sentence on each result below the table, where people read it."""
    from bezstab.show import varying_words

    if results and for_reading(form):
        show_text("\n" + "\n".join(varying_words(m.name, varying) for m, varying in zip(methods, results, strict=True)))
