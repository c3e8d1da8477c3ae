"""Drives whose controller is slower than the physics, as check, choose and region ask about them and answer."""

from typing import TYPE_CHECKING, Any

import click

from bezstab.cli.options import OF_A_CONTROLLER, refuse_beside, typed_options
from bezstab.cli.output import show_rows, show_text
from bezstab.show import HELD, LATE_COMMANDS, timing_words

if TYPE_CHECKING:
    from bezstab.questions import HeldAnswer, HeldQuestion

ABOUT_DRIVES = {"--pd", "--h", "--every", "--late", "--filter", "--method", "--format"}
"""Options that go with a question about a held or late drive."""


def held_asked(typed: dict[str, Any], asked: str, *allowed: str, always: bool = False) -> "HeldQuestion | None":
    """Take the timing options out of `typed`. Return the question about such a drive.

    None if no option about a controller was typed, unless `always`: every step then computes its torque and applies it.
    Without --method it is about all four ways of applying a drive. Errors as `HeldQuestion`; UsageError, which says
    what is `asked`, if an option was typed that is neither about drives nor `allowed`.
    """
    from bezstab.questions import HeldQuestion

    timing = {name: typed.pop(name) for name in ("every", "late", "filter_seconds")}
    if not always and typed_options().keys().isdisjoint(OF_A_CONTROLLER.options):
        return None
    if typed["h"] is None:
        raise click.UsageError("--pd needs --h: the step in s")
    methods = typed_options().get("--method", ())
    question = HeldQuestion(drive=typed["drive"], h=typed["h"], methods=methods, **timing)
    refuse_beside(asked, typed_options().keys() - {*ABOUT_DRIVES, *allowed}, "this answer is about the drive alone")
    return question


def show_held(question: "HeldQuestion") -> "list[HeldAnswer]":
    """Print and return the answer for each way of applying a held or late drive; print what is not judged."""
    from bezstab.questions import held_answers

    found = list(held_answers(question))
    heading = timing_words(question.timing, float(question.h))
    show_rows(HELD, map(HELD.row, found), heading=heading)
    show_text(f"\n{LATE_COMMANDS}")
    return found
