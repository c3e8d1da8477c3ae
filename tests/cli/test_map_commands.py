"""Figures and tables of regions, lists of methods and families."""

import csv
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

from bezstab.errors import InputError
from bezstab.methods import GROUPS, lookup
from bezstab.stability import RATES, combined_error, error_front, spectral_radius
from bezstab.units import from_dimensionless
from tests.cli.running import arrays, rows, run

NOTHING = ("--figure", "none", "--table", "none")
ACCURACY = ("region", "--method", "RK4", "--accuracy", "--quality", "fast")


def test_the_list_of_methods_has_a_line_for_each_below_the_heading_of_its_group() -> None:
    lines = run("methods").stdout.splitlines()
    for group in GROUPS:
        first = lines.index(group.heading) + 1 + bool(group.note)
        assert [line.split()[0] for line in lines[first : first + len(group.methods)]] == list(group.methods)
    listed = rows("methods")
    assert [(row["group"], row["method"]) for row in listed] == [
        (group.heading, name) for group in GROUPS for name in group.methods
    ]
    assert all(row["source"] for row in listed)
    assert r"\hat{\alpha}" in run("methods", "B4", "--latex").stdout


@pytest.mark.slow
def test_region_writes_what_is_asked_for_where_it_is_asked_for(tmp_path: Path) -> None:
    options = "--figure svg --table npz --grid 11 --alpha-range -0.1 0.5 --beta-range 1/10 2/10 --level 0.8 --h 0.001"
    result = run("region", "--method", "B3", "-o", "out", *options.split())
    assert result.stderr.count("wrote") == 2
    assert {path.name for path in (tmp_path / "out").iterdir()} == {"region_B3.svg", "region_B3.npz"}
    table = arrays(tmp_path / "out" / "region_B3.npz")
    assert table["alpha_hat"][:11] == pytest.approx(np.linspace(-0.1, 0.5, 11))
    assert table["beta_hat"][::11] == pytest.approx(np.linspace(0.1, 0.2, 11))
    assert table["two_alpha"] == pytest.approx(table["alpha_hat"] * 1e3)
    assert "0.8" in (tmp_path / "out" / "region_B3.svg").read_text(encoding="utf-8")


def test_the_tables_of_a_map_and_of_compared_boundaries(tmp_path: Path) -> None:
    assert run("region", "--quality", "fast", "--figure", "none", "--table", "csv").exit_code == 0
    compared = ("region", "--compare", "--method", "B4", "--method", "RK4@5", "--figure", "none", "--table", "csv")
    (row, _) = rows(*compared, "--level", "0.9")
    assert row["z_abs_below"] == 0.9
    points, boundaries = (
        list(csv.DictReader((tmp_path / name).read_text(encoding="utf-8").splitlines()))
        for name in ("region_B4.csv", "compare_B4_RK4@5.csv")
    )
    assert list(points[0]) == ["alpha_hat", "beta_hat", "z_abs", "z_angle_deg"]
    assert len(points) == 50**2
    assert {row["method"] for row in boundaries} == {"B4", "RK4@5"}


def test_region_prints_the_area_of_each_level_asked_for() -> None:
    whole, faster, none = rows("region", "--method", "B4", "--level", "0.9", "--level", "0.5", *NOTHING)
    assert [row["z_abs_below"] for row in (whole, faster, none)] == [1, 0.9, 0.5]
    assert 0 < faster["area"] < whole["area"]  # type: ignore[operator]
    assert (none["area"], none["best_z_abs"], none["best_reason"]) == (0, None, "none: |z_p| is 0.625884 at least")


@pytest.mark.slow
def test_a_users_method_has_maps_and_steps_of_several_h(tmp_path: Path) -> None:
    Path("mine.toml").write_text('name = "a/b"\nrho = ["1", "-1"]\nsigma = ["0", "1"]', encoding="utf-8")
    assert run("region", "--method", "mine.toml", "--grid", "5").exit_code == 0
    assert (tmp_path / "region_a_b.png").exists()
    assert rows("poles", "--alpha", "1", "--beta", "1/2", "--method", "mine.toml@2")[0]["method"] == "a/b@2"


