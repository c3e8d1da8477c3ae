"""Help lists options in groups, and fits one screen."""

import click
import pytest
from click.testing import CliRunner

from bezstab.cli.command_group import main
from bezstab.cli.grouped_help import GroupedCommand, grouped

ONE_SCREEN = 40
"""Lines of help, at 80 columns."""


@click.command(cls=GroupedCommand)
@grouped("First", click.option("--b", help="Of b."), click.option("--a", help="Of a."))
@grouped("Second", click.option("--c"))
def example(a: str, b: str, c: str) -> None:
    """Say what was typed."""
    click.echo(f"{a} {b} {c}")


def test_options_stand_below_their_headings_in_the_order_in_which_they_are_written() -> None:
    listed = CliRunner().invoke(example, ["--help"], terminal_width=80).output.partition("\n\n  Say")[2]
    words = [line.split()[0] for line in listed.splitlines()[2:] if line]
    assert words == ["First:", "--b", "--a", "Second:", "--c", "--help"]


def test_grouped_options_are_given_as_any_other() -> None:
    assert CliRunner().invoke(example, ["--c", "3", "--a", "1", "--b", "2"]).output == "1 2 3\n"


@pytest.mark.parametrize("command", ["engines", "methods", "drive", "chain", "steps", "lint", "paper"])
def test_help_fits_one_screen(command: str) -> None:
    lines = CliRunner().invoke(main, [command, "--help"], terminal_width=80).output.splitlines()
    assert len(lines) <= ONE_SCREEN
    assert max(map(len, lines)) <= 80
    (place,) = [place for place, line in enumerate(lines) if line.startswith(f"  Example: bezstab {command}")]
    assert not lines[place + 1]  # an example that is broken into two lines does not work as typed
