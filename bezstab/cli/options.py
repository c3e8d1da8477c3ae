"""The types of options' values, and what was typed."""

import os
import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from pathlib import Path
from typing import Any

import click
from click.shell_completion import CompletionItem

from bezstab.cli.output import NOTES
from bezstab.compiling import COMPILED_CHOICE, compiler
from bezstab.engines.conversions import Engine, Point
from bezstab.engines.engine_list import ENGINES, engine_and_values, engine_named
from bezstab.errors import InputError
from bezstab.methods.registry import REGISTRY, lookup
from bezstab.rationals import rational
from bezstab.units import LEAST_STEP, LONGEST_STEP, to_dimensionless

EngineValues = tuple[Engine, tuple[Fraction, ...]]

MOST_IN_SEQUENCE = 10**6  # steps: a run of minutes


@dataclass(frozen=True)
class ParsedType(click.ParamType):  # type: ignore[type-arg]  # generic since click 8.3
    """A type whose values `parse` makes of the typed text. Its InputError becomes a message that names the option.

    The shell offers the `names` when it completes a value.
    """

    name: str
    parse: Callable[[str], object]
    names: Callable[[], Iterable[str]] | None = None

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """Return the parsed value; fail with a message that names the option if there is none."""
        try:
            return self.parse(value)
        except InputError as error:
            self.fail(str(error), param, ctx)

    def shell_complete(
        self, ctx: click.Context, param: click.Parameter, incomplete: str
    ) -> "list[CompletionItem[Any]]":
        """Return the names that begin with the typed text, in upper or lower case; files where none does."""
        if self.names is None:
            return []
        fitting = [name for name in self.names() if name.lower().startswith(incomplete.lower())]
        return [CompletionItem(name) for name in fitting] or [CompletionItem(incomplete, type="file")]


def _scenes() -> Iterable[str]:
    from bezstab.mechanism.scene_files import shipped_scenes

    return shipped_scenes()


def _positive(text: str) -> Fraction:
    number = rational(text)
    if number <= 0:
        raise InputError(f"{text} is not positive")
    return number


def _within_squares(text: str, unit: str) -> Fraction:
    """Return a positive number whose square is within float64; messages name the unit."""
    number = _positive(text)
    if not LEAST_STEP <= float(number) <= LONGEST_STEP:
        raise InputError(f"{text}: expected {LEAST_STEP:g} to {LONGEST_STEP:g} {unit}")
    return number


def _sequence(text: str) -> list[Fraction]:
    """Return the steps (s) of a text such as 3*0.01,0.02 (0.01 three times, then 0.02), or of a file of such texts."""
    if os.path.isfile(text):  # pathlib raises for a sequence that is too long to be a file's name
        try:
            text = Path(text).read_text(encoding="utf-8")
        except (OSError, ValueError) as error:
            raise InputError(f"cannot read {text[:50]!r}: {error}") from None
    sequence: list[Fraction] = []
    for part in re.split(r"[,\s]+", text.strip()):
        count, star, step = part.rpartition("*")
        times = rational(count) if star else Fraction(1)
        if times.denominator != 1 or not 1 <= times <= MOST_IN_SEQUENCE - len(sequence):
            raise InputError(f"{part[:50]!r}: expected a number of steps from 1, and {MOST_IN_SEQUENCE} in all")
        sequence += [_within_squares(step, "s")] * int(times)
    return sequence


def _engine_values(text: str) -> EngineValues:
    """Return an engine and its values; note which they are, to be said beside an answer, if its defaults are taken."""
    engine, values = engine_and_values(text)
    if engine.defaults and not text.partition("=")[2]:
        listed = ", ".join(f"{name} = {float(value):g}" for name, value in zip(engine.units, values, strict=False))
        note = f"{engine.name}: without values, its defaults are taken: {listed}"
        click.get_current_context().meta.setdefault(NOTES, []).append(note)
    return engine, values


NUMBER = ParsedType("number", rational)
POSITIVE = ParsedType("number", _positive)
SECONDS = ParsedType("seconds", partial(_within_squares, unit="s"))
SPEED = ParsedType("number", partial(_within_squares, unit="times the scene's own speed"))
SEQUENCE = ParsedType("steps", _sequence)
NUMBERS = ParsedType("number,number,...", lambda text: tuple(map(rational, text.split(","))))
METHOD = ParsedType("method", lookup, lambda: REGISTRY)
REAL = ParsedType("number", lambda text: float(rational(text)))
ENGINE = ParsedType("name", engine_named, lambda: ENGINES)
ENGINE_VALUES = ParsedType("name[=values]", _engine_values, lambda: [f"{name}=" for name in ENGINES])
SCENE = ParsedType("scene", str, _scenes)


def choose_compiled(_context: click.Context, _option: click.Parameter, choice: str) -> None:
    """Set the environment variable to the value of the option: worker processes inherit it.

    InputError if numba is asked for and missing.
    """
    if choice == "yes":
        compiler()
    os.environ[COMPILED_CHOICE] = choice


@dataclass(frozen=True)
class TypedPoint:
    """The options --alpha, --beta and --physical as typed: alpha_hat and beta_hat, or with `physical` both in 1/s."""

    alpha: Fraction | None
    beta: Fraction | None
    physical: bool = False

    @property
    def numbers(self) -> Point | None:
        """The two numbers, None without them; UsageError if one is missing."""
        if self.alpha is not None and self.beta is not None:
            return self.alpha, self.beta
        if self.alpha is not None or self.beta is not None:
            raise click.UsageError("--alpha and --beta go together: they give one point")
        if self.physical:
            raise click.UsageError("--physical needs --alpha and --beta: it says that they are in 1/s")
        return None

    def at(self, h: Fraction | None) -> Point | None:
        """Return the point (alpha_hat, beta_hat) for a step of h (s), None without one; UsageError as `numbers`."""
        if self.numbers is None or not self.physical:
            return self.numbers
        if h is None:
            raise click.UsageError("--physical needs --h: α and β in 1/s need the step in s")
        return to_dimensionless(*self.numbers, h)
