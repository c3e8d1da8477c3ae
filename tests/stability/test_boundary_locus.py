import numpy as np
import pytest

from bezstab.errors import NumericalError
from bezstab.stability import Region, best_point, region
from tests.reference.companion_poles import radius
from tests.reference.made_methods import multistep, runge_kutta


def test_an_edge_that_several_roots_reach_together_is_reported() -> None:
    """With mu = rho/sigma of equal modulus in three places of the circle, every arc has other roots on it."""
    method = multistep("together", "1 -1 1 -1", "0 1 -2 3")
    assert radius(method, np.array([0.6]), np.array([0.08])) < 0.8  # there is a region
    with pytest.raises(NumericalError, match="several roots share it"):
        region(method)


@pytest.mark.slow
def test_an_arc_shorter_than_the_sampling_is_found() -> None:
    """Just above the least |z_p| = 0.79880 the region is a sliver between two arcs, of 2e-3 and 5e-3 rad."""
    sliver = multistep("sliver", "1 -7/8 13/24 -2/3 -1/4 1/4", "0 -7/2 9/2 -1 5/2 -23/24")
    by_slices = 9.663030e-10  # whose ends are proven: sliced_areas takes minutes for it
    assert region(sliver, 0.8).area == pytest.approx(by_slices, rel=2e-6)
    least = best_point(sliver)
    assert least
    assert region(sliver, (1 + 1e-5) * least.z_abs).area  # 1e-15 of the other: both arcs lie between two samples


def test_two_roots_that_meet_on_the_circle_outside_every_region_leave_none() -> None:
    assert region(multistep("meet", "1 0 -1", "0 6 -4")).area == 0


def test_roots_that_stay_on_the_circle_leave_no_region() -> None:
    # leapfrog: z1 z2 = -1
    leapfrog = multistep("leapfrog", "1 0 -1", "0 2 0")
    assert region(leapfrog) == Region(leapfrog, 1.0)


def test_a_region_of_which_a_strip_lies_far_away_is_not_empty() -> None:
    """|R| < 1 also near -4000: with a mu there beta_hat exceeds 1e7, and the area is 2e-10 of the region's box."""
    shape = region(runge_kutta("far", "1/4000;0 87/50;0 0 3/250", "0 0 0 1"))
    r, one = np.array([[0.012 * 1.74 / 4000, 0.012 * 1.74, 0.012, 1, 1], [0, 0, 0, 0, 1]])
    far, near = sorted(float(z.real) for z in np.roots(r + one) if z.imag == 0)  # R = -1; 1 there and at 0
    width = far - min(float(z.real) for z in np.roots(r - one))
    x, y = (np.arange(1000) + 0.5) / 200 - 3, (np.arange(2000)[:, np.newaxis] + 0.5) / 200
    conjugate = 4 * (y * (np.abs(np.polyval(r, x + 1j * y)) < 1)).sum() / 200**2
    strip = width * -near * (near / 2 - far)
    assert shape.area == pytest.approx(conjugate - near**3 / 6 + strip, rel=1e-4)  # pixels of 1/200
    assert shape.extent
    assert shape.extent[1][1] > 1e7
