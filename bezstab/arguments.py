"""Arguments of functions in Python: numbers read exactly, and mistakes told in the names of keywords."""

import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from fractions import Fraction
from typing import Any

import numpy as np

from bezstab.errors import InputError, shown
from bezstab.rationals import rational
from bezstab.units import to_dimensionless

Number = int | float | str | Fraction
"""A number that is read exactly: a float as the decimal it shows, a text as a decimal or a fraction such as "6/11"."""


@contextmanager
def in_keywords() -> Iterator[None]:
    """Turn the options that an InputError names (--h-max) into the keywords of a function (h_max)."""
    try:
        yield
    except InputError as error:
        raise InputError(re.sub(r"--([a-z]+(?:-[a-z]+)*)", _keyword, str(error))) from None


def _keyword(option: re.Match[str]) -> str:
    """Return the keyword for what an option is about."""
    return {"time": "duration", "filter": "filter_seconds"}.get(option[1], option[1].replace("-", "_"))


def exact_number(value: Number, name: str) -> Fraction:
    """Return one number exactly as it is written, a float as the decimal it shows; InputError for what is none."""
    if isinstance(value, np.ndarray | np.generic) and value.ndim == 0 and not isinstance(value, np.ma.MaskedArray):
        value = value.item()
    if isinstance(value, bool) or not isinstance(value, int | float | str | Fraction):
        raise InputError(f"{name} = {shown(value)}: expected one real number")
    try:
        return rational(str(value))
    except ValueError as error:  # InputError, and what Python says of whole numbers with thousands of digits
        raise InputError(f"{name}: {error}") from None


def exact_or_none(value: Number | None, name: str) -> Fraction | None:
    """Return the same of a number that may be missing."""
    return None if value is None else exact_number(value, name)


def whole_number(value: int, name: str) -> int:
    """Return a whole number; InputError for what is none."""
    if isinstance(value, bool) or not isinstance(value, int):
        raise InputError(f"{name} = {shown(value)}: expected a whole number")
    return value


def real_number(value: Number, name: str) -> float:
    """Return one number as float64; errors as `exact_number`."""
    return float(exact_number(value, name))


def plane_point(
    alpha_hat: Any,
    beta_hat: Any,
    alpha: Any,
    beta: Any,
    h: Number | None,
    *,
    read: Callable[[Any, str], Any] = exact_number,
    needed: bool = True,
) -> Any:
    """Return (alpha_hat, beta_hat) from whichever two were given, alpha and beta in 1/s with the step h in s.

    Numbers are exact, unless they are `read` else. InputError if anything else is given. Where nothing is: InputError
    if a point is `needed`, else None.
    """
    all_four = {"alpha_hat": alpha_hat, "beta_hat": beta_hat, "alpha": alpha, "beta": beta}
    given = {name: value for name, value in all_four.items() if value is not None}
    if not given and not needed:
        return None
    if given.keys() not in ({"alpha_hat", "beta_hat"}, {"alpha", "beta"}):
        expected = "alpha_hat= and beta_hat=, or as alpha= and beta= in 1/s with h= in s"
        raise InputError(f"a point is given as {expected}, not as {', '.join(given) or 'nothing'}")
    first, second = (read(value, name) for name, value in given.items())
    if "alpha_hat" in given:
        return first, second
    if h is None:
        raise InputError("alpha and beta in 1/s need the step h in s")
    return to_dimensionless(first, second, exact_number(h, "h"))
