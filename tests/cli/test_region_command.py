"""region --accuracy and tradeoff --predicted: rows, files, what they are about, and what is refused in a line."""

import csv
import io
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

from bezstab.errors import InputError
from bezstab.methods import lookup
from bezstab.stability import RATES, choose, combined_error, error_front, spectral_radius
from bezstab.units import from_dimensionless
from tests.cli.running import arrays, rows, run

NOTHING = ("--figure", "none", "--table", "none")
MAP = ("region", "--method", "RK4", "--accuracy", "--quality", "fast")


def number(row: dict[str, object], key: str) -> float:
    value = row[key]
    assert isinstance(value, float)
    return value


def test_the_row_of_a_map_has_both_best_points_and_what_they_force() -> None:
    (row,) = rows(*MAP, *NOTHING)
    chosen = choose(lookup("RK4"), "accurate", margins=False)
    assert (row["omega_h"], row["accurate_alpha_hat"], row["accurate_beta_hat"]) == (
        0.01,
        chosen.alpha_hat,
        chosen.beta_hat,
    )
    assert row["accurate_z_abs"] == abs(chosen.pole)
    for error, point in (
        ("accurate_error", ("accurate_alpha_hat", "accurate_beta_hat")),
        ("best_error", ("best_alpha_hat", "best_beta_hat")),
    ):
        alpha_hat, beta_hat = (number(row, key) for key in point)
        assert row[error] == float(combined_error(lookup("RK4"), alpha_hat, beta_hat, Fraction(1, 100)))
    assert number(row, "best_error") > 1e6 * number(row, "accurate_error")


@pytest.mark.slow
def test_the_map_is_written_as_figure_and_table(tmp_path: Path) -> None:
    assert run(*MAP, "--table", "csv").exit_code == 0
    assert {path.name for path in tmp_path.iterdir()} == {"region_RK4_accuracy.png", "region_RK4_accuracy.csv"}
    text = (tmp_path / "region_RK4_accuracy.csv").read_text(encoding="utf-8")
    table = list(csv.DictReader(io.StringIO(text)))
    assert list(table[0]) == ["alpha_hat", "beta_hat", "z_abs", "z_angle_deg", "combined_error"]
    assert len(table) == 50**2
    points = np.array([[float(row[key]) for key in table[0]] for row in table])
    steps = np.diff(np.log(points[:50, 0]))
    assert steps == pytest.approx(steps[0])  # logarithmic
    decaying = points[:, 2] < 1
    assert np.isnan(points[~decaying, 4]).all()
    expected = combined_error(lookup("RK4"), points[decaying, 0], points[decaying, 1], Fraction(1, 100))
    assert points[decaying, 4] == pytest.approx(expected)
    for key, column in (("alpha_hat", 0), ("beta_hat", 1)):  # both best points lie inside
        (row,) = rows(*MAP, *NOTHING)
        for point in ("best", "accurate"):
            assert points[:, column].min() < number(row, f"{point}_{key}") < points[:, column].max()


@pytest.mark.slow
def test_the_same_map_is_the_same_bytes(tmp_path: Path) -> None:
    written = []
    for _ in range(2):
        assert run(*MAP).exit_code == 0
        written.append([path.read_bytes() for path in tmp_path.iterdir()])
    assert len(written[0]) == 1
    assert written[0] == written[1]


def test_ranges_and_levels_are_those_asked_for(tmp_path: Path) -> None:
    options = "--alpha-range 0.001 1 --beta-range 1e-5 2 --grid 7 --level 0.9 --figure none --table npz -o out"
    region, level = rows(*MAP, *options.split())
    assert (region["z_abs_below"], level["z_abs_below"]) == (1, 0.9)
    assert region["accurate_error"] == level["accurate_error"]
    table = arrays(tmp_path / "out" / "region_RK4_accuracy.npz")
    assert table["alpha_hat"][:7] == pytest.approx(np.geomspace(1e-3, 1, 7))
    assert table["beta_hat"][::7] == pytest.approx(np.geomspace(1e-5, 2, 7))


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ("", "ωh = 0.01"),
        ("--h 0.002 --omega 10", "ω = 10 1/s, ωh = 0.02"),
        ("--h 0.003 --scene driven_four_bar", "that of driven_four_bar with ω = 7.87 1/s, ωh = 0.0236"),
        ("--h 0.003 --scene driven_four_bar --speed 2", "that of driven_four_bar with ω = 15.7 1/s, ωh = 0.0472"),
    ],
)
@pytest.mark.slow_except("--h 0.002")
def test_both_say_on_which_motion_errors_are_told(options: str, words: str) -> None:
    for command in (MAP, ("tradeoff", "--predicted", "--method", "RK4", "--level", "0.9")):
        result = run(*command, *NOTHING, *options.split())
        assert result.exit_code == 0, result.stderr
        assert words in result.stdout


@pytest.mark.slow
def test_a_method_without_an_accurate_point_has_its_map_nevertheless(monkeypatch: pytest.MonkeyPatch) -> None:
    def refused(*_: object, **__: object) -> None:
        raise InputError("RK4: no feedback decays so fast")

    monkeypatch.setattr("bezstab.questions.regions.choose", refused)
    result = run(*MAP, "--format", "csv")
    assert result.exit_code == 0
    assert "no most accurate point: RK4: no feedback decays so fast" in result.stderr
    assert "wrote region_RK4_accuracy.png" in result.stderr


