"""The command that runs a mechanism: simulate."""

from typing import Any

import click

from bezstab.cli.asking import asked, show_point
from bezstab.cli.options import NUMBER, SEQUENCE, changed, command, flag, option
from bezstab.cli.output import Files, say, show_rows, worked_out
from bezstab.compiling import compiled_choice
from bezstab.errors import NumericalError
from bezstab.methods.schemes import implicit


@command(
    changed("scene", default="slider_crank"),
    "speed",
    changed("method", default="B4"),
    changed("alpha", default="0.5"),
    changed("beta", default="0.1"),
    *("physical", "holding"),
    changed("h", default="0.001"),
    option(
        "--steps sequence",
        SEQUENCE,
        "Step sizes in s, taken in turn, over and over: such as 1/60,0.00917 or 3*0.01,0.02, or a file with such a "
        "list. α̂ and β̂ are then those at the step --h.",
    ),
    flag("--hold", "With --steps: α̂ and β̂ stay the same while steps vary; else α and β do."),
    changed("duration", default="10"),
    option("--perturb", NUMBER, "Initial error of the first constraint, in its own unit.", default="0"),
    option(
        "--start",
        click.Choice(["rk4", "ramp", "euler", "steady"]),
        "How a multistep method gets its first values: by RK4, by members of its family with fewer steps, or by "
        "explicit Euler. An implicit method: by Gauss's method of order four, by BDF methods with fewer steps, or by "
        "implicit Euler. steady: with the velocity that the method has in the long run, half a step back for "
        "symplectic Euler.",
        default="rk4",
    ),
    "compiled",
    "files",
    "form",
)
def simulate(files: Files, **typed: Any) -> None:
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

    from bezstab.runs.figures import history_figure
    from bezstab.runs.sentences import passages_words
    from bezstab.runs.simulating import RunQuestion, run_answer
    from bezstab.runs.tables import history_arrays
    from bezstab.show.row_kinds import SIMULATIONS

    if typed["stabilise"] != "baumgarte":
        typed["point"] = None
    question = asked(RunQuestion, **typed)
    files.check_output()
    worked_out(lambda: question.mechanism, typed["scene"])
    run = worked_out(lambda: run_answer(question), question.method.name)
    files.write(
        files.path("simulate", typed["scene"], question.method.name),
        lambda: history_figure(run),
        lambda: history_arrays(run),
    )
    show_point(typed, question.point)
    show_rows(SIMULATIONS, [SIMULATIONS.row(run)])
    if compiled_choice() == "yes" and (implicit(run.method) or run.after.projecting):
        say("bezstab: this run was not compiled: only runs of explicit methods without projection are")
    if len(run.singular_times):
        say(f"bezstab: {passages_words(run.singular_times.tolist())}")
    if run.failure:
        raise NumericalError(run.failure)
