import csv
import importlib.util
import io
import json
import os
from pathlib import Path

import numpy as np
import pytest

from bezstab.mechanism import shipped_scenes
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


def test_without_stabilisation_there_is_no_feedback() -> None:
    plain = rows("simulate", "--time", "0.02", "--stabilise", "none", "--figure", "none", "--table", "none")
    assert (plain[0]["alpha_hat"], plain[0]["beta_hat"]) == (0, 0)


def test_a_projected_run_keeps_its_constraints_and_says_what_that_costs() -> None:
    common = ("simulate", "--method", "AB4", "--time", "0.05", "--figure", "none")
    (held,) = rows(*common, "--stabilise", "projection", "--perturb", "1e-4", "--iterations", "2")
    (fed_back,) = rows(*common)
    assert (held["stabilise"], held["alpha_hat"], held["beta_hat"]) == ("projection", 0, 0)
    assert fed_back["stabilise"] == "baumgarte"
    assert fed_back["factorizations"] == fed_back["run_evaluations"] == held["run_evaluations"]
    total, evaluated = held["factorizations"], held["run_evaluations"]
    assert isinstance(total, int)
    assert isinstance(evaluated, int)
    assert 50 <= total - evaluated <= 150


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ("--stabilise projection --alpha 1", "--alpha does not go with --stabilise projection: it has no feedback"),
        ("--stabilise none --physical", "--physical does not go with --stabilise none: it has no feedback"),
        ("--stabilise projection --iterations 0", "Invalid value for '--iterations': 0 is not in the range x>=1."),
        ("--iterations 2", "--iterations needs --stabilise projection: they are its iterations"),
    ],
)
def test_options_that_do_not_go_with_a_projection_are_refused_in_a_line(options: str, said: str) -> None:
    result = run("simulate", *options.split())
    assert result.exit_code == 2
    assert result.stderr == f"bezstab: {said}\n"


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
    assert [path.suffix for path in tmp_path.iterdir()] == [".png"]


@pytest.mark.parametrize(
    ("time", "said"),
    [
        ("0.7", ""),
        ("1", "a singular configuration, at t = 0.772 s: "),
        ("4", "2 singular configurations, at t = 0.772, "),
    ],
)
def test_simulate_says_where_it_goes_through_singular_configurations(time: str, said: str) -> None:
    command = ("simulate", "--scene", "slider_crank_equal", "--figure", "none", "--table", "none", "--format", "json")
    result = run(*command, "--time", time)
    assert result.exit_code == 0
    assert json.loads(result.stdout)[0]["singular_passages"] == {"0.7": 0, "1": 1, "4": 2}[time]
    assert said in result.stderr
    assert len(result.stderr.splitlines()) == bool(said)


@pytest.mark.parametrize("command", ["simulate", "verify --method B4", "tradeoff"])
def test_a_speed_is_a_positive_number_that_has_something_to_multiply(command: str) -> None:
    for options, said in (
        (["--speed", "0"], "'--speed': 0 is not positive"),
        (["--speed", "1e150"], "'--speed': 1e150: expected 1e-100 to 1e+100"),
        (["--speed", "2", "--scene", "pendulum"], "speed 2: pendulum starts at rest and nothing drives it"),
    ):
        result = run(*command.split(), *options)
        assert result.exit_code == 2
        assert said in result.stderr
        assert len(result.stderr.splitlines()) == 1


def test_a_driver_at_twice_its_speed_does_four_times_the_work_on_what_has_no_weight(tmp_path: Path) -> None:
    (tmp_path / "own.toml").write_text(
        (shipped_scenes()["driven_four_bar"]).read_text(encoding="utf-8").replace("-9.81", "0.0"), encoding="utf-8"
    )
    common = ("--scene", "own.toml", "--figure", "none", "--table", "none", "--method", "RK4", "--alpha", "0.1")
    (slow,) = rows("simulate", *common, "--time", "0.2", "--h", "0.0002", "--beta", "0.01")
    (fast,) = rows("simulate", *common, "--time", "0.1", "--h", "0.0001", "--beta", "0.01", "--speed", "2")
    slow_work, slow_drift, fast_work = slow["driver_work"], slow["energy_drift"], fast["driver_work"]
    assert isinstance(slow_work, float)
    assert isinstance(slow_drift, float)
    assert fast_work == pytest.approx(4 * slow_work, rel=1e-7)  # RK4's error
    assert abs(slow_work) > 1e5 * abs(slow_drift)
    assert slow["force_work"] == 0