TRADE = ("tradeoff", "--predicted", "--method", "RK4", "--method", "B4")


@pytest.mark.slow
def test_the_predicted_trade_is_the_front(tmp_path: Path) -> None:
    found = rows(*TRADE, "--level", "0.99", "--level", "0.7", "--h", "0.001", "--omega", "10")
    fronts = [point for name in ("RK4", "B4") for point in error_front(lookup(name), [0.99, 0.7])]
    assert {path.name for path in tmp_path.iterdir()} == {"tradeoff_predicted.csv", "tradeoff_predicted.png"}
    assert len(found) == len(fronts) == 6  # each method's least |z_p| besides
    for row, point in zip(found, fronts, strict=True):
        assert (row["method"], row["z_abs_below"]) == (point.method.name, point.z_abs_below)
        assert (row["alpha_hat"], row["combined_error"]) == (point.alpha_hat, point.combined_error)
        alpha, beta = from_dimensionless(point.alpha_hat, point.beta_hat, 0.001)
        assert (row["alpha"], row["beta"]) == (pytest.approx(alpha), pytest.approx(beta))
        reached = spectral_radius(lookup(point.method.name), number(row, "alpha_hat"), number(row, "beta_hat"))
        assert reached <= number(row, "z_abs_below") + 1e-6
    first = [path.read_bytes() for path in sorted(tmp_path.iterdir())]
    rows(*TRADE, "--level", "0.99", "--level", "0.7", "--h", "0.001", "--omega", "10")
    assert [path.read_bytes() for path in sorted(tmp_path.iterdir())] == first


@pytest.mark.slow
def test_without_a_step_there_is_nothing_in_seconds_and_the_usual_rates() -> None:
    found = rows(*TRADE[:4], *NOTHING)
    assert [row["z_abs_below"] for row in found[:-1]] == list(RATES)
    assert {(row["h"], row["alpha"], row["beta"]) for row in found} == {(None, None, None)}
    assert "α (1/s)" not in run(*TRADE, "--level", "0.9", *NOTHING).stdout


@pytest.mark.parametrize(
    ("command", "said"),
    [
        ("region --accuracy --compare", "--compare does not go with --accuracy: it draws one map for each method"),
        ("region --accuracy --alpha-beta --h 0.01", "--alpha-beta does not go with --accuracy"),
        (
            "region --accuracy --scene driven_four_bar --h 0.01 --speed 1 --speed 2",
            "--accuracy takes one --speed, but 2 were given",
        ),
        ("region --accuracy --speed 2", "--speed needs --scene"),
        ("region --accuracy --scene driven_four_bar", "--scene needs --h"),
        ("region --accuracy --omega 3", "--omega needs --h"),
        ("region --accuracy --omega 0 --h 1", "'--omega': 0 is not positive"),
        ("region --accuracy --omega 10 --h 0.1", "--omega 10: omega h = 1 rad a step: expected 1e-06 to 1"),
        ("region --accuracy --alpha-range 0 1", "--alpha-range 0 1: the axes of --accuracy are logarithmic"),
        ("region --accuracy --beta-range -1 1", "--beta-range -1 1: the axes of --accuracy are logarithmic"),
        ("region --omega 3 --h 0.01", "--omega needs --accuracy"),
        ("tradeoff --predicted --alpha 1 --beta 1", "--alpha does not go with --predicted: it simulates nothing"),
        ("tradeoff --predicted --time 3", "--time does not go with --predicted: it simulates nothing"),
        ("tradeoff --predicted --against time", "--against does not go with --predicted: it simulates nothing"),
        ("tradeoff --predicted --level 1", "--level 1: expected a |z_p| below 1"),
        ("tradeoff --predicted --level 0", "'--level': 0 is not positive"),
        ("tradeoff --predicted --h 0.1", "--predicted with --h needs --omega or --scene"),
        ("tradeoff --predicted --h 0.1 --h 0.2 --omega 1", "--predicted takes one --h, but 2 were given"),
        ("tradeoff --predicted --omega 3", "--omega needs --h"),
        ("tradeoff --predicted --speed 2", "--speed needs --scene"),
        ("tradeoff --predicted -o file/below", "file/below"),
        ("tradeoff --level 0.9", "--level needs --predicted"),
        ("tradeoff --alpha 1 --beta 1 --omega 3", "--omega does not go with --alpha and --beta"),
        ("tradeoff --omega 100", "--omega 100: omega h = 2 rad a step: expected 1e-06 to 1"),
    ],
)
def test_a_mistake_is_answered_in_a_line_and_nothing_is_written(command: str, said: str, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("", encoding="utf-8")
    result = run(*command.split())
    assert result.exit_code == 2
    assert said in result.stderr
    assert len(result.stderr.splitlines()) == 1
    assert result.stdout == ""
    assert [path.name for path in tmp_path.iterdir()] == ["file"]
