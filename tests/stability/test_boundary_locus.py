from dataclasses import replace
from math import pi

import numpy as np
import pytest
from numpy.polynomial.polynomial import polyval2d

from bezstab.errors import NumericalError
from bezstab.methods import LinearMultistep, lookup
from bezstab.stability import FloatArray, Region, pencil_of, region, spectral_radius
from bezstab.stability.boundary_locus import Arc, _ends_on_the_axis, bounds_of, rim_radius
from bezstab.stability.pencils import largest_root_in_z
from tests.methods.kinds import EXPLICIT, sampled
from tests.reference.companion_poles import radius
from tests.reference.sliced_areas import sliced_area
from tests.stability.made_methods import multistep, runge_kutta


def arcs(name: str, level: float) -> tuple[Arc, ...]:
    return bounds_of(pencil_of(lookup(name)), level).arcs


@pytest.mark.parametrize("name", sampled(EXPLICIT))
@pytest.mark.parametrize("level", [1.0, 0.9])
def test_an_arc_lies_in_the_upper_half_on_the_level(name: str, level: float) -> None:
    for arc in arcs(name, level):
        inner = arc.mu[20:-20]  # towards its ends other roots come near the circle too
        assert (inner.imag > 0).all()
        # an ABM has roots that nearly meet on the circle
        assert np.abs(largest_root_in_z(arc.pencil, inner)) == pytest.approx(level, abs=1e-6 if "ABM" in name else 1e-9)


def test_halves_that_agree_to_rounding_are_not_halved_further(monkeypatch: pytest.MonkeyPatch) -> None:
    """B4's density is smooth but at its ends: 16 nodes to each half, and as many halvings as digits at either end."""
    (arc,) = arcs("B4", 1.0)
    asked: list[int] = []
    density = Arc._area_density

    def counted(self: Arc, theta: FloatArray) -> FloatArray:
        asked.append(theta.size)
        return density(self, theta)

    monkeypatch.setattr(Arc, "_area_density", counted)
    arc.area()
    assert sum(asked) < 2 * 16 * 2 * 15


def axis_ends(theta: list[float], mu: list[complex]) -> FloatArray:
    """Return where B4's interval of the real axis may end, with one arc given by its samples; z = 1 is at mu = 0."""
    pencil = pencil_of(lookup("B4"))
    return _ends_on_the_axis(pencil, 1.0, [Arc(pencil, 1.0, np.array(theta), np.array(mu))])


def test_an_interval_may_end_where_an_arc_reaches_the_axis_with_a_pair_on_the_circle() -> None:
    solved = axis_ends([0.0, pi], [0j, 0j])  # at either angle z is real: these are solved for, whatever the arc says
    assert solved == pytest.approx([-27 / 34, 0], abs=1e-12)
    away = -0.5 + 0.1j
    assert axis_ends([2.0, 2.1, 2.2], [-0.5 + 0j, away, away]) == pytest.approx([-27 / 34, -0.5, 0], abs=1e-12)
    assert axis_ends([2.0, 2.1, 2.2], [away, away, -0.5 + 0j]) == pytest.approx([-27 / 34, -0.5, 0], abs=1e-12)
    assert axis_ends([0.0, 2.1, 2.2], [-0.5 + 0j, away, away]) == pytest.approx(solved, abs=0)
    assert axis_ends([2.0, 2.1, pi], [away, away, -0.5 + 0j]) == pytest.approx(solved, abs=0)


@pytest.mark.parametrize(("apart", "ends"), [(1e-6, 3), (1e-11, 2)])
def test_ends_of_an_interval_are_one_only_if_they_coincide_to_rounding(apart: float, ends: int) -> None:
    beside = -27 / 34 * (1 - apart) + 0j
    assert len(axis_ends([2.0, 2.1], [beside, -0.5 + 0.1j])) == ends


@pytest.mark.parametrize("name", ["B4", "AB4", "RK4"])
def test_between_its_samples_an_arc_is_solved_for(name: str) -> None:
    for arc in arcs(name, 1.0):
        theta = (arc.theta[1:] + arc.theta[:-1]) / 2
        residual = polyval2d(np.exp(1j * theta), arc.at(theta), pencil_of(lookup(name)).table)
        assert np.abs(residual).max() < 1e-12


@pytest.mark.parametrize("name", ["B4", "AB3", "AB4", "RK4"])
def test_nothing_on_an_arc_is_further_than_its_furthest(name: str) -> None:
    for arc in arcs(name, 1.0):
        theta = np.linspace(arc.theta[0], arc.theta[-1], 5000)
        for direction in ([1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.3, -1.0]):
            along = arc.coordinate(theta, np.array(direction)).max()
            assert along - 1e-12 < arc.furthest(np.array(direction)) < along + 1e-5


