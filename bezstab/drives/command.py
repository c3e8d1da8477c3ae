"""The command that judges a joint's drive, or finds its gains: drive."""

from collections.abc import Sequence
from fractions import Fraction
from functools import partial
from pathlib import Path

import click

from bezstab.cli import shared_options as shared
from bezstab.cli.grouped_help import GroupedCommand, grouped
from bezstab.cli.options import NUMBER, POSITIVE, SECONDS, ParsedType
from bezstab.cli.output import Files, show_answers, show_text
from bezstab.errors import InputError
from bezstab.methods.registry import lookup
from bezstab.methods.schemes import Method
from bezstab.rationals import rational

Late = tuple[Fraction, bool]
"""A delay, and whether it is in seconds, not steps."""


def _late(text: str) -> Late:
    """Return a delay in steps ("1.5") or in seconds ("5ms")."""
    for unit, size in (("ms", Fraction(1, 1000)), ("s", Fraction(1))):
        if text.endswith(unit):
            return rational(text.removesuffix(unit)) * size, True
    return rational(text), False


LATE = ParsedType("steps, or 5ms", _late)


def _load(text: str) -> Fraction:
    """Return a force or a torque; InputError for gravity, which is none without a mass and an arm."""
    if text == "gravity":
        raise InputError("gravity: give its torque in N m, 9.81 times mass times arm, or its force in N")
    return rational(text)


POINTS = 200
"""Along each axis of the figure."""


@click.command(cls=GroupedCommand)
@grouped(
    "The drive",
    click.option("--kp", type=NUMBER, help="Stiffness, N m/rad or N/m."),
    click.option("--kd", type=NUMBER, help="Damping, N m s/rad or N s/m."),
    click.option("--ki", type=NUMBER, default="0", help="Integral gain, N m/(rad s) or N/(m s)."),
    click.option("--inertia", type=POSITIVE, required=True, help="Inertia or mass that it moves, kg m² or kg."),
    click.option("--bandwidth", type=NUMBER, help="Find critically damped gains of so many Hz."),
    click.option("--settle", type=NUMBER, help="Find critically damped gains that settle in so many s."),
    click.option("--load", type=ParsedType("number", _load), help="A steady load, N m or N: how far does it sag?"),
)
@grouped(
    "Your simulation",
    click.option("--h", type=SECONDS, help="Step of the physics in s; or --physics."),
    click.option("--physics", type=POSITIVE, help="Rate of the physics in Hz, in place of --h."),
    shared.methods,
    click.option("--every", type=int, help="Hold each torque for so many steps [1]."),
    click.option("--controller", type=POSITIVE, help="Rate of the controller in Hz, in place of --every."),
    click.option(
        "--late", type=LATE, default="0", metavar="STEPS|5MS", help="Delay of the torque: steps, or a time such as 5ms."
    ),
    click.option("--filter", "filter_seconds", type=NUMBER, default="0", help="Time constant of a filter of q', s."),
)
@grouped("Output", *shared.output_options)
def drive(
    kp: Fraction | None,
    kd: Fraction | None,
    ki: Fraction,
    inertia: Fraction,
    h: Fraction | None,
    physics: Fraction | None,
    bandwidth: Fraction | None,
    settle: Fraction | None,
    methods: Sequence[Method],
    every: int | None,
    controller: Fraction | None,
    late: Late,
    filter_seconds: Fraction,
    load: Fraction | None,
    output: Path,
    figure: str,
    **_: object,
) -> bool:
    """Judge a joint's drive: exit status 0 if safe, 1 if not.

    The torque is -kp (q - target) - kd q', and with --ki an integral part. Without --method all four ways to apply it
    are judged: explicit (SYM), implicit in velocity (imex-euler), stable PD (stable-pd), fully implicit
    (implicit-euler). Yours is most often SYM.

    A contact with stiffness k and damping c between bodies of reduced mass m is --kp k --kd c --inertia m.

    Example: bezstab drive --kp 200 --kd 5 --inertia 0.1 --h 0.002 --every 4
    """
    from bezstab.drives.answer import gains_for, judge_drive, rates
    from bezstab.drives.columns import COLUMNS, NOT_JUDGED, timing_words, ways_words
    from bezstab.engines.drives import DRIVE_METHODS, FRESH, Drive, timing_of

    ways = tuple(methods) or tuple(map(lookup, DRIVE_METHODS))
    h, every = rates(h, physics, every, controller)
    number, seconds = late
    timing = timing_of(h, every, number / h if seconds else number, filter_seconds)
    if bandwidth is not None or settle is not None:
        if kp is not None or kd is not None or ki:
            raise InputError("--bandwidth and --settle find kp and kd: leave out --kp, --kd and --ki")
        judged = gains_for(inertia, h, ways, timing, bandwidth=bandwidth, settle=settle)
        show_text(f"kp = {float(judged.kp):g}, kd = {float(judged.kd):g}\n")
    elif kp is None or kd is None:
        raise InputError("give --kp and --kd, or --bandwidth, or --settle")
    else:
        judged = Drive(kp, kd, inertia, ki)
    files = Files(output, figure)
    answers = [judge_drive(judged, h, method, timing, load) for method in ways]
    if timing != FRESH:
        show_text(f"{timing_words(timing, float(h))}\n")
    if len(answers) > 1:
        show_text(f"{ways_words(answers)}\n")
    show_answers(COLUMNS, answers)
    if timing != FRESH:
        show_text(f"\n{NOT_JUDGED}")
    for answer in answers if figure != "none" else ():
        from bezstab.drives.figure import drive_figure

        files.write(files.path("drive", answer.method.name), partial(drive_figure, answer, POINTS))
    return all(answers)
