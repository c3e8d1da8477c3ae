"""The command that holds predicted poles against measured ones: verify."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from bezstab.cli.asking import asked, of_each, show_point
from bezstab.cli.options import Rule, changed, command, flag, option
from bezstab.cli.output import Files, Work, for_reading, progress, show_rows, show_text, worked_out
from bezstab.methods.schemes import Method

if TYPE_CHECKING:
    from bezstab.runs.verifying import VerifyQuestion
    from bezstab.show.fields import Row

WHICH_POINTS = ("--alpha", "--points", "--map")
"""Options each of which says what is verified."""


@command(
    changed("scene", default="slider_crank"),
    "speed",
    changed("methods", default=["B4"]),
    "point",
    option(
        "--points",
        click.IntRange(1, 1000),
        "Verify so many points, spread over the region and around it, instead of one at --alpha and --beta [20].",
    ),
    option("--map across", click.IntRange(2, 10000), "Simulate N×N points, and draw their verdicts."),
    flag("--floquet", "Also predict exactly, for a motion that repeats itself, by linearising its steps."),
    changed("h", default="0.001"),
    "shared_out",
    Rule(WHICH_POINTS, "each says which points are verified", excludes=WHICH_POINTS),
)
def verify(across: int | None, work: Work, files: Files, **typed: Any) -> int:
    """Compare predicted poles with poles measured in a simulation.

    Two runs start with opposite kicks. The dominant pole is fitted to their difference. If no pole can be measured, the
    row says why. For a mechanism that moves there are several predictions: that of the map, for a mechanism at rest;
    bounds for the motion; and with --floquet the exact one.

    --map runs a simulation at each of N×N points and draws the verdicts under the exact boundary. --workers or
    --scheduler share the work. --resume continues a run that was stopped.

    Example: bezstab verify --method AB4 --points 20
    """

    from bezstab.runs.verifying import VerifyQuestion
    from bezstab.show.row_kinds import VERDICT_MAPS

    question = asked(VerifyQuestion, **typed)
    worked_out(lambda: question.mechanism, typed["scene"])
    if across:
        rows, status = of_each(question.methods, lambda method: [_write_map(question, method, across, work, files)])
        show_rows(VERDICT_MAPS, rows)
        return status
    _show_measurements(question, typed)
    return 0


def _show_measurements(question: VerifyQuestion, typed: dict[str, Any]) -> None:
    """Print the poles measured at one point, else at random ones, and where there are several how well they agree."""

    from bezstab.runs.measured_poles import measurement_summary
    from bezstab.runs.sentences import exact_rate_words
    from bezstab.show.row_kinds import MEASUREMENTS, SUMMARIES

    scene, floquet = question.mechanism.scene.name, question.floquet
    measured = [question.measurements(method) for method in progress(question.methods, "verify")]
    rows = [MEASUREMENTS.row(each, scene=scene) for of_method in measured for each in of_method]
    show_point(typed, question.point)
    show_rows(MEASUREMENTS, rows, () if floquet else ("right",))
    if not for_reading():
        return
    for of_method in measured if floquet else ():
        show_text(exact_rate_words(of_method[0]))
    if len(rows) > len(measured):  # of one point each there is nothing to sum up
        click.echo()
        summaries = map(measurement_summary, measured)
        show_rows(SUMMARIES, map(SUMMARIES.row, summaries), () if floquet else ("followed",))


def _write_map(question: VerifyQuestion, method: Method, across: int, work: Work, files: Files) -> Row:
    """Simulate across x across runs of a method, write their verdicts as table and figure, return how many agree."""

    from bezstab.runs.figures import verdict_figure
    from bezstab.runs.shared_work import results_of_chunks
    from bezstab.runs.tables import verdict_arrays
    from bezstab.runs.verdict_maps import map_rows, simulated_verdicts, verdict_map
    from bezstab.show.row_kinds import VERDICT_MAPS
    from bezstab.stability.regions import region

    scene, h = question.mechanism.scene, float(question.h)
    path = files.path("verify", str(question.scene), method.name)
    chunks = map_rows(scene, method, h, across)
    job = f"verify --map {across} --h {h} {method} {scene}"
    with results_of_chunks(simulated_verdicts, chunks, path, job, work) as results:
        verdicts = verdict_map(chunks, results)
        files.write(path, lambda: verdict_figure(verdicts, region(method)), lambda: verdict_arrays(verdicts))
    return VERDICT_MAPS.row(verdicts)
