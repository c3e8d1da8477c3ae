"""The command that measures what accuracy costs: tradeoff."""

from collections.abc import Sequence
from fractions import Fraction
from typing import Any

import click

from bezstab.cli.asking import say_if_units_were_mistaken
from bezstab.cli.options import POSITIVE, SECONDS, Rule, TypedPoint, changed, command, flag, option, typed_options
from bezstab.cli.output import Files, Work, progress, show_rows, show_text, worked_out

OF_RUNS = (
    *("--alpha", "--beta", "--physical", "--stabilise", "--iterations", "--time", "--tolerance", "--repeats"),
    *("--against", "--compiled", "--workers", "--scheduler", "--resume"),
)
"""Options that say what is simulated."""


@command(
    changed("scene", default="slider_crank_light"),
    "speed",
    changed("methods", default=("B2", "B3", "B4", "AB2", "AB4", "ABM4", "RK4", "SIE", "SYM")),
    option("--h steps", SECONDS, "Step size in s. Repeatable [ten from 0.0001 to 0.02].", multiple=True),
    changed("duration", default="2"),
    *("point", "omega", "holding"),
    flag(
        "--predicted",
        "Simulate nothing; print the least error that each method's feedback makes, for each speed of decay.",
    ),
    option(
        "--level levels",
        POSITIVE,
        "With --predicted: decay with |z_p| of at most LEVEL, below 1. Repeatable [fifteen from 0.1 to 0.999].",
        multiple=True,
    ),
    option("--tolerance", POSITIVE, "The error that is good enough, in m and rad.", default="1e-6"),
    option("--repeats", click.IntRange(1, 100), "How often each run is timed.", default=3),
    option(
        "--against",
        click.Choice(["evaluations", "time", "projection"]),
        "What errors are compared with: evaluations of f, or processor time on this machine. With projection each run "
        "is made with feedback and with projection, and errors are compared with factorizations.",
        default="evaluations",
    ),
    "shared_out",
    Rule(("--level",), "it says how fast errors must decay", needs=("--predicted",)),
    Rule(("--against projection",), "it has runs with and without feedback", excludes=("--stabilise",)),
    Rule(("--predicted",), "it simulates nothing", excludes=OF_RUNS),
    Rule(("--predicted",), "it is a table", excludes=("--figure",)),
)
def tradeoff(predicted: bool, point: TypedPoint, work: Work, files: Files, **typed: Any) -> None:
    """Measure what accuracy costs, by method and step.

    Each run is compared with a reference of known accuracy. Prints errors, evaluations, processor time (median and
    range), the order observed, and which run is the cheapest within --tolerance. Writes the table, without times, and
    two figures of errors against evaluations or time, which mark it. A run that fails is marked as diverged.

    Without --alpha and --beta each step size has its own point: that of the goal accurate, for the scene's motion or
    for --omega. If α̂ and β̂ stay the same while h shrinks, methods with stages lose order. In the second half of a
    run the error of the start is gone. Only the feedback's error remains, and the work that its multipliers do on it,
    which changes the trajectory; compare "predicted".

    --stabilise projection replaces feedback by projection onto the constraints after each step. --against projection
    makes both, feedback at the advised points and, with --alpha and --beta, at that one too. It draws the errors of
    trajectory, constraints and energy at equal cost, in factorizations of C_q M⁻¹ C_qᵀ.

    --predicted simulates nothing. It prints the least error that a method's feedback makes on a motion, for each
    |z_p|, and what that feedback does to the motion's energy. The motion is --omega, or a --scene with one --h; else it
    turns by ωh = 0.01. Writes tradeoff_predicted.csv.

    Example: bezstab tradeoff --method B4 --method AB4 --h 0.002 --h 0.004 --time 2
    """

    from bezstab.runs.accuracy_costs import measured_runs
    from bezstab.runs.figures import trade_figures
    from bezstab.runs.shared_work import results_of_chunks
    from bezstab.runs.tables import untimed_arrays
    from bezstab.runs.trades import TradeQuestion
    from bezstab.show.row_kinds import SWEPT

    levels = typed.pop("levels")
    if predicted:
        _show_fronts(files, levels, **{name: typed[name] for name in ("methods", "omega", "speed", "steps")})
        return
    question = TradeQuestion(numbers=point.numbers, physical=point.physical, **typed)
    say_if_units_were_mistaken(question.methods, point, None)
    path = files.path("tradeoff", typed["scene"])
    sweeps = worked_out(lambda: question.sweeps, typed["scene"])
    with results_of_chunks(measured_runs, sweeps, path, f"{question.methods} {question}", work) as results:
        swept = question.swept(results)
        marked = zip(swept.runs, swept.front_labels, strict=True)
        rows = [SWEPT.row(run, front=front, cheapest=run is swept.cheapest) for run, front in marked]
        files.write(path, None, lambda: untimed_arrays(rows))
        for name, draw in trade_figures(swept, question.moving.name).items():
            files.write(path.with_name(f"{path.name}_{name}"), draw)
    show_rows(SWEPT, rows)
    show_text(f"\n{question.basis}")


def _show_fronts(files: Files, levels: Sequence[Fraction], **typed: Any) -> None:
    """Print the least error that each method forces, by speed of decay; write it as a table."""

    from bezstab.runs.tables import untimed_arrays
    from bezstab.runs.trades import FrontQuestion
    from bezstab.show.result_sentences import combined_words, energy_words
    from bezstab.show.row_kinds import FRONTS
    from bezstab.show.rows import row_in_seconds

    question = FrontQuestion(levels=levels, scene=typed_options().get("--scene"), **typed)
    files.check_output()
    fronts = progress(question.fronts(), "fronts", len(question.methods))
    h = None if question.h is None else float(question.h)
    rows = [row_in_seconds(FRONTS.fields, point, h) for front in fronts for point in front]
    files.write(files.path("tradeoff", "predicted"), None, lambda: untimed_arrays(rows))
    show_rows(FRONTS, rows)
    show_text(combined_words(question.motion) + energy_words(question.motion))
