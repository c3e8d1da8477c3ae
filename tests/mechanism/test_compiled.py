import math

import mpmath as mp
import numpy as np
import pytest

from bezstab.mechanism import compiled_mechanism, initial_state, load_scene, observation_function, observe


def test_a_scene_is_compiled_once() -> None:
    assert compiled_mechanism(load_scene("pendulum")) is compiled_mechanism(load_scene("pendulum"))


def test_multipliers_are_the_same_in_every_arithmetic() -> None:
    """Of four constraints; before them come their c and cdot."""
    mechanism = compiled_mechanism(load_scene("slider_crank"))
    q, v = initial_state(mechanism)
    seen = observe(mechanism, np.zeros(1), q[np.newaxis], v[np.newaxis], 3.0, 4.0)
    floats = observation_function(mechanism, math)(0.0, 3.0, 4.0, q.tolist(), v.tolist())[8:12]
    arrays = observation_function(mechanism, np)(0.0, 3.0, 4.0, q[:, np.newaxis], v[:, np.newaxis])[8:12]
    with mp.workdps(30):
        precise = observation_function(mechanism, mp)(
            mp.mpf(0), mp.mpf(3), mp.mpf(4), [mp.mpf(x) for x in q], [mp.mpf(x) for x in v]
        )[8:12]
    scale = np.abs(floats).max()  # gains this small leave the rounding of c, which beta^2 multiplies, below it
    assert np.stack(arrays, axis=-1) == pytest.approx(seen.multipliers, abs=0)
    assert floats == pytest.approx(seen.multipliers[0], abs=1e-13 * scale)
    assert floats == pytest.approx([float(x) for x in precise], abs=1e-13 * scale)
