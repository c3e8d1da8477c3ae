"""What a cell of a table shows where it takes more than a format."""

import math
from collections.abc import Callable, Sequence

from bezstab.show.fields import formatted

MOST_FIXED = 1e6  # a modulus from here on is shown with an exponent


def pole_words(pole: complex) -> str:
    """Return a pole and its conjugate, or a real one: 0.762694 ± 0.142074i."""
    form = ".6f" if max(abs(pole.real), pole.imag) < MOST_FIXED else ".6e"
    visible = round(pole.imag / max(1, abs(pole.real)), 6) != 0
    return f"{pole.real:{form}} ± {pole.imag:{form}}i" if visible else f"{pole.real:{form}}"


def modulus_words(modulus: float) -> str:
    """Return |z|: six decimals, or an exponent where it is huge."""
    return formatted(modulus, ".6e" if abs(modulus) >= MOST_FIXED else ".6f")


def up_to(form: str, without: str) -> Callable[[float], str]:
    """Return the form of a number that is infinite where there is no limit."""
    return lambda number: without if math.isinf(number) else formatted(number, form)


def between(form: str, without: str) -> Callable[[Sequence[float]], str]:
    """Return the form of a pair of ends: 0.2 to 1.65."""
    end = up_to(form, without)
    return lambda ends: f"{end(ends[0])} to {end(ends[1])}"
