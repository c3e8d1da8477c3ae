"""What `engines` says of an engine: its defaults as a point, what to set for one, and what was run."""

from fractions import Fraction

import pytest

from bezstab.catalogue.answer import engine_facts
from bezstab.engines.engine_list import ENGINES
from tests.cli.running import run

H = Fraction(1, 100)


def test_defaults_are_shown_as_the_point_that_the_engine_makes_of_them() -> None:
    """k = 100 and d = 20 of RigidBodyDynamics.jl: alpha_hat = d h, beta_hat = k h^2; MapleSim has none."""
    usual = [engine_facts(ENGINES[name], H).usual for name in ("bullet", "rigidbodydynamics.jl", "maplesim")]
    assert usual == [(1, Fraction(1, 5)), (20 * H, 100 * H**2), None]


def test_a_point_comes_as_what_to_set_or_as_the_reason_why_nothing_can_be() -> None:
    asked = Fraction(1), Fraction(1, 5)
    assert engine_facts(ENGINES["ode"], H, asked).setting == "ERP = 0.2"
    assert "reaches only" in str(engine_facts(ENGINES["physx"], H, asked).setting)
    assert engine_facts(ENGINES["ode"], H).setting is None


def test_the_list_is_a_line_an_engine_and_a_name_shows_the_rest(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("COLUMNS", raising=False)
    lines = run("engines").output.splitlines()
    assert [line.split()[0] for line in lines[2 : 2 + len(ENGINES)]] == list(ENGINES)
    assert max(map(len, lines[1 : 2 + len(ENGINES)])) <= 120
    shown = run("engines pybullet").output
    for heading in ("left out", "source", "a spinning body", "sweeps in a step"):
        assert f"\n{heading} " in shown
        assert heading not in lines[1]
