import csv
import io
import os
import re
import shlex
import signal
import subprocess
import time
from pathlib import Path

import click
import pytest
from click.testing import CliRunner
from hypothesis import given, settings
from hypothesis import strategies as st

from bezstab.cli import main
from tests.cli.examples import each_example
from tests.cli.running import interruptible, run

CONTEXT = click.Context(main)
NAMES = main.list_commands(CONTEXT)


def test_help_has_a_heading_for_each_group_and_a_whole_sentence_for_each_command() -> None:
    text = CliRunner().invoke(main, ["--help"], terminal_width=80).stdout
    sections = dict(re.findall(r"^(\w+):\n((?:  .+\n)+)", text, re.MULTILINE))
    assert list(sections) == ["Options", "Maps", "Choose", "Evidence", "Programs", "Paper"]
    listed = [line.split(maxsplit=1) for title in list(sections)[1:] for line in sections[title].splitlines()]
    assert [name for name, _ in listed] == NAMES
    for _, sentence in listed:
        assert sentence[0].isupper()
        assert sentence.endswith(".")
        assert not sentence.endswith("...")


def test_without_a_command_there_is_help() -> None:
    bare, asked = run(), run("--help")
    assert (bare.exit_code, bare.stdout, bare.stderr) == (0, asked.stdout, "")


def test_an_extension_is_found_by_name_and_an_unknown_command_is_not() -> None:
    assert run("paper", "--help").exit_code == 0
    assert main.get_command(CONTEXT, "foo") is None


