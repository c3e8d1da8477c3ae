"""The two kinds of bad news: a user's mistake, and numerical trouble.

ValueError
 └── InputError          something given cannot be; exit status 2 on the command line
ArithmeticError
 └── NumericalError      something computed broke down; exit status 3
"""

import difflib
from collections.abc import Iterable

LONGEST_SHOWN = 60  # characters of a value


class InputError(ValueError):
    """A user's mistake: one line that names what was given, its value and what is accepted.

    Names that do not exist, values out of range, TOML files that are not as documented and methods that cannot be
    (inconsistent, unstable already at h = 0) all end here.
    """


class NumericalError(ArithmeticError):
    """Numerical trouble: one line that says when and where a computation broke down.

    The input was acceptable. A run that blows up raises nothing: its trajectory ends early and says when and why.
    """


def check_kind(value: object, kind: type, made_by: str) -> None:
    """Raise InputError unless a value is of a kind, which `made_by` makes."""
    if not isinstance(value, kind):
        raise InputError(f"{shown(value)}: expected a {kind.__name__}, as {made_by} makes it")


def shown(value: object) -> str:
    """Return a value as a message can have it: on one line, and not longer than is read."""
    text = " ".join(repr(value).split())
    return text if len(text) <= LONGEST_SHOWN else f"{text[:LONGEST_SHOWN]}..."


def unknown_name(kind: str, name: str, known: Iterable[str], file: str = "; or a .toml file") -> InputError:
    """Return the error of a name that is neither known nor, unless `file` is empty, a TOML file's.

    It suggests the nearest, in any case, if that is like it: a method's name is no misspelt scene.
    """
    by_folded_name = {other.casefold(): other for other in known}
    near = difflib.get_close_matches(name.casefold(), by_folded_name, n=1)
    suggestion = f": did you mean {by_folded_name[near[0]]}?" if near else ""
    listed = ", ".join(by_folded_name.values())
    return InputError(f"unknown {kind} {name!r}{suggestion} (names: {listed}{file})")
