import math

import mpmath as mp
import numpy as np
import pytest

from bezstab.mechanism import compiled_mechanism, initial_state, load_scene, multipliers_function, observe


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
