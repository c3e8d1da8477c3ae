"""Points as they are typed: an engine's words, a drive's gains, units that were probably meant, feedback to choose."""

import math
from typing import Any

import pytest

from tests.cli.running import DATA, rows, run


@pytest.mark.parametrize(
    ("name", "alpha", "beta", "verdict"),
    [
        ("SYM", "1", "2.00000000000000000001", "diverges"),
        ("RK1", "6/11", "6/11", "marginal"),
        ("RK1", "2.00000000000000000002", "2", "converges"),
    ],
)
def test_the_verdict_is_proven_on_the_numbers_as_typed(name: str, alpha: str, beta: str, verdict: str) -> None:
    (row,) = rows(f"poles --method {name} --alpha {alpha} --beta {beta}")
    assert row["verdict"] == verdict


def test_omega_times_h_is_taken_exactly_as_typed_and_h_alone_makes_no_unit() -> None:
    point = "check --method SYM --alpha 1 --beta 1/2"
    (row,) = rows(point, "--h 1/240 --omega 12")
    assert row["omega_h"] == 1 / 20
    (usual,) = rows(point)
    assert (usual["alpha_hat"], usual["z_abs"]) == (row["alpha_hat"], row["z_abs"])


def test_an_engines_clamps_are_applied_unless_told_not_to() -> None:
    words = "check --engine mujoco=0.0001,1 --h 0.002"
    applied = run(words)
    assert applied.exit_code == 0
    assert "refsafe raises timeconst 0.0001 s" in applied.stderr
    assert "mujoco: left out: " in applied.stderr
    given = rows(words, "--as-typed", status=1)[0]
    assert (given["alpha_hat"], given["applied"]) == (40, "as typed")


def test_what_is_meant_in_seconds_has_a_largest_step_and_what_is_meant_per_step_has_none() -> None:
    def limits(words: str, status: int = 0) -> tuple[Any, Any]:
        row = rows("check --h 1/240 --engine", words, status=status)[0]
        return row["h_limit"], row["h_factor"] / 240

    for words in ("bullet=0.2", "box2d=60,2", "mujoco=0.02,1"):
        assert limits(words)[0] is None
    # 2h / timeconst reaches 4 sqrt 2 - 4, where the critically damped path leaves SYM's triangle
    assert limits("mujoco=0.02,1 --as-typed")[0] == pytest.approx(0.02 * (2 * math.sqrt(2) - 2), rel=1e-12)
    # stiffness and damping stay as they are, as alpha and beta do: the two ways agree
    of_the_engine, of_alpha_and_beta = limits("brax-spring=5000,20,1")
    assert of_the_engine == pytest.approx(of_alpha_and_beta, rel=1e-9)


@pytest.mark.parametrize(
    ("typed", "note"),
    [
        ("check --method SYM --alpha 50 --beta 50.5 --h 0.002", "if 50 and 50.5 are in 1/s, add --physical"),
        ("check --method SYM --alpha 50 --beta 50.5 --h 0.002 --physical", ""),
        ("check --method SYM --alpha 14217 --beta 16544 --h 0.002 --physical", ""),  # meant so, and unsafe
        (
            "poles --alpha 50 --beta 50",
            "if 50 and 50 are in 1/s, add --physical and your --h",
        ),  # no step to read them at
        (f"probe {DATA}/pendulum.csv --alpha 50 --beta 50", "if 50 and 50 are in 1/s, add --physical and your --h"),
        # they would settle in seconds, where a step was typed
        ("check --method RK2 --alpha 1 --beta 1 --h 0.01", "if 1 and 1 are in 1/s, add --physical"),
        ("check --method RK4 --alpha 1/2 --beta 1/10 --h 1/100", ""),  # in 700 s: a feedback that nobody has
        ("check --method SYM --alpha 4 --beta 3", ""),  # unstable, but no numbers of 1/s
        ("verify --scene pendulum --method SYM --h 0.01 --alpha 5 --beta 5", "if 5 and 5 are in 1/s, add --physical"),
        ("simulate --time 0.02 --figure none --table none --method SYM --h 0.01 --alpha 5 --beta 5", "if 5 and 5 are"),
        ("tradeoff --method SYM --h 0.002 --time 0.01 --alpha 50 --beta 50 --figure none --table none", "if 50 and 50"),
    ],
)
def test_numbers_that_look_like_one_over_seconds_are_asked_about(typed: str, note: str) -> None:
    said = [line.removeprefix("note: ") for line in run(typed).stderr.splitlines() if line.startswith("note: ")]
    assert [line[: len(note)] for line in said] == [note] * bool(note)
    assert "your --h" in note or not any("your --h" in line for line in said)


@pytest.mark.parametrize(
    "point", ["--h 1/240 --alpha 60 --beta 60.1 --physical", "--engine maplesim=60,60.1 --h 0.003"]
)
def test_what_was_typed_is_shown_as_typed(point: str) -> None:
    given = rows("check --method SYM", point)[0]
    assert (given["alpha"], given["beta"]) == (60, 60.1)


def test_a_step_is_taken_as_often_as_typed() -> None:
    (row,) = rows("simulate --scene pendulum --method SYM --steps 3*0.01,0.02 --time 0.05 --figure none --table none")
    assert (row["time"], row["evaluations"]) == (pytest.approx(0.05), 4)
