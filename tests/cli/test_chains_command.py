from pathlib import Path

import pytest

from tests.cli.running import rows, run


def test_chains_prints_the_fewest_stable_sweeps_and_draws(tmp_path: Path) -> None:
    options = ("--engine", f"chipmunk={0.9**60!r}", "--h", "1/60", "--mass-ratio", "10", "--to", "5", "-o", "there")
    found = rows("chains", *options)
    assert [row["chain_bodies"] for row in found] == [1, 2, 3, 4, 5]
    assert [row["stable_iterations"] for row in found[2:]] == [3, 4, 5]  # two bodies are marginal with one sweep
    assert {row["chain_mass_ratio"] for row in found} == {10}
    assert found[0]["swept_z_abs"] == pytest.approx(0.9)
    assert (tmp_path / "there" / "chains_chipmunk.png").read_bytes().startswith(b"\x89PNG")


def test_chains_says_what_its_sweeps_are() -> None:
    result = run(
        "chains", "--engine", "bullet=0.2", "--h", "1/60", "--to", "1", "--mass-ratio", "1", "--figure", "none"
    )
    assert result.exit_code == 0
    assert result.stdout.startswith("1 body: stable from 1 sweep. With 10 sweeps each step")
    assert "bullet: sweeps are its m_numIterations" in result.stderr


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--engine", "mujoco=0.02,1"), "mujoco solves all constraints together"),
        (("--engine", "bullet=0.2", "--to", "0"), "expected 1 to 100 bodies"),
        (("--engine", "bullet=0.2", "--mass-ratio", "0"), "--mass-ratio 0: expected"),
    ],
)
def test_what_is_no_chain_is_one_line(options: tuple[str, ...], said: str) -> None:
    result = run("chains", *options, "--h", "1/60", "--figure", "none")
    assert (result.exit_code, result.stdout) == (2, "")
    assert said in result.stderr
