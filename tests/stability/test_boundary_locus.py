import numpy as np
import pytest

from bezstab.errors import NumericalError
from bezstab.stability import Region, pencil_of, region, spectral_radius
from bezstab.stability.boundary_locus import bounds_of
from tests.reference.companion_poles import radius
from tests.reference.sliced_areas import sliced_area
from tests.stability.made_methods import multistep, runge_kutta


@pytest.mark.promise(
    "Edges that several roots share",
    unknown=(
        "An edge that several roots share, or one shorter than its samples, may not be found: then no area is given"
    ),
)
def test_an_edge_that_several_roots_reach_together_is_reported() -> None:
    """With mu = rho/sigma of equal modulus in three places of the circle, every arc has other roots on it."""
    method = multistep("together", "1 -1 1 -1", "0 1 -2 3")
    assert radius(method, np.array([0.6]), np.array([0.08])) < 0.8  # there is a region
    with pytest.raises(NumericalError, match="several roots share it"):
        region(method)


@pytest.mark.slow
def test_an_arc_shorter_than_the_sampling_is_found() -> None:
    """Just above the least |z_p| = 0.79880 the region is a sliver between two arcs, of 2e-3 and 5e-3 rad."""
    method, level = multistep("sliver", "1 -7/8 13/24 -2/3 -1/4 1/4", "0 -7/2 9/2 -1 5/2 -23/24"), 0.8
    shape = region(method, level)
    assert shape.extent
    alpha_hat, beta_hat = (np.linspace(low, high, 1200) for low, high in shape.extent)
    inside = (spectral_radius(method, alpha_hat, beta_hat[:, np.newaxis]) < level).sum()
    pixel = (alpha_hat[1] - alpha_hat[0]) * (beta_hat[1] - beta_hat[0])
    assert shape.area == pytest.approx(inside * pixel, rel=0.1)  # some 800 pixels, most of them at an edge


@pytest.mark.slow
def test_an_arc_that_ends_just_short_of_the_real_axis_bounds_an_interval() -> None:
    method = multistep("short of it", "1 -1 0 -3/8 3/8 1/4 -1/4", "0 1/4 5/3 -1 9/5 -1/4 -191/120")
    assert region(method).area == pytest.approx(sliced_area(method, 1.0), rel=1e-8)  # it ends 4e-9 of |mu| from it


def test_two_roots_that_meet_on_the_circle_outside_every_region_leave_none() -> None:
    assert region(multistep("meet", "1 0 -1", "0 6 -4")).area == 0


def test_roots_that_stay_on_the_circle_leave_no_region() -> None:
    # leapfrog: z1 z2 = -1
    leapfrog = multistep("leapfrog", "1 0 -1", "0 2 0")
    assert region(leapfrog) == Region(leapfrog, 1.0, 0.0, (), None)


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


def test_where_the_modulus_touches_the_level_an_interval_ends() -> None:
    """Chebyshev's R(mu) = T_3(1 + mu/9) touches -1 at mu = -4.5 and 1 at -13.5, inside (-18, 0)."""
    chebyshev = runge_kutta("chebyshev", "1/27;0 4/27", "0 0 1")
    intervals = bounds_of(pencil_of(chebyshev), 1.0).intervals
    assert (intervals[0][0], intervals[-1][1]) == pytest.approx((-18, 0), abs=1e-12)
    for touched in (-4.5, -13.5):  # double roots: known to the root of rounding
        assert not any(start + 1e-6 < touched < end - 1e-6 for start, end in intervals)
