"""The command that judges a MuJoCo model: lint."""

from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING

import click

from bezstab.cli import shared_options as shared
from bezstab.cli.grouped_help import GroupedCommand, grouped
from bezstab.cli.options import NUMBER, ParsedType
from bezstab.cli.output import progress, show_tables, show_text
from bezstab.errors import InputError
from bezstab.rationals import rational

if TYPE_CHECKING:  # so that `bezstab --help`, which lists this command, loads nothing that computes
    from bezstab.mujoco.controllers import Gains


def _gains(text: str) -> "Gains":
    """Return the gains that hip.*=200,5 says."""
    from bezstab.mujoco.controllers import Gains

    pattern, equals, numbers = text.rpartition("=")
    gains = numbers.split(",")
    if not (pattern and equals and len(gains) == 2):
        raise InputError(f"{text!r}: expected NAME=KP,KD")
    return Gains(pattern, *map(rational, gains))


def _rate(text: str) -> tuple[str, float]:
    """Return the joint and the rate that crank=20 says."""
    joint, equals, rate = text.rpartition("=")
    if not (joint and equals):
        raise InputError(f"{text!r}: expected JOINT=RATE")
    return joint, float(rational(rate))


def _load(text: str) -> tuple[str, tuple[float, ...]]:
    """Return the body and the force that gripper=0,0,-20 says; of gravity alone no body."""
    if text == "gravity":
        return "", ()
    body, equals, force = text.rpartition("=")
    if not (body and equals):
        raise InputError(f"{text!r}: expected gravity, or BODY=FX,FY,FZ in N")
    return body, tuple(float(rational(number)) for number in force.split(","))


@click.command(cls=GroupedCommand)
@click.argument("model", type=click.Path(path_type=Path))
@grouped(
    "What is judged",
    click.option("--at", multiple=True, help="qpos0, a keyframe, or a CSV log of qpos; repeatable [all]."),
    click.option("--deep", is_flag=True, help="Judge constraints past solimp's width, too."),
    click.option(
        "--spin",
        type=ParsedType("joint=rate", _rate),
        multiple=True,
        help="Energy left after a second, begun at a joint's rate in rad/s or m/s; repeatable.",
    ),
    click.option(
        "--load",
        "loads",
        type=ParsedType("gravity|body=fx,fy,fz", _load, lambda: ["gravity"]),
        multiple=True,
        help="Sag under gravity, and under a force (N) on a body; repeatable.",
    ),
)
@grouped(
    "A controller",
    click.option(
        "--pd",
        "gains",
        type=ParsedType("name=kp,kd", _gains),
        multiple=True,
        help="Gains for the motors, or else joints, of a name or regular expression; repeatable.",
    ),
    click.option("--every", type=int, default=1, help="Hold each torque for so many steps."),
    click.option("--late", type=NUMBER, default="0", help="Delay of the torque in steps."),
)
@grouped("Output", shared.form)
def lint(
    model: Path,
    at: Sequence[str],
    gains: "Sequence[Gains]",
    every: int,
    late: Fraction,
    spin: Sequence[tuple[str, float]],
    loads: Sequence[tuple[str, tuple[float, ...]]],
    deep: bool,
    **_: object,
) -> int:
    """Judge a MuJoCo model at its timestep: exit status 1 if unsafe.

    MODEL is MuJoCo's XML or a URDF. lint differentiates MuJoCo's own step at each state: at qpos0 and every keyframe,
    or at those of --at. A log has rows of qpos, or of qpos and qvel; lint shows its worst row.

    "Unsafe" means: errors grow, and a smaller step or another gain would stop that. A mechanism that falls by itself
    does so at any step. Where a contact or limit just begins, lint judges the model with all of them and without. The
    last table shows each solref as Baumgarte's feedback.

    Exit status: 1 if unsafe somewhere, else 3 if not smooth somewhere, else 0. Needs mujoco 3.7 or later.

    Example: bezstab lint robot.xml
    """
    from bezstab.engines.drives import Timing
    from bezstab.mujoco.columns import ENERGIES, REMEDIES, SAGS, SETTINGS, STATES, SUSPECTS
    from bezstab.mujoco.linting import linted_model

    timing = Timing(every, late)
    if timing != Timing() and not gains:
        raise InputError("--every and --late need --pd: they are about a controller")
    load = {body: force for body, force in loads if body} if loads else None
    linted = linted_model(model, at, gains, timing, deep=deep, spin=dict(spin), load=load, shown=progress)
    show_text(linted.sentence)
    show_tables(
        [
            (STATES, linted.judged),
            (SUSPECTS, linted.suspects),
            (REMEDIES, linted.remedies),
            (ENERGIES, linted.kept),
            (SAGS, linted.sags or ()),
            (SETTINGS, linted.feedbacks),
        ]
    )
    return linted.status
