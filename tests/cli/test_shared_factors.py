"""A method whose rho and sigma share a factor, through the command line: one clear answer each."""

import json
from pathlib import Path

import pytest

from bezstab.methods import lookup
from bezstab.stability import best_point, choose, region
from tests.cli.running import run

AB2_TIMES = {
    "0.9": (["1", "-19/10", "9/10", "0"], ["0", "3/2", "-37/20", "9/20"]),
    "-0.9": (["1", "-1/10", "-9/10", "0"], ["0", "3/2", "17/20", "-9/20"]),
    "±i": (["1", "-1", "1", "-1", "0"], ["0", "3/2", "-1/2", "3/2", "-1/2"]),
    "-1": (["1", "0", "-1", "0"], ["0", "3/2", "1", "-1/2"]),
}


@pytest.fixture
def files(tmp_path: Path) -> dict[str, str]:
    for number, (rho, sigma) in enumerate(AB2_TIMES.values()):
        (tmp_path / f"{number}.toml").write_text(f"rho = {json.dumps(rho)}\nsigma = {json.dumps(sigma)}\n")
    return {root: str(tmp_path / f"{number}.toml") for number, root in enumerate(AB2_TIMES)}


def region_row(path: str) -> dict[str, object]:
    result = run("region", "--method", path, "--figure", "none", "--table", "none", "--format", "json")
    assert result.exit_code == 0
    (row,) = json.loads(result.stdout)
    return dict(row)


@pytest.mark.parametrize("root", ["0.9", "-0.9"])
def test_a_root_inside_the_circle_leaves_the_region_and_bounds_the_decay(root: str, files: dict[str, str]) -> None:
    row = region_row(files[root])
    best = best_point(lookup("AB2"))
    assert best
    assert row["area"] == region(lookup("AB2")).area
    assert (row["best_z_abs"], row["best_alpha_hat"]) == (pytest.approx(0.9), best.alpha_hat)
    assert row["best_where"] == f"a pole stays at {root} whatever α̂ and β̂"


@pytest.mark.parametrize("goal", ["robust", "fastest"])
def test_the_choice_is_that_without_the_factor(goal: str, files: dict[str, str]) -> None:
    result = run("choose", "--method", files["-0.9"], "--h", "0.001", "--goal", goal, "--format", "json")
    (row,) = json.loads(result.stdout)
    expected = choose(lookup("AB2"), goal)  # type: ignore[arg-type]
    assert (row["alpha_hat"], row["beta_hat"], row["z_abs"]) == pytest.approx(
        (expected.alpha_hat, expected.beta_hat, 0.9), rel=1e-9
    )


@pytest.mark.promise("Poles that no feedback moves, where ρ and σ share a factor")
@pytest.mark.parametrize("root", ["±i", "-1"])
def test_a_root_on_the_circle_leaves_nothing(root: str, files: dict[str, str]) -> None:
    row = region_row(files[root])
    assert (row["area"], row["best_z_abs"]) == (0, None)
    assert row["best_where"] == f"stable nowhere: a pole stays at {root} whatever α̂ and β̂"
    result = run("choose", "--method", files[root], "--h", "0.001")
    assert result.exit_code == 2
    assert f"is not stable with any α and β: a pole stays at {root} on the unit circle" in result.stderr
