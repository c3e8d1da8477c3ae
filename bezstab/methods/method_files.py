"""Methods in TOML files; configs/methods/README.md documents the format."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from bezstab.errors import InputError
from bezstab.files import read_toml
from bezstab.methods.algebraic_numbers import DIGITS
from bezstab.methods.multistep_methods import MOST_BDF_STEPS, adams_bashforth, adams_moulton, bdf, bezier
from bezstab.methods.recipes import recipe
from bezstab.methods.runge_kutta_methods import MEMBERS, explicit
from bezstab.methods.schemes import Coefficients, Family, LinearMultistep, Method, RungeKutta, Scheme
from bezstab.methods.square_roots import SQUARE_ROOT, RootSum, root_sum
from bezstab.toml_tables import TomlTable

EXAMPLE = "x0 + v0 + 1/2 a0"
EQUATIONS = f"a table of equations like x1 = {EXAMPLE!r}"
SHOWN = 40  # characters of what was given in place of an equation
LISTED = 200  # and of the keys that were given instead

MOST_STAGES = 40  # of a tableau: its exact P takes 3 s
MOST_STEPS = 100  # of a multistep method: its region takes 20 s

MOST_STEPS_COMPARED = 12  # as in the largest built-in member; the weights of n steps take n^3 exact operations


def read_method(path: Path) -> Method:
    """Return the method in a TOML file: rho and sigma, or A and b, as strings, or a table of equations.

    Numbers are exact; rationals good to 40 digits stand for square roots, and `digits` says so. Name and source are the
    file's, if given.
    Its family is the one that has a member with the same coefficients, whatever the file calls it, else None.
    Nothing in the file is executed. InputError, naming the file and the key, for anything else.
    """
    return read_toml("method file", path, lambda data: _parse_method(data, path))


def _parse_method(data: dict[str, Any], path: Path) -> Method:
    table = TomlTable(data)
    name = table.text("name", default=path.stem)
    source = table.text("source", default=str(path))
    scheme, irrational = _parse_scheme(table)
    return Method(name, scheme, source, family=_family_of(scheme), digits=DIGITS if irrational else None)


def _parse_scheme(table: TomlTable) -> tuple[Scheme, bool]:
    """Return the scheme by the table or whichever pair of keys the file has, and whether a number of it is irrational.

    InputError for every other key.
    """
    found = set(table.data) - {"name", "source"}
    if "update" in found and not {"rho", "sigma", "A", "b"} & found:
        equations = table.entry("update", lambda value: isinstance(value, dict), EQUATIONS)
        table.refuse_unknown_keys()
        texts = {result: _sum_text(result, text) for result, text in equations.items()}
        return recipe(texts), any(SQUARE_ROOT in text for text in texts.values())
    if {"rho", "sigma"} <= found and not {"A", "b"} & found:
        rho, sigma = table.exact_numbers("rho", root_sum), table.exact_numbers("sigma", root_sum)
        table.refuse_unknown_keys()
        _refuse_more_than(MOST_STEPS, len(rho) - 1, "steps")
        return LinearMultistep(_in_decimals(rho), _in_decimals(sigma)), _some_are_irrational(rho, sigma)
    if {"A", "b"} <= found and not {"rho", "sigma"} & found:
        tableau, weights = table.exact_rows("A", root_sum), table.exact_numbers("b", root_sum)
        table.refuse_unknown_keys()
        _refuse_more_than(MOST_STAGES, len(weights), "stages")
        scheme = RungeKutta(tuple(_in_decimals(row) for row in tableau), _in_decimals(weights))
        return scheme, _some_are_irrational(*tableau, weights)
    listed = ", ".join(sorted(found)) or "none"
    raise InputError(f"expected the keys rho and sigma, or A and b, or the table update, but found {listed[:LISTED]}")


def _in_decimals(numbers: Sequence[RootSum]) -> Coefficients:
    return tuple(number.in_decimals() for number in numbers)


def _some_are_irrational(*rows: Sequence[RootSum]) -> bool:
    return any(number.irrational for row in rows for number in row)


def _refuse_more_than(most: int, number: int, of_what: str) -> None:
    if number > most:
        raise InputError(f"{number} {of_what}: expected at most {most}")


def _sum_text(result: str, text: object) -> str:
    """Return the right-hand side of an equation, if it is a text."""
    if not isinstance(text, str):
        raise InputError(f"update: {result[:SHOWN]!r} = {repr(text)[:SHOWN]}: expected a text like {EXAMPLE!r}")
    return text


def _family_of(scheme: Scheme) -> Family | None:
    """Return the family with a member that has this very scheme: compared with those of as many steps or stages.

    B1 is AB1 and B2 is AB2: there Adams-Bashforth wins, under whose name everybody knows them. No result depends on
    it, as the members of fewer steps, with which either family would start, are the same too.
    """
    members: list[Method] = []
    match scheme:
        case LinearMultistep() if scheme.steps <= MOST_STEPS_COMPARED:
            members = [adams_bashforth(scheme.steps), bezier(scheme.steps), adams_moulton(scheme.steps + 1)]
            if scheme.steps <= MOST_BDF_STEPS:
                members.append(bdf(scheme.steps))
        case RungeKutta():
            members = [explicit(name) for name in MEMBERS]
    for member in members:
        if member.scheme == scheme:
            return member.family
    return None
