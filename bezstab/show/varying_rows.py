"""What sequences of steps do that vary within a range: as keys of a row, and in one sentence."""

from __future__ import annotations

from itertools import groupby
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence
    from fractions import Fraction

    from bezstab.stability import VaryingSteps


def varying_words(name: str, varying: VaryingSteps) -> str:
    """Return the verdict on a range of steps of the method of that name, and why, in one sentence."""
    held = "α̂ and β̂ held" if varying.hold else "α and β fixed"
    of_range = f"steps between {_seconds(varying.h_min)} and {_seconds(varying.h_max)}"
    match varying.varying:
        case "proven":
            return f"{name}, {held}: proven to decay for every sequence of {of_range} ({_reason(varying)})."
        case "refuted":
            assert varying.sequence
            steps = sequence_text(varying.sequence)
            if len(varying.sequence) == 1:
                return f"{name}, {held}: refuted for {of_range}: a step of {steps} alone does not decay."
            return f"{name}, {held}: refuted for {of_range}: {steps}, over and over, {_growth(varying)}."
        case "not known":
            return f"{name}, {held}: not known whether every sequence of {of_range} decays."


def sequence_text(sequence: Sequence[Fraction]) -> str:
    """Return steps in s as text, with how often each is taken: 3 of 0.01 s, then 0.02 s."""
    repeated = [(_seconds(step), len(list(same))) for step, same in groupby(sequence)]
    return ", then ".join(step if count == 1 else f"{count} of {step}" for step, count in repeated)


def _growth(varying: VaryingSteps) -> str:
    """Return what a sequence does to errors: how many times as large they are after each round, where that is seen."""
    growth = "" if varying.growth is None else f"{varying.growth:.3g}"
    return f"grow {growth}-fold each time" if growth and float(growth) > 1 else "do not decay"


def _seconds(step: Fraction) -> str:
    return f"{float(step):.6g} s"


def _reason(varying: VaryingSteps) -> str:
    match varying.kind:
        case "quadratic":
            return "a quadratic form falls with each step"
        case "polygon":
            assert varying.certificate
            return f"each step maps a polygon of {2 * len(varying.certificate)} corners into itself"
        case _:
            return "each step decays alone, and steps commute"
