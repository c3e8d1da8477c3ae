"""The exact reading of numbers: texts, and floats as they are printed."""

from decimal import Decimal
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bezstab.errors import InputError
from bezstab.rationals import exact, rational, typed_number


@given(st.floats(allow_nan=False, allow_infinity=False))
def test_a_float_is_exactly_the_decimal_it_shows(x: float) -> None:
    assert exact(x) == Fraction(Decimal(repr(x)))
    assert float(exact(x)) == x


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("6/11", Fraction(6, 11)),
        ("-.5", Fraction(-1, 2)),
        ("+2.50E+1", Fraction(25)),
        ("0e-999", Fraction(0)),
        ("0." + "3" * 100, Fraction(int("3" * 100), 10**100)),
    ],
)
def test_a_number_is_read_exactly(text: str, value: Fraction) -> None:
    assert rational(text) == value


NO_NUMBERS = """
nan inf -1e999 1.1e308 1e-400 1e999999999 1/0 1/-2 1.0/2 --1 0x10 1_000 1j True pi 2**3 １ ½ −1 1e٣
"""


@pytest.mark.parametrize(
    "text", [*map(str, NO_NUMBERS.split()), "", "1 / 2", "1\n2", "1\0", "1" * 400, "1/" + "1" * 100_000]
)
def test_what_is_no_finite_number_of_ordinary_size_is_refused_in_one_line(text: str) -> None:
    with pytest.raises(InputError, match=r"\A.*\Z"):
        rational(text)


@given(st.text(alphabet="0123456789+-./eE_ naif٣", max_size=12))
def test_any_text_is_an_exact_number_or_refused(text: str) -> None:
    try:
        value = rational(text)
    except InputError:
        return
    assert value == Fraction(text.strip())
    assert value == 0 or 1e-307 <= abs(value) <= 1e308


def test_a_number_is_shown_as_it_would_be_typed() -> None:
    shown = [typed_number(Fraction(text)) for text in ("20", "0.002", "1/240", "-1/2", "1e-9", "0.1234567890123")]
    assert shown == ["20", "0.002", "1/240", "-0.5", "1e-09", "0.1234567890123"]
    assert typed_number(Fraction(0.1)) == "0.1"  # which float64 reads as that very number
