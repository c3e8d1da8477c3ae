import math

import mpmath as mp
import numpy as np
import pytest

from bezstab.mechanism import (
    acceleration_function,
    compiled_mechanism,
    initial_state,
    load_scene,
    multipliers_function,
    observe,
    shipped_scenes,
)
from bezstab.mechanism.compiled import slope_function


def test_a_scene_is_compiled_once() -> None:
    assert compiled_mechanism(load_scene("pendulum")) is compiled_mechanism(load_scene("pendulum"))


def test_a_mechanism_prints_in_one_line() -> None:
    mechanism = compiled_mechanism(load_scene("slider_crank"))
    assert repr(mechanism) == "Mechanism(slider-crank, 5 coordinates, 4 constraints)"


def test_multipliers_are_the_same_in_every_arithmetic() -> None:
    mechanism = compiled_mechanism(load_scene("slider_crank"))
    q, v = initial_state(mechanism)
    seen = observe(mechanism, np.zeros(1), q[np.newaxis], v[np.newaxis], 3.0, 4.0)
    floats = multipliers_function(mechanism, math)(0.0, 3.0, 4.0, q.tolist(), v.tolist())
    arrays = multipliers_function(mechanism, np)(0.0, 3.0, 4.0, q[:, np.newaxis], v[:, np.newaxis])
    with mp.workdps(30):
        precise = multipliers_function(mechanism, mp)(
            mp.mpf(0), mp.mpf(3), mp.mpf(4), [mp.mpf(x) for x in q], [mp.mpf(x) for x in v]
        )
    scale = np.abs(floats).max()  # gains this small leave the rounding of c, which beta^2 multiplies, below it
    assert np.stack(arrays, axis=-1) == pytest.approx(seen.multipliers, abs=0)
    assert floats == pytest.approx(seen.multipliers[0], abs=1e-13 * scale)
    assert floats == pytest.approx([float(x) for x in precise], abs=1e-13 * scale)


@pytest.mark.parametrize("scene", [name for name in shipped_scenes() if name != "n_four_bar"])
def test_accelerations_change_as_their_slope_says(scene: str) -> None:
    """Along a direction, off the constraints, against differences of 50 digits."""
    mechanism, shift = compiled_mechanism(load_scene(scene)), mp.mpf(10) ** -20
    acceleration, slope = acceleration_function(mechanism, mp), slope_function(mechanism, mp)
    with mp.workdps(50):
        situation = (mp.mpf(1) / 1000, mp.mpf(600), mp.mpf(40000))
        q, v = ([mp.mpf(x) + mp.mpf(1) / 1000 for x in part.tolist()] for part in initial_state(mechanism))
        dq, dv = ([mp.mpf(1 + (i + first) % 3) for i in range(mechanism.size)] for first in (0, 1))

        def moved(sign: int) -> tuple[mp.mpf, ...]:
            moved_q = [x + sign * shift * d for x, d in zip(q, dq, strict=True)]
            moved_v = [x + sign * shift * d for x, d in zip(v, dv, strict=True)]
            return acceleration(*situation, moved_q, moved_v)

        differences = [(a - b) / (2 * shift) for a, b in zip(moved(1), moved(-1), strict=True)]
        scale = max(map(abs, differences))
        assert scale > 1
        changes = slope(*situation, q, v, dq, dv)
        assert max(abs(a - b) for a, b in zip(changes, differences, strict=True)) < mp.mpf(10) ** -20 * scale
