"""What is printed of a log: columns of the pole, of the methods that are compared with it, and of the points found."""

from collections.abc import Sequence
from fractions import Fraction
from typing import NamedTuple

from bezstab.probes.answer import Probe
from bezstab.probes.probed_poles import Likeness, LikePoint
from bezstab.show.cells import modulus_words
from bezstab.show.columns import POLE, Column, of_part
from bezstab.units import alpha_and_beta


class Compared(NamedTuple):
    """A method whose pole is compared with that of a log."""

    answer: Probe
    one: Likeness


class Found(NamedTuple):
    """A point at which a method has the pole of a log; `h` is the integrator's step (s), if it is known."""

    answer: Probe
    point: LikePoint
    h: Fraction | None


def _fits(it: Compared) -> bool | None:
    told = it.one.method.name in it.answer.fitting
    return None if it.one.fits and not told else it.one.fits


def _rates(it: Found) -> tuple[float | None, float | None]:
    return alpha_and_beta(it.point.alpha_hat, it.point.beta_hat, it.h)


POLES: Sequence[Column[Probe]] = (
    Column("column", "column", lambda answer: answer.column, "column of the log"),
    *of_part(Probe, lambda answer: answer.pole, POLE),
    Column(
        "± of z",
        "uncertainty",
        lambda answer: answer.found.uncertainty if answer.pole is not None else None,
        "how far the pole may be off, or α̂ and β̂; null without a pole",
        form=".1e",
    ),
    Column("rows", "", lambda answer: answer.found.samples, ""),
    Column("remark", "remark", lambda answer: answer.found.reason, "why there is no pole; empty where there is one"),
)

COMPARED: Sequence[Column[Compared]] = (
    Column("column", "column", lambda it: it.answer.column, "column of the log", apart=True),
    Column("method", "method", lambda it: it.one.method.name, "integration method", brief=True),
    Column(
        "predicted |z_p|",
        "predicted_z_abs",
        lambda it: abs(it.one.predicted),
        "modulus of the pole of the method at the point",
        form=modulus_words,
        brief=True,
    ),
    Column("distance", "distance", lambda it: it.one.distance, "distance of both poles", form=".1e", brief=True),
    Column("allowed", "", lambda it: it.one.allowed, "", form=".1e", brief=True),
    Column(
        "fits",
        "fits",
        _fits,
        "whether the log may be the method's; null where more distance is allowed than methods differ by",
        brief=True,
    ),
)

FOUND: Sequence[Column[Found]] = (
    Column("column", "column", lambda it: it.answer.column, "column of the log", apart=True),
    Column("method", "method", lambda it: it.point.method.name, "integration method", brief=True),
    Column("α̂", "alpha_hat", lambda it: it.point.alpha_hat, "2αh where the method has the pole", brief=True),
    Column("β̂", "beta_hat", lambda it: it.point.beta_hat, "β²h² where the method has the pole", brief=True),
    Column(
        "± of α̂, β̂",
        "uncertainty",
        lambda it: [it.point.alpha_hat_error, it.point.beta_hat_error],
        "how far α̂ and β̂ may be off",
        form=".1e",
        brief=True,
    ),
    Column("α (1/s)", "alpha", lambda it: _rates(it)[0], "damping; null without h", "1/s", brief=True),
    Column("β (1/s)", "beta", lambda it: _rates(it)[1], "stiffness as a rate; null without h", "1/s", brief=True),
)
