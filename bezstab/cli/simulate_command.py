"""The command that runs a mechanism: simulate."""

from fractions import Fraction
from pathlib import Path
from typing import Any

import click

from bezstab.cli.asking import TypedPoint, asked, point_options
from bezstab.cli.options import (
    METHOD,
    NUMBER,
    SECONDS,
    SEQUENCE,
    Rule,
    compiled_option,
    format_option,
    refuse_feedback,
    ruled,
    scene_option,
    speed_option,
    stabilise_options,
    step_option,
)
from bezstab.cli.output import Files, figure_options, say, show_rows
from bezstab.errors import InputError, NumericalError
from bezstab.methods import Method
from bezstab.show import SIMULATIONS, Format, passages_words


@click.command()
@scene_option("slider_crank")
@speed_option
@click.option(
    "--method",
    type=METHOD,
    default="B4",
    help="A method's name, as `bezstab methods` lists it, or a .toml file; NAME@m takes steps of m h.",
)
@point_options("α̂; α in 1/s with --physical.", "β̂; β in 1/s with --physical.", "0.5", "0.1")
@stabilise_options
@step_option
@click.option(
    "--steps",
    "sequence",
    type=SEQUENCE,
    help="Step sizes in s, taken in turn, over and over: such as 1/60,0.00917 or 3*0.01,0.02, or a file with such a "
    "list. α̂ and β̂ are then those at the step --h.",
)
@click.option("--hold", is_flag=True, help="With --steps: α̂ and β̂ stay the same while steps vary; else α and β do.")
@click.option("--time", "duration", type=SECONDS, default="10", help="Duration in s.")
@click.option("--perturb", type=NUMBER, default="0", help="Initial error of the first constraint, in its own unit.")
@click.option(
    "--start",
    type=click.Choice(["rk4", "ramp", "euler"]),
    default="rk4",
    help="How a multistep method gets its first values: by RK4, by members of its family with fewer steps, or by "
    "explicit Euler. An implicit method: by Gauss's method of order four, by BDF methods with fewer steps, or by "
    "implicit Euler.",
)
@compiled_option
@figure_options
@format_option
@ruled(Rule("--hold", "it is about steps that vary", needs=("--steps",)))
def simulate(point: TypedPoint, files: Files, form: Format, **typed: Any) -> None:
    """Run a mechanism and see what its constraint error does.

    Prints the largest |c| and |ċ|, the energy drift and the number of evaluations, and draws the first constraint
    and its rate. --table csv also writes the whole history. Exit status 3 if the run broke down; what came before
    is kept.

    --steps gives a sequence of step lengths, for any one-step method. Work and energy drift are then integrated by
    the trapezoidal rule, which is less exact.

    --stabilise projection replaces the feedback. After each step it moves the positions, then the velocities, back onto
    the constraints, by the least change in the metric of the masses. "factorizations" counts how often S = C_q M⁻¹ C_qᵀ
    is factored: once for each evaluation, and once or more for each projection.

    Example: bezstab simulate --method AB4 --alpha 0.5 --beta 0.101 --time 2
    """
    from bezstab import show
    from bezstab.questions import RunQuestion, run_answer

    refuse_feedback(typed["stabilise"])
    if typed["stabilise"] == "baumgarte":
        typed["point"] = point
    question = asked(RunQuestion, **typed)
    _check_number_of_steps(typed["duration"], min(question.sequence or [typed["h"]]), question.method)
    files.check_output()
    run = run_answer(question)
    files.write(
        files.path("simulate", Path(typed["scene"]).stem, question.method.name),
        lambda: show.history_figure(run),
        lambda: show.history_arrays(run),
    )
    show_rows(SIMULATIONS, [SIMULATIONS.row(run)], form)
    if len(run.singular_times):
        say(f"bezstab: {passages_words(run.singular_times.tolist())}")
    if run.failure:
        raise NumericalError(run.failure)


def _check_number_of_steps(time: Fraction, h: Fraction, method: Method) -> None:
    """Raise InputError unless the time (s) is a number of steps that a run can take."""
    from bezstab.mechanism import MOST_STEPS

    steps = time / (h * method.step_multiple)
    if not 1 <= steps <= MOST_STEPS:
        taken = f"{float(steps):g} steps of {method.name}"
        raise InputError(f"--time {float(time):g}: {taken}, expected 1 to {MOST_STEPS:g}")
