import csv
import io
import json
import os
import re
import shlex
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import click
import numpy as np
import pytest
from click.testing import CliRunner, Result
from hypothesis import given, settings
from hypothesis import strategies as st

from bezstab.cli import main


def run(*arguments: str) -> Result:
    return CliRunner().invoke(main, list(arguments))


def arrays(path: Path) -> dict[str, Any]:
    with np.load(path) as file:
        return dict(file)


def rows(*arguments: str) -> list[dict[str, object]]:
    result = run(*arguments, "--format", "json")
    assert result.exit_code == 0, result.stderr
    data = json.loads(result.stdout)
    assert isinstance(data, list)
    return data


@pytest.fixture(autouse=True)
def _in_an_empty_directory(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def test_poles_prints_the_default_methods_and_keys() -> None:
    found = rows("poles", "--alpha", "0.5", "--beta", "0.1")
    assert [row["method"] for row in found] == ["B2", "B3", "B4", "AB2", "AB3", "AB4", "RK4@5", "SIE"]
    assert list(found[0]) == ["method", "alpha_hat", "beta_hat", "z_real", "z_imag", "z_abs", "z_angle_deg", "verdict"]
    assert {row["verdict"] for row in found} == {"converges"}


@pytest.mark.parametrize(
    ("name", "alpha", "beta", "verdict"),
    [
        ("SYM", "1", "2", "marginal"),
        ("SYM", "1", "2.00000000000000000001", "diverges"),
        ("SYM", "1", "1.99999999999999999999", "converges"),
        ("AB2", "1.5", "0.5", "marginal"),
        ("AB2", "2", "1", "diverges"),
        ("RK1", "2", "2", "marginal"),
        ("RK1", "2.00000000000000000002", "2", "converges"),
        ("B4", "0", "0", "diverges"),
        ("B4", "-0.1", "0.1", "diverges"),
        ("RK1", "6/11", "3/11", "converges"),
        ("RK1", "6/11", "6/11", "marginal"),
    ],
)
def test_the_verdict_is_proven_on_the_numbers_as_typed(name: str, alpha: str, beta: str, verdict: str) -> None:
    (row,) = rows("poles", "--method", name, "--alpha", alpha, "--beta", beta)
    assert row["verdict"] == verdict


def test_physical_units_and_all_poles() -> None:
    physical = rows(
        "poles", "--alpha", "50", "--beta", "50", "--h", "0.002", "--physical", "--method", "B3", "--all-poles"
    )
    assert physical == rows("poles", "--alpha", "0.2", "--beta", "0.01", "--method", "B3", "--all-poles")
    assert len(physical) == 6


def test_methods_lists_and_shows() -> None:
    assert {row["method"] for row in rows("methods")} >= {"B12", "AB8", "ABM4", "RK4", "SIE", "SYM"}
    (row,) = rows("methods", "B4")
    assert row["order"] == 2
    assert row["recursion"] == "y_{k+1} = y_k + h/108 (175 f_k - 81 f_{k-1} + 15 f_{k-2} - f_{k-3})"
    assert r"\hat{\alpha}" in run("methods", "B4", "--latex").stdout
    text = run("methods", "B4").stdout
    for piece in ("175 z^3 - 81 z^2 + 15 z - 1", "11664 z^8", "0.8096847184", "11/36", "0.625883502", "1.588235294"):
        assert piece in text


def test_region_needs_no_option_and_writes_two_files(tmp_path: Path) -> None:
    result = run("region", "--method", "B4")
    assert result.exit_code == 0
    assert {path.name for path in tmp_path.iterdir()} == {"region_B4.png", "region_B4.csv"}
    assert "0.8096847184" in result.stdout
    assert "wrote" not in result.stdout
    assert result.stderr.count("wrote") == 2
    table = list(csv.DictReader(io.StringIO((tmp_path / "region_B4.csv").read_text(encoding="utf-8"))))
    assert list(table[0]) == ["alpha_hat", "beta_hat", "z_abs", "z_angle_deg"]
    assert len(table) == 200**2


def test_region_prints_the_promised_keys(tmp_path: Path) -> None:
    (row, other) = rows("region", "--method", "B4", "--method", "AB4", "--figure", "none", "--table", "none")
    assert (row["method"], other["method"]) == ("B4", "AB4")
    assert {"area", "alpha_hat_max", "beta_hat_max", "best_z_abs", "best_alpha_hat", "best_beta_hat"} <= set(row)
    assert not list(tmp_path.iterdir())


def test_region_options(tmp_path: Path) -> None:
    options = (
        "-o out --figure svg --table npz --grid 11 --alpha-range -0.1 0.5 --beta-range 1/10 2/10 --level 0.8 --h 0.001"
    )
    assert run("region", "--method", "B3", *options.split()).exit_code == 0
    assert {path.name for path in (tmp_path / "out").iterdir()} == {"region_B3.svg", "region_B3.npz"}
    table = arrays(tmp_path / "out" / "region_B3.npz")
    assert table["alpha_hat"][:11] == pytest.approx(np.linspace(-0.1, 0.5, 11))
    assert table["beta_hat"][::11] == pytest.approx(np.linspace(0.1, 0.2, 11))
    assert table["two_alpha"] == pytest.approx(table["alpha_hat"] * 1e3)
    assert "0.8" in (tmp_path / "out" / "region_B3.svg").read_text(encoding="utf-8")


def test_compare_overlays_boundaries(tmp_path: Path) -> None:
    assert run("region", "--compare", "--method", "B4", "--method", "RK4@5", "--h", "0.001").exit_code == 0
    assert {path.suffix for path in tmp_path.iterdir()} == {".png", ".csv"}
    table = list(csv.DictReader(io.StringIO(next(tmp_path.glob("*.csv")).read_text(encoding="utf-8"))))
    assert {row["method"] for row in table} == {"B4", "RK4@5"}


def test_a_users_method(tmp_path: Path) -> None:
    Path("mine.toml").write_text('name = "a/b"\nrho = ["1", "-1"]\nsigma = ["0", "1"]', encoding="utf-8")
    assert run("region", "--method", "mine.toml", "--grid", "5").exit_code == 0
    assert (tmp_path / "region_a_b.png").exists()
    assert rows("poles", "--alpha", "1", "--beta", "1/2", "--method", "mine.toml@2")[0]["method"] == "a/b@2"


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


def test_quality_is_points_per_axis(tmp_path: Path) -> None:
    run("region", "--quality", "fast", "--figure", "none", "--table", "npz")
    assert len(arrays(tmp_path / "region_B4.npz")["z_abs"]) == 50**2


def test_choose_prints_what_to_set() -> None:
    (row,) = rows("choose", "--h", "0.001", "--goal", "fastest")
    keys = "method h goal alpha_hat beta_hat alpha beta z_abs z_angle_deg settle_steps settle_seconds h_max"
    assert set(keys.split()) <= set(row)
    assert row["z_abs"] == pytest.approx(0.625883502027, abs=1e-7)  # a double mu: half the digits
    assert row["alpha"] == pytest.approx(1000 * 1.0126978003 / 2)
    assert row["beta"] == pytest.approx(1000 * 0.2563892087**0.5)
    assert row["h_max"] == pytest.approx(0.0015683, rel=1e-4)
    (gentle,) = rows("choose", "--h", "0.001", "--goal", "gentle", "--settle", "0.5")
    assert gentle["settle_steps"] == 500
    assert gentle["alpha"] == pytest.approx(gentle["beta"])
    (finer,) = rows("choose", "--h", "0.001", "--h-max", "0.002", "--method", "SYM")
    (coarse,) = rows("choose", "--h", "0.002", "--method", "SYM")
    assert (finer["alpha"], finer["beta"], finer["h_max"]) == pytest.approx(
        (coarse["alpha"], coarse["beta"], coarse["h_max"])
    )


def test_family_ends_with_its_limit(tmp_path: Path) -> None:
    found = rows("family", "bezier", "--from", "3", "--to", "5")
    assert [row["n"] for row in found] == [3, 4, 5, None]
    assert [row["method"] for row in found] == ["B3", "B4", "B5", "B∞"]
    assert [path.name for path in tmp_path.iterdir()] == ["family_bezier.png"]
    found = rows("family", "adams-bashforth", "--figure", "none")
    assert [row["order"] for row in found] == list(range(2, 9))


def test_an_engines_own_words_are_read_and_printed(tmp_path: Path) -> None:
    (given, _) = rows("check", "--engine", "mujoco=0.004,1", "--h", "0.002", "--method", "SYM")
    assert (given["alpha_hat"], given["beta_hat"], given["z_abs"]) == (1, 0.25, 0.75)
    (row,) = rows("choose", "--engine", "mujoco", "--h", "0.002")
    assert row["method"] == "SYM"
    k, c = re.findall(r"-([\d.]+)", str(row["engine"]))
    assert (float(c) * 0.002, float(k) * 0.002**2) == pytest.approx((row["alpha_hat"], row["beta_hat"]))
    listed = {str(row["name"]): row for row in rows("engines", "--alpha", "1", "--beta", "0.2", "--h", "0.002")}
    assert listed["ode"]["set"] == "ERP = 0.2"
    assert "reaches" in str(listed["box2d"]["set"])
    assert all(row["excludes"] and row["source"] for row in listed.values())
    rows("region", "--method", "SYM", "--engine", "mujoco", "--h", "0.002", "--figure", "svg", "--table", "none")
    assert "timeconst" in (tmp_path / "region_SYM.svg").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("name", "verdict"),
    [("RK2", "converges"), ("RK1", "marginal"), *((name, "diverges") for name in ("SYM", "AB2", "AB3", "AB4"))],
)
def test_check_judges_the_textbook_rule(name: str, verdict: str) -> None:
    rule = ("--h", "0.001", "--alpha", "1000", "--beta", "1414.2135623730951", "--physical")  # alpha = 1/h, sqrt(2)/h
    assert rows("check", "--method", "RK2", *rule)[0]["z_abs"] == pytest.approx(0, abs=1e-6)  # as above
    result = run("check", "--method", name, "--alpha", "2", "--beta", "2", "--format", "json")
    assert result.exit_code == (0 if verdict == "converges" else 1)
    given, instead = json.loads(result.stdout)
    assert given["verdict"] == verdict
    assert (given["h_factor"] is None) == (verdict != "converges")
    assert (instead["goal"], instead["verdict"]) == ("robust", "converges")


