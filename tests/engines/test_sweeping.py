"""Every engine that says how it sweeps: one constraint alone is its point, and numbers of sweeps are checked."""

from fractions import Fraction

import pytest

from bezstab.engines.engine_list import ENGINES
from bezstab.methods.registry import lookup
from bezstab.stability.closed_loop import spectral_radius
from bezstab.stability.sweeps import chain, swept_growth


@pytest.mark.parametrize("name", [name for name, engine in ENGINES.items() if engine.sweeping])
def test_one_constraint_swept_is_the_engines_point(name: str) -> None:
    engine, h = ENGINES[name], Fraction(1, 240)
    typed = {"chipmunk": ("1/500",), "box2d": (60, 2), "rapier": (30, 1), "jolt-spring": (5, "1/2"), "pbd": ("2/3",)}
    values = tuple(map(Fraction, typed.get(name, ("1/5",) * len(engine.parameters))))
    assert engine.sweeping
    assert engine.method
    growth = swept_growth(chain(1), engine.sweeping.step(engine.sweeping.iterations, h, *values))
    point = engine.applied(values, h).point
    assert growth.factor == pytest.approx(float(spectral_radius(lookup(engine.method), *map(float, point))), abs=1e-7)
    assert engine.sweeps
    assert engine.sweeping.source
    assert engine.sweeping.excludes
