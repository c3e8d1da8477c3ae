"""Help lists options in groups, and fits two screens."""

import re

import click
import pytest
from click.testing import CliRunner

from bezstab.cli.command_group import main
from bezstab.show.tables import shown_width

SCREENS = 50
"""Lines of help, at 80 columns."""
WIDTH = 78
"""Of help in such a terminal and in wider ones: click leaves two columns free, but not in its runner of tests."""


def test_options_stand_below_their_headings_in_the_order_in_which_they_are_written() -> None:
    listed = CliRunner().invoke(main, ["engines", "--help"]).output.partition("What is asked:")[2]
    words = [line.split()[0] for line in listed.splitlines() if re.match("  -|O", line)]
    assert words == ["--alpha", "--beta", "--h", "--omega", "Output:", "--format", "-h,"]


@pytest.mark.parametrize("command", main.list_commands(click.Context(main)))
def test_help_fits_two_screens_its_example_a_line_and_every_option_is_explained(command: str) -> None:
    lines = CliRunner().invoke(main, [command, "--help"], terminal_width=WIDTH).output.splitlines()
    assert len(lines) <= SCREENS
    assert max(map(shown_width, lines)) <= WIDTH
    (place,) = [place for place, line in enumerate(lines) if line.startswith(f"  Example: bezstab {command}")]
    assert not lines[place + 1]  # an example that is broken into two lines does not work as typed
    for option in getattr(main.get_command(click.Context(main), command), "params", []):
        assert not isinstance(option, click.Option) or option.help, option.opts
