"""Methods in TOML files, own ones and built-in ones; configs/methods/README.md documents the format."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from fractions import Fraction
from functools import cache, partial
from pathlib import Path
from typing import Any

from bezstab.errors import InputError, shown
from bezstab.files import read_toml
from bezstab.methods.algebraic_numbers import DIGITS
from bezstab.methods.schemes import LinearMultistep, Method, MethodGroup, RungeKutta, Scheme
from bezstab.rationals import rational
from bezstab.toml_tables import TomlTable, list_of, of_type

EXAMPLE = "x0 + v0 + 1/2 a0"
EQUATIONS = f"a table of equations like x1 = {EXAMPLE!r}"
RATIONAL_STRINGS = 'a list of whole numbers and rational strings like "175/108"'

LARGEST = Fraction(10**50)  # of a coefficient: float64 holds the squares of quotients
MOST_STAGES = 20  # of a tableau: its exact P takes seconds
MOST_STEPS = 100  # of a multistep method: its region takes 20 s


def read_method(path: Path) -> Method:
    """Return the method in a TOML file: rho and sigma, or A and b, as strings, or a table of equations.

    Numbers are exact; rationals good to 40 digits stand for square roots, and `digits` says so. Name and source are the
    file's, if given. Nothing in the file is executed. InputError, naming the file and the key, for anything else.
    """
    return read_toml("method file", path, lambda data: _parse_method(data, path.stem, str(path)))


def built_in_group(
    key: str, heading: str, note: str = "", others: Mapping[str, Callable[[], Method]] | None = None
) -> MethodGroup:
    """Return the methods that a table of built_in.toml has, and others."""
    methods = {name: partial(_built_in, name, **table) for name, table in _built_in_tables()[key].items()}
    return MethodGroup(heading, {**methods, **(others or {})}, note)


@cache
def _built_in_tables() -> dict[str, Any]:
    return read_toml("methods", Path(__file__).with_name("built_in.toml"), dict)


def _built_in(name: str, digits: int | None = None, **data: Any) -> Method:
    return replace(_parse_method(data, name), digits=digits)


def _parse_method(data: dict[str, Any], name: str, source: str = "") -> Method:
    table = TomlTable(data)
    name, source = table.text("name", default=name), table.text("source", default=source)
    coefficients = {key: value for key, value in data.items() if key not in ("name", "source")}
    digits = DIGITS if "sqrt" in str(coefficients) else None
    return Method(name, _parse_scheme(table, sorted(coefficients)), source, digits=digits)


def _parse_scheme(table: TomlTable, keys: list[str]) -> Scheme:
    """Return the scheme by the table or the pair of keys that the file has; InputError for other keys."""

    def coefficient(value: object) -> Fraction:
        number = _number(str(value) if type(value) is int else of_type(str, value))  # not bool, an int, too
        if number and not 1 / LARGEST <= abs(number) <= LARGEST:
            raise InputError(f"{shown(value)}: expected 0 or a size of 1e-50 to 1e50")
        return number

    row = list_of(coefficient)
    match keys:
        case ["update"]:
            equations = table.entry("update", partial(of_type, dict), EQUATIONS)
            for result, text in equations.items():
                if not isinstance(text, str):
                    raise InputError(f"update: {shown(result)} = {shown(text)}: expected a text like {EXAMPLE!r}")
            from bezstab.methods.recipes import recipe  # loads sympy

            return recipe(equations)
        case ["rho", "sigma"]:
            rho, sigma = (tuple(table.entry(key, row, RATIONAL_STRINGS)) for key in keys)
            _refuse_more_than(MOST_STEPS, len(rho) - 1, "steps")
            return LinearMultistep(rho, sigma)
        case ["A", "b"]:
            tableau = table.entry("A", list_of(row), f"a list of rows, each {RATIONAL_STRINGS}")
            weights = table.entry("b", row, RATIONAL_STRINGS)
            _refuse_more_than(MOST_STAGES, len(weights), "stages")
            return RungeKutta(tuple(map(tuple, tableau)), tuple(weights))
    found = shown(", ".join(keys) or "none")[1:-1]
    raise InputError(f"expected the keys rho and sigma, or A and b, or the table update, but found {found}")


def _number(text: str) -> Fraction:
    try:
        return rational(text)
    except InputError:
        from bezstab.methods.recipes import exact_number  # loads sympy

        return exact_number(text)


def _refuse_more_than(most: int, number: int, of_what: str) -> None:
    if number > most:
        raise InputError(f"{number} {of_what}: expected at most {most}")