@pytest.mark.parametrize(
    ("command", "named"),
    [
        ("choose --method B4", "--h"),
        ("choose --h 0.001 --goal quick", "--goal"),
        ("choose --h 0.001 --spread 1", "--spread"),
        ("choose --h 0.001 --h-max 0.0001", "--h-max"),
        ("choose --h 0.001 --h-max 0.01 --goal fastest", "--h-max"),
        ("choose --h 0.001 --goal gentle", "--settle"),
        ("choose --method B4 --h 0.001 --goal gentle --settle 0.005", "--settle"),
        ("choose --h 0.001", "--method SYM"),
        ("check --alpha 1 --beta 1", "--method SYM"),
        ("check --alpha 1 --beta 1 --physical", "--method SYM"),
        ("check --alpha 1 --beta 1 --physical --method SYM --speed 2", "--speed"),
        ("check --alpha 1 --beta 1 --physical --method SYM --hold", "--h"),
        ("check --alpha 1 --physical --method SYM", "--beta"),
        ("choose --engine box2d --h 0.01 --h-max 0.02", "--h-max"),
        ("choose --engine box2d --h 0.01 --goal critical", "box2d"),
        ("check --alpha 1", "--beta"),
        ("check --engine mujoco=0.02,1", "--h"),
        ("check --engine mujoco=0.02 --h 0.002", "solref[1]"),
        ("check --engine havok=1 --h 0.002", "mujoco"),
        ("check --engine mujoco=a,b --h 0.002", "mujoco=solref[0],solref[1]"),
        ("check --engine bullet=0.2 --h 0.002 --method B4", "SYM"),
        ("check --engine pinocchio=100,20 --h 0.002", "--method"),
        ("check --engine mujoco=0.02,1 --pd 1,1,1 --h 0.002", "--pd"),
        ("check --as-typed --alpha 1 --beta 1", "--as-typed"),
        ("check --pd 1,1 --h 0.002", "kp,kd,inertia"),
        ("check --pd 1,x,1 --h 0.002", "kp,kd,inertia"),
        ("check --pd 1,1,0 --h 0.002", "inertia"),
        ("check --pd 1,1,1", "--h"),
        ("poles --pd 1,1,1 --h 0.1 --alpha 1", "--alpha"),
        ("choose --engine mujoco --pd 1,1,1 --h 0.002", "--pd"),
        ("choose --engine rbdl --h 0.002", "--method"),
        ("check --engine bullet=0.2 --alpha 1 --h 0.002 --method SYM", "--alpha"),
        ("choose --engine bullet --h 0.002 --keep alpha=beta", "bullet"),
        ("region --engine mujoco", "--h"),
        ("engines --alpha 1", "--beta"),
        ("family bezier --from 5 --to 4", "--from 5 --to 4"),
        ("family adams-bashforth --to 9", "--to 9"),
        ("family bezier --from 0", "--from"),
        ("family gauss", "gauss"),
        ("paper --only fig10", "--only"),
        ("paper -o file/below", "file/below"),
        ("simulate --scene pendulm", "did you mean pendulum"),
        ("simulate --scene missing.toml", "missing.toml"),
        ("simulate --h 0", "--h"),
        ("simulate --time 1e-9", "--time"),
        ("simulate --time 1e9", "--time"),
        ("simulate --start late", "--start"),
        ("simulate --perturb 1e300", "start"),
        ("probe", "LOG"),
        ("probe missing.csv", "missing.csv"),
        ("probe file", "file: is empty"),
        ("probe file --minus file --alpha 1", "--beta"),
        ("probe file --alpha 1 --beta 1 --physical", "--h"),
        ("probe file --every 0", "--every"),
        ("probe file --turning -1", "--turning"),
        ("verify --scene pendulm", "did you mean pendulum"),
        ("verify --alpha 1", "--beta"),
        ("verify --alpha 1 --beta 1 --points 3", "--points"),
        ("verify --map 8 --points 3", "--map"),
        ("verify --map 1", "--map"),
        ("verify --witness mujoco --points 3", "--witness"),
        ("verify --witness mujoco --scene pendulum", "revolute"),
        ("verify --witness ode", "--witness"),
        ("verify --points 0", "--points"),
        ("verify --map 4 -o file/below", "file/below"),
        ("verify --map 4 --workers 0", "--workers"),
        ("verify --map 4 --scheduler nonsense://x", "--scheduler nonsense://x"),
        ("tradeoff --scene pendulm", "did you mean pendulum"),
        ("tradeoff --alpha 1", "--beta"),
        ("tradeoff --physical", "--physical"),
        ("tradeoff --time 0.01", "--time"),
        ("tradeoff --time 1e9", "--time"),
        ("tradeoff --h 0", "--h"),
        ("tradeoff --tolerance 0", "--tolerance"),
        ("tradeoff --repeats 0", "--repeats"),
        ("tradeoff --time 0.1 -o file/below", "file/below"),
        ("region --quality best", "--quality"),
        ("region --alpha-range 0 1e307", "--alpha-range"),
        ("poles --alpha nan --beta 1", "--alpha"),
        ("poles --alpha 1 --beta inf", "--beta"),
        ("poles --alpha 1e999 --beta 1", "--alpha"),
        ("poles --alpha 1/0 --beta 1", "--alpha"),
        ("poles --alpha 1", "--beta"),
        ("poles --alpha 1 --beta 1 --physical", "--h"),
        ("poles --alpha 1 --beta 1 --h 0.1", "--physical"),
        ("poles --alpha 1 --beta 1 --h -1 --physical", "--h"),
        ("poles --alpha 1 --beta 1 --method B99", "did you mean B9"),
        ("poles --alpha 1 --beta 1 --method missing.toml", "missing.toml"),
        ("poles --alpha 1 --beta 1 --method RK4@0", "RK4@0"),
        ("poles --alpha 1 --beta 1 --format yaml", "--format"),
        ("poles --alpha 1 --beta 1 --frmat csv", "--frmat"),
        ("region --grid -5", "--grid"),
        ("region --grid 1000000", "--grid"),
        ("region --grid 1.5", "--grid"),
        ("region --alpha-range 1 0", "--alpha-range"),
        ("region --beta-range 1 1", "--beta-range"),
        ("region --beta-range 1 1.00000000000000000000001", "--beta-range"),
        ("region --level 2", "--level"),
        ("region --level 0", "--level"),
        ("region --compare --level 0.5 --level 0.7", "--level"),
        ("region -o file/below", "file/below"),
        ("region --figure jpg", "--figure"),
        ("region --h 1e300", "--h"),
        ("methods B99", "B99"),
        ("methods RK1@1e300", "RK1@1e300"),
        ("methods RK4@1e-300", "RK4@1e-300"),
        ("check --alpha 1 --beta 1e300 --h 1 --physical", "β̂"),
        ("check --engine mujoco=1e-200,1 --h 1 --as-typed", "mujoco"),
        ("choose --h 0.1 --h-max 1e300", "--h-max"),
        ("choose --h 0.1 --goal gentle --settle 1e-300", "--settle"),
        ("foo", "foo"),
    ],
)
@pytest.mark.slow_except("check", "choose", "poles", "verify --witness")
def test_a_mistake_takes_one_line_status_two_and_no_file(command: str, named: str, tmp_path: Path) -> None:
    Path("file").touch()
    result = run(*shlex.split(command))
    assert result.exit_code == 2
    assert result.stdout == ""
    assert result.stderr.count("\n") == 1
    assert named in result.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["file"]


NUMBERS = ["0", "-0.1", "0.5", "1", "2", "1e-17", "-1e-30", "1e-300", "1e100", "1e300", "6/11", "nan", "1e999", "x"]
STEPS = ["1e-100", "0.001", "1", "1e100", "0", "1e300"]
TYPED: dict[str, dict[str, list[str] | None]] = {
    "poles": {
        "--alpha": NUMBERS,
        "--beta": NUMBERS,
        "--h": STEPS,
        "--physical": None,
        "--all-poles": None,
        "--omega": NUMBERS,
    },
    "check": {
        "--alpha": NUMBERS,
        "--beta": NUMBERS,
        "--h": STEPS,
        "--physical": None,
        "--omega": NUMBERS,
        "--engine": ["mujoco=0.02,1", "mujoco=0,0", "bullet=0.2", "box2d=60,-2", "drake=1e300,1", "ode=", "x=1"],
    },
    "engines": {"--alpha": NUMBERS, "--beta": NUMBERS, "--h": STEPS},
    "methods": {"--latex": None},
    "region --figure none --table none": {"--level": NUMBERS, "--h": STEPS, "--compare": None, "--engine": ["mujoco"]},
}


