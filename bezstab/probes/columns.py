"""What is printed of a log: columns of the pole, of the methods that are compared with it, and of the points found."""

from collections.abc import Sequence
from typing import NamedTuple

from bezstab.probes.answer import Probe
from bezstab.probes.probed_poles import Likeness, LikePoint
from bezstab.show.cells import modulus_words
from bezstab.show.columns import POLE, RATES, Column, of_part


class Compared(NamedTuple):
    """A method whose pole is compared with that in a column of a log."""

    column: str
    one: Likeness


class Found(NamedTuple):
    """A point at which a method has the pole in a column of a log."""

    column: str
    point: LikePoint


POLES: Sequence[Column[Probe]] = (
    Column("column", "column", lambda answer: answer.column, "column of the log"),
    *of_part(Probe, lambda answer: answer.pole, POLE),
    Column(
        "± of z",
        "uncertainty",
        lambda answer: answer.uncertainty,
        "how far the pole may be off, or α̂ and β̂; null without a pole",
        form=".1e",
    ),
    Column("remark", "remark", lambda answer: answer.reason, "why there is no answer; empty where there is one"),
)

COMPARED: Sequence[Column[Compared]] = (
    Column("column", "column", lambda it: it.column, "column of the log", apart=True),
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
        lambda it: it.one.fits,
        "whether the log may be the method's; null where more distance is allowed than methods differ by",
        brief=True,
    ),
)

FOUND: Sequence[Column[Found]] = (
    Column("column", "column", lambda it: it.column, "column of the log", apart=True),
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
    *of_part(Found, lambda it: it.point, RATES),
)
