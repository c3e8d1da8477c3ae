"""The command that judges a MuJoCo model: lint."""

from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path

import click

from bezstab import evidence
from bezstab.cli.options import OF_A_CONTROLLER, ParsedType, command, option
from bezstab.cli.output import for_reading, progress, show_rows, show_text
from bezstab.errors import InputError
from bezstab.rationals import rational
from bezstab.show import LINTED


def _gains(text: str) -> "evidence.MotorGains":
    """Return the gains that hip.*=200,5 says."""
    pattern, equals, numbers = text.rpartition("=")
    gains = numbers.split(",")
    if not (pattern and equals and len(gains) == 2):
        raise InputError(f"{text!r}: expected NAME=KP,KD")
    return evidence.MotorGains(pattern, *map(rational, gains))


@command(
    option(
        "--pd gains",
        ParsedType("name=kp,kd", _gains),
        "Judge the motors of that name, or regular expression, with a controller's gains. Repeatable.",
        multiple=True,
    ),
    *("every", "late", "form"),
    OF_A_CONTROLLER,
)
@click.argument("model", type=click.Path(path_type=Path))
def lint(model: Path, gains: "Sequence[evidence.MotorGains]", every: int, late: Fraction) -> bool:
    """Judge a MuJoCo model: exit status 1 if anything is unsafe.

    MODEL is MuJoCo's XML or a URDF. MuJoCo also opens the files that it includes: meshes, textures, height fields.
    Nothing is simulated.

    There is a row for each equality, limit, friction loss, pair of contact parameters, spring, damper, drive and
    motor. It shows the element's point (α̂, β̂), the method that MuJoCo's integrator is there, and the verdict. If the
    element is unsafe, relies on refsafe or is needlessly soft, "advice" has the line to write. If no single point
    stands for an element, it is "not judged", and the row says why. solimp can make several points of one setting: the
    one with the largest |z| is judged, and "judged" says which. "stable for h times" is how many times as long the time
    step may be at the same physical parameters.

    The last row judges all equalities, springs and drives together, and decides. Elements may be unsafe together
    although each is safe alone. One that is unsafe alone may be safe in its closed loop. Needs mujoco 3.7 or later:
    from there on connect and weld have the term of turning normals.

    A <motor> is controlled from outside the model. With --pd it is judged with its controller's gains, on the model's
    own inertias: alone, and in the last row with all the rest. --every, --late and MuJoCo's own delay say when its
    torque is computed and applied. A late target of a position drive takes no stability.

    Example: bezstab lint robot.xml
    """
    from bezstab import stability

    timing = stability.Timing(every, late)
    model_data = evidence.read_mujoco_model(model)
    linted = list(progress(evidence.linted_model(model_data, gains, timing), "lint", len(model_data.elements)))
    step = f"timestep {float(model_data.h):g} s, integrator {model_data.integrator}"
    poses = f"; keyframes not judged: {', '.join(model_data.keyframes)}" if model_data.keyframes else ""
    show_text(f"{model.name} at qpos0: {step}{poses}\n")
    if linted or not for_reading():
        show_rows(LINTED, (LINTED.row(each, advice=each.advice or None) for each in linted))
    else:
        show_text("Nothing to judge: no equality, limit, friction loss, contact, spring, damper or drive.")
    return not any(each.unsafe for each in linted)
