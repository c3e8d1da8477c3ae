"""probe: logs as files and on standard input, and the words that it answers with."""

import json
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner
from numpy.typing import NDArray

from bezstab.cli import main
from bezstab.methods import REGISTRY, lookup
from bezstab.stability import FloatArray, poles
from tests.cli.running import rows, run
from tests.reference.sampled_responses import of_poles


def write(name: str, **columns: NDArray[np.floating[Any]]) -> None:
    np.savetxt(name, np.stack(list(columns.values()), axis=1), "%.9g", ",", header=",".join(columns), comments="")


def response(name: str, alpha_hat: float, beta_hat: float, count: int = 300) -> FloatArray:
    return 1e-3 * of_poles(poles(lookup(name), alpha_hat, beta_hat), count, seed=2)


def test_a_row_for_each_fit_and_for_each_method_in_order() -> None:
    write("log.csv", t=np.arange(300) / 240, c_1=response("B4", 0.5, 0.1), c_2=response("AB4", 0.4, 0.1))
    write("zero.csv", t=np.arange(300) / 240, c_1=np.zeros(300), c_2=np.zeros(300))
    answer = rows("probe log.csv --minus zero.csv --alpha 1/2 --beta 0.1 --h 1/240 --turning 0")
    fits = [row for row in answer if row["samples"] is not None]
    assert [row["column"] for row in fits] == ["c_1", "c_2"]
    assert fits[0]["z_abs"] == pytest.approx(abs(poles(lookup("B4"), 0.5, 0.1)[0]), abs=1e-6)
    for column, true in (("c_1", "B4"), ("c_2", None)):
        methods: list[dict[str, Any]] = [row for row in answer if row["column"] == column and row["method"] is not None]
        assert [row["distance"] for row in methods] == sorted(row["distance"] for row in methods)
        assert len(methods) == len(REGISTRY)  # of what does not fit people see the nearest, programs all
        assert [row["method"] for row in methods if row["fits"]] == ([true] if true else [])


def test_standard_input_is_read_for_a_dash_and_columns_are_fitted_jointly_if_asked_for() -> None:
    c = response("B4", 0.5, 0.1)
    text = "\n".join(f"{value:.9g}" for value in c)
    (row,) = json.loads(CliRunner().invoke(main, ["probe", "-", "--format", "json"], input=text).stdout)
    assert row["column"] == "1"
    assert row["z_abs"] == pytest.approx(abs(poles(lookup("B4"), 0.5, 0.1)[0]), abs=1e-6)
    write("log.csv", c_1=c, c_2=-0.1 * c)
    assert rows("probe log.csv --jointly")[0]["column"] == "c_1, c_2"


def test_what_tells_no_pole_or_fits_nothing_is_status_three_with_its_reason() -> None:
    """One column that fits is a success."""
    clean = response("B4", 0.5, 0.1)
    noisy = clean + 1e-5 * np.random.default_rng(1).normal(size=clean.size)
    write("log.csv", noisy=noisy, rounded=np.round(clean, 5))
    point = "--beta 0.1 --h 0.001 --turning 0"
    result = run("probe log.csv --alpha 0.5", point, "--format json")
    assert (result.exit_code, [row["z_abs"] for row in json.loads(result.stdout)]) == (3, [None, None])
    assert "no pole can be told: noisy: " in result.stderr
    assert "rounded: rounded to 1e-05" in result.stderr
    write("log.csv", noisy=noisy, clean=clean)
    assert [row["z_abs"] is None for row in rows("probe log.csv")] == [True, False]
    wrong = run("probe log.csv --alpha 0.3 --column clean", point)
    assert (wrong.exit_code, wrong.stderr) == (3, "bezstab: nothing fits clean\n")
    assert "nothing fits at (0.3, 0.1)" in wrong.stdout
    assert run("probe log.csv --alpha 0.5", point).exit_code == 0


def critically_damped(order: int, count: int = 60) -> FloatArray:
    """Return an error that a Runge-Kutta method of its own order steps at alpha_hat = 2, beta_hat = 1: mu = -1 twice.

    So that of the polynomial R it has R(-1)^k and k R'(-1) R(-1)^(k-1), where c = 1 and c' = 0 in the beginning.
    """
    series = np.array([1, 1, 1 / 2, 1 / 6, 1 / 24][: order + 1])
    z, slope = (np.polynomial.polynomial.polyval(-1.0, each) for each in (series, series[1:] * np.arange(1, order + 1)))
    k = np.arange(count)
    return np.asarray(1e-3 * (z**k + k * slope * z ** (k - 1.0)))


@pytest.mark.filterwarnings("error")
def test_where_poles_meet_what_fits_only_for_that_is_no_answer() -> None:
    """Two poles of AM6 nearly meet there: a motion may move them further than methods differ."""
    write("rk4.csv", t=np.arange(60) / 100, c=critically_damped(4))
    found = {row["method"]: row for row in rows("probe rk4.csv --alpha 2 --beta 1 --h 0.01") if row["method"]}
    assert [name for name, row in found.items() if row["told"]] == ["RK4"]
    assert found["am6"]["fits"]
    assert (
        "not told, as a motion may move their poles by more than methods differ"
        in run("probe rk4.csv --alpha 2 --beta 1 --h 0.01").stdout
    )
    beside = run("probe rk4.csv --alpha 2.002 --beta 1 --h 0.01")
    assert (beside.exit_code, beside.stderr) == (3, "bezstab: no method can be told by c\n")
    assert "cannot be told: only" in beside.stdout
    write("rk2.csv", t=np.arange(60) / 100, c=critically_damped(2))
    said = run("probe rk2.csv --alpha 2 --beta 1 --h 0.01").stdout
    assert "behaves like RK2 at (2, 1)" in said  # AB2 and B2 have this pole too, but not as their dominant one


def test_an_absolute_value_is_to_be_logged_with_its_sign() -> None:
    k = np.arange(100)
    c = 1e-3 * 0.9**k * np.cos(0.7 * k)
    write("abs.csv", c=np.abs(c))
    result = run("probe abs.csv")
    assert result.exit_code == 3
    assert "log the signed error" in result.stderr
    write("signed.csv", c=c)
    assert "signed" not in run("probe signed.csv").output
