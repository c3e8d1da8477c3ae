"""The group of all commands: how they are listed, found and ended; what any words that are typed end in."""

import re
import shlex
from pathlib import Path

import click
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bezstab.cli.command_group import main
from bezstab.cli.removed import WENT
from tests.cli.running import run

NAMES = main.list_commands(click.Context(main))


def test_help_has_a_heading_for_each_group_and_a_whole_sentence_for_each_command() -> None:
    text = run("--help").stdout
    assert re.findall(r"^(\w+):$", text, re.MULTILINE) == ["Options", "Maps", "Choose", "Evidence", "Paper"]
    listed = re.findall(r"^  (\w+)  .*[A-Z].*[^.]\.$", text.partition("Maps:")[2], re.MULTILINE)
    assert listed == NAMES
    bare = run()
    assert (bare.exit_code, bare.stdout, bare.stderr) == (0, text, "")


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.slow
def test_the_example_in_the_help_runs(name: str) -> None:
    example = re.search(r"Example: bezstab ((?:[^\n]|\n  \S)*)", run(name, "--help").stdout)
    assert example
    needs_more = name == "probe"  # logs of the user's own
    Path("robot.xml").write_text("<mujoco/>", encoding="utf-8")
    less_to_do = "--time 0.5 --alpha 0.1 --beta 0.01 --repeats 1" if name == "tradeoff" else ""
    assert run(f"{example[1]} {less_to_do}").exit_code == (2 if needs_more else 0)


NUMBERS = ["0", "-0.1", "0.5", "1", "2", "1e-17", "-1e-30", "1e-300", "1e100", "1e300", "6/11", "nan", "1e999", "x"]
ENGINES = ["mujoco=0.02,1", "mujoco=0,0", "bullet=0.2", "box2d=60,-2", "drake=1e300,1", "ode=", "x=1", "mujoco"]
TYPED = {
    "poles": ["--alpha {}", "--beta {}", "--h {}", "--physical", "--all-poles"],
    "check": ["--alpha {}", "--beta {}", "--h {}", "--physical", "--omega {}", "--engine {}"],
    "engines": ["--alpha {}", "--beta {}", "--h {}", "--omega {}"],
    "methods": ["--latex"],
    "region --figure none --table none": ["--level {}", "--h {}", "--compare", "--engine {}"],
}
METHODS = ["B2", "AB4", "RK4@5", "SYM", "B4@1e-6", "RK1@1e300", "b4"]


@pytest.mark.slow
@settings(deadline=None)  # the first region takes its time
@given(st.data())
def test_whatever_is_typed_ends_in_an_answer_or_one_line(data: st.DataObject) -> None:
    command = data.draw(st.sampled_from(sorted(TYPED)))
    words = [command]
    for option in data.draw(st.lists(st.sampled_from(TYPED[command]), unique=True)):
        words.append(option.format(data.draw(st.sampled_from(ENGINES if "engine" in option else NUMBERS))))
    for method in data.draw(st.lists(st.sampled_from(METHODS), max_size=2)):
        words.append(method if command == "methods" else f"--method {method}")
    result = run(*words, data.draw(st.sampled_from(["", "--format json"])))
    assert result.exit_code in (0, 1, 2, 3)
    assert result.exit_code < 2 or result.stderr.count("\n") == 1  # beside an answer there may be notes


@pytest.mark.parametrize("name", WENT)
def test_what_was_removed_says_where_it_went(name: str) -> None:
    result = run(name)
    assert (result.exit_code, result.stdout) == (2, "")
    assert result.stderr == f"bezstab: `{name}`: {WENT[name]}\n"


def test_numerical_trouble_is_status_three_and_no_file(tmp_path: Path) -> None:
    result = run("region --method RK4 --alpha-range 0 1e100")
    assert (result.exit_code, result.stdout, result.stderr.count("\n")) == (3, "", 1)
    assert not list(tmp_path.iterdir())


def test_a_level_that_nothing_reaches_is_no_trouble() -> None:
    result = run("region --method B2 --level 1e-300 --figure none --table none")
    assert (result.exit_code, result.stderr) == (0, "")


EULER = 'A = [["0"]]\nb = ["1"]\n'


@pytest.mark.parametrize("name", ["\x1b[2J\x07", "line\nline", "\N{LINE SEPARATOR}", "a  b", "x" * 300])
def test_nothing_that_is_typed_or_read_commands_the_terminal(name: str) -> None:
    if len(name) < 255:
        Path(f"{name}.toml").write_text(EULER, encoding="utf-8")  # the method is called like its file
    for file in (f"{name}.toml", f"{name}/missing.toml"):
        result = run("poles --alpha 1 --beta 1 --method", shlex.quote(file))
        assert result.exit_code in (0, 2)
        assert result.stderr.count("\n") == (result.exit_code == 2)
        assert not {"\x1b", "\x07", "\u2028"} & set(result.output)
    wrote = run("region --quality fast --figure none --table csv -o", shlex.quote(name))
    assert wrote.exit_code == (2 if len(name) > 255 else 0)
    assert wrote.stderr.count("\n") == 1
    assert "\x1b" not in wrote.stderr
