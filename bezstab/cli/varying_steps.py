"""What check and choose share when they are asked about steps that vary: --h-min, --h-max and --hold."""

import math
import shlex
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

import click

from bezstab.cli.options import SECONDS
from bezstab.cli.output import for_reading, show_command, show_text
from bezstab.cli.typed_points import typed_number
from bezstab.errors import InputError
from bezstab.methods import check_one_step, lookup
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

AT_REST = "--scene driven_slider_crank --speed 1e-9"
"""A mechanism without degrees of freedom, all but at rest: what changes in it is the error alone, at any step."""

PERTURBED = 1e-6  # m, the error at first: small enough to grow visibly before it is no longer small
GROWN = 1e4  # times that
MOST_STEPS = 10**5  # of a run: some seconds


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


@dataclass(frozen=True)
class VaryingAnswer:
    """What sequences of steps do that vary, for a method at a point; `shown_by` is the line that shows errors grow.

    `shown_by` is None unless it was refuted, and where no run shows it: of a user's own method, which has no name to
    type, and where errors grow too slowly.
    """

    method: "Method"
    varying: "VaryingSteps"
    shown_by: str | None


def varying_answers(
    steps: StepRange | None,
    methods: "Sequence[Method]",
    points: Sequence[tuple[Fraction, Fraction]],
    scene: str | None,
    speed: Fraction,
) -> list[VaryingAnswer]:
    """Return what sequences of steps of the range do, for each method at its point; none without a range.

    `scene` and `speed` are those of the mechanism that was asked about, None for one at rest.
    """
    if steps is None:
        return []
    from bezstab.stability import varying_steps

    answers = []
    for method, point in zip(methods, points, strict=True):
        varying = varying_steps(method, *point, h=steps.h, h_min=steps.h_min, h_max=steps.h_max, hold=steps.hold)
        answers.append(VaryingAnswer(method, varying, _growing_run(method, point, steps, varying, scene, speed)))
    return answers


def _growing_run(
    method: "Method",
    point: tuple[Fraction, Fraction],
    steps: StepRange,
    varying: "VaryingSteps",
    scene: str | None,
    speed: Fraction,
) -> str | None:
    """Return the line with which simulate shows an error of PERTURBED grow about GROWN times; None where none does."""
    if varying.sequence is None or varying.growth is None or not varying.growth > 1:
        return None
    from bezstab.show import repeated

    try:
        can_be_typed = lookup(method.name) == method  # not so a user's own, from a file
    except InputError:
        return None
    if not can_be_typed:
        return None
    rounds = max(1, math.floor(math.log(GROWN) / math.log(varying.growth)))
    if rounds * len(varying.sequence) > MOST_STEPS:
        return None
    mechanism = AT_REST if scene is None else f"--scene {shlex.quote(scene)}"
    if scene and speed != 1:
        mechanism += f" --speed {typed_number(speed)}"
    alpha_hat, beta_hat = point
    taken = ",".join(
        typed_number(step) if count == 1 else f"{count}*{typed_number(step)}"
        for step, count in repeated(varying.sequence)
    )
    time = sum(varying.sequence) * method.step_multiple * rounds
    return (
        f"bezstab simulate {mechanism} --method {shlex.quote(method.name)} --alpha {typed_number(alpha_hat)} "
        f"--beta {typed_number(beta_hat)} --h {typed_number(steps.h)} --steps {taken}{' --hold' if steps.hold else ''} "
        f"--perturb {PERTURBED:g} --time {float(time):.6g}"
    )


def with_varying(rows: Sequence[Row], answers: Sequence[VaryingAnswer]) -> list[Row]:
    """Return rows with what is known of steps that vary, safe only where proven; as they are without answers."""
    from bezstab.show import varying_row

    if not answers:
        return list(rows)
    return [
        {
            **row,
            **varying_row(answer.varying),
            "shown_by": answer.shown_by,
            "safe": row["safe"] and answer.varying.varying == "proven",
        }
        for row, answer in zip(rows, answers, strict=True)
    ]


def varying_columns(steps: StepRange | None) -> list[Column]:
    """Return the column that with_varying adds; none without a range."""
    return [] if steps is None else [column("varying steps", "varying")]


def say_varying(answers: Sequence[VaryingAnswer], form: Format) -> None:
    """Print a sentence on each answer below the table, and the line that shows it, where people read."""
    from bezstab.show import varying_words

    if not for_reading(form):
        return
    for answer in answers:
        show_text("\n" + varying_words(answer.method.name, answer.varying))
        if answer.shown_by:
            show_text("\nThis shows errors grow:\n")
            show_command(answer.shown_by)
