from fractions import Fraction

import pytest

from bezstab.engines.engine_list import ENGINES

H = Fraction(1, 100)


@pytest.mark.parametrize(
    ("name", "typed", "clamped", "note"),
    [
        ("mujoco", ("0.001", 1, "0.9", "0.9"), ("0.02", 1), "refsafe raises timeconst 0.001 s to 2h = 0.02 s"),
        ("genesis", ("0.001",), ("0.02",), "constraint_timeconst 0.001 s is raised to 2h = 0.02 s"),
        ("box2d", (60, 2), (25, 2), "hertz 60 is clamped to 0.25/h = 25"),
        ("drake-sap", (10**9, 0, 1), (), "near rigid: k is lowered until w/R = 3948, and tau is h"),
    ],
)
def test_values_that_an_engine_clamps_are_told(
    name: str, typed: tuple[str | int, ...], clamped: tuple[str | int, ...], note: str
) -> None:
    engine, values = ENGINES[name], tuple(map(Fraction, typed))
    applied = engine.applied(values, H)
    assert applied.point == engine.read(H, *map(Fraction, clamped)) != engine.read(H, *values)
    assert applied.notes == (note,)
