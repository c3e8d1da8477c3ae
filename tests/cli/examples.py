"""Examples of every command: what holds of all of them is tested on these."""

import json
import shlex
from pathlib import Path
from typing import Any

import pytest

from tests.cli.running import run

SMALL = "--figure none --table none"
DATA = Path(__file__).parent / "data"
LOG = (
    f"probe {shlex.quote(str(DATA / 'pendulum.csv'))}"  # an error of symplectic Euler's at alpha_hat 2/3, beta_hat 1/4
)

EXAMPLES: dict[str, list[str]] = {
    "poles": ["poles --alpha 0.5 --beta 0.1", "poles --alpha 1 --beta 2 --method SYM --all-poles"],
    "region": [f"region --method SYM --method bdf3 {SMALL}", f"region --method SYM --method bdf3 --accuracy {SMALL}"],
    "methods": ["methods", "methods SYM RK4@5"],
    "family": ["family bezier --from 2 --to 3 --figure none"],
    "choose": ["choose --engine mujoco --h 0.002"],
    "check": ["check --method SYM --alpha 2 --beta 2 --h 0.01"],
    "lint": [f"lint {shlex.quote(str(DATA / 'two_joints.xml'))}"],
    "probe": [
        f"{LOG} --alpha 2/3 --beta 1/4 --method SYM --method RK4",
        f"{LOG} --method SYM --h 1/120",
    ],
    "chains": ["chains --engine bullet=0.2 --h 1/60 --to 3 --figure none"],
    "engines": ["engines", "engines --alpha 1 --beta 0.2 --h 0.002"],
    "simulate": [f"simulate --scene pendulum --method SYM --time 0.02 {SMALL}"],
    "verify": [
        "verify --scene pendulum --method SYM --points 3",
        "verify --scene pendulum --method RK2 --alpha 2 --beta 2",
    ],
    "tradeoff": [
        f"tradeoff --scene pendulum --method SYM --h 0.01 --h 0.02 --time 0.1 {SMALL}",
        f"tradeoff --predicted --method SYM --level 0.9 --h 0.01 --omega 2 {SMALL}",
    ],
    "extremes": ["extremes --short"],
    "paper": ["paper --only fig7 --figure none"],
}
"""Of every command that prints rows; together they print every kind of row."""

LONG = {
    "poles": ["poles --alpha 0.5 --beta 0.1 --scene driven_four_bar --h 0.005"],
    "region": [f"region --method SYM --scene driven_four_bar --h 0.01 {SMALL}"],
    "choose": ["choose --method SYM --h 0.01 --scene driven_four_bar", "choose --method SYM --method RK1 --h 0.01"],
    "check": [
        "check --method SYM --method RK2 --alpha 2 --beta 2",
        "check --method SYM --alpha 2 --beta 100 --physical --h-min 0.00917 --h-max 1/60",
        "check --engine mujoco=0.02,1 --h 0.002",
        "check --engine bullet=0.2 --h 1/60 --chain 3 --mass-ratio 10",
        "check --pd 1000,80,0.1 --h 1/240",
        "check --pd 200,5,0.1 --h 0.002 --every 4 --late 1",
        "check --method SYM --alpha 1 --beta 0.5 --h 0.01 --scene driven_four_bar",
    ],
    "verify": [
        f"verify --scene pendulum --method SYM --map 3 {SMALL}",
        "verify --witness mujoco",
        "verify --scene driven_four_bar --h 0.01 --alpha 0.5 --beta 0.1 --floquet",
        "verify --scene driven_four_bar --h 0.01 --method SYM --accuracy",
    ],
}
"""More of them, which take longer."""

SLOW_COMMANDS = ("extremes", "family", "paper", "tradeoff", "verify")
WITHOUT_ROWS = {"explore", "schema"}
"""Commands that open a window, or print a schema."""


def each_example(long: bool = True) -> list[Any]:
    """Return every example as a parameter of a test, those that take long marked as slow; or none of LONG."""
    quick = [
        pytest.param(text, marks=[pytest.mark.slow] if name in SLOW_COMMANDS else [], id=text)
        for name, texts in EXAMPLES.items()
        for text in texts
    ]
    of_long = [text for texts in LONG.values() for text in texts] if long else []
    return quick + [pytest.param(text, marks=pytest.mark.slow, id=text) for text in of_long]


def printed_rows(text: str) -> list[dict[str, Any]]:
    """Return the rows of an example; a choice that is not safe ends with status one."""
    result = run(*shlex.split(text), "--format", "json")
    assert result.exit_code in (0, 1), result.stderr
    assert result.exception is None or isinstance(result.exception, SystemExit)
    rows: list[dict[str, Any]] = json.loads(result.stdout)
    return rows
