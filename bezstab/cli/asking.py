"""The question that was typed, and how answers are shown that several commands give."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from fractions import Fraction
from typing import TypeVar

from bezstab.cli.command_group import NUMERICAL_TROUBLE
from bezstab.cli.options import TypedPoint
from bezstab.cli.output import say, show_text
from bezstab.engines.conversions import Engine
from bezstab.engines.engine_list import WITNESSES
from bezstab.errors import NumericalError
from bezstab.methods.registry import lookup
from bezstab.methods.schemes import Method
from bezstab.rationals import typed_number

Found = TypeVar("Found")


def say_each(reasons: Iterable[str | None]) -> None:
    """Say each reason on standard error, once."""
    for reason in dict.fromkeys(reasons):
        if reason:
            say(f"bezstab: {reason}")


def of_each(methods: Iterable[Method], rows_of: Callable[[Method], Iterable[Found]]) -> tuple[list[Found], int]:
    """Return what is found of all methods, and an exit status: what cannot be found of one withholds no other's.

    Why it cannot be found is said on standard error. NumericalError where that is so of all.
    """
    rows: list[Found] = []
    failed: list[NumericalError] = []
    for method in methods:
        try:
            rows += rows_of(method)
        except NumericalError as error:
            failed.append(error)
    if failed and not rows:
        raise failed[0]
    say_each(map(str, failed))
    return rows, NUMERICAL_TROUBLE if failed else 0


def show_sentences(sentences: Iterable[str | None]) -> None:
    """Print those that say something, each below an empty line."""
    for sentence in filter(None, sentences):
        show_text(f"\n{sentence}")


def say_what_is_left_out(engine: Engine, *, many: bool = False) -> None:
    """Say on standard error what the conversion of an engine's values leaves out, for one constraint or for many.

    It is also said if the engine itself was never run.
    """
    swept = "; it solves each constraint by itself, in sweeps: chains of them may diverge all the same"
    ask = ": ask `bezstab chain`" if engine.sweeping else ""
    say(f"{engine.name}: left out: {engine.excludes}{swept + ask if engine.sweeps and not many else ''}")
    if engine.name not in WITNESSES:
        say(f"{engine.name}: taken from its source, never tested against the engine")
    if many and engine.sweeping:
        say(f"{engine.name}: sweeps are its {engine.sweeping.word}; of them left out: {engine.sweeping.excludes}")


def say_if_units_were_mistaken(methods: Sequence[Method], point: TypedPoint, h: Fraction | None) -> None:
    """Say on standard error if a point may be alpha and beta in 1/s, and how to say that it is; h in s, if typed.

    Without methods, of that of most engines.
    """

    from bezstab.questions.meant import meant_in_seconds

    if point.numbers is None or point.physical:
        return
    if meant_in_seconds(methods or (lookup("SYM"),), point.numbers, h):
        alpha, beta = map(typed_number, point.numbers)
        needed = "" if h else " and your --h"
        say(f"note: if {alpha} and {beta} are in 1/s, add --physical{needed}")
