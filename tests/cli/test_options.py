"""What is typed becomes what is meant, or one line that names the option."""

from dataclasses import dataclass
from fractions import Fraction

import click
import pytest
from click.testing import CliRunner

from bezstab.cli.options import NUMBER, POSITIVE, SECONDS, ParsedType, gathered


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


@dataclass(frozen=True)
class Place:
    """Two options that belong together."""

    across: Fraction
    up: Fraction


def test_options_that_belong_together_arrive_as_one_value() -> None:
    options = [click.option(name, type=NUMBER, default="1") for name in ("--across", "--up")]

    @click.command()
    @gathered(Place, "place", *options)
    @click.option("--other", default="no")
    def move(place: Place, other: str) -> None:
        click.echo(f"{place.across} {place.up} {other}")

    assert CliRunner().invoke(move, ["--up", "1/2", "--other", "yes"]).stdout == "1 1/2 yes\n"
