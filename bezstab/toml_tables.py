"""Tables of TOML files, entry by entry checked: what is wrong is said with its place, key, value and what is expected.

Nothing is ever executed: an entry is a text, a number, an exact number written as a text, or a list or table of them.
"""

from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from typing import Any

from bezstab.errors import InputError

Point = tuple[float, float]

LEAST = 1e-100  # of a number that is not 0, and of the inverse of the largest: so their squares are within float64
LISTED = 200  # characters of the keys that are there, where one is missing
SIZE = "0 or of size 1e-100 to 1e100"
RATIONAL_STRINGS = 'rational strings like "175/108"'


class TomlTable:
    """One TOML table that hands out checked entries and, when asked, refuses the keys that nobody asked for.

    `where` is what its messages begin with, as "body 'crank'"; nothing for the only table of a file. A method that
    hands out an entry raises InputError if it is not what is expected, or missing without a default.
    """

    def __init__(self, data: object, where: str = "") -> None:
        if not isinstance(data, dict):
            raise InputError(f"{where}: expected a table")
        self.data: dict[str, Any] = data
        self.where = where
        self.known: list[str] = []
        self.inner: list[TomlTable] = []

    def mistake(self, what: str) -> InputError:
        """Return the error that says what is wrong, with the place in front."""
        return InputError(f"{self.where}: {what}" if self.where else what)

    def entry(self, key: str, valid: Callable[[Any], bool], expected: str, default: object = None) -> Any:
        """Return the entry, or `default` if there is none, if it is valid; `expected` says what would be."""
        if key not in self.known:
            self.known.append(key)
        if key not in self.data and default is None:
            found = ", ".join(self.data)[:LISTED] or "nothing"  # a misspelt key is missing under its right name
            raise self.mistake(f"{key} is missing: found {found}")
        value = self.data.get(key, default)
        if not valid(value):
            raise self.mistake(f"{key} = {value!r}: expected {expected}")
        return value

    def text(self, key: str, default: str | None = None) -> str:
        """Return one line of text that is not blank."""
        return str(self.entry(key, _is_line, "one line of text", default))

    def texts(self, key: str) -> list[str]:
        """Return a list of texts."""
        return list(self.entry(key, _are_texts, "a list of names"))

    def number(self, key: str, default: float | None = None) -> float:
        """Return a number that is 0 or of size 1e-100 to 1e100."""
        return float(self.entry(key, is_number, f"a number, {SIZE}", default))

    def positive_number(self, key: str, default: float | None = None) -> float:
        """Return a number from 1e-100 to 1e100."""
        return float(self.entry(key, _is_positive, "a positive number, 1e-100 to 1e100", default))

    def point(self, key: str, default: Point | None = None) -> Point:
        """Return a pair of numbers."""
        x, y = self.entry(key, is_point, f"two numbers, {SIZE}", default)
        return float(x), float(y)

    def numbers(self, key: str, allowed: Sequence[str]) -> dict[str, float]:
        """Return a table of numbers, none if absent, with keys among the allowed ones."""
        entries = self.entry(key, _are_numbers, f"a table of numbers, {SIZE}", {})
        for name in entries:
            if name not in allowed:
                raise self.mistake(f"{key} names {name!r}, which is not among {', '.join(allowed)}")
        return {name: float(number) for name, number in entries.items()}

    def exact_numbers(self, key: str, read: Callable[[str], Fraction]) -> tuple[Fraction, ...]:
        """Return a list of exact numbers, each written as a text ("175/108", "-0.5", "2") and read by `read`."""
        return self._exact(key, self.entry(key, _are_texts, f"a list of {RATIONAL_STRINGS}"), read)

    def exact_rows(self, key: str, read: Callable[[str], Fraction]) -> tuple[tuple[Fraction, ...], ...]:
        """Return a list of such lists."""
        rows = self.entry(key, _are_lists_of_texts, f"a list of rows, each a list of {RATIONAL_STRINGS}")
        return tuple(self._exact(key, row, read) for row in rows)

    def _exact(self, key: str, texts: Sequence[str], read: Callable[[str], Fraction]) -> tuple[Fraction, ...]:
        try:
            return tuple(read(text) for text in texts)
        except InputError as error:
            raise self.mistake(f"{key}: {error}") from None

    def tables(self, key: str) -> list["TomlTable"]:
        """Return an array of tables, none if absent."""
        entries = self.entry(key, lambda value: isinstance(value, list), "an array of tables", [])
        tables = [TomlTable(entry, f"{key} {number}") for number, entry in enumerate(entries, start=1)]
        self.inner += tables
        return tables

    def table(self, key: str) -> "TomlTable":
        """Return a table, an empty one if absent."""
        table = TomlTable(self.entry(key, lambda value: isinstance(value, dict), "a table", {}), key)
        self.inner.append(table)
        return table

    def optional_table(self, key: str) -> "TomlTable | None":
        """Return a table, None if absent."""
        table = self.table(key)
        return table if key in self.data else None

    def refuse_unknown_keys(self, instead: Mapping[str, str] | None = None) -> None:
        """Raise InputError, listing the known ones, if a key here or in a table handed out was not asked for.

        `instead` says of keys that people try here what to write in their place.
        """
        for table in self.inner:
            table.refuse_unknown_keys()
        unknown = sorted(set(self.data) - set(self.known))
        if unknown:
            advice = (instead or {}).get(unknown[0])
            written_instead = f"write {advice}; " if advice else ""
            raise self.mistake(f"unknown key {unknown[0]!r}: {written_instead}known are {', '.join(self.known)}")


def is_number(value: object) -> bool:
    """Return whether this is a number, not a truth value, that is 0 or of size 1e-100 to 1e100 (so not nan)."""
    if not isinstance(value, int | float) or isinstance(value, bool):
        return False
    return value == 0 or LEAST <= abs(value) <= 1 / LEAST


def is_pair(value: object) -> bool:
    """Return whether this is a list of two (or, for a default, a tuple)."""
    return isinstance(value, list | tuple) and len(value) == 2


def is_point(value: Any) -> bool:
    """Return whether this is a pair of numbers."""
    return is_pair(value) and all(is_number(entry) for entry in value)


def _is_positive(value: Any) -> bool:
    return is_number(value) and bool(value > 0)


def _is_line(value: object) -> bool:
    return isinstance(value, str) and value.strip() != "" and value.isprintable()


def _are_texts(value: object) -> bool:
    return isinstance(value, list) and all(isinstance(entry, str) for entry in value)


def _are_lists_of_texts(value: object) -> bool:
    return isinstance(value, list) and all(_are_texts(row) for row in value)


def _are_numbers(value: object) -> bool:
    return isinstance(value, dict) and all(is_number(entry) for entry in value.values())
