"""Drives whose controller is slower than the physics: the options of check, choose and region, what is printed."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import TYPE_CHECKING

import click

from bezstab.cli.options import NUMBER, ParsedType, gathered, left_at_default, refuse_beside, typed_options
from bezstab.cli.output import Files, for_reading, show_rows, show_text
from bezstab.engines import Drive
from bezstab.errors import InputError
from bezstab.methods import Method, lookup
from bezstab.rationals import rational, typed_number
from bezstab.show import HELD, LATE_COMMANDS, NOT_JUDGED, Format, held_row, timing_words

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from bezstab.questions import HeldAnswer, HeldQuestion


@dataclass(frozen=True)
class HeldTiming:
    """When a drive's torque is computed and applied, as typed; None where an option was not given."""

    every: int | None
    late: Fraction | None
    filter_seconds: Fraction | None

    def question(
        self, drive: Drive | None, h: Fraction | None, methods: Sequence[Method], *, always: bool = False
    ) -> "HeldQuestion | None":
        """Return the question about such a drive at a step of h (s), None where no option says a timing.

        With `always` each step then computes its torque and applies it. Without typed methods it is about all four ways
        of applying a drive. InputError without a drive or a step.
        """
        from bezstab.questions import HeldQuestion
        from bezstab.stability import Timing

        if not always and self.every is None and self.late is None and self.filter_seconds is None:
            return None
        if drive is None or h is None:
            raise InputError("--every, --late and --filter are about a drive: they need --pd and --h")
        if self.filter_seconds is not None and self.filter_seconds < 0:
            raise InputError(f"--filter {float(self.filter_seconds):g}: expected 0 s or more")
        every, filter_steps = 1 if self.every is None else self.every, (self.filter_seconds or Fraction(0)) / h
        timing = Timing(every=every, late=self.late or Fraction(0), filter_steps=filter_steps)
        if left_at_default("methods"):
            return HeldQuestion(drive=drive, h=h, timing=timing)
        return HeldQuestion(drive=drive, h=h, timing=timing, methods=tuple(methods))


timing_options = gathered(
    HeldTiming,
    "timing",
    click.option(
        "--every", type=int, help="With --pd: the torque is computed every so many steps, and held in between [1]."
    ),
    click.option(
        "--late", type=NUMBER, help="With --pd: the torque is applied so many steps late, or a fraction of them [0]."
    ),
    click.option(
        "--filter",
        "filter_seconds",
        type=NUMBER,
        help="With --pd: the measured velocity goes through a first-order filter with this time constant in s [0].",
    ),
)


ABOUT_DRIVES = {"--pd", "--h", "--every", "--late", "--filter", "--method", "--format"}
"""Options of commands that a question about a held or late drive has."""


def refuse_others(asked: str, *allowed: str) -> None:
    """Raise UsageError for an option of the running command that says nothing of a held or late drive."""
    refuse_beside(asked, typed_options() - {*ABOUT_DRIVES, *allowed}, "this answer is about the drive alone")


def show_held(question: "HeldQuestion", form: Format) -> "list[HeldAnswer]":
    """Print what each way of applying a held or late drive does, and what is not judged; return these answers."""
    from bezstab.questions import held_answers

    found = list(held_answers(question))
    heading = timing_words(question.timing, float(question.h))
    show_rows(HELD, [held_row(answer) for answer in found], form, heading=heading)
    if for_reading(form):
        show_text(f"\n{LATE_COMMANDS} {NOT_JUDGED}")
    return found


def check_held(question: "HeldQuestion", form: Format) -> bool:
    """Print whether a held or late drive is safe, and what it is that is used up; return whether every way is safe."""
    refuse_others("--every, --late and --filter")
    return all(answer.safe for answer in show_held(question, form))


def region_held(question: "HeldQuestion", points: int, files: Files, form: Format) -> None:
    """Print what `check` prints, and write the map of each way of applying the drive over kd and kp."""
    from bezstab import show, stability

    refuse_others("--pd", "--quality", "--grid", "--output", "--figure")
    files.check_output()
    alpha_hat, beta_hat = question.drive.point(question.h)
    own = float(alpha_hat), float(beta_hat)
    for answer in show_held(question, form):

        def draw(answer: "HeldAnswer" = answer) -> "Figure":
            return show.held_figure(answer, stability.held_map(answer.method.name, question.timing, points, own))

        files.write(files.path("region", answer.method.name, "held"), draw)


def choose_held(question: "HeldQuestion", bandwidth: Fraction | None, settle: Fraction | None, form: Format) -> bool:
    """Print gains for a bandwidth (Hz) or a time to settle (s) as `check` would; return whether every way is safe.

    Of the question's drive only the inertia counts.
    """
    from bezstab.questions import held_gains

    refuse_others("--bandwidth, --settle, --every, --late and --filter", "--bandwidth", "--settle")
    methods = (lookup("SYM"),) if left_at_default("methods") else question.methods
    drive = held_gains(
        question.drive.inertia, question.h, question.timing, bandwidth=bandwidth, settle=settle, methods=methods
    )
    if for_reading(form):
        show_text(f"kp = {typed_number(drive.kp)}, kd = {typed_number(drive.kd)}\n")
    return all(answer.safe for answer in show_held(replace(question, drive=drive, methods=methods), form))


def _inertia_or_drive(text: str) -> Drive:
    """Return the drive that 100,2,0.01 says, or the inertia alone, with gains that are to be chosen."""
    from bezstab.cli.asking import drive_of

    return Drive(Fraction(0), Fraction(0), rational(text)) if "," not in text else drive_of(text)


inertia_option = click.option(
    "--pd",
    "drive",
    type=ParsedType("inertia", _inertia_or_drive),
    help="Choose gains for a joint drive on this inertia (SI units); of KP,KD,INERTIA only the inertia counts.",
)
bandwidth_option = click.option(
    "--bandwidth",
    type=NUMBER,
    help="With --pd: choose critically damped gains with this natural frequency in Hz.",
)
