from pathlib import Path

import pytest

from tests.cli.running import arrays, rows, run


@pytest.mark.slow
def test_verify_takes_implicit_and_second_order_methods() -> None:
    for name in ("radau3", "hht", "verlet-old"):
        point = ("--alpha", "0.5", "--beta", "0.4", "--method", name)
        (row,) = rows("verify", "--scene", "pendulum", *point)
        assert row["measured_z_abs"] == pytest.approx(row["predicted_z_abs"], abs=1e-5)
        assert row["verdicts_agree"] is True


@pytest.mark.slow
def test_verify_prints_predicted_and_measured_pole(tmp_path: Path) -> None:
    (row,) = rows("verify", "--alpha", "0.5", "--beta", "0.1", "--method", "AB4")
    assert row["scene"] == "slider-crank"
    assert row["measurable"] is True
    assert row["predicted_z_abs"] == pytest.approx(0.998848, abs=1e-6)
    assert row["measured_z_abs"] == pytest.approx(row["predicted_z_abs"], abs=1e-4)
    assert row["measured_z_angle_deg"] == pytest.approx(row["predicted_z_angle_deg"], abs=0.01)
    assert row["predicted_verdict"] == row["measured_verdict"] == "converges"
    (gone,) = rows("verify", "--alpha", "2", "--beta", "2", "--method", "RK2")  # deadbeat: nothing is left to measure
    assert gone["measurable"] is False
    assert gone["measured_z_abs"] is None
    assert gone["reason"]
    assert gone["measured_verdict"] == "converges"
    assert len(rows("verify", "--points", "3", "--method", "B4", "--method", "SYM")) == 6
    assert not list(tmp_path.iterdir())


@pytest.mark.slow
def test_verify_map_writes_verdicts_and_figure(tmp_path: Path) -> None:
    (row,) = rows("verify", "--map", "5", "--scene", "pendulum", "--method", "SYM", "--table", "npz")
    assert (row["runs"], row["judged_runs"], row["agreeing"], row["disagreeing"]) == (25, 25, 25, 0)
    assert row["agreeing_share"] == 1
    assert row["band"] == 0.005
    assert sorted(path.suffix for path in tmp_path.iterdir()) == [".npz", ".png"]
    columns = arrays(tmp_path / "verify_pendulum_SYM.npz")
    assert (columns["diverges"] == (columns["z_abs"] >= 1)).all()


def test_what_is_thrown_apart_at_once_diverges_and_seconds_are_understood() -> None:
    at = ("verify", "--scene", "pendulum", "--method", "RK4")
    (gone,) = rows(*at, "--alpha", "14217", "--beta", "16544")  # |z| = 1.7e15: nothing stays finite
    assert (gone["measurable"], gone["measured_verdict"], gone["verdicts_agree"]) == (False, "diverges", True)
    # alpha = 400 1/s and beta = 500 1/s: alpha_hat = 2 alpha h, beta_hat = (beta h)^2
    (in_seconds,) = rows(*at, "--alpha", "400", "--beta", "500", "--h", "0.001", "--physical")
    assert (in_seconds["alpha_hat"], in_seconds["beta_hat"]) == (0.8, 0.25)
    mistaken = run(*at, "--alpha", "400", "--beta", "500", "--h", "0.001")
    assert "add --physical: bezstab verify --method RK4 --alpha 400 --beta 500 --h 0.001 --physical" in mistaken.stderr


@pytest.mark.slow
def test_verify_tells_what_the_motion_does_to_a_prediction() -> None:
    """The driven four-bar at omega h = 0.063: AB4 converges by the map, diverges by the law and by exact rates."""
    point = ("--method", "AB4", "--alpha", "0.5", "--beta", "0.1", "--h", "0.01")
    (row,) = rows("verify", "--scene", "driven_four_bar", *point, "--floquet")
    at_rest, law, exact = row["predicted_z_abs"], row["law_z_abs"], row["floquet_z_abs"]
    assert isinstance(at_rest, float)
    assert isinstance(law, float)
    assert isinstance(exact, float)
    assert at_rest < 1 < law
    assert abs(law - exact) < 0.2 * abs(at_rest - exact)
    assert row["measured_verdict"] == "diverges"
    assert row["right"] == "law, exact"


