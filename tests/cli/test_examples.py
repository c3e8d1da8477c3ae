"""What holds of every command that prints rows: its keys, their values, its forms and the width of its lines."""

import csv
import io
import json
import re

import click
import pytest

from bezstab.cli.command_group import main
from bezstab.show.tables import shown_width
from tests.cli.running import DATA, run
from tests.show.keys_page import COLUMNS

SMALL = "--figure none --table none"
WITHOUT_ROWS = {"paper", "chain", "drive", "lint", "steps"}
"""The paper's command writes tables; the rows of chain, drive, lint and steps are held by tests of their folders."""

EXAMPLES = (
    "poles --alpha 0.5 --beta 0.1",
    "poles --alpha 1 --beta 2 --method SYM --all-poles",
    "poles --alpha 0.5 --beta 0.1 --scene driven_four_bar --h 0.005",
    f"region --method SYM --method bdf3 {SMALL}",
    f"region --method SYM --method bdf3 --accuracy {SMALL}",
    f"region --method SYM --scene driven_four_bar --h 0.01 {SMALL}",
    "methods",
    "methods SYM RK4@5",
    "choose --engine mujoco --h 0.002",
    "choose --method SYM --h 0.01 --scene driven_four_bar",
    "choose --method SYM --method RK1 --h 0.01",
    "check --method SYM --alpha 2 --beta 2",
    "check --method SYM --method RK2 --alpha 2 --beta 2",
    "check --engine mujoco=0.02,1 --h 0.002",
    "choose --engine bullet --h 1/60",
    "check --method SYM --alpha 1 --beta 0.5 --h 0.01 --scene driven_four_bar",
    "probe pendulum.csv --alpha 1/3 --beta 1/16 --method SYM --method RK4",
    "probe pendulum.csv --method SYM --h 1/240",
    "engines",
    "engines --alpha 1 --beta 0.2 --h 0.002",
    "engines bullet box2d",
    f"simulate --scene pendulum --method SYM --time 0.02 {SMALL}",
    "verify --scene pendulum --method SYM --points 3",
    "verify --scene pendulum --method RK2 --alpha 2 --beta 2",
    f"verify --scene pendulum --method SYM --map 3 --workers 1 {SMALL}",
    "verify --scene driven_four_bar --h 0.01 --alpha 0.5 --beta 0.1 --floquet",
    f"tradeoff --scene pendulum --method SYM --h 0.01 --h 0.02 --time 0.1 --workers 1 {SMALL}",
    "tradeoff --predicted --method SYM --level 0.9 --h 0.01 --omega 2 --table none",
)
"""Together they print every kind of row."""
QUICK = ("poles --alpha 1", "check --method SYM --alpha 2 --beta 2", "probe", "engines", "simulate")


def printed(example: str, *form: str) -> str:
    """Return what an example prints; a choice that is not safe ends with status one."""
    result = run(example, *form)
    assert result.exit_code in (0, 1), result.stderr
    return result.stdout


def test_every_command_that_prints_rows_has_an_example() -> None:
    names = set(main.list_commands(click.Context(main))) - WITHOUT_ROWS
    assert names == {example.split()[0] for example in EXAMPLES}


@pytest.mark.parametrize(
    "example",
    [pytest.param(each, marks=() if each.startswith(QUICK) else pytest.mark.slow) for each in EXAMPLES],
)
def test_an_example_keeps_to_its_keys_and_the_width_of_the_terminal(
    example: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(DATA)
    rows = json.loads(printed(example, "--format json"))
    (keys,) = {tuple(row) for row in rows}
    assert set(keys) <= {column.key for columns in COLUMNS[example.split(maxsplit=1)[0]] for column in columns}
    if example.startswith(QUICK):
        assert next(csv.reader(io.StringIO(printed(example, "--format csv")))) == list(keys)
        assert re.search(r"^\|[-| ]+\|$", printed(example, "--format markdown"), re.MULTILINE)
    for columns in (80, 120):
        monkeypatch.setenv("COLUMNS", str(columns))
        assert max(map(shown_width, printed(example).splitlines())) <= columns
