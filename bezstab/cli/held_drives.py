"""Drives whose controller is slower than the physics: the options of check, choose and region, what is printed."""

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

import click

from bezstab.cli.options import NUMBER, ParsedType, gathered, typed_beside
from bezstab.cli.output import Files, for_reading, show_rows, show_text
from bezstab.engines import Drive
from bezstab.errors import InputError
from bezstab.methods import Method
from bezstab.rationals import rational, typed_number
from bezstab.show import HELD, LATE_COMMANDS, NOT_JUDGED, Format, held_row, timing_words

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from bezstab.questions import HeldAnswer, HeldQuestion
    from bezstab.stability import Timing


@dataclass(frozen=True)
class HeldTiming:
    """When a drive's torque is computed and applied, as typed; None where an option was not given."""

    every: int | None
    late: Fraction | None
    filter_seconds: Fraction | None

    def of(self, drive: Drive | None, h: Fraction | None) -> "Timing | None":
        """Return the timing of a drive at a step of h (s), None where no option says one; InputError without both."""
        from bezstab.stability import Timing

        if self.every is None and self.late is None and self.filter_seconds is None:
            return None
        if drive is None or h is None:
            raise InputError("--every, --late and --filter are about a drive: they need --pd and --h")
        if self.filter_seconds is not None and self.filter_seconds < 0:
            raise InputError(f"--filter {float(self.filter_seconds):g}: expected 0 s or more")
        every, filter_steps = 1 if self.every is None else self.every, (self.filter_seconds or Fraction(0)) / h
        return Timing(every=every, late=self.late or Fraction(0), filter_steps=filter_steps)


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


ABOUT_DRIVES = {"drive", "h", "every", "late", "filter_seconds", "methods", "form"}
"""Parameters of commands that a question about a held or late drive has."""


def refuse_others(asked: str, *allowed: str) -> None:
    """Raise UsageError for an option of the running command that says nothing of a held or late drive."""
    if other := typed_beside(ABOUT_DRIVES | set(allowed)):
        raise click.UsageError(f"{other} does not go with {asked}: this answer is about the drive alone")


def held_question(drive: Drive, h: Fraction, timing: "Timing", methods: Sequence[Method]) -> "HeldQuestion":
    """Return the question about a held or late drive: in some ways of applying it, without methods in all four."""
    from bezstab.questions import HeldQuestion

    if not methods:
        return HeldQuestion(drive=drive, h=h, timing=timing)
    return HeldQuestion(drive=drive, h=h, timing=timing, methods=tuple(methods))


def check_held(drive: Drive, h: Fraction, timing: "Timing", methods: Sequence[Method], form: Format) -> bool:
    """Print whether a held or late drive is safe, and what it is that is used up; return whether every way is safe."""
    from bezstab.questions import held_answers

    refuse_others("--every, --late and --filter")
    found = list(held_answers(held_question(drive, h, timing, methods)))
    _show_held(found, form)
    return all(answer.safe for answer in found)


def _show_held(found: "Sequence[HeldAnswer]", form: Format) -> None:
    """Print what each way of applying one drive does, and what is not judged."""
    question = found[0].question
    heading = timing_words(question.timing, float(question.h))
    show_rows(HELD, [held_row(answer) for answer in found], form, heading=heading)
    if for_reading(form):
        show_text(f"\n{LATE_COMMANDS} {NOT_JUDGED}")


def region_held(
    drive: Drive,
    h: Fraction | None,
    timing: "Timing | None",
    methods: Sequence[Method],
    points: int,
    files: Files,
    form: Format,
) -> None:
    """Write the map of each way of applying a held or late drive over kd and kp; print what `check` prints.

    UsageError without h (s). Without a timing each step computes its torque and applies it.
    """
    from bezstab.questions import held_answers
    from bezstab.stability import Timing, held_map

    refuse_others("--pd", "quality", "grid", "output", "figure")
    if h is None:
        raise click.UsageError("--pd needs --h: the step in s")
    question = held_question(drive, h, timing or Timing(), methods)
    files.check_output()
    found = list(held_answers(question))
    alpha_hat, beta_hat = drive.point(h)
    own = float(alpha_hat), float(beta_hat)
    for answer in found:

        def draw(answer: "HeldAnswer" = answer) -> "Figure":
            from bezstab.show import held_figure

            return held_figure(answer, held_map(answer.method.name, question.timing, points, own))

        files.write_figure(files.path("region", answer.method.name, "held"), draw)
    _show_held(found, form)


def choose_held(
    inertia: Fraction,
    h: Fraction,
    timing: "Timing | None",
    methods: Sequence[Method],
    bandwidth: Fraction | None,
    settle: Fraction | None,
    form: Format,
) -> bool:
    """Print gains for a bandwidth (Hz) or a time to settle (s) as `check` would; return whether every way is safe."""
    from bezstab.methods import lookup
    from bezstab.questions import held_answers, held_gains
    from bezstab.stability import Timing

    refuse_others("--bandwidth, --settle, --every, --late and --filter", "bandwidth", "settle")
    timing = timing or Timing()
    applied = list(methods) or [lookup("SYM")]
    drive = held_gains(inertia, h, timing, bandwidth=bandwidth, settle=settle, methods=applied)
    if for_reading(form):
        show_text(f"kp = {typed_number(drive.kp)}, kd = {typed_number(drive.kd)}\n")
    found = list(held_answers(held_question(drive, h, timing, applied)))
    _show_held(found, form)
    return all(answer.safe for answer in found)


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