@pytest.mark.parametrize(("name", "direction"), [("B4", (0.0, 1.0)), ("AB3", (1.0, 0.0))])
def test_an_arc_turns_where_it_does_however_its_samples_lie(name: str, direction: tuple[float, float]) -> None:
    (arc,) = arcs(name, 1.0)
    (turn,) = arc.turns(np.array(direction))
    theta = np.array([arc.theta[0], turn - 0.006, turn + 0.005, turn + 0.1, arc.theta[-1]])  # nearly at a bracket's end
    few = replace(arc, theta=theta, mu=arc.at(theta))
    # where it turns it is flat: to the root of rounding
    assert few.turns(np.array(direction)) == pytest.approx([turn], abs=1e-7)


def test_the_interval_of_a_bezier_method_ends_at_zero_and_at_minus_one() -> None:
    scheme = lookup("B4").scheme
    assert isinstance(scheme, LinearMultistep)
    rho, sigma = (np.polyval(np.array(part, float), -1.0) for part in (scheme.rho, scheme.sigma))
    ((start, end),) = bounds_of(pencil_of(lookup("B4")), 1.0).intervals
    assert (start, end) == pytest.approx((rho / sigma, 0), abs=1e-12)


def on_locus(name: str) -> tuple[FloatArray, FloatArray]:
    """Return (-2 Re mu, |mu|^2) for mu = rho/sigma over the upper half circle, and |z_p| there."""
    scheme = lookup(name).scheme
    assert isinstance(scheme, LinearMultistep)
    z = np.exp(1j * np.linspace(0.01, 3.13, 500))
    mu = np.polyval(np.array(scheme.rho, float), z) / np.polyval(np.array(scheme.sigma, float), z)
    points = np.stack([-2 * mu.real, np.abs(mu) ** 2], axis=1)
    return points, radius(lookup(name), *points.T)


@pytest.mark.parametrize("name", ["AB4", "AB5", "AB6"])
def test_the_loops_of_the_locus_are_cut(name: str) -> None:
    points, modulus = on_locus(name)
    loop = points[modulus > 1 + 1e-3]
    assert len(loop) > 10
    curve = region(lookup(name)).boundary[0]
    gaps = np.abs(loop[:, None] - curve).max(axis=-1).min(axis=1)
    assert gaps.max() > 0.01 * np.abs(curve).max()  # chords are a hundredth of that


@pytest.mark.parametrize("name", ["B1", "B2", "B3", "B4", "B12"])
def test_the_whole_locus_of_a_bezier_method_is_boundary(name: str) -> None:
    assert on_locus(name)[1] == pytest.approx(1, abs=1e-9)  # eps times the condition, at most 1e4 near z = 1


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


@pytest.mark.parametrize(
    ("name", "intervals", "stable_angle"),
    [
        ("implicit-euler", [(-128, 0), (2, 128)], np.pi),
        ("trapezoid", [(-128, 0)], np.pi / 2),
        ("bdf2", [(-256, 0), (4, 256)], np.pi),
    ],
)
def test_an_unbounded_set_is_cut_off_at_its_rim(
    name: str, intervals: list[tuple[float, float]], stable_angle: float
) -> None:
    pencil = pencil_of(lookup(name))
    bounds = bounds_of(pencil, 1.0, 1, rim_radius(pencil, 1.0))
    assert np.array(bounds.intervals) == pytest.approx(np.array(intervals), abs=1e-9)
    assert bounds.rim == pytest.approx(stable_angle, abs=1e-9)
    assert not bounds.bounded


def test_a_bounded_set_of_an_implicit_method_does_not_reach_its_rim() -> None:
    pencil = pencil_of(lookup("am3"))
    bounds = bounds_of(pencil, 1.0, 1, rim_radius(pencil, 1.0))
    assert bounds.bounded
    assert np.array(bounds.intervals) == pytest.approx(np.array([(-6, 0)]), abs=1e-12)


def test_where_the_modulus_touches_the_level_an_interval_ends() -> None:
    """Chebyshev's R(mu) = T_3(1 + mu/9) touches -1 at mu = -4.5 and 1 at -13.5, inside (-18, 0)."""
    chebyshev = runge_kutta("chebyshev", "1/27;0 4/27", "0 0 1")
    intervals = bounds_of(pencil_of(chebyshev), 1.0).intervals
    assert (intervals[0][0], intervals[-1][1]) == pytest.approx((-18, 0), abs=1e-12)
    for touched in (-4.5, -13.5):  # double roots: known to the root of rounding
        assert not any(start + 1e-6 < touched < end - 1e-6 for start, end in intervals)
