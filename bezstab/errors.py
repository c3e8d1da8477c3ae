"""The two kinds of bad news: a user's mistake, and numerical trouble."""

import difflib
from collections.abc import Iterable


class InputError(ValueError):
    """A user's mistake, said in one line that names what was given and what is accepted."""


class NumericalError(ArithmeticError):
    """A computation that broke down, said in one line that names when and where."""


def unknown_name(kind: str, name: str, known: Iterable[str]) -> InputError:
    """Return the error of a name that is neither known nor a TOML file's; it suggests the nearest, in any case."""
    names = {other.casefold(): other for other in known}
    near = names[difflib.get_close_matches(name.casefold(), names, n=1, cutoff=0)[0]]
    return InputError(
        f"unknown {kind} {name!r}: did you mean {near}? (names: {', '.join(names.values())}; or a .toml file)"
    )