@pytest.mark.slow
@settings(deadline=None)  # the first region takes its time
@given(st.data())
def test_whatever_is_typed_ends_in_an_answer_or_one_line(data: st.DataObject) -> None:
    command = data.draw(st.sampled_from(sorted(TYPED)))
    options = TYPED[command]
    words = command.split()
    for name in data.draw(st.lists(st.sampled_from(sorted(options)), unique=True)):
        words += [name, *(data.draw(st.sampled_from(option)) for option in [options[name]] if option)]
    named = data.draw(
        st.lists(st.sampled_from(["B2", "AB4", "RK4@5", "SYM", "B4@1e-6", "RK1@1e300", "b4"]), max_size=2)
    )
    words += [word for name in named for word in (["--method", name] if command != "methods" else [name])]
    result = run(*words, "--format", data.draw(st.sampled_from(["text", "json"])))
    assert isinstance(result.exception, SystemExit | None)
    assert result.exit_code in (0, 1, 2, 3)
    assert result.stderr.count("\n") == (result.exit_code > 1)


def test_numerical_trouble_is_status_three(tmp_path: Path) -> None:
    result = run("region", "--method", "RK4", "--alpha-range", "0", "1e100")
    assert result.exit_code == 3
    assert result.stderr.count("\n") == 1
    assert not list(tmp_path.iterdir())


@pytest.mark.usefixtures("_few_extremes")
@pytest.mark.parametrize("example", each_example(long=False))
@pytest.mark.slow
def test_every_command_prints_a_table_for_programs_and_one_for_people(example: str) -> None:
    table, page = (run(*shlex.split(example), "--format", form) for form in ("csv", "markdown"))
    assert table.exit_code == page.exit_code
    assert len(list(csv.DictReader(io.StringIO(table.stdout)))) >= 1
    assert re.search(r"^\|[-| ]+\|$", page.stdout, re.MULTILINE)


LONG_EXAMPLES = {"tradeoff", "family", "choose", "verify", "region"}


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=[pytest.mark.slow] if name in LONG_EXAMPLES else [])
        for name in NAMES
        if name != "extremes"  # which takes minutes; its short form is among the golden outputs
    ],
)
def test_the_example_in_the_help_runs(name: str) -> None:
    shown = run(name, "--help").stdout
    example = re.search(r"Example: bezstab ((?:[^\n]|\n  \S)*)", shown)
    assert example, shown
    needs_more = name in ("explore", "probe")  # a screen, and logs of the user's own
    if name == "lint":
        pytest.importorskip("mujoco")
        Path("robot.xml").write_text("<mujoco/>", encoding="utf-8")
    assert run(*shlex.split(example[1])).exit_code == (2 if needs_more else 0)


def test_every_option_explains_itself() -> None:
    for name in NAMES:
        command = main.get_command(CONTEXT, name)
        assert command
        for option in command.params:
            assert not isinstance(option, click.Option) or option.help, (name, option.opts)


@pytest.mark.parametrize("command", ["engines", "check --method SYM --alpha 3 --beta 3"])
@pytest.mark.slow_except("engines")
def test_a_closed_pipe_is_no_error_to_read_and_no_verdict(command: str) -> None:
    """1 would say that fault was found, as it is here by `check`; 141 is what a shell says of SIGPIPE."""
    with subprocess.Popen(interruptible(*command.split()), stdout=subprocess.PIPE, stderr=subprocess.PIPE) as source:
        assert source.stdout
        assert source.stderr
        source.stdout.close()
        assert source.stderr.read() == b""
    assert source.returncode == 141


@pytest.mark.parametrize(
    ("command", "seconds"),
    [
        pytest.param("region --grid 4000 --method B12", 5, marks=pytest.mark.slow),
        ("simulate --time 10000 --compiled no", 2),
        pytest.param("simulate --time 100000 --method RK4 --compiled yes", 5, marks=pytest.mark.slow),
        pytest.param("verify --points 1000 --method B12", 5, marks=pytest.mark.slow),
    ],
)
def test_an_interrupt_stops_cleanly(command: str, seconds: float, tmp_path: Path) -> None:
    running = subprocess.Popen(
        interruptible(*command.split()), stdout=subprocess.PIPE, stderr=subprocess.PIPE, cwd=tmp_path
    )
    time.sleep(seconds)  # until then it has begun to compute
    assert running.poll() is None
    os.kill(running.pid, signal.SIGINT)
    _, errors = running.communicate(timeout=60)
    assert running.returncode == 130
    assert errors.decode().split() == ["bezstab:", "interrupted"]
    assert not list(tmp_path.iterdir())
