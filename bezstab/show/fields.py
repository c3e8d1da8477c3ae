"""A field of a row: its key, heading, form, unit and meaning. Rows, tables and the table of keys derive from it."""

from __future__ import annotations

import cmath
import math
import unicodedata
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, Literal

Value = str | float | int | Sequence[float] | Sequence[Sequence[str]] | None
Row = Mapping[str, Any]
"""A value by key, each of the kind that its `Field` says."""

Text = Callable[[Row], str]
"""What a cell or a sentence says of a row."""

Kind = Literal["number", "integer", "text", "truth", "numbers", "text rows"]
"""Of a value; numbers are a list, text rows a list of lists of texts."""

MISSING = "-"

PARTS: Mapping[str, Callable[[complex], float]] = {
    "abs": abs,
    "angle_deg": lambda z: math.degrees(cmath.phase(z)),
}
"""What a complex number has beside its real and its imaginary part."""


def visible(text: str) -> str:
    """Return the text on one line, without what would command a terminal: a line's end is \\n, the escape \\x1b."""
    return "".join(
        character.encode("unicode_escape").decode()
        if unicodedata.category(character) in ("Cc", "Zl", "Zp")
        else character
        for character in text
    )


Form = str | Callable[[Any], str]
"""Of a value: a format, or what makes its text."""


def formatted(value: Value, form: Form = "") -> str:
    """Return a value in a form, by default six digits, minus zero as zero; a dash for None and for an empty text.

    Truth is yes or no; a format of its own is what it is called in place of no.
    """
    if value is None or value == "":
        return MISSING
    if callable(form):
        return form(value)
    if isinstance(value, bool):
        return "yes" if value else form or "no"
    if isinstance(value, float):
        return format(value + 0.0, form or ".6g")  # minus zero becomes zero
    return format(value, form)


@dataclass(frozen=True)
class Field:
    """One value of a row: its key in JSON and CSV, its meaning and kind, where it is from, and how a table shows it.

    A table shows it in a column below `heading`, unless that is empty, in its `form`, or as the `text` made of the row.
    Where there is no value the column shows what `otherwise` makes of the row, by default a dash. `unit` is "" where it
    has none. `null` says when there is no value. `path` leads to it in the result by attributes and places, such as
    "margins.alpha.0", or "t.-1" for the last time. In a result where no path begins like this, and without a path, it
    is the attribute that has the key's name.
    """

    key: str
    meaning: str
    heading: str = ""
    form: Form = ""
    kind: Kind = "number"
    text: Text | None = None
    otherwise: Text | None = None
    unit: str = ""
    null: str = ""
    path: str = ""

    def cell(self, row: Row) -> str:
        """Return what the column of this field shows of a row, on one line; a dash where there is no value."""
        value = row.get(self.key)
        make = self.otherwise if value is None and self.otherwise else self.text
        return visible(make(row) if make else formatted(value, self.form))

    def shown(self, heading: str, text: Text | None = None) -> Field:
        """Return the same field as another table shows it: as it is, or as the text made of the row."""
        return replace(self, heading=heading, form="", text=text, otherwise=None)

    def of(self, path: str) -> Field:
        """Return the same field where another result has it."""
        return replace(self, path=path)

    @property
    def hidden(self) -> Field:
        """The same field where a table does not show it."""
        return self.shown("")

    def value_of(self, result: Any) -> Any:
        """Return what the path leads to in a result; None where something on the way is None."""
        value, names = result, self.path.split(".")
        for name in names if hasattr(result, names[0]) else [self.key]:
            if value is None:
                return None
            if name in PARTS:
                value = PARTS[name](value)
            else:
                value = value[int(name)] if name.lstrip("-").isdigit() else getattr(value, name)
        return value

    def plain(self, value: Any) -> Value:
        """Return a value as a row has it, by its kind; None for what is missing or not finite.

        An exact number is float64, or text. A method or a scene is its name; several texts, or the keys of a mapping,
        are one text with commas between them.
        """
        if value is None or (isinstance(value, float) and not math.isfinite(value)):
            return None
        match self.kind:
            case "numbers":
                return [float(number) for number in value]
            case "text rows":
                return [[str(number) for number in row] for row in value]
            case "text":
                return ", ".join(value) if isinstance(value, tuple | Mapping) else str(getattr(value, "name", value))
            case _:  # truth is an integer, too
                return value if isinstance(value, int) else float(value)


number = Field
integer = partial(Field, kind="integer")
text = partial(Field, kind="text")
truth = partial(Field, kind="truth")


def column(heading: str, key: str, form: str = "") -> Field:
    """Return a field that nothing but a table shows."""
    return Field(key, "", heading, form)


@dataclass(frozen=True)
class RowKind:
    """One kind of row that a command prints: what it is, the fields it always has, and those that options add.

    The `sentence` says in words what a row says in numbers, if anything.
    """

    title: str
    fields: tuple[Field, ...]
    added: tuple[Field, ...] = ()
    sentence: Text = lambda _: ""

    def columns(self, rows: Sequence[Row], without: Collection[str] = ()) -> list[Field]:
        """Return the columns of a table of such rows: the fields with a heading that show something in some row.

        `without` are keys of fields that are not shown.
        """
        keys = {key for row in rows for key in row} - set(without)
        return [
            field
            for field in (*self.fields, *self.added)
            if field.heading and field.key in keys and any(field.cell(row) != MISSING for row in rows)
        ]

    def row(self, result: object, **found: Any) -> dict[str, Value]:
        """Return the row of a result, without what options add: of each field what was found, else as `cells`."""
        return cells(self.fields, result, found)


def cells(fields: Sequence[Field], result: object, found: Mapping[str, Any] | None = None) -> dict[str, Value]:
    """Return the values of fields by key: those found, else what each field's path leads to in a result."""
    known = found or {}
    return {
        field.key: field.plain(known[field.key] if field.key in known else field.value_of(result)) for field in fields
    }