def test_paper_writes_the_chosen_parts_and_prints_findings(tmp_path: Path) -> None:
    found = rows("paper", "--only", "table5", "--only", "fig7", "--figure", "svg", "-o", "out")
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == ["paper_fig7.svg", "paper_table5.md"]
    assert {row["where"] for row in found} >= {"Table 4", "Table 5", "Fig. 9e"}
    assert set(found[0]) == {"where", "claim", "paper", "here", "agreement"}
    table = (tmp_path / "out" / "paper_table5.md").read_text(encoding="utf-8").splitlines()
    assert len([line for line in table if line.startswith("|")]) == 2 + 12
    assert r"\|z_p\|" in table[2]  # a bare bar would end the cell
    timed = run("paper", "--only", "table6")
    assert "processor time" in timed.stdout
    assert "property" in timed.stdout


@pytest.mark.parametrize(
    ("command", "named"),
    [
        ("choose --method B4", "--h"),
        ("choose --h 0.001 --goal quick", "--goal"),
        ("choose --h 0.001 --spread 1", "--spread"),
        ("choose --h 0.001 --h-max 0.0001", "--h-max"),
        ("choose --h 0.001 --h-max 0.01 --goal fastest", "--h-max"),
        ("choose --h 0.001 --goal gentle", "--settle"),
        ("choose --h 0.001 --goal gentle --settle 0.005", "--settle"),
        ("check --alpha 1 --beta 1 --physical", "--h"),
        ("check --alpha 1", "--beta"),
        ("check --engine mujoco=0.02,1", "--h"),
        ("check --engine mujoco=0.02 --h 0.002", "solref[1]"),
        ("check --engine havok=1 --h 0.002", "mujoco"),
        ("check --engine mujoco=a,b --h 0.002", "mujoco=solref[0],solref[1]"),
        ("check --engine bullet=0.2 --h 0.002", "SYM"),
        ("check --engine bullet=0.2 --alpha 1 --h 0.002 --method SYM", "--alpha"),
        ("choose --engine bullet --h 0.002", "bullet"),
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
        ("check --engine mujoco=1e-200,1 --h 1", "mujoco"),
        ("choose --h 0.1 --h-max 1e300", "--h-max"),
        ("choose --h 0.1 --goal gentle --settle 1e-300", "--settle"),
        ("foo", "foo"),
    ],
)
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
    "poles": {"--alpha": NUMBERS, "--beta": NUMBERS, "--h": STEPS, "--physical": None, "--all-poles": None},
    "check": {
        "--alpha": NUMBERS,
        "--beta": NUMBERS,
        "--h": STEPS,
        "--physical": None,
        "--engine": ["mujoco=0.02,1", "mujoco=0,0", "bullet=0.2", "box2d=60,-2", "drake=1e300,1", "ode=", "x=1"],
    },
    "engines": {"--alpha": NUMBERS, "--beta": NUMBERS, "--h": STEPS},
    "methods": {"--latex": None},
    "region --figure none --table none": {"--level": NUMBERS, "--h": STEPS, "--compare": None, "--engine": ["mujoco"]},
}


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


