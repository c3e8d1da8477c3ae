"""What is printed of a chain: its columns."""

from collections.abc import Sequence

from bezstab.chains.answer import ChainAnswer
from bezstab.show.columns import SENTENCE, Column, in_seconds

COLUMNS: Sequence[Column[ChainAnswer]] = (
    Column("engine", "engine", lambda answer: answer.engine.name, "engine that sweeps over its constraints"),
    Column("safe", "safe", lambda answer: answer.safe, "whether errors decay by more than rounding"),
    Column(
        "|z| a step", "z_abs", lambda answer: answer.z_abs, "a step multiplies errors by it", form=".6f", brief=True
    ),
    Column("accuracy of |z|", "uncertainty", lambda answer: answer.accuracy, "how far that may be off", form=".1g"),
    Column(
        "|z| of one alone",
        "z_abs_alone",
        lambda answer: answer.alone_z_abs,
        "the same for one constraint alone, with as many sweeps",
        form=".6f",
        brief=True,
    ),
    Column(
        "by link",
        "growing",
        lambda answer: list(answer.growing),
        "errors of the links from the world on that grow, or decay last, as shares of the largest",
        form=".3g",
    ),
    Column(
        "a tenth in (s)",
        "",
        lambda answer: in_seconds(answer.tenth_steps, answer.h),
        "",
        form=".4g",
        brief=True,
    ),
    Column(
        "settles in (s)",
        "settle_seconds",
        lambda answer: in_seconds(answer.settle_steps, answer.h),
        "time until an error is a thousandth; null where it does not fall",
        unit="s",
        form=".4g",
        brief=True,
    ),
    Column("masses", "", lambda answer: [float(mass) for mass in answer.links.masses], "", form=".6g"),
    Column("motor", "", lambda answer: answer.links.motor.words if answer.links.motor else None, ""),
    Column("h", "h", lambda answer: float(answer.h), "step", unit="s"),
    Column("sweeps", "iterations", lambda answer: answer.iterations, "sweeps over all constraints in a step"),
    Column(
        "stable from (sweeps)",
        "stable_iterations",
        lambda answer: answer.stable_iterations,
        "fewest sweeps with which errors decay; null if none that was tried",
        brief=True,
    ),
    Column(
        "setting for this chain",
        "setting",
        lambda answer: answer.setting,
        "strongest values that leave a tenth to spare; null where there are none, or nothing to set",
        brief=True,
    ),
    Column(
        "sags by",
        "sag",
        lambda answer: answer.sag,
        "how far some body rests from its place under that load, at most; null where none is given, or errors grow",
        unit="m",
        form=".3g",
    ),
    Column(
        "jitters by",
        "jitter",
        lambda answer: answer.jitter,
        "error of the worst joint at which growth ends where the chain hangs, within a factor of three; else null",
        unit="m",
        form=".2g",
        brief=True,
    ),
    SENTENCE,
)
