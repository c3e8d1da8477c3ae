"""What is typed becomes what is meant, or one line that names the option."""

from fractions import Fraction

import click
import pytest

from bezstab.cli.options import ENGINE_VALUES, METHOD, NUMBER, POSITIVE, SECONDS, ParsedType, both_or_none


@pytest.mark.parametrize(
    ("kind", "text", "meant"),
    [
        (NUMBER, "-0.1", Fraction(-1, 10)),
        (NUMBER, "6/11", Fraction(6, 11)),
        (POSITIVE, "1e-3", Fraction(1, 1000)),
        (SECONDS, "1/240", Fraction(1, 240)),
    ],
)
def test_numbers_are_read_exactly(kind: ParsedType, text: str, meant: Fraction) -> None:
    assert kind.convert(text, None, None) == meant


@pytest.mark.parametrize(
    ("kind", "text"),
    [(NUMBER, "pi"), (NUMBER, "nan"), (POSITIVE, "0"), (POSITIVE, "-1"), (SECONDS, "1e-200"), (SECONDS, "1e200")],
)
def test_what_is_no_such_number_is_refused(kind: ParsedType, text: str) -> None:
    with pytest.raises(click.BadParameter):
        kind.convert(text, None, None)


def test_a_method_is_found_by_its_name() -> None:
    assert METHOD.convert("RK4@5", None, None).step_multiple == 5
    with pytest.raises(click.BadParameter, match="unknown method"):
        METHOD.convert("RK44", None, None)


def test_an_engine_comes_with_values_of_its_parameters() -> None:
    engine, values = ENGINE_VALUES.convert("mujoco=0.02,1", None, None)
    assert (engine.name, values) == ("mujoco", (Fraction(1, 50), Fraction(1)))
    for text in ("mujoco", "mujoco=a,b", "unity=1"):
        with pytest.raises(click.BadParameter):
            ENGINE_VALUES.convert(text, None, None)


def test_a_point_is_two_numbers_or_none() -> None:
    assert both_or_none(None, None) is None
    assert both_or_none(Fraction(1), Fraction(2)) == (Fraction(1), Fraction(2))
    for alpha, beta in ((Fraction(1), None), (None, Fraction(1))):
        with pytest.raises(click.UsageError, match="go together"):
            both_or_none(alpha, beta)
