"""Regions against closed forms, boundary points in fifty digits, and what other routes find stable."""

from fractions import Fraction
from math import atan, inf, pi, sin, sqrt

import numpy as np
import pytest

from bezstab.errors import NumericalError
from bezstab.methods.registry import lookup
from bezstab.methods.schemes import Method
from bezstab.stability.arrays import Extent
from bezstab.stability.regions import Region, region, window
from tests.methods.kinds import FEW
from tests.reference.companion_poles import radius
from tests.reference.enclosed_points import enclosed
from tests.reference.made_methods import multistep, runge_kutta
from tests.reference.random_methods import other_random_method, random_method


def found_extent(shape: Region) -> Extent:
    assert shape.extent is not None
    return shape.extent


def assert_area(shape: Region, exact: float) -> None:
    """Hold an area to its own estimate, which is honest and small."""
    assert shape.area is not None
    assert shape.area_error <= 1e-6 * exact
    known = shape.area_error + exact * max(1e-9, 1e-12 / (1 - shape.level) if shape.level < 1 else 0)
    assert abs(shape.area - exact) <= known  # as exact as ends are asked to be, and as poles that are next to one


@pytest.mark.parametrize("level", [1.0, 0.5, 0.01])
@pytest.mark.parametrize("name", ["AB1", "RK1", "SYM"])
def test_euler_and_its_shear_have_area_4_r_cubed(name: str, level: float) -> None:
    # z = w = mu + 1: the triangle p < r^2, |s| < (r^2 + p) / r with corners (0, -r^2), (+-2r, r^2).
    # SYM's P is Euler's with alpha_hat + beta_hat for alpha_hat: a shear of unit determinant.
    assert_area(region(lookup(name), level), 4 * level**3)


@pytest.mark.parametrize("level", [1.0, 0.6, 0.3])
def test_midpoint_has_the_area_of_a_disc_in_a_wedge(level: float) -> None:
    # z = (w^2 + 1) / 2, w = mu + 1: z1 z2 < r^2 is the disc s^2 + (p - 1)^2 < 4 r^2; z = r, with k = 2r - 1, the wedge
    # p + k > sqrt(k) |s| from the disc's lowest point (none if k <= 0); z = -r is never met. At r = 1: 4 + 2 pi.
    phi = atan(sqrt(max(2 * level - 1, 0)))
    exact = 4 * level**2 * (pi - 2 * phi + sin(2 * phi))
    assert_area(region(lookup("RK2"), level), exact)


@pytest.mark.parametrize("name", [*FEW, "AB8", "B12", "dopri5", "RK4@5", "verlet-predicted"])
@pytest.mark.parametrize("level", [1.0, 0.9])
@pytest.mark.slow
def test_the_curves_are_closed_touch_the_extent_and_enclose_the_area_and_what_is_stable(
    name: str, level: float
) -> None:
    method, shape = lookup(name), region(lookup(name), level)
    shoelace = 0.0
    for curve in shape.boundary:
        assert (curve[0] == curve[-1]).all()
        (a, b), (next_a, next_b) = curve[:-1].T, curve[1:].T
        shoelace += abs(float(np.sum(a * next_b - next_a * b))) / 2
    assert shoelace == pytest.approx(shape.area, rel=1e-4)  # 400 chords an arc: (pi / 400)^2
    if shape.extent:
        low, high = np.transpose(shape.extent)
        places = (np.concatenate(shape.boundary) - low) / (high - low)
        assert places.min() >= -1e-9
        assert places.max() <= 1 + 1e-9
        for attained in (places.min(axis=0), 1 - places.max(axis=0)):
            assert (attained < 1e-4).all()  # a chord's sagitta
    low, high = np.transpose(window(region(method)))
    low += 1e-3 * high
    points = np.random.default_rng(3).uniform(low, high, (4000, 2))
    modulus = radius(method, *points.T)
    clear = np.abs(modulus - level) > 1e-3  # chords leave the curve by less
    assert (enclosed(shape.boundary, points) == (modulus < level))[clear].all()


@pytest.mark.parametrize(
    ("name", "extent"),
    [
        ("SYM", (0, 2, 0, 4)),
        ("AB2", (0, 2, 0, 1)),  # mu(-1) = -1 twice, and the line of z = -1
        ("RK2", (0, 4, 0, 2 + 2 * sqrt(2))),  # beta_hat = p - s + 1 over the disc s^2 + (p - 1)^2 < 4
        ("ABM2", (0, 4, 0, 4)),  # a cusp on alpha = beta: mu = -2 twice
    ],
)
def test_extents_in_closed_form(name: str, extent: tuple[float, ...]) -> None:
    assert np.ravel(found_extent(region(lookup(name)))) == pytest.approx(extent, abs=1e-9)


