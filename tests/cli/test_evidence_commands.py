import csv
import io
import json
from pathlib import Path

import numpy as np
import pytest

from tests.cli.running import arrays, rows, run


def test_simulate_writes_history_and_figure(tmp_path: Path) -> None:
    (row,) = rows("simulate", "--time", "0.05", "--perturb", "1e-4", "--table", "npz")
    assert {path.name for path in tmp_path.iterdir()} == {
        "simulate_slider_crank_B4.npz",
        "simulate_slider_crank_B4.png",
    }
    history = arrays(tmp_path / "simulate_slider_crank_B4.npz")
    assert history["t"][-1] == pytest.approx(0.05)
    assert history["c_1"][0] == pytest.approx(1e-4, rel=1e-2)  # to first order in the perturbation
    assert row["c_max"] == pytest.approx(max(np.abs(history[f"c_{i}"]).max() for i in range(1, 5)))
    assert {"crank.theta", "d/dt slider.x", "cdot_4", "lambda_1", "energy"} <= set(history)


def test_without_stabilisation_the_parameters_do_not_count() -> None:
    plain = rows("simulate", "--time", "0.02", "--no-stabilization", "--figure", "none", "--table", "none")
    assert (plain[0]["alpha_hat"], plain[0]["beta_hat"]) == (0, 0)


def test_physical_parameters_are_the_same_run() -> None:
    common = ("simulate", "--time", "0.02", "--figure", "none", "--table", "none", "--h", "0.002")
    assert rows(*common, "--alpha", "50", "--beta", "50", "--physical") == rows(
        *common, "--alpha", "0.2", "--beta", "0.01"
    )


def test_a_blow_up_is_status_three_and_keeps_the_history(tmp_path: Path) -> None:
    result = run("simulate", "--alpha", "1.7", "--beta", "0.8", "--time", "1", "--format", "json")
    assert result.exit_code == 3
    assert "blow-up" in json.loads(result.stdout)[0]["failure"]
    assert "at t = 0.1" in result.stderr.splitlines()[-1]
    assert len(list(tmp_path.iterdir())) == 2


def test_simulate_shows_the_iterations_of_an_implicit_method_only() -> None:
    common = ("simulate", "--time", "0.02", "--figure", "none", "--table", "none")
    implicit, explicit = (run(*common, "--method", name).stdout for name in ("trapezoid", "verlet-half"))
    assert "Newton's iterations" in implicit
    assert "Newton's iterations" not in explicit
    (row,) = rows(*common, "--method", "trapezoid")
    iterations, evaluations = row["iterations"], row["evaluations"]
    assert isinstance(iterations, int)
    assert isinstance(evaluations, int)
    assert 60 <= iterations < evaluations
    (row,) = rows(*common, "--method", "verlet-half")
    assert row["iterations"] is None


def test_a_step_that_does_not_converge_is_status_three() -> None:
    options = ("--scene", "four_bar", "--h", "0.5", "--time", "50", "--physical", "--alpha", "10", "--beta", "10")
    result = run("simulate", "--method", "trapezoid", *options, "--figure", "none", "--table", "none")
    assert result.exit_code == 3
    assert "at t = 0.5 s: Newton's method did not converge in" in result.stderr.splitlines()[-1]


def test_verify_takes_implicit_and_second_order_methods() -> None:
    for name in ("radau3", "hht", "verlet-old"):
        point = ("--alpha", "0.5", "--beta", "0.4", "--method", name)
        (row,) = rows("verify", "--scene", "pendulum", *point)
        assert row["measured_abs"] == pytest.approx(row["predicted_abs"], abs=1e-5)
        assert row["verdicts_agree"] is True


def test_verify_prints_predicted_and_measured_pole(tmp_path: Path) -> None:
    (row,) = rows("verify", "--alpha", "0.5", "--beta", "0.1", "--method", "AB4")
    assert row["scene"] == "slider-crank"
    assert row["measurable"] is True
    assert row["predicted_abs"] == pytest.approx(0.998848, abs=1e-6)
    assert row["measured_abs"] == pytest.approx(row["predicted_abs"], abs=1e-4)
    assert row["measured_angle_deg"] == pytest.approx(row["predicted_angle_deg"], abs=0.01)
    assert row["predicted_verdict"] == row["measured_verdict"] == "converges"
    (gone,) = rows("verify", "--alpha", "2", "--beta", "2", "--method", "RK2")  # deadbeat: nothing is left to measure
    assert gone["measurable"] is False
    assert gone["measured_abs"] is None
    assert gone["reason"]
    assert gone["measured_verdict"] == "converges"
    assert len(rows("verify", "--points", "3", "--method", "B4", "--method", "SYM")) == 6
    assert not list(tmp_path.iterdir())


def test_verify_map_writes_verdicts_and_figure(tmp_path: Path) -> None:
    (row,) = rows("verify", "--map", "5", "--scene", "pendulum", "--method", "SYM", "--table", "npz")
    assert (row["runs"], row["agreement"], row["disagreeing"]) == (25, 1, 0)
    assert row["band"] == 0.005
    assert sorted(path.suffix for path in tmp_path.iterdir()) == [".npz", ".png"]
    columns = arrays(tmp_path / "verify_pendulum_SYM.npz")
    assert (columns["diverges"] == (columns["z_abs"] >= 1)).all()


def test_tradeoff_writes_a_table_without_times_and_two_figures(tmp_path: Path) -> None:
    command = "--method B2 --method AB4 --h 0.004 --h 0.02 --time 0.6 --alpha 50 --beta 50 --physical"
    options = command.split()
    found = rows("tradeoff", *options)
    name = "tradeoff_slider_crank_light"
    assert {path.name for path in tmp_path.iterdir()} == {
        f"{name}.csv", f"{name}_trajectory.png", f"{name}_constraint.png"
    }  # fmt: skip
    table = list(csv.DictReader(io.StringIO((tmp_path / f"{name}.csv").read_text(encoding="utf-8"))))
    assert [(row["method"], row["h"]) for row in table] == [(row["method"], str(row["h"])) for row in found]
    assert not any("second" in key for key in table[0])
    assert all(float(str(row["seconds"])) > 0 for row in found)
    (failed,) = [row for row in found if row["failure"]]
    assert (failed["method"], failed["h"], failed["trajectory_error"]) == ("AB4", 0.02, None)
    first = (tmp_path / f"{name}.csv").read_bytes()
    assert "diverged" in run("tradeoff", *options, "--workers", "1").stdout
    assert (tmp_path / f"{name}.csv").read_bytes() == first
