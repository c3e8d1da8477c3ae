import math

import mpmath as mp
import numpy as np
import pytest

from bezstab.mechanism import (
    compiled_mechanism,
    initial_state,
    load_scene,
    multipliers_function,
    observe,
    shipped_scenes,
)
from bezstab.mechanism.compiled import compiled_residuals
from bezstab.methods import lookup


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
def test_the_residuals_of_a_scene_change_as_their_slope_says(scene: str) -> None:
    """Along a direction of the unknowns of two evaluations, off the constraints, against differences of 50 digits."""
    mechanism, h, shift = compiled_mechanism(load_scene(scene)), mp.mpf(1) / 1000, mp.mpf(10) ** -20
    ((_, residual),) = compiled_residuals(mechanism, lookup("gauss4"), mp).items()
    count = mechanism.size * residual.evaluations
    with mp.workdps(50):
        q, v = ([mp.mpf(x) for x in part.tolist()] for part in initial_state(mechanism))
        situation = (mp.mpf(0), 3, h, mp.mpf(600), mp.mpf(40000))
        known = [*(x + h for x in q), *(x * h + h for x in v)] * residual.evaluations
        unknown = [mp.mpf(i + 1) / 10**4 for i in range(count)]
        direction = [mp.mpf(1 + i % 3) for i in range(count)]
        slopes, up, down = ([mp.mpf(0)] * count for _ in range(3))
        residual.slope(situation, known, unknown, direction, slopes)
        for values, sign in ((up, 1), (down, -1)):
            moved = [u + sign * shift * d for u, d in zip(unknown, direction, strict=True)]
            residual.residual(situation, known, moved, values)
        differences = [(a - b) / (2 * shift) for a, b in zip(up, down, strict=True)]
        scale = max(map(abs, differences))
        assert scale > 1
        assert max(abs(a - b) for a, b in zip(slopes, differences, strict=True)) < mp.mpf(10) ** -20 * scale
