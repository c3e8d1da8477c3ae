import json
import re
from pathlib import Path

import pytest

from tests.cli.running import rows, run


def test_choose_prints_what_to_set() -> None:
    (row,) = rows("choose", "--h", "0.001", "--goal", "fastest")
    keys = "method h goal alpha_hat beta_hat alpha beta z_abs z_angle_deg settle_steps settle_seconds h_limit"
    assert set(keys.split()) <= set(row)
    assert row["z_abs"] == pytest.approx(0.625883502027, abs=1e-7)  # a double mu: half the digits
    assert row["alpha"] == pytest.approx(1000 * 1.0126978003 / 2)
    assert row["beta"] == pytest.approx(1000 * 0.2563892087**0.5)
    assert row["h_limit"] == pytest.approx(0.0015683, rel=1e-4)
    (gentle,) = rows("choose", "--h", "0.001", "--goal", "gentle", "--settle", "0.5")
    assert gentle["settle_steps"] == 500
    assert gentle["alpha"] == pytest.approx(gentle["beta"])
    (finer,) = rows("choose", "--h", "0.001", "--h-max", "0.002", "--method", "SYM")
    (coarse,) = rows("choose", "--h", "0.002", "--method", "SYM")
    assert (finer["alpha"], finer["beta"], finer["h_limit"]) == pytest.approx(
        (coarse["alpha"], coarse["beta"], coarse["h_limit"])
    )


def test_an_engines_own_words_are_read_and_printed(tmp_path: Path) -> None:
    (given, _) = rows("check", "--engine", "mujoco=0.004,1", "--h", "0.002", "--as-typed")
    assert (given["alpha_hat"], given["beta_hat"], given["z_abs"]) == (1, 0.25, 0.75)
    (row,) = rows("choose", "--engine", "mujoco", "--h", "0.002")
    assert row["method"] == "SYM"
    k, c = re.findall(r"-([\d.]+)", str(row["setting"]))
    assert (float(c) * 0.002, float(k) * 0.002**2) == pytest.approx((row["alpha_hat"], row["beta_hat"]))
    listed = {str(row["engine"]): row for row in rows("engines", "--alpha", "1", "--beta", "0.2", "--h", "0.002")}
    assert listed["ode"]["setting"] == "ERP = 0.2"
    assert "dampingRatio = 2" in str(listed["box2d"]["setting"])
    assert "α̂ = β̂" in str(listed["pbd"]["setting"])
    assert all(row["excludes"] and row["source"] for row in listed.values())
    rows("region", "--method", "SYM", "--engine", "mujoco", "--h", "0.002", "--figure", "svg", "--table", "none")
    assert "timeconst" in (tmp_path / "region_SYM.svg").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("name", "verdict"),
    [
        *(("RK2", "converges"), ("RK1", "marginal"), ("SYM", "diverges")),
        *(pytest.param(name, "diverges", marks=pytest.mark.slow) for name in ("AB2", "AB3", "AB4")),
    ],
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
