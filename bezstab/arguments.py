"""Arguments of functions in Python: numbers read exactly, and mistakes told in the names of keywords."""

import re
from collections.abc import Iterator
from contextlib import contextmanager
from fractions import Fraction

import numpy as np

from bezstab.errors import InputError, shown
from bezstab.rationals import rational

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


def whole_number(value: int, name: str) -> int:
    """Return a whole number; InputError for what is none."""
    if isinstance(value, bool) or not isinstance(value, int):
        raise InputError(f"{name} = {shown(value)}: expected a whole number")
    return value


def real_number(value: Number, name: str) -> float:
    """Return one number as float64; errors as `exact_number`."""
    return float(exact_number(value, name))
