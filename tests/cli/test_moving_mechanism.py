"""--scene and --speed of poles, choose, check and region."""

import pytest

from tests.cli.running import rows, run

FOUR_BAR = "--scene driven_four_bar"


def test_poles_print_what_the_motion_does() -> None:
    asked = "poles --alpha 0.5 --beta 0.1 --method B4 --method AB4"
    moving, at_rest = rows(asked, FOUR_BAR, "--h 0.01"), rows(asked)
    for row, plain in zip(moving, at_rest, strict=True):
        assert all(row[key] == plain[key] for key in ("z_abs", "verdict"))
        assert row["z_abs"] < row["z_abs_at_most"]
        assert row["kappa"] == pytest.approx(3.22, abs=0.01)  # 1/s: half of omega
    assert [row["moving_verdict"] for row in moving] == ["converges", "not settled"]
    assert [row["safe"] for row in (*at_rest, *moving)] == [True, True, True, False]


@pytest.mark.slow
def test_beyond_first_order_the_run_decides() -> None:
    result = run("choose --method AB4 --goal robust --h 0.02 --speed 1.8", FOUR_BAR)
    assert "turn by κh = 0.12 a step: beyond 0.1 nothing is settled" in result.stderr
    assert "The prediction settles nothing, but the run went through." in result.stdout
    assert result.exit_code == 0
