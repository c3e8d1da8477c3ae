"""What |z_p| tends to far out, against |z_p| itself out there, on its way and all around."""

import numpy as np
import pytest

from bezstab.methods import lookup
from bezstab.stability import spectral_radius
from bezstab.stability.far_limits import least_far_limit
from bezstab.stability.plane_pencils import plane_pencil_of
from tests.reference.second_order_methods import second_order


@pytest.mark.parametrize("name", ["average-acceleration", "hht", "generalized-alpha", "imex-euler", "implicit-euler"])
def test_far_out_on_its_way_the_modulus_comes_to_it_and_nowhere_below(name: str) -> None:
    method = lookup(name) if name != "implicit-euler" else second_order("implicit euler")
    limit = least_far_limit(plane_pencil_of(method))
    on_the_way = [float(spectral_radius(method, *limit.point(t))) for t in (1e4, 1e8)]
    assert on_the_way[1] == pytest.approx(limit.z_abs, abs=1e-2)  # where four poles meet in the limit: (1/t)^(1/4)
    far = np.geomspace(1e8, 1e10, 9)
    ratios = np.geomspace(1e-4, 1e4, 33)
    all_round = spectral_radius(method, far[:, np.newaxis] * ratios, far[:, np.newaxis])
    assert all_round.min() > limit.z_abs - 1e-2