def test_the_window_shows_the_region_the_origin_and_a_margin() -> None:
    shape = region(lookup("B3"), 0.9)
    for (low, high), (first, last) in zip(found_extent(shape), window(shape), strict=True):
        assert low >= first == 0
        assert last == pytest.approx(1.05 * high)


def test_an_island_without_end_is_mentioned_too() -> None:
    """On each line of constant alpha_hat up to the last one the region is a stretch from zero, the island goes on."""
    shape = region(other_random_method(91))
    ((alpha_hat, beta_hat),) = shape.islands
    assert shape.bounded
    assert found_extent(shape)[1][1] < 1 < beta_hat
    assert (radius(shape.method, np.full(2, alpha_hat), np.array([beta_hat, 1e6])) < 1).all()


def test_an_island_is_mentioned_and_not_measured() -> None:
    """The gap before it lies between two of the first lines: its first estimate took the island for the region."""
    shape = region(random_method(24))
    ((alpha_hat, beta_hat),) = shape.islands
    assert radius(shape.method, np.array([alpha_hat]), np.array([beta_hat])) < 1
    assert found_extent(shape)[0][1] < 4.2 < alpha_hat
    assert not enclosed(shape.boundary, np.array([[alpha_hat, beta_hat]])).any()


def test_parts_that_only_touch_are_refused() -> None:
    """Two lobes of the first meet in a point; the locus |z| = 3/4 of the other is Bernoulli's lemniscate."""
    with pytest.raises(NumericalError, match="or only touch"):
        region(runge_kutta("two intervals", "1/9", "0 1"))
    with pytest.raises(NumericalError, match="details without end"):
        region(runge_kutta("touching itself", "2/7", "1/2 1/2"), 0.75)


def test_a_region_of_a_level_contains_what_is_below_it() -> None:
    # z = 1 + mu: |z|^2 is 1/2 and 1/10
    assert region(lookup("RK1"), 0.5).contains([1, 2], [0.5, 1.1]).tolist() == [False, True]


# Implicit methods: S_r may be unbounded.


@pytest.mark.parametrize(
    ("theta", "level"), [("1/2", "0.99995"), ("1/2", "0.7"), ("1/2", "0.05"), ("2/5", "1"), ("1/10", "0.3")]
)
def test_a_theta_method_has_the_area_of_two_disc_halves(theta: str, level: str) -> None:
    # |1 + (1 - theta) mu| < r |1 - theta mu| is a disc of radius rho: 4 int int y over its half, and (2 rho)^3 / 6
    t, r = Fraction(theta), Fraction(level)
    rho = float(r / ((1 - t) ** 2 - (r * t) ** 2))
    assert_area(region(multistep("theta", "1 -1", f"{t} {1 - t}"), float(r)), 4 * rho**3)


@pytest.mark.parametrize("name", ["implicit-euler", "trapezoid", "bdf6", "radau3"])
def test_an_unbounded_region_says_so(name: str) -> None:
    shape = region(lookup(name))
    assert not shape.bounded
    assert shape.area is None
    assert "unbounded" in repr(shape)
    (alpha_min, alpha_max), (beta_min, beta_max) = found_extent(shape)
    assert alpha_max == beta_max == inf
    assert (alpha_min, beta_min) == (0, 0)
    assert np.isfinite(window(shape)).all()
    assert np.isfinite(np.array(shape.view)).all()


@pytest.mark.parametrize(
    ("method", "level"),
    [pytest.param(lookup("bdf6"), 0.9, marks=pytest.mark.slow), (other_random_method(157), 1.0)],
    ids=str,
)
def test_the_curves_of_what_goes_on_enclose_what_is_stable_in_the_window(method: Method, level: float) -> None:
    """A part of the first ends in a cusp that rounding closes; of the second thin parts begin beyond the window."""
    shape = region(method, level)
    assert not shape.bounded
    (_, right), (_, top) = window(shape)
    points = np.random.default_rng(3).uniform((0, 0), (0.9 * right, min(0.9 * top, 30)), (2000, 2))
    modulus = radius(method, *points.T)
    clear = np.abs(modulus - level) > 1e-2
    assert (enclosed(shape.boundary, points) == (modulus < level))[clear].all()
