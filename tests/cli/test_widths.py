"""No line of text is wider than the terminal: for every command, at 80 and 120 columns."""

import os
import pty
import shlex
import subprocess
import sys

import click
import pytest
from click.testing import CliRunner

from bezstab.cli import main
from bezstab.show import shown_width
from tests.cli.examples import each_example
from tests.cli.running import run


def text_of(command: str, columns: str) -> str:
    """Return what a command prints as text where COLUMNS is set; "" unsets it."""
    result = CliRunner(env={"COLUMNS": columns}).invoke(main, shlex.split(command))
    assert result.exit_code in (0, 1), result.stderr
    assert result.exception is None or isinstance(result.exception, SystemExit)
    return result.stdout


@pytest.mark.promise("Text on a terminal", computed="no line is wider, at 80 and 120 columns, for every command")
@pytest.mark.usefixtures("_few_extremes")
@pytest.mark.parametrize("columns", [80, pytest.param(120, marks=pytest.mark.slow)])
@pytest.mark.parametrize("example", each_example())
def test_no_line_is_wider_than_the_terminal(example: str, columns: int) -> None:
    lines = text_of(example, str(columns)).splitlines()
    assert lines
    assert max(map(shown_width, lines)) <= columns


def test_help_wraps_at_80_columns() -> None:
    for name in ("", *main.list_commands(click.Context(main))):
        for columns in ("80", "200"):
            lines = text_of(f"{name} --help", columns).splitlines()
            assert max(map(shown_width, lines)) <= 80, name


def test_only_a_path_is_wider() -> None:
    path = "directory/" * 12 + "missing.toml"
    text = text_of("engines", "40")
    assert max(map(shown_width, text.splitlines())) <= 40
    result = CliRunner(env={"COLUMNS": "40"}).invoke(main, ["poles", "--alpha", "1", "--beta", "1", "--method", path])
    assert result.exit_code == 2
    assert path in result.stderr  # a message is one line, for programs to read


@pytest.mark.parametrize("columns", ["", "0", "-1", "wide", "1000"])
def test_without_a_width_several_rows_are_a_table_and_one_row_is_a_block(columns: str) -> None:
    several = text_of("poles --alpha 0.5 --beta 0.1", columns).splitlines()
    assert several[2].split() == ["method", "pole", "z", "|z|", "∠z", "(deg)", "verdict", "error", "×", "least"]
    assert len(several) == 2 + 1 + 8 + 2  # the last line says what errors are shares of
    single = text_of("poles --alpha 0.5 --beta 0.1 --method B4", columns).splitlines()
    assert single[2] == "Safe. Each step multiplies the error by 0.78."
    assert single[4].split() == ["method", "B4"]


def test_a_terminal_that_says_how_wide_it_is_is_believed() -> None:
    """On a real terminal of 60 columns, without COLUMNS: what goes to a pipe is wider."""
    ours, theirs = pty.openpty()
    import fcntl
    import struct
    import termios

    fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("HHHH", 24, 60, 0, 0))
    environment = {key: value for key, value in os.environ.items() if key != "COLUMNS"}
    command = [sys.executable, "-m", "bezstab", "engines", "--alpha", "1", "--beta", "0.2"]
    subprocess.run(command, stdout=theirs, stderr=subprocess.PIPE, env=environment, check=True)
    os.close(theirs)
    shown = b""
    while chunk := _read(ours):
        shown += chunk
    lines = shown.decode().splitlines()
    assert 40 < max(map(shown_width, lines)) <= 60
    assert max(map(shown_width, text_of("engines --alpha 1 --beta 0.2", "").splitlines())) > 200


def _read(terminal: int) -> bytes:
    try:
        return os.read(terminal, 4096)
    except OSError:  # what a terminal says whose other end is closed
        return b""


@pytest.mark.parametrize(
    ("command", "first"),
    [
        pytest.param(
            "check --method B4 --h 0.001 --alpha 432.215 --beta 523.205 --physical",
            "Safe. Each step multiplies the error by 0.65. The step may grow to 1.56 ms, α 1.32-fold, β 1.62-fold.",
            marks=pytest.mark.slow,
        ),
        ("check --method SYM --alpha 2 --beta 2", "Not safe. Each step multiplies the error by 2.4."),
        ("check --method SYM --alpha 1 --beta 2", "Not safe. The error neither shrinks nor grows."),
        (
            "check --method trapezoid --alpha 1 --beta 1 --h 0.01",
            "Safe. Each step multiplies the error by 0.65. The step, α and β may grow without limit.",
        ),
        ("region --method SYM --figure none --table none", "SYM is stable in a region of area 4; the least |z_p| is"),
        ("methods SYM", "SYM is explicit, of order 1, with 1 evaluation in each step."),
        ("simulate --scene pendulum --time 0.02 --figure none --table none", "B4 went through to 20 ms;"),
        ("verify --scene pendulum --method SYM --alpha 1 --beta 0.5", "Predicted |z| 0.500000, measured 0.500000:"),
        ("verify --scene pendulum --method RK2 --alpha 2 --beta 2", "Not measurable: "),
    ],
)
def test_one_row_is_a_block_below_a_sentence(command: str, first: str) -> None:
    lines = text_of(command, "200").splitlines()
    assert lines[0].startswith(first)
    assert lines[0].endswith(".")
    assert lines[1] == ""


def test_the_answer_of_check_comes_before_what_to_take_instead() -> None:
    text = run("check", "--method", "SYM", "--alpha", "2", "--beta", "2").stdout
    given, instead = text.split("What `choose` gives instead:")
    assert given.startswith("Not safe.")
    assert instead.strip().startswith("Safe.")