@pytest.mark.slow
def test_a_map_of_each_way_of_applying_a_drive_is_written_and_the_rows_are_those_of_check(tmp_path: Path) -> None:
    late = ("--pd", "200,5,0.1", "--h", "0.002", "--every", "4", "--late", "1")
    assert rows("region", *late, "--quality", "fast") == rows("check", *late)
    ways = ("SYM", "imex-euler", "stable-pd", "implicit-euler")
    assert {path.name for path in tmp_path.iterdir()} == {f"region_{way}_held.png" for way in ways}


@pytest.mark.slow
def test_the_map_of_errors_is_written_as_figure_and_table_and_the_same_again(tmp_path: Path) -> None:
    options = "--alpha-range 0.001 6 --beta-range 1e-5 9 --grid 20 --level 0.9 --table npz"
    for _ in range(2):
        region, level = rows(*ACCURACY, *options.split(), "-o", "out")
        written = {path.name: path.read_bytes() for path in (tmp_path / "out").iterdir()}
    assert {path.name: path.read_bytes() for path in (tmp_path / "out").iterdir()} == written
    assert set(written) == {"region_RK4_accuracy.png", "region_RK4_accuracy.npz"}
    assert (region["z_abs_below"], level["z_abs_below"]) == (1, 0.9)
    assert region["accurate_error"] == level["accurate_error"]
    table = arrays(tmp_path / "out" / "region_RK4_accuracy.npz")
    assert table["alpha_hat"][:20] == pytest.approx(np.geomspace(1e-3, 6, 20))
    assert table["beta_hat"][::20] == pytest.approx(np.geomspace(1e-5, 9, 20))
    decaying = table["z_abs"] < 1
    assert np.isnan(table["combined_error"][~decaying]).all()
    expected = combined_error(
        lookup("RK4"), table["alpha_hat"][decaying], table["beta_hat"][decaying], Fraction(1, 100)
    )
    assert table["combined_error"][decaying] == pytest.approx(expected)


@pytest.mark.slow
def test_a_method_without_an_accurate_point_has_its_map_nevertheless(monkeypatch: pytest.MonkeyPatch) -> None:
    def refused(*_: object, **__: object) -> None:
        raise InputError("RK4: no feedback decays so fast")

    monkeypatch.setattr("bezstab.questions.regions.choose", refused)
    result = run(*ACCURACY, "--format", "csv")
    assert result.exit_code == 0
    assert "no most accurate point: RK4: no feedback decays so fast" in result.stderr
    assert "wrote region_RK4_accuracy.png" in result.stderr


@pytest.mark.slow
def test_the_predicted_trade_is_the_front(tmp_path: Path) -> None:
    trade = ("tradeoff", "--predicted", "--method", "RK4", "--method", "B4")
    found = rows(*trade, "--level", "0.99", "--level", "0.7", "--h", "0.001", "--omega", "10")
    fronts = [point for name in ("RK4", "B4") for point in error_front(lookup(name), [0.99, 0.7])]
    assert {path.name for path in tmp_path.iterdir()} == {"tradeoff_predicted.csv", "tradeoff_predicted.png"}
    for row, point in zip(found, fronts, strict=True):
        assert (row["method"], row["z_abs_below"]) == (point.method.name, point.z_abs_below)
        assert (row["alpha_hat"], row["combined_error"]) == (point.alpha_hat, point.combined_error)
        assert (row["alpha"], row["beta"]) == pytest.approx(from_dimensionless(point.alpha_hat, point.beta_hat, 0.001))
        assert spectral_radius(point.method, point.alpha_hat, point.beta_hat) <= point.z_abs_below + 1e-6
    usual = rows(*trade[:4], *NOTHING)  # without a step nothing is in seconds
    assert [row["z_abs_below"] for row in usual[:-1]] == list(RATES)
    assert {(row["h"], row["alpha"], row["beta"]) for row in usual} == {(None, None, None)}
