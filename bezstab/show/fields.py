"""A field of a row: its key, heading, form, unit and meaning. Rows, tables and schemas derive from it."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from importlib import import_module
from typing import Any, Literal, get_args

from bezstab.show.columns import MISSING, Column, Row, Value, formatted

Kind = Literal["number", "integer", "text", "truth", "numbers", "text rows"]
"""Of a value; numbers are a list, text rows a list of lists of texts."""

Sentence = Callable[[Row], str]


@dataclass(frozen=True)
class Field:
    """One value of a row: its key in JSON and CSV, its kind and meaning, and how a table shows it.

    A table shows it below `heading`, unless that is empty, in the format `form`, or as the `text` made of the row.
    `unit` is "" where it has none; `null` says when there is no value, "" for never; `values` are all that a text can
    be, where there are few; `values_of` names types that list them, such as "evidence.MovingVerdict". The value is
    `value` of the result, by default its attribute of the name of the key.
    """

    key: str
    kind: Kind
    meaning: str
    heading: str = ""
    form: str = ""
    text: Callable[[Row], str] | None = None
    unit: str = ""
    null: str = ""
    values: tuple[str, ...] = ()
    values_of: tuple[str, ...] = ()
    value: Callable[[Any], object] | None = None

    @property
    def description(self) -> str:
        """The meaning with the unit, and when there is no value, as one text."""
        unit = f", in {self.unit}" if self.unit else ""
        return f"{self.meaning}{unit}{f'; null {self.null}' if self.null else ''}."

    @property
    def all_values(self) -> tuple[str, ...]:
        """All that a text can be, where there are few, those of named types included; loads what has the types."""
        types = [getattr(import_module(f"bezstab.{room}"), name) for room, name in map(_parted, self.values_of)]
        return tuple(dict.fromkeys([*self.values, *(value for each in types for value in get_args(each))]))

    @property
    def column(self) -> Column:
        """The column of a table that shows this field."""
        return Column(self.heading, self.text or (lambda row: formatted(row[self.key], self.form)))

    def shown(self, heading: str, form: str = "", text: Callable[[Row], str] | None = None) -> Field:
        """Return the same field as another table shows it."""
        return replace(self, heading=heading, form=form, text=text)

    @property
    def hidden(self) -> Field:
        """The same field where a table does not show it."""
        return self.shown("")


def _parted(name: str) -> tuple[str, str]:
    room, _, last = name.partition(".")
    return room, last


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


def cells(fields: Sequence[Field], result: object, found: Mapping[str, Value] | None = None) -> dict[str, Value]:
    """Return the values of fields by key: those found, else what each field takes from a result.

    Numbers and texts as they are, an exact number as float64, a method or a scene by its name. TypeError, naming the
    field and its type, for anything else.
    """
    known = found or {}
    return {field.key: known[field.key] if field.key in known else _cell(field, result) for field in fields}


def _cell(field: Field, result: object) -> Value:
    value = field.value(result) if field.value else getattr(result, field.key)
    if isinstance(value, Fraction):
        return float(value)
    if value is None or isinstance(value, str | float | int):
        return value
    name = getattr(value, "name", None)
    if isinstance(name, str):  # a method, a scene
        return name
    raise TypeError(f"{type(result).__name__}.{field.key} is a {type(value).__name__}: no row knows how to show it")
