"""A field of a row: its key, heading, form, unit and meaning. Rows, tables and schemas derive from it."""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import partial
from importlib import import_module
from typing import Any, Literal, get_args

from bezstab.show.columns import MISSING, Column, Row, Value, formatted

Kind = Literal["number", "integer", "text", "truth", "numbers", "text rows"]
"""Of a value; numbers are a list, text rows a list of lists of texts."""

Sentence = Callable[[Row], str]


PARTS: Mapping[str, Callable[[complex], float]] = {
    "abs": abs,
    "angle_deg": lambda z: math.degrees(cmath.phase(z)),
}
"""What a complex number has beside its real and its imaginary part."""


@dataclass(frozen=True)
class Field:
    """One value of a row: its key in JSON and CSV, its meaning and kind, where it is from, and how a table shows it.

    A table shows it below `heading`, unless that is empty, in the format `form`, or as the `text` made of the row.
    `unit` is "" where it has none. `null` says when there is no value, "" for never. `values_of` names types that list
    all that a text can be, such as "evidence.MovingVerdict". `path` leads to it in the result by attributes and places,
    such as "margins.alpha.0", or "t.-1" for the last time. By default it is the attribute that has the key's name.
    """

    key: str
    meaning: str
    heading: str = ""
    form: str = ""
    kind: Kind = "number"
    text: Callable[[Row], str] | None = None
    unit: str = ""
    null: str = ""
    values_of: tuple[str, ...] = ()
    path: str = ""

    @property
    def description(self) -> str:
        """The meaning with the unit, and when there is no value, as one text."""
        unit = f", in {self.unit}" if self.unit else ""
        return f"{self.meaning}{unit}{f'; null {self.null}' if self.null else ''}."

    @property
    def values(self) -> tuple[str, ...]:
        """All that a text can be, where there are few; loads what has the types that say so."""
        named = [name.rpartition(".") for name in self.values_of]
        types = [getattr(import_module(f"bezstab.{module}"), name) for module, _, name in named]
        return tuple(dict.fromkeys(value for each in types for value in get_args(each)))

    @property
    def column(self) -> Column:
        """The column of a table that shows this field."""
        return Column(self.heading, self.text or (lambda row: formatted(row[self.key], self.form)))

    def shown(self, heading: str, form: str = "", text: Callable[[Row], str] | None = None) -> Field:
        """Return the same field as another table shows it."""
        return replace(self, heading=heading, form=form, text=text)

    def of(self, path: str) -> Field:
        """Return the same field where another result has it."""
        return replace(self, path=path)

    @property
    def hidden(self) -> Field:
        """The same field where a table does not show it."""
        return self.shown("")


number = partial(Field, kind="number")
integer = partial(Field, kind="integer")
text = partial(Field, kind="text")
truth = partial(Field, kind="truth")


@dataclass(frozen=True)
class RowKind:
    """One kind of row that a command prints: what it is, the fields it always has, and those that options add.

    `sometimes` are keys that are null in some rows of this kind, though elsewhere they never are. The `sentence` says
    in words what a row says in numbers.
    """

    title: str
    fields: tuple[Field, ...]
    added: tuple[Field, ...] = ()
    sometimes: tuple[str, ...] = ()
    sentence: Sentence | None = None

    def columns(self, rows: Sequence[Row], without: Collection[str] = ()) -> list[Column]:
        """Return the columns of a table of such rows: of every field with a heading that shows something in some row.

        `without` are keys of fields that are not shown.
        """
        keys = {key for row in rows for key in row} - set(without)
        columns = [field.column for field in (*self.fields, *self.added) if field.heading and field.key in keys]
        return [column for column in columns if any(column.cell(row) != MISSING for row in rows)]

    def row(self, result: object, **found: Value) -> dict[str, Value]:
        """Return the row of a result, without what options add: of each field what was found, else as `cells`."""
        return cells(self.fields, result, found)


def cells(fields: Sequence[Field], result: object, found: Mapping[str, Value] | None = None) -> dict[str, Value]:
    """Return the values of fields by key: those found, else what each field's path leads to in a result.

    Numbers and texts are as they are, an exact number is float64, what is infinite or missing on the way is None. A
    method or a scene is its name; several texts are one, with commas between them. TypeError, naming the field and its
    type, for anything else.
    """
    known = found or {}
    return {field.key: known[field.key] if field.key in known else _cell(field, result) for field in fields}


def _found_at(path: str, result: object) -> Any:
    """Return what a path of attributes and places leads to; None where something on the way is None."""
    value: Any = result
    for name in path.split("."):
        if value is None:
            return None
        if name in PARTS and isinstance(value, complex):
            value = PARTS[name](value)
        else:
            value = value[int(name)] if name.lstrip("-").isdigit() else getattr(value, name)
    return value


def _cell(field: Field, result: object) -> Value:
    path = field.path or field.key
    value = _found_at(path, result)
    if field.kind == "numbers" and value is not None:
        return [float(number) for number in value]
    if field.kind == "text rows" and value is not None:
        return [[str(number) for number in row] for row in value]
    if isinstance(value, Fraction):
        return str(value) if field.kind == "text" else float(value)
    if isinstance(value, tuple) and field.kind == "text":
        return ", ".join(value)
    if value is None or isinstance(value, str | float | int):
        return None if isinstance(value, float) and not math.isfinite(value) else value
    name = getattr(value, "name", None)
    if isinstance(name, str):  # a method, a scene
        return name
    raise TypeError(f"{type(result).__name__}.{path} is a {type(value).__name__}: no row knows how to show it")