def test_simulate_shows_the_iterations_of_an_implicit_method_only() -> None:
    common = ("simulate", "--time", "0.02", "--figure", "none", "--table", "none")
    implicit, explicit = (run(*common, "--method", name).stdout for name in ("trapezoid", "verlet-half"))
    assert "Newton's iterations" in implicit
    assert "Newton's iterations" not in explicit
    (row,) = rows(*common, "--method", "trapezoid")
    iterations, evaluations = row["iterations"], row["run_evaluations"]
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


@pytest.mark.slow
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


def test_tradeoff_draws_feedback_and_projection_and_the_same_again(tmp_path: Path) -> None:
    command = "--scene pendulum --method SYM --h 0.01 --h 0.02 --time 0.1 --repeats 1 --against projection"
    options = [*command.split(), "--alpha", "0.5", "--beta", "0.1", "--workers", "1"]
    found = rows("tradeoff", *options)
    assert [(row["stabilise"], row["advised"]) for row in found] == [
        *[("baumgarte", True)] * 2,
        *[("baumgarte", False)] * 2,
        *[("projection", False)] * 2,
    ]
    assert [(row["alpha_hat"], row["z_abs"]) for row in found[4:]] == [(0, None)] * 2
    written = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    assert set(written) == {"tradeoff_pendulum.csv", "tradeoff_pendulum_projection.png"}
    assert "SYM: for a trajectory error of" in run("tradeoff", *options).stdout
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == written


def test_tradeoff_without_feedback_has_no_point() -> None:
    command = "--scene pendulum --method SYM --h 0.01 --h 0.02 --time 0.1 --repeats 1 --figure none --table none"
    for held in ("projection", "none"):
        found = rows("tradeoff", *command.split(), "--stabilise", held, "--workers", "1")
        assert {(row["stabilise"], row["alpha_hat"], row["z_abs"]) for row in found} == {(held, 0, None)}


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ("--stabilise projection --alpha 1 --beta 1", "--alpha does not go with --stabilise projection"),
        ("--against projection --stabilise none", "--stabilise does not go with --against projection"),
        ("--iterations 1", "--iterations needs --stabilise projection"),
    ],
)
def test_tradeoff_refuses_what_does_not_go_with_projection_in_a_line(options: str, said: str) -> None:
    result = run("tradeoff", *options.split())
    assert result.exit_code == 2
    assert result.stderr.startswith(f"bezstab: {said}")
    assert len(result.stderr.splitlines()) == 1


SWEEP = "tradeoff --scene pendulum --method SYM --h 0.01 --h 0.02 --time 0.1 --workers 1 --table none"


@pytest.mark.parametrize(
    "command",
    [
        "simulate --scene pendulum --method SYM --time 0.1",
        "verify --scene pendulum --method SYM --points 2",
        "verify --scene pendulum --method implicit-euler --points 2",
        pytest.param(
            "tradeoff --scene pendulum --method SYM --h 0.01 --h 0.02 --time 0.1 --alpha 0.3 --beta 0.04",
            marks=pytest.mark.slow,  # starts worker processes
        ),
    ],
)
@pytest.mark.slow
def test_compiled_runs_answer_the_same(command: str) -> None:
    """But for rounding: runs agree to 1e-12 of the coordinates' size, of which an error may be a small part."""
    timed = {"seconds", "seconds_min", "seconds_max"}
    answers = []
    for choice in ("no", "yes"):
        unwritten = () if command.startswith("verify") else ("--figure", "none", "--table", "none")
        found = rows(*command.split(), *unwritten, "--compiled", choice)
        answers.append([{key: value for key, value in row.items() if key not in timed} for row in found])
    for by_numpy, compiled in zip(*answers, strict=True):
        assert compiled.keys() == by_numpy.keys()
        for key, value in by_numpy.items():
            alike = pytest.approx(value, rel=1e-6, abs=1e-12) if isinstance(value, float) else value
            assert compiled[key] == alike, key
    assert "BEZSTAB_COMPILED" not in os.environ


@pytest.mark.parametrize("command", ["simulate", "verify", "verify --map 5", "tradeoff", "extremes", "paper"])
def test_without_numba_compiled_runs_are_refused_in_a_line(command: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    refused = run(*command.split(), "--compiled", "yes")
    assert refused.exit_code == 2
    assert refused.stderr == "bezstab: compiled runs need an optional package: pip install 'bezstab[fast]'\n"


def test_the_environment_may_ask_for_compiled_runs_too(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("BEZSTAB_COMPILED", "perhaps")
    refused = run("simulate", "--time", "0.01", "--figure", "none", "--table", "none")
    assert refused.exit_code == 2
    assert refused.stderr == "bezstab: BEZSTAB_COMPILED=perhaps: expected auto, yes or no\n"
