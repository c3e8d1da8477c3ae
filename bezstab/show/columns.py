"""Columns: what is printed of an answer, each a typed function of it. Text, CSV, JSON and the table of keys follow."""

import cmath
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Generic, Protocol, SupportsFloat, TypeVar

from bezstab.methods.schemes import Method
from bezstab.show.cells import MISSING, Form, Row, Value, formatted, modulus_words, pole_words, visible

Answer = TypeVar("Answer")
Answer_contra = TypeVar("Answer_contra", contravariant=True)
Part = TypeVar("Part")
Found = TypeVar("Found")


@dataclass(frozen=True)
class Column(Generic[Answer_contra]):
    """One value of an answer: its heading in text, its key in CSV and JSON, how it is found, its unit and meaning.

    `form` is a format, or a function from the value to its text; `words` are the text itself where that takes more of
    the answer. A `brief` column is printed without --all; one that tells answers `apart` is printed where there are
    several. Without a heading it is for programs alone, without a key for people.
    """

    heading: str
    key: str
    value: Callable[[Answer_contra], Value]
    meaning: str
    unit: str = ""
    form: Form = ""
    brief: bool = False
    apart: bool = False
    words: Callable[[Answer_contra], str | None] | None = None

    def text(self, answer: Answer_contra) -> str:
        """Return what a table shows of an answer, on one line; a dash where there is no value."""
        if self.words:
            return visible(self.words(answer) or MISSING)
        value = self.value(answer)
        return MISSING if isinstance(value, float) and math.isnan(value) else visible(formatted(value, self.form))


def of_part(
    _: type[Answer], part: Callable[[Answer], Part | None], columns: Sequence[Column[Part]]
) -> list[Column[Answer]]:
    """Return columns of a part of such an answer as columns of the answer, without a value where it has no part."""

    def lifted(of: Callable[[Part], Found]) -> Callable[[Answer], Found | None]:
        return lambda answer: None if (found := part(answer)) is None else of(found)

    return [
        Column(**{**vars(each), "value": lifted(each.value), "words": each.words and lifted(each.words)})
        for each in columns
    ]


class _OfAMethod(Protocol):
    """An answer about a method."""

    @property
    def method(self) -> Method: ...


class _AtAPoint(Protocol):
    """An answer about a point of the plane."""

    @property
    def alpha_hat(self) -> float: ...
    @property
    def beta_hat(self) -> float: ...


class _WithRates(Protocol):
    """An answer about a point in 1/s."""

    @property
    def alpha(self) -> float | None: ...
    @property
    def beta(self) -> float | None: ...


class _InWords(Protocol):
    """An answer that has a sentence."""

    @property
    def sentence(self) -> str: ...


METHOD = Column[_OfAMethod]("method", "method", lambda it: it.method.name, "integration method", apart=True)

POINT: Sequence[Column[_AtAPoint]] = (
    Column("α̂", "alpha_hat", lambda it: it.alpha_hat, "damping of the feedback, 2αh"),
    Column("β̂", "beta_hat", lambda it: it.beta_hat, "stiffness of the feedback, β²h²"),
)

RATES: Sequence[Column[_WithRates]] = (
    Column("α (1/s)", "alpha", lambda it: it.alpha, "damping of the feedback; null without a step", "1/s", brief=True),
    Column("β (1/s)", "beta", lambda it: it.beta, "its stiffness as a rate; null if β̂ < 0, too", "1/s", brief=True),
)

SENTENCE = Column[_InWords]("", "sentence", lambda it: it.sentence, "the answer in words")

POLE: Sequence[Column[complex]] = (
    Column(
        "pole z",
        "z",
        lambda z: (z.real, z.imag),
        "real and imaginary part of the pole, of the upper one of a pair",
        form=lambda parts: pole_words(complex(*parts)),
    ),
    Column("|z_p|", "z_abs", abs, "modulus of the pole: each step multiplies errors by it", form=modulus_words),
    Column("∠z (deg)", "", lambda z: math.degrees(cmath.phase(z)), "", form=".3f"),
)


def in_seconds(steps: int | None, h: SupportsFloat) -> float | None:
    """Return how long so many steps of h (s) take; None where there are none."""
    return None if steps is None else steps * float(h)


def row_of(columns: Sequence[Column[Answer]], answer: Answer) -> Row:
    """Return the values of an answer by key; None for what is not finite, also within a list."""
    return {column.key: _finite(column.value(answer)) for column in columns if column.key}


def _finite(value: Any) -> Any:
    if isinstance(value, tuple | list):
        return [_finite(each) for each in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
