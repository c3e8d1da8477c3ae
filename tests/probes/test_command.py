"""probe: logs as files and on standard input, and the words that it answers with."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner
from numpy.typing import NDArray

from bezstab.cli.command_group import main
from bezstab.methods.registry import lookup
from bezstab.probes.answer import MOST_USED
from bezstab.stability.arrays import FloatArray
from bezstab.stability.closed_loop import poles
from tests.cli.running import rows, run
from tests.reference.sampled_responses import of_poles


def write(name: str, **columns: NDArray[np.floating[Any]]) -> None:
    np.savetxt(name, np.stack(list(columns.values()), axis=1), "%.9g", ",", header=",".join(columns))


def response(name: str, alpha_hat: float, beta_hat: float, count: int = 300) -> FloatArray:
    return 1e-3 * of_poles(poles(lookup(name), alpha_hat, beta_hat), count, seed=2)


def test_a_row_for_each_column_and_for_each_method_in_order_from_a_file_or_standard_input() -> None:
    write("log.csv", t=np.arange(300) / 240, c_1=response("B4", 0.5, 0.1), c_2=response("AB4", 0.4, 0.1))
    write("zero.csv", t=np.arange(300) / 240, c_1=np.zeros(300), c_2=np.zeros(300))
    answer = rows("probe log.csv --minus zero.csv --alpha 1/2 --beta 0.1 --h 1/240 --turning 0 --method B4")
    fits = [row for row in answer if row["uncertainty"] is not None]
    assert [row["column"] for row in fits] == ["c_1", "c_2"]
    assert fits[0]["z_abs"] == pytest.approx(abs(poles(lookup("B4"), 0.5, 0.1)[0]), abs=1e-6)
    assert [(row["column"], row["method"]) for row in answer if row["fits"]] == [("c_1", "B4")]
    for column in ("c_1", "c_2"):
        distances: list[Any] = [row["distance"] for row in answer if row["column"] == column and row["method"]]
        assert distances == sorted(distances)
        assert len(distances) == 1 + len(MOST_USED)
    text = Path("log.csv").read_text(encoding="utf-8")
    of_dash = CliRunner().invoke(main, ["probe", "-", "--minus", "zero.csv", "--format", "json"], input=text).stdout
    assert [row["z_abs"] for row in json.loads(of_dash)] == [row["z_abs"] for row in fits]


def test_what_tells_no_pole_or_has_no_method_is_status_three_with_its_reason() -> None:
    """One column with an answer is a success."""
    clean = response("B4", 0.5, 0.1)
    noisy = clean + 1e-5 * np.random.default_rng(1).normal(size=clean.size)
    write("log.csv", noisy=noisy, rounded=np.round(clean, 5))
    point = "--beta 0.1 --h 0.001 --turning 0 --method B4"
    result = run("probe log.csv --alpha 0.5", point, "--format json")
    assert (result.exit_code, [row["z_abs"] for row in json.loads(result.stdout)]) == (3, [None, None])
    assert result.stderr.count("log more digits, or kick harder") == 2
    write("log.csv", noisy=noisy, clean=clean)
    assert [row["z_abs"] is None for row in rows("probe log.csv")] == [True, False]
    wrong = run("probe log.csv --alpha 0.3 --column clean", point)
    assert (wrong.exit_code, wrong.stderr) == (
        3,
        "bezstab: clean: |z_p| = 0.775814 ± 3e-05; none of these methods has this pole there.\n",
    )
    assert run("probe log.csv --alpha 0.5", point).exit_code == 0


def test_there_is_no_answer_where_more_is_allowed_than_methods_differ_by() -> None:
    write("log.csv", c=response("SYM", 0.05, 0.001))
    write("zero.csv", c=np.zeros(300))
    asked = "probe log.csv --minus zero.csv --alpha 0.05 --beta 0.001 --h 0.01 --method SYM --method B4 --turning"
    fast, at_rest = run(asked, "30"), run(asked, "0")
    assert (fast.exit_code, at_rest.exit_code) == (3, 0)
    assert "more is allowed (0.1) than methods differ by" in fast.stderr
    assert "the pole of SYM at α̂ = 0.05, β̂ = 0.001" in at_rest.stdout


def test_a_point_is_given_for_each_method_or_it_is_said_that_there_is_none() -> None:
    write("log.csv", c=response("SYM", 0.5, 0.25))
    (_, point, other) = rows("probe log.csv --method SYM --method RK4 --h 0.01")
    assert (point["alpha_hat"], point["beta_hat"]) == pytest.approx((0.5, 0.25), abs=1e-6)
    assert point["beta"] == pytest.approx(50, abs=1e-4)
    assert other["method"] == "RK4"
    write("real.csv", c=1e-3 * 0.5 ** np.arange(40.0))
    none = run("probe real.csv --method SYM")
    assert (none.exit_code, "it gives no α and β" in none.stderr) == (3, True)