@pytest.mark.promise("Rates where drivers turn and oscillate")
@pytest.mark.parametrize(
    ("scene", "method", "said"),
    [
        ("driven_four_bar", "B4", "Exact rates of B4: along the method's own motion"),
        ("driven_four_bar", "bdf2", "Exact rates of bdf2: along the method's own motion"),  # implicit
        ("four_bar", "B4", "No rate of B4 is exact: the motion does not begin anew, as nothing drives it."),
    ],
)
@pytest.mark.slow
def test_exact_rates_are_said_to_be_along_which_motion(scene: str, method: str, said: str) -> None:
    point = ("--alpha", "0.5", "--beta", "0.1", "--h", "0.01")
    assert said in run("verify", "--scene", scene, "--method", method, *point, "--floquet").stdout.replace("\n", " ")


def test_without_floquet_nothing_exact_is_computed() -> None:
    (row,) = rows("verify", "--scene", "driven_four_bar", "--alpha", "0.5", "--beta", "0.2", "--h", "0.01")
    assert row["floquet_z_abs"] is None
    assert "exact |z|" not in run("verify", "--alpha", "0.5", "--beta", "0.2").stdout


@pytest.mark.slow
@pytest.mark.parametrize("scene", ["four_bar", "slider_crank_300rpm"])
@pytest.mark.parametrize("method", ["B4", "AB4", "AB7", "AB8", "RK4", "SYM"])
def test_on_fast_scenes_hardly_a_verdict_that_is_not_flagged_is_wrong(scene: str, method: str) -> None:
    measured = rows("verify", "--scene", scene, "--method", method, "--points", "200")
    assert sum(row["verdicts_agree"] is False for row in measured) <= 2


@pytest.mark.slow
def test_predicted_and_measured_errors_are_compared_at_shares_of_the_gains() -> None:
    command = ("verify", "--accuracy", "--scene", "driven_four_bar", "--h", "0.004", "--method", "SYM")
    found = rows(*command)
    assert [(row["gain_share"], row["h"]) for row in found] == [
        (share, h) for share in (0.2, 0.3, 0.5, 0.7, 1) for h in (0.004, 0.002)
    ]
    for row in found:
        assert row["quotient"] == pytest.approx(1, abs=0.05)
        assert row["predicted_order"] == (None if row["h"] == 0.004 else pytest.approx(2, abs=0.05))  # at strong gains
        assert row["reason"] == ""
    text = run(*command)
    assert text.exit_code == 0
    assert "the prediction holds" in text.stdout


@pytest.mark.slow
def test_where_the_prediction_does_not_hold_the_exit_status_says_so() -> None:
    # 40 steps a turn of the crank: AB4's fifth derivative needs the tenfold
    command = ("verify", "--accuracy", "--scene", "driven_four_bar", "--h", "0.025", "--method", "AB4")
    result = run(*command)
    assert result.exit_code == 1
    assert "the prediction does NOT hold" in result.stdout


@pytest.mark.slow
def test_what_is_as_small_as_rounding_is_not_compared() -> None:
    result = run("verify", "--accuracy", "--method", "ABM4")  # 4e-16 m on the slider-crank with the flywheel
    assert result.exit_code == 3
    assert "below 1e-14 rounding is as large" in result.stdout
    assert "ABM4: nothing could be compared." in result.stdout


def test_accuracy_goes_with_one_point_or_none() -> None:
    (mistaken, unstable) = (
        run("verify", "--accuracy", "--points", "3"),
        run("verify", "--accuracy", "--scene", "driven_four_bar", "--alpha", "0.5", "--beta", "1"),
    )
    assert (mistaken.exit_code, unstable.exit_code) == (2, 2)
    assert "--points does not go with --accuracy" in mistaken.stderr
    assert "B4 is not stable at 1 times the gains of α̂ = 0.5, β̂ = 1" in unstable.stderr
