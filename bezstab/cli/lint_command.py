"""The command that judges a MuJoCo model: lint."""

from pathlib import Path

import click

from bezstab.cli.options import format_option
from bezstab.cli.output import for_reading, progress, show_rows, show_text
from bezstab.show import LINTED, Format


@click.command()
@click.argument("model", type=click.Path(path_type=Path))
@format_option
@click.pass_context
def lint(context: click.Context, model: Path, form: Format) -> None:
    """Judge a MuJoCo model: exit status 1 if anything is unsafe.

    MODEL is MuJoCo's XML; MuJoCo also opens what it includes, its meshes, textures and height fields, and nothing is
    simulated. A row for each equality, limit, friction loss, pair of contact parameters, spring, damper and drive: its
    point, the method that MuJoCo's integrator is there, and the line to write where it is unsafe, relies on refsafe or
    is needlessly soft; "not judged", and why, where no one point stands for an element. Of the points that solimp makes
    of one setting the one with the largest |z| is judged; "judged" says which, and why. "stable for h times" is up to
    which multiple of the time step it stays stable at the same physical parameters. The last row is of all equalities,
    springs and drives together, and decides: they may be unsafe where each alone is not, or safe where one alone,
    without its closed loop, is not. Needs mujoco 3.7 or later, since when connect and weld have the term of turning
    normals.

    Example: bezstab lint robot.xml
    """
    from bezstab.evidence import linted_model, read_mujoco_model
    from bezstab.show import linted_row

    model_data = read_mujoco_model(model)
    linted = list(progress(linted_model(model_data), "lint", model_data.size))
    heading = f"{model.name}: timestep {model_data.h:g} s, integrator {model_data.integrator}"
    if linted or not for_reading(form):
        rows = [linted_row(each) for each in linted]
        show_rows(rows, LINTED.columns(rows), form, heading)
    else:
        show_text(
            f"{heading}\n\nNothing to judge: no equality, limit, friction loss, contact, spring, damper or drive."
        )
    context.exit(1 if any(each.unsafe for each in linted) else 0)
