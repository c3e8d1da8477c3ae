"""Regions against closed forms, enclosed points by eigenvalues, and what other routes find stable."""

from fractions import Fraction
from math import inf

import numpy as np
import pytest

from bezstab.errors import NumericalError
from bezstab.methods.recipes import recipe
from bezstab.methods.registry import lookup
from bezstab.methods.schemes import Method
from bezstab.stability.regions import Region, region, window
from tests.methods.kinds import FEW
from tests.reference.companion_poles import radius
from tests.reference.enclosed_points import enclosed
from tests.reference.made_methods import multistep, runge_kutta
from tests.reference.random_methods import other_random_method, random_method


def assert_area(shape: Region, exact: float) -> None:
    """Hold an area to its own estimate, which is honest and small."""
    assert shape.area is not None
    assert shape.area_error <= 1e-6 * exact
    known = shape.area_error + exact * max(1e-9, 1e-12 / (1 - shape.level) if shape.level < 1 else 0)
    assert abs(shape.area - exact) <= known  # as exact as ends are asked to be, and as poles that are next to one


@pytest.mark.parametrize("level", [1.0, 0.5, 0.01])
@pytest.mark.parametrize("name", ["RK1", "SYM"])
def test_euler_and_its_shear_have_area_4_r_cubed(name: str, level: float) -> None:
    # z = w = mu + 1: the triangle p < r^2, |s| < (r^2 + p) / r with corners (0, -r^2), (+-2r, r^2).
    # SYM's P is Euler's with alpha_hat + beta_hat for alpha_hat: a shear of unit determinant.
    assert_area(region(lookup(name), level), 4 * level**3)


@pytest.mark.parametrize(("theta", "level"), [("1/2", "0.99995"), ("1/2", "0.05"), ("2/5", "1")])
def test_a_theta_method_has_the_area_of_two_disc_halves(theta: str, level: str) -> None:
    # |1 + (1 - theta) mu| < r |1 - theta mu| is a disc of radius rho: 4 int int y over its half, and (2 rho)^3 / 6
    t, r = Fraction(theta), Fraction(level)
    rho = float(r / ((1 - t) ** 2 - (r * t) ** 2))
    assert_area(region(multistep("theta", "1 -1", f"{t} {1 - t}"), float(r)), 4 * rho**3)


TWO_EVALUATIONS = {
    "x1": "x0 + v0 + 1/2 first",
    "v1": "v0 + second",
    "first": "acceleration(x0, 1/2 v0 + 1/2 v1)",
    "second": "acceleration(x0, v0)",
}
"""beta_hat comes near 4 as alpha_hat grows."""


@pytest.mark.parametrize(
    ("method", "level", "extent"),
    [
        (lookup("SYM"), 1, (0, 2, 0, 4)),
        (lookup("RK1"), 0.5, (1, 3, 0.25, 2.25)),  # both z, 1 + mu, within 1/2: alpha_hat = 2 - s, beta_hat = 1 - s + p
        (lookup("AB2"), 1, (0, 2, 0, 1)),  # mu(-1) = -1 twice, and the line of z = -1
        (lookup("ABM2"), 1, (0, 4, 0, 4)),  # a cusp on alpha = beta: mu = -2 twice
        # (a + 2) z^2 + (2 b - 4) z + 2 - a: a, b > 0 and P(-1) = 8 - 2 b > 0; within 1/2 |b - 2| < (10 - 3 a)/4
        (lookup("verlet-implicit"), 1, (0, inf, 0, 4)),
        (lookup("verlet-implicit"), 0.5, (6 / 5, 10 / 3, 2 / 5, 18 / 5)),
        *((lookup(name), 1, (0, inf, 0, inf)) for name in ("stable-pd", "trapezoid", "bdf6")),
        (Method("two evaluations", recipe(TWO_EVALUATIONS), ""), 1, (0, inf, 0, 4)),
    ],
    ids=str,
)
def test_extents_in_closed_form(method: Method, level: float, extent: tuple[float, ...]) -> None:
    shape = region(method, level)
    assert np.ravel(np.array(shape.extent)) == pytest.approx(np.array(extent), rel=1e-8, abs=1e-9)
    assert shape.approached == (False, method.name == "two evaluations")
    assert shape.bounded is (inf not in extent)
    assert (shape.area is None) is not shape.bounded
    for (low, high), end in zip(window(shape), extent[1::2], strict=True):
        assert low == 0
        assert high == pytest.approx(1.05 * end) if shape.bounded else np.isfinite(high)


def test_an_end_of_what_is_bounded_is_reached_however_far_out() -> None:
    """The last line of constant alpha_hat meets gauss4's region at beta_hat = 13,000."""
    found = region(lookup("gauss4"), 0.9)
    assert found.bounded


def assert_what_is_enclosed(shape: Region, off: float, right: float, top: float) -> None:
    """Hold the curves against eigenvalues at random points of a window, where |z_p| is so far off the level."""
    low, high = np.array([0.001, 1])[:, np.newaxis] * (right, top)
    points = np.random.default_rng(3).uniform(low, high, (4000, 2))
    modulus = radius(shape.method, *points.T)
    clear = np.abs(modulus - shape.level) > off
    assert (enclosed(shape.boundary, points) == (modulus < shape.level))[clear].all()


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
        points = np.concatenate(shape.boundary)
        touched = np.stack([points.min(axis=0), points.max(axis=0)], axis=1)
        assert touched == pytest.approx(np.array(shape.extent), abs=1e-4 * np.max(shape.extent))  # a chord's sagitta
    assert_what_is_enclosed(shape, 1e-3, *np.transpose(window(region(method)))[1])  # chords leave the curve by less


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
    assert_what_is_enclosed(shape, 1e-2, 0.9 * right, min(0.9 * top, 30))


@pytest.mark.parametrize("method", [other_random_method(91), random_method(24)], ids=str)
def test_an_island_is_mentioned_and_not_measured(method: Method) -> None:
    """The first goes on for ever along lines of the region; the gap before the other lies between two first lines."""
    shape = region(method)
    ((alpha_hat, beta_hat),) = shape.islands
    assert shape.bounded
    assert (radius(method, np.array([alpha_hat]), np.array([beta_hat])) < 1).all()
    assert not enclosed(shape.boundary, np.array([[alpha_hat, beta_hat]])).any()


def test_parts_that_only_touch_are_refused() -> None:
    """Two lobes meet in a point."""
    with pytest.raises(NumericalError, match="or only touch"):
        region(runge_kutta("two intervals", "1/9", "0 1"))
