"""Tables of TOML files, entry by entry checked: what is wrong is said with its place, key, value and what is expected.

Nothing is ever executed: an entry is a text, a number, an exact number written as a text, or a list or table of them.
"""

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any, TypeVar

from bezstab.errors import InputError

Point = tuple[float, float]

LEAST = 1e-100  # of a number that is not 0, and of the inverse of the largest: so their squares are within float64
LISTED = 200  # characters of the keys that are there, where one is missing
SIZE = "0 or of size 1e-100 to 1e100"

Kind = TypeVar("Kind")
Read = TypeVar("Read")
"""What a reader makes of an entry; a reader raises ValueError for what it does not take."""


def a_number(value: object) -> float:
    """Return a number, not a truth value, that is 0 or of size 1e-100 to 1e100 (so not nan)."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise ValueError
    if value != 0 and not LEAST <= abs(value) <= 1 / LEAST:
        raise ValueError
    return float(value)


def a_positive_number(value: object) -> float:
    """Return such a number above 0."""
    found = a_number(value)
    if found <= 0:
        raise ValueError
    return found


def of_type(kind: type[Kind], value: object) -> Kind:
    """Return a value of that type."""
    if not isinstance(value, kind):
        raise ValueError
    return value


def a_line(value: object) -> str:
    """Return one line of text that is not blank."""
    text = of_type(str, value)
    if not text.strip() or not text.isprintable():
        raise ValueError
    return text


def list_of(read: Callable[[Any], Read]) -> Callable[[object], list[Read]]:
    """Return the reader of a list, each entry of which `read` reads."""
    return lambda value: [read(entry) for entry in of_type(list, value)]


def pair_of(read: Callable[[Any], Read]) -> Callable[[object], tuple[Read, Read]]:
    """Return the reader of a list of two."""

    def read_pair(value: object) -> tuple[Read, Read]:
        first, second = list_of(read)(value)
        return first, second

    return read_pair


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

    def entry(self, key: str, read: Callable[[Any], Read], expected: str, default: Read | None = None) -> Read:
        """Return what `read` makes of the entry, or `default` if there is none; `expected` says what it takes."""
        self.known.append(key)
        if key not in self.data:
            if default is not None:
                return default
            found = ", ".join(self.data)[:LISTED] or "nothing"  # a misspelt key is missing under its right name
            raise self.mistake(f"{key} is missing: found {found}")
        try:
            return read(self.data[key])
        except InputError as error:  # whose words are better
            raise self.mistake(f"{key}: {error}") from None
        except ValueError:
            raise self.mistake(f"{key} = {self.data[key]!r}: expected {expected}") from None

    def text(self, key: str, default: str | None = None) -> str:
        """Return one line of text that is not blank."""
        return self.entry(key, a_line, "one line of text", default)

    def texts(self, key: str) -> list[str]:
        """Return a list of texts."""
        return self.entry(key, list_of(partial(of_type, str)), "a list of names")

    def number(self, key: str, default: float | None = None) -> float:
        """Return a number that is 0 or of size 1e-100 to 1e100."""
        return self.entry(key, a_number, f"a number, {SIZE}", default)

    def positive_number(self, key: str, default: float | None = None) -> float:
        """Return a number from 1e-100 to 1e100."""
        return self.entry(key, a_positive_number, "a positive number, 1e-100 to 1e100", default)

    def point(self, key: str, default: Point | None = None) -> Point:
        """Return a pair of numbers."""
        return self.entry(key, pair_of(a_number), f"two numbers, {SIZE}", default)

    def numbers(self, key: str, allowed: Sequence[str]) -> dict[str, float]:
        """Return a table of numbers, none if absent, with keys among the allowed ones."""

        def read(value: object) -> dict[str, float]:
            return {name: a_number(number) for name, number in of_type(dict, value).items()}

        found: dict[str, float] = self.entry(key, read, f"a table of numbers, {SIZE}", {})
        for name in found:
            if name not in allowed:
                raise self.mistake(f"{key} names {name!r}, which is not among {', '.join(allowed)}")
        return found

    def tables(self, key: str) -> list["TomlTable"]:
        """Return an array of tables, none if absent."""
        entries: list[object] = self.entry(key, partial(of_type, list), "an array of tables", [])
        tables = [TomlTable(entry, f"{key} {number}") for number, entry in enumerate(entries, start=1)]
        self.inner += tables
        return tables

    def table(self, key: str) -> "TomlTable":
        """Return a table, an empty one if absent."""
        table = TomlTable(self.entry(key, partial(of_type, dict), "a table", {}), key)
        self.inner.append(table)
        return table

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
