import csv
import io
from pathlib import Path

import numpy as np
import pytest

from bezstab.methods import GROUPS, lookup
from tests.cli.running import arrays, rows, run
from tests.reference.slice_integral import slice_area


def test_poles_prints_the_default_methods_and_keys() -> None:
    found = rows("poles", "--alpha", "0.5", "--beta", "0.1")
    assert [row["method"] for row in found] == ["B2", "B3", "B4", "AB2", "AB3", "AB4", "RK4@5", "SIE"]
    assert list(found[0]) == [
        "method",
        "alpha_hat",
        "beta_hat",
        "z_real",
        "z_imag",
        "z_abs",
        "z_angle_deg",
        "verdict",
        "safe",
        "omega_h",
        "forced_error",
        "total_error",
        "velocity_error",
        "order_left",
        "times_least",
        "times_least_velocity",
    ]
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


def test_a_method_shown_whole_says_what_order_strong_feedback_leaves_it() -> None:
    (row,) = rows("methods", "RK4")
    assert (row["order"], row["order_left"]) == (4, 2)
    assert str(row["steady_error"]).startswith("θ^2 β̂ (α̂ β̂ - 4 β̂ + 24)/")
    for name, left in (("RK4", "constraint errors are of order 2."), ("AB4", "constraint errors keep that order.")):
        assert f"With α̂ and β̂ held as h shrinks, {left}" in " ".join(run("methods", name).stdout.split())


def test_the_list_of_methods_is_grouped_and_fits_80_columns() -> None:
    lines = run("methods").stdout.splitlines()
    assert max(map(len, lines)) <= 80
    for group in GROUPS:
        place = lines.index(group.heading)
        assert lines[place - 1] == ""
        first = place + 1 + bool(group.note)
        assert [line.split()[0] for line in lines[first : first + len(group.methods)]] == list(group.methods)
    assert "forest-ruth           1      3            1 (4)  3.274868243" in lines  # with and without damping


def test_the_list_of_methods_has_a_row_for_each_with_its_group_in_json() -> None:
    listed = rows("methods")
    assert [(row["group"], row["method"]) for row in listed] == [
        (group.heading, name) for group in GROUPS for name in group.methods
    ]
    assert {row["method"] for row in listed if row["digits"]} == {
        *("tsit5", "forest-ruth", "yoshida4", "sdirk2", "dirk3", "gauss4", "radau5")
    }
    assert all(row["source"] for row in listed)


def test_sie_is_said_not_to_be_semi_implicit_euler() -> None:
    assert "not what engines call semi-implicit Euler" in " ".join(run("methods", "--help").stdout.split()).replace(
        "semi- implicit", "semi-implicit"
    )
    assert "not that of engines, which is SYM" in run("methods").stdout


@pytest.mark.parametrize("name", ["leapfrog", "velocity-verlet"])
def test_an_ambiguous_method_is_answered_with_a_choice(name: str) -> None:
    result = run("poles", "--method", name, "--alpha", "1", "--beta", "1")
    assert result.exit_code == 2
    assert "which velocity does your feedback use?" in result.stderr
    assert "SIE" not in result.stderr


@pytest.mark.slow
def test_region_needs_no_option_and_writes_a_figure(tmp_path: Path) -> None:
    result = run("region", "--method", "B4")
    assert result.exit_code == 0
    assert {path.name for path in tmp_path.iterdir()} == {"region_B4.png"}
    assert "0.8096847184" in result.stdout
    assert "wrote" not in result.stdout
    assert result.stderr.count("wrote") == 1


def test_the_long_table_of_region_is_written_when_asked_for(tmp_path: Path) -> None:
    assert run("region", "--method", "B4", "--figure", "none", "--table", "csv").exit_code == 0
    table = list(csv.DictReader(io.StringIO((tmp_path / "region_B4.csv").read_text(encoding="utf-8"))))
    assert list(table[0]) == ["alpha_hat", "beta_hat", "z_abs", "z_angle_deg"]
    assert len(table) == 200**2


def test_region_prints_the_promised_keys(tmp_path: Path) -> None:
    (row, other) = rows("region", "--method", "B4", "--method", "AB4", "--figure", "none", "--table", "none")
    assert (row["method"], other["method"]) == ("B4", "AB4")
    assert {
        "area",
        "alpha_hat_max",
        "beta_hat_min",
        "beta_hat_max",
        "best_z_abs",
        "best_alpha_hat",
        "best_beta_hat",
    } <= set(row)
    assert not list(tmp_path.iterdir())


@pytest.mark.slow
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