@pytest.mark.parametrize("form", ["text", "json", "csv", "markdown"])
@pytest.mark.parametrize(
    "command",
    [
        "poles --alpha 1 --beta 1",
        "methods",
        "methods B3 SYM",
        "region --method B3 --figure none --table none",
        "simulate --time 0.01 --figure none --table none",
        "verify --points 2",
        "paper --only fig7 --figure none",
        "choose --method SYM --h 0.01",
        "engines --alpha 0.5 --beta 0.25",
        "family bezier --from 3 --to 4 --figure none",
        "check --method RK1 --alpha 1 --beta 0.25",
        "verify --map 3 --figure none --table none",
        "tradeoff --method SYM --h 0.01 --h 0.02 --time 0.1 --figure none --table none",
    ],
)
def test_every_command_prints_in_every_format(command: str, form: str) -> None:
    result = run(*command.split(), "--format", form)
    assert result.exit_code == 0
    assert result.stderr == ""
    if form == "csv":
        assert len(list(csv.DictReader(io.StringIO(result.stdout)))) >= 1
    if form == "json":
        assert isinstance(json.loads(result.stdout), list)


@pytest.mark.parametrize("name", main.commands)
def test_the_example_in_the_help_runs(name: str) -> None:
    shown = run(name, "--help").stdout
    example = re.search(r"Example: bezstab ((?:[^\n]|\n  \S)*)", shown)
    assert example, shown
    needs_a_screen = name == "explore"
    assert run(*shlex.split(example[1])).exit_code == (2 if needs_a_screen else 0)


