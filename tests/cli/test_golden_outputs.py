"""The commands of the README print the numbers that they once printed, each under its key.

golden/outputs.json holds exit status, rows and written files of each command, without processor times, which no two
runs share. Keys are those of today; what rows have got since is not there.
"""

import json
import re
from pathlib import Path
from typing import Any

import pytest

from tests.cli.running import run

GOLDEN: list[dict[str, Any]] = json.loads((Path(__file__).parent / "golden" / "outputs.json").read_text("utf-8"))
SLOW = ("tradeoff", "region --compare")


TOLERANCES: list[tuple[str, str, float, float]] = [
    # simulated, then fitted: libm and BLAS differ between machines, by less than fits are off what is predicted
    ("verify", "z_.*", 1e-6, 1e-5),
    # an unstable run: what a libm's last bit does at its start, 1e-15 m, has grown 1.0014^10000 = 1.6e6 times
    ("simulate --method AB4 --alpha 0.5 --beta 0.101", "c_max|cdot_max|energy_drift", 1e-3, 0.0),
    # simulated: libm differs between machines, and 1e-13 (SI) is rounding over a run of thousands of steps
    ("simulate|tradeoff", "c_max|cdot_max|least_pivot|trajectory_error", 1e-6, 1e-13),
    # the difference of two energies of some 10 J, each rounded
    ("simulate|tradeoff", "energy_drift", 1e-6, 1e-10),
    # the logarithm of a ratio of simulated errors
    ("tradeoff", "order", 1e-6, 1e-5),
    # the goal accurate: where an error is least it is flat, so that its place is known to the root of rounding
    ("choose --method (RK4|B4 --method SYM)", "alpha.*|beta.*|worst|h_.*|.*error|z_(real|imag|abs)", 1e-5, 1e-7),
    # many choices are double poles, which split by the root of rounding, 1e-8
    ("choose|check", "z_.*", 1e-9, 1e-7),
    # float64 arithmetic on numbers of order one
    ("", ".*", 1e-9, 1e-12),
]
"""Of commands and keys, relative and absolute; the first that fits both."""


def assert_agrees(command: str, key: str, printed: Any, expected: Any) -> None:
    """Fail unless a value is as before: numbers within their tolerance, everything else exactly."""
    if isinstance(expected, list):
        for ours, theirs in zip(printed, expected, strict=True):
            assert_agrees(command, key, ours, theirs)
    elif isinstance(expected, float):
        relative, absolute = next(
            bounds for of, keys, *bounds in TOLERANCES if re.match(of, command) and re.fullmatch(keys, key)
        )
        assert printed == pytest.approx(expected, rel=relative, abs=absolute), key
    else:
        assert printed == expected, key


@pytest.mark.parametrize(
    "golden",
    [
        pytest.param(each, marks=pytest.mark.slow if each["command"].startswith(SLOW) else (), id=each["command"])
        for each in GOLDEN
    ],
)
def test_a_command_prints_what_it_printed_before(golden: dict[str, Any], tmp_path: Path) -> None:
    command = golden["command"]
    result = run(command, "--format json")
    assert result.exit_code == golden["status"], result.stderr
    printed = json.loads(result.stdout)
    if command == "methods":  # which lists more methods since
        known = {row["method"] for row in golden["rows"]}
        printed = [row for row in printed if row["method"] in known]
    assert len(printed) == len(golden["rows"])
    assert len({tuple(row) for row in printed}) <= 1  # every row has the same keys
    for row, expected in zip(printed, golden["rows"], strict=True):
        assert set(expected) <= set(row)
        for key, value in expected.items():
            assert_agrees(command, key, row[key], value)
    assert sorted(path.name for path in tmp_path.iterdir()) == golden["files"]
