"""Drives whose controller is slower than the physics, as check, choose and region ask about them and answer."""

from functools import partial
from typing import Any

import click

from bezstab import questions, show
from bezstab.cli.options import OF_A_CONTROLLER, refuse_beside, typed_options
from bezstab.cli.output import Files, show_rows, show_text

ABOUT_DRIVES = {
    *("--pd", "--h", "--every", "--late", "--filter", "--method", "--format"),
    *("--bandwidth", "--settle", "--quality", "--grid", "--output", "--figure"),
}
"""Options that go with a question about a held or late drive, of those that its commands have."""


def held_asked(typed: dict[str, Any], asked: str, *, always: bool = False) -> "questions.HeldQuestion | None":
    """Take the timing options out of `typed`. Return the question about such a drive.

    None if no option about a controller was typed, unless `always`: every step then computes its torque and applies it.
    Without --method it is about all four ways of applying a drive. Errors as `HeldQuestion`; UsageError, which says
    what is `asked`, if an option was typed that is not about drives.
    """
    timing = {name: typed.pop(name) for name in ("every", "late", "filter_seconds")}
    if not always and typed_options().keys().isdisjoint(OF_A_CONTROLLER.options):
        return None
    if typed["h"] is None:
        raise click.UsageError("--pd needs --h: the step in s")
    methods = typed_options().get("--method", ())
    question = questions.HeldQuestion(drive=typed["drive"], h=typed["h"], methods=methods, **timing)
    refuse_beside(asked, typed_options().keys() - ABOUT_DRIVES, "this answer is about the drive alone")
    return question


def write_held(question: "questions.HeldQuestion", points: int, files: Files) -> None:
    """Print the answers, and write for each way of applying the drive |z_p| over kd and kp, at points x points."""
    files.check_output()
    for answer in show_held(question):
        files.write(files.path("region", answer.method.name, "held"), partial(show.held_figure, answer, points))


def show_held(question: "questions.HeldQuestion") -> "list[questions.HeldAnswer]":
    """Print and return the answer for each way of applying a held or late drive; print what is not judged."""
    found = list(questions.held_answers(question))
    heading = show.timing_words(question.timing, float(question.h))
    show_rows(show.HELD, map(show.HELD.row, found), heading=heading)
    show_text(f"\n{show.LATE_COMMANDS}")
    return found