@pytest.mark.parametrize("command", main.commands.values(), ids=str)
def test_every_option_explains_itself(command: click.Command) -> None:
    assert all(option.help for option in command.params if isinstance(option, click.Option))


def bezstab(*arguments: str) -> list[str]:
    return [sys.executable, "-m", "bezstab", *arguments]


def test_a_closed_pipe_is_no_error_to_read() -> None:
    with subprocess.Popen(bezstab("methods"), stdout=subprocess.PIPE, stderr=subprocess.PIPE) as source:
        assert source.stdout
        assert source.stderr
        source.stdout.close()
        assert source.stderr.read() == b""


@pytest.mark.parametrize(
    "command", ["region --grid 4000 --method B12", "simulate --time 10000", "verify --points 1000 --method B12"]
)
def test_an_interrupt_stops_cleanly(command: str, tmp_path: Path) -> None:
    running = subprocess.Popen(bezstab(*command.split()), stdout=subprocess.PIPE, stderr=subprocess.PIPE, cwd=tmp_path)
    time.sleep(5)
    assert running.poll() is None
    os.kill(running.pid, signal.SIGINT)
    _, errors = running.communicate(timeout=60)
    assert running.returncode == 130
    assert errors.decode().split() == ["bezstab:", "interrupted"]
    assert not list(tmp_path.iterdir())


def test_an_interrupted_map_says_how_to_go_on(tmp_path: Path) -> None:
    command = bezstab("verify", "--map", "300", "--workers", "1")
    running = subprocess.Popen(command, stderr=subprocess.PIPE, cwd=tmp_path, start_new_session=True)
    while not list(tmp_path.glob("*.chunks/[0-9]*.npz")):
        assert running.poll() is None
        time.sleep(0.1)
    os.killpg(running.pid, signal.SIGINT)  # as a terminal does, to the workers too
    _, errors = running.communicate(timeout=60)
    assert running.returncode == 130
    advice, interrupted = filter(None, errors.decode().splitlines())  # click breaks the line of ^C
    assert "--resume" in advice
    assert interrupted == "bezstab: interrupted"