def test_region_prints_the_area_of_each_level_asked_for(tmp_path: Path) -> None:
    files = ("--figure", "none", "--table", "none")
    whole, faster, none = rows("region", "--method", "B4", "--level", "0.9", "--level", "0.5", *files)
    assert [row["z_abs_below"] for row in (whole, faster, none)] == [1, 0.9, 0.5]
    assert faster["area"] == pytest.approx(slice_area(lookup("B4"), 0.9).area, rel=1e-9)
    assert (none["area"], none["best_z_abs"], none["best_reason"]) == (0, None, "none: |z_p| is 0.625884 at least")
    (compared,) = rows("region", "--method", "B4", "--compare", "--level", "0.9", *files)
    assert (compared["z_abs_below"], compared["area"]) == (0.9, faster["area"])
    assert run("region", "--compare", "--level", "0.9", *files).stdout.startswith("B4 has |z_p| < 0.9 in a region")


@pytest.mark.slow
def test_levels_are_of_the_mechanism_at_rest(tmp_path: Path) -> None:
    scene = ("--scene", "driven_four_bar", "--h", "0.005", "--figure", "none", "--table", "none")
    moving, at_rest = rows("region", "--method", "B4", "--level", "0.9", *scene)
    assert moving["area_moving"]
    assert (at_rest["z_abs_below"], at_rest["speed"], at_rest["area_moving"]) == (0.9, None, None)


@pytest.mark.parametrize("name", ["radau3", "hht"])
def test_the_map_of_an_unbounded_region_holds_its_best_point(name: str, tmp_path: Path) -> None:
    """Radau's is the corner of the map's window; that of HHT lies beyond everything else that there is to see."""
    options = ("--figure", "none", "--table", "npz", "--quality", "fast", "-o", str(tmp_path))
    (row,) = rows("region", "--method", name, *options)
    (path,) = tmp_path.iterdir()
    shown = arrays(path)
    for key in ("alpha_hat", "beta_hat"):
        assert shown[key].min() < float(str(row[f"best_{key}"])) < shown[key].max()


def test_quality_is_points_per_axis(tmp_path: Path) -> None:
    run("region", "--quality", "fast", "--figure", "none", "--table", "npz")
    assert len(arrays(tmp_path / "region_B4.npz")["z_abs"]) == 50**2


def test_compare_overlays_boundaries(tmp_path: Path) -> None:
    compared = ("region", "--compare", "--method", "B4", "--method", "RK4@5", "--h", "0.001", "--table", "csv")
    assert run(*compared).exit_code == 0
    assert {path.suffix for path in tmp_path.iterdir()} == {".png", ".csv"}
    table = list(csv.DictReader(io.StringIO(next(tmp_path.glob("*.csv")).read_text(encoding="utf-8"))))
    assert {row["method"] for row in table} == {"B4", "RK4@5"}


@pytest.mark.slow
def test_a_users_method(tmp_path: Path) -> None:
    Path("mine.toml").write_text('name = "a/b"\nrho = ["1", "-1"]\nsigma = ["0", "1"]', encoding="utf-8")
    assert run("region", "--method", "mine.toml", "--grid", "5").exit_code == 0
    assert (tmp_path / "region_a_b.png").exists()
    assert rows("poles", "--alpha", "1", "--beta", "1/2", "--method", "mine.toml@2")[0]["method"] == "a/b@2"


@pytest.mark.slow
def test_family_ends_with_its_limit(tmp_path: Path) -> None:
    found = rows("family", "bezier", "--from", "3", "--to", "5")
    assert [row["steps"] for row in found] == [3, 4, 5, None]
    assert [row["method"] for row in found] == ["B3", "B4", "B5", "B∞"]
    assert [path.name for path in tmp_path.iterdir()] == ["family_bezier.png"]
    found = rows("family", "adams-bashforth", "--figure", "none")
    assert [row["order"] for row in found] == list(range(2, 9))


def test_region_and_methods_say_what_has_no_limit() -> None:
    command = ("region", "--method", "trapezoid", "--figure", "none", "--table", "none")
    (row,) = rows(*command)
    assert row["bounded"] is False
    assert (row["area"], row["alpha_hat_min"], row["alpha_hat_max"], row["beta_hat_max"]) == (None, 0, None, None)
    assert (row["stable_for_all"], row["unconditional_damping_ratio"], row["critical_damping_limit"]) == (
        "proven",
        0,
        None,
    )
    assert "unbounded" in run(*command).stdout
    assert "all (proven for any α, β)" in run(*command).stdout
    text = run("methods", "am3").stdout
    assert "critical damping limit        6" in text
    assert "unconditional damping ratio   none" in text
