"""What else methods are called, and what to say where a name means several of them or none: names.toml.

A name that means one method is an alias. One that people use for methods that differ in what the feedback sees, or for
one that is not built in, is answered with a short list and the one difference that matters.
"""

import re
from collections.abc import Iterable
from difflib import get_close_matches
from pathlib import Path

from bezstab.errors import InputError
from bezstab.files import read_toml

NAMES: dict[str, dict[str, str]] = read_toml("names of methods", Path(__file__).with_name("names.toml"), dict)

LETTERS = str.maketrans({"α": "alpha", "β": "beta", "γ": "gamma", "θ": "theta", "ρ": "rho", "é": "e", "ö": "oe"})
SIMILARITY = 0.75  # of a misspelt name: one letter wrong in four


def folded(name: str) -> str:
    """Return a name as it is compared: in lower case, without - and _ and spaces, with the names of Greek letters."""
    return re.sub(r"[-_\s]", "", name.lower().translate(LETTERS))


ALIASES = {folded(name): method for method, names in NAMES["same"].items() for name in names.split()}
ADVICE = {
    folded(name): answer.format_map(NAMES["words"])
    for answer, names in NAMES["answers"].items()
    for name in names.split()
}


def unknown_method(name: str, known: Iterable[str]) -> InputError:
    """Return the error of a name that is no method's: advice where there is some, else the nearest name."""
    if folded(name) in ADVICE:
        return InputError(f"method {name!r}: {ADVICE[folded(name)]}")
    said = {other: f"{other}: {answer}" for other, answer in ADVICE.items()}
    said |= {alias: f"{alias} ({method})" for alias, method in ALIASES.items()}
    said |= {folded(each): each for each in known}
    near = get_close_matches(folded(name).partition("(")[0], said, n=1, cutoff=SIMILARITY)
    suggestion = f": did you mean {said[near[0]]}?" if near else ""
    return InputError(f"unknown method {name!r}{suggestion} (`bezstab methods` lists all; or give a .toml file)")
