import json
import sys
from pathlib import Path

import numpy as np
import pytest

from tests.cli.running import DATA, arrays, rows, run

NOTHING = "--figure none --table none"


def test_simulate_writes_the_history_that_its_row_sums_up(tmp_path: Path) -> None:
    (row,) = rows("simulate --time 0.05 --perturb 1e-4 --table npz")
    assert sorted(path.suffix for path in tmp_path.iterdir()) == [".npz", ".png"]
    history = arrays(tmp_path / "simulate_slider_crank_B4.npz")
    assert history["t"][-1] == pytest.approx(0.05)
    assert history["c_1"][0] == pytest.approx(1e-4, rel=1e-2)  # to first order in the perturbation
    assert row["c_max"] == pytest.approx(max(np.abs(history[f"c_{i}"]).max() for i in range(1, 5)))
    assert {"crank.theta", "d/dt slider.x", "cdot_4", "lambda_1", "energy"} <= set(history)


def test_a_run_without_any_error_is_drawn_without_a_warning() -> None:
    result = run(f"simulate --time 0.01 --scene {DATA / 'plumb.toml'}")
    assert "largest |c| is 0.0e+00" in result.stdout
    assert result.stderr == "wrote simulate_plumb_B4.png\n"


def test_a_run_that_fails_is_status_three_with_its_time_and_keeps_the_history(tmp_path: Path) -> None:
    result = run("simulate --alpha 1.7 --beta 0.8 --time 1 --table csv --format json")
    assert result.exit_code == 3
    assert "blow-up" in json.loads(result.stdout)[0]["remark"]
    assert "at t = 0.1" in result.stderr.splitlines()[-1]
    assert sorted(path.suffix for path in tmp_path.iterdir()) == [".csv", ".png"]


@pytest.mark.parametrize(
    ("options", "compiled"), [("gauss4", False), ("SYM", True), ("SYM --stabilise projection", False)]
)
def test_a_run_that_is_not_compiled_though_that_was_asked_for_says_so(options: str, compiled: bool) -> None:
    said = run(f"simulate --scene pendulum --time 0.01 --figure none --compiled yes --method {options}")
    assert ("this run was not compiled: only runs of explicit methods" in said.stderr) is not compiled


def test_simulate_says_where_it_goes_through_singular_configurations() -> None:
    result = run("simulate --scene slider_crank_equal", NOTHING, "--format json --time 4")
    assert result.exit_code == 0
    assert "2 singular configurations, at t = 0.772, " in result.stderr


@pytest.mark.slow
def test_tradeoff_writes_a_table_without_times_and_two_figures_and_the_same_again(tmp_path: Path) -> None:
    point = "--alpha 0.1 --beta 0.01 --repeats 1"
    command = f"tradeoff --scene pendulum --method SYM --method AB4 --h 0.01 --h 0.02 --time 0.1 {point} --workers"
    found = rows(command, "2")
    written = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    name = "tradeoff_pendulum"
    assert set(written) == {f"{name}.csv", f"{name}_trajectory.png", f"{name}_constraint.png"}
    header, *table = written[f"{name}.csv"].decode().splitlines()
    assert "second" not in header
    assert len(table) == len(found) == 4
    assert all(float(str(row["seconds"])) > 0 for row in found)
    assert run(command, "1").exit_code == 0
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == written


MAP = "verify --scene pendulum --method SYM --map 3 --figure none"


def test_without_joblib_one_process_draws_a_map_and_what_needs_it_is_refused_in_a_line(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    assert run(MAP, "--workers 1").exit_code == 0
    (table,) = tmp_path.iterdir()
    written = table.read_bytes()
    table.unlink()
    monkeypatch.setitem(sys.modules, "joblib", None)
    assert run(MAP).exit_code == 0
    assert [path.read_bytes() for path in tmp_path.iterdir()] == [written]
    for more in ("--workers 2", "--scheduler tcp://127.0.0.1:1", "--resume"):
        refused = run(MAP, more)
        assert refused.exit_code == 2
        assert refused.stderr == (
            "bezstab: --workers, --scheduler and --resume need an optional package: pip install 'bezstab[parallel]'\n"
        )


@pytest.mark.parametrize("command", ["simulate", "paper"])
def test_without_numba_compiled_runs_are_refused_in_a_line(command: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "numba", None)
    refused = run(command, "--compiled yes")
    assert refused.exit_code == 2
    assert refused.stderr == "bezstab: compiled runs need an optional package: pip install 'bezstab[fast]'\n"


def test_what_is_thrown_apart_at_once_diverges_and_seconds_are_understood() -> None:
    at = "verify --scene pendulum --method RK4"
    (gone,) = rows(at, "--alpha 14217 --beta 16544")  # |z| = 1.7e15: nothing stays finite
    assert (gone["z_abs"], gone["verdict"], gone["agreeing"]) == (None, "diverges", True)
    # alpha = 400 1/s and beta = 500 1/s: alpha_hat = 2 alpha h, beta_hat = (beta h)^2
    (in_seconds,) = rows(at, "--alpha 400 --beta 500 --h 0.001 --physical")
    assert (in_seconds["alpha_hat"], in_seconds["beta_hat"]) == (0.8, 0.25)
    assert in_seconds["floquet_z_abs"] is None  # nothing exact is computed unless it is asked for
