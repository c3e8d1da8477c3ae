"""What is printed of a model: the columns of its states, of the suspects, and of the settings of constraints."""

import math
from collections.abc import Sequence

from bezstab.mujoco.blame import Suspect
from bezstab.mujoco.energy import Kept
from bezstab.mujoco.linting import Judged
from bezstab.mujoco.remedies import Remedy
from bezstab.mujoco.sags import Sag
from bezstab.mujoco.solrefs import Feedback
from bezstab.show.columns import Column


def _largest_step(judged: Judged) -> str | None:
    """Return the largest safe step in words; None where there is none."""
    if judged.h_limit is None:
        return "none" if judged.kind == "unsafe" else None
    return "any" if math.isinf(judged.h_limit) else f"{judged.h_limit:.4g}"


def _sag_words(sag: Sag) -> str | None:
    if sag.angle is not None:
        return f"{math.degrees(sag.angle):.3g}°"
    return None if sag.length is None else f"{1000 * sag.length:.3g} mm"


STATES: Sequence[Column[Judged]] = (
    Column("", "role", lambda _: "state", "what the row is about"),
    Column("at", "at", lambda judged: judged.at, "qpos0, a keyframe, a row of a log"),
    Column(
        "errors",
        "verdict",
        lambda judged: judged.kind,
        "decays, neutral, moves on, falls by itself, unsafe, not smooth",
    ),
    Column("|z|", "z_abs", lambda judged: judged.z_abs, "a step multiplies errors by it, at most"),
    Column(
        "a tenth in (s)",
        "",
        lambda judged: judged.seconds_to(10.0),
        "",
        form=".3g",
    ),
    Column(
        "a thousandth",
        "settle_seconds",
        lambda judged: judged.seconds_to(1000.0),
        "until errors are a thousandth; null where some do not fall",
        "s",
        ".3g",
    ),
    Column("falls (1/s)", "", lambda judged: judged.rate, "", form=".3g"),
    Column(
        "safe up to h (s)",
        "h_limit",
        lambda judged: judged.h_limit,
        "largest safe step; null where there is none, or any is",
        "s",
        words=_largest_step,
    ),
)

SUSPECTS: Sequence[Column[Suspect]] = (
    Column("", "role", lambda _: "element", "what the row is about"),
    Column("element", "element", lambda suspect: suspect.element, "element of the model"),
    Column("kind", "kind", lambda suspect: suspect.kind, "what the element or the setting is"),
    Column("|z| alone", "z_abs_alone", lambda suspect: suspect.z_abs_alone, "|z| with this element alone"),
    Column("|z| without", "z_abs_without", lambda suspect: suspect.z_abs_without, "|z| without this element"),
    Column("to blame", "", lambda suspect: suspect.blamed, ""),
)

REMEDIES: Sequence[Column[Remedy]] = (
    Column("", "role", lambda _: "remedy", "what the row is about"),
    Column("write", "setting", lambda remedy: remedy.write, "what makes every unsafe state safe, checked by the step"),
    Column("for", "element", lambda remedy: remedy.element, "element of the model"),
    Column("|z| then", "z_abs", lambda remedy: remedy.z_abs, "a step multiplies errors by it, at most"),
)

ENERGIES: Sequence[Column[Kept]] = (
    Column("", "role", lambda _: "energy", "what the row is about"),
    Column("from", "at", lambda kept: kept.at, "qpos0, a keyframe, a row of a log"),
    Column("with", "setting", lambda kept: kept.setting, "solref and solimp"),
    Column(
        "energy kept in 1 s",
        "energy_rate",
        lambda kept: None if kept.kept is None else kept.kept - 1,
        "share of its energy that a motion gains in a second, without drives and friction; null where the run breaks "
        "down",
        "1/s",
        lambda gained: format(1 + gained, ".2%"),
    ),
)

SAGS: Sequence[Column[Sag]] = (
    Column("", "role", lambda _: "sag", "what the row is about"),
    Column("from", "at", lambda sag: sag.at, "qpos0, a keyframe, a row of a log"),
    Column("element", "element", lambda sag: sag.element, "element of the model"),
    Column(
        "off by",
        "sag",
        lambda sag: sag.length if sag.angle is None else sag.angle,
        "how far it is off where the model comes to rest; of a drive at its joint",
        "m or rad",
        words=_sag_words,
    ),
)

SETTINGS: Sequence[Column[Feedback]] = (
    Column("", "role", lambda _: "setting", "what the row is about"),
    Column("setting", "setting", lambda feedback: feedback.setting, "solref and solimp"),
    Column("of", "kind", lambda feedback: feedback.kinds, "what the element or the setting is"),
    Column("α̂", "alpha_hat", lambda feedback: feedback.alpha_hat, "dimensionless damping"),
    Column("β̂", "beta_hat", lambda feedback: feedback.beta_hat, "dimensionless stiffness"),
    Column("|z|", "z_abs", lambda feedback: feedback.z_abs, "a step multiplies errors by it, at most"),
    Column("verdict", "verdict", lambda feedback: feedback.verdict, "what errors do, proven"),
    Column("MuJoCo", "remark", lambda feedback: feedback.notes or None, "what MuJoCo makes of the setting"),
)
