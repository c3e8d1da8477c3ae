from itertools import combinations
from math import pi

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from matplotlib.path import Path
from numpy.typing import NDArray

from bezstab.derivation import closed_loop, coefficient_table, effective_parameters
from bezstab.methods import REGISTRY, LinearMultistep, Method, RungeKutta, lookup, rational
from bezstab.poles import ComplexArray, FloatArray, dominant_pole, poles, spectral_radius
from bezstab.region import Region, pole_map, region, window

BoolArray = NDArray[np.bool_]

NAMES = [*REGISTRY, "RK4@5"]


def independent_radius(method: Method, alpha_hat: FloatArray, beta_hat: FloatArray) -> FloatArray:
    """Return |z_p| by eigenvalues of P's companion, its coefficients evaluated from the exact ones."""
    leading, *rest = closed_loop(method).all_coeffs()
    companion = np.zeros((*alpha_hat.shape, len(rest), len(rest)))
    for column, coefficient in enumerate(rest):
        terms = (coefficient / leading).as_poly(*closed_loop(method).domain.symbols).terms()
        companion[..., 0, column] = -sum(float(c) * alpha_hat**i * beta_hat**j for (i, j), c in terms)
    companion[..., range(1, len(rest)), range(len(rest) - 1)] = 1
    return np.asarray(np.abs(np.linalg.eigvals(companion)).max(axis=-1))


def inside(curves: tuple[FloatArray, ...], points: FloatArray) -> BoolArray:
    """Return which points the closed curves enclose, by the even-odd rule."""
    return np.asarray(np.sum([Path(curve).contains_points(points) for curve in curves], axis=0) % 2 == 1)


def counted_area(method: Method, level: float, size: int) -> float:
    """Return the area by counting the cells of a size x size grid whose centres are stable."""
    (a_low, a_high), (b_low, b_high) = window(region(method))
    a, b = (low + (high - low) * (np.arange(size) + 0.5) / size for low, high in ((a_low, a_high), (b_low, b_high)))
    stable = independent_radius(method, *np.meshgrid(a, b)) < level
    return float(stable.mean() * (a_high - a_low) * (b_high - b_low))


def polar_area(method: Method, panels: int) -> float:
    """Return the area by polar coordinates about a point of S's real interval, S = {mu: all roots inside |z| < 1}.

    S's upper half contributes int 4y dx dy = int 4/3 sin(phi) R^3 dphi, the real pairs (interval)^3 / 6. The radius R
    to S's edge comes from bisection on the eigenvalues of pi's companion: no locus, no resultant.
    """
    table = np.array([[float(c) for c in row] for row in coefficient_table(method)])
    (a, b), (c, d) = ([float(x) for x in row] for row in effective_parameters(method))

    def stable(mu: ComplexArray) -> BoolArray:
        coefficients = np.polynomial.polynomial.polyval(mu, table.T)  # shape (n + 1, mu.size)
        companion = np.zeros((mu.size, len(table) - 1, len(table) - 1), complex)
        companion[:, 0, :] = -(coefficients[-2::-1] / coefficients[-1]).T
        companion[:, range(1, len(table) - 1), range(len(table) - 2)] = 1
        return np.asarray(np.abs(np.linalg.eigvals(companion)).max(axis=-1) < 1)

    def radius(centre: float, phi: FloatArray) -> FloatArray:
        low, high = np.zeros_like(phi), np.full_like(phi, np.nan)
        for r in np.linspace(0, 8, 401)[1:] * abs(centre):  # the first way out
            leaving = np.isnan(high) & ~stable(centre + r * np.exp(1j * phi))
            high[leaving] = r
            low[np.isnan(high)] = r
            if not np.isnan(high).any():
                break
        for _ in range(50):
            middle = (low + high) / 2
            inner = stable(centre + middle * np.exp(1j * phi))
            low, high = np.where(inner, middle, low), np.where(inner, high, middle)
        return (low + high) / 2

    end = next(x for x in np.geomspace(1e-3, 8, 400) if not stable(np.array([-x]))[0])
    centre = -end / 2
    nodes, weights = np.polynomial.legendre.leggauss(24)
    edges = np.linspace(0, np.pi, panels + 1)
    half = np.diff(edges)[:, None] / 2
    phi = (edges[:-1, None] + half + half * nodes).ravel()
    upper = np.sum((half * weights).ravel() * 4 / 3 * np.sin(phi) * radius(centre, phi) ** 3)
    right, left = radius(centre, np.array([0.0, np.pi]))
    return float((upper + (left + right) ** 3 / 6) / (a * d - b * c))


@pytest.mark.parametrize(
    ("name", "area"),
    [
        ("RK1", 4),  # |1 + mu| < 1: the triangle (0,0), (2,0), (4,4)
        ("SYM", 4),  # 0 < alpha_hat < 2, 0 < beta_hat < 4 - 2 alpha_hat
        ("RK2", 4 + 2 * pi),
    ],
)
def test_areas_known_in_closed_form(name: str, area: float) -> None:
    assert region(lookup(name)).area == pytest.approx(area, rel=1e-13)


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("level", [1.0, 0.9])
def test_counting_cells_converges_to_the_area(name: str, level: float) -> None:
    method = lookup(name)
    exact = region(method, level).area
    box = np.prod(np.diff(window(region(method))))
    for size in (40, 160):
        assert abs(counted_area(method, level, size) - exact) < box / size  # cells that the boundary cuts: a few a row


SMOOTH = [f"B{n}" for n in range(1, 13)] + ["AB2", "RK1", "RK2", "RK3", "RK4", "SIE", "SYM", "RK4@5"]
CORNERED = ["AB4", "AB5", "AB6", "AB7", "AB8", "ABM2", "ABM4"]  # AB3's and ABM3's S have lobes behind their edge


@pytest.mark.parametrize("name", SMOOTH)
def test_polar_coordinates_give_the_same_area(name: str) -> None:
    # the edge is smooth, so 8 x 24 Gauss nodes reach rounding
    assert polar_area(lookup(name), 8) == pytest.approx(region(lookup(name)).area, rel=1e-10)


@pytest.mark.slow
@pytest.mark.parametrize("name", CORNERED)
def test_polar_coordinates_give_the_same_area_where_loops_were_cut(name: str) -> None:
    # a corner somewhere inside a panel leaves an error of the square of its width
    assert polar_area(lookup(name), 60) == pytest.approx(region(lookup(name)).area, rel=1e-4)


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("level", [1.0, 0.95, 0.9])
def test_every_boundary_point_has_the_modulus_of_the_level(name: str, level: float) -> None:
    method = lookup(name)
    for curve in region(method, level).boundary:
        error = np.abs(spectral_radius(method, *curve.T) - level)
        for k in np.flatnonzero(error > 1e-10):
            # only where poles meet on the circle: where both mu do, which costs the square root of eps, and where
            # roots of pi do, as ABM4's four at z = 1: the fourth root of eps, at worst
            z = poles(method, *curve[k])[:4]
            assert min(abs(a - b) for a, b in combinations(z, 2)) < 0.05
            assert error[k] < 1e-3


@pytest.mark.parametrize("name", NAMES)
def test_the_boundary_separates_stable_from_unstable(name: str) -> None:
    method, random = lookup(name), np.random.default_rng(3)
    (a_low, a_high), (b_low, b_high) = window(region(method))
    points = random.uniform((a_low, b_low), (a_high, b_high), (4000, 2))
    z_abs = independent_radius(method, *points.T)
    clear = np.abs(z_abs - 1) > 1e-3  # chords leave the curve by less
    assert (inside(region(method).boundary, points) == (z_abs < 1))[clear].all()


@pytest.mark.parametrize("name", ["AB4", "AB5"])
def test_the_loops_of_the_locus_are_cut(name: str) -> None:
    scheme = lookup(name).scheme
    assert isinstance(scheme, LinearMultistep)
    z = np.exp(1j * np.linspace(0.01, 3.13, 2000))
    mu = np.polyval([float(c) for c in scheme.rho], z) / np.polyval([float(c) for c in scheme.sigma], z)
    outside = spectral_radius(lookup(name), -2 * mu.real, np.abs(mu) ** 2) > 1 + 1e-6
    assert outside.any()


@given(
    st.sampled_from(["B2", "B4", "AB3", "ABM3", "RK3", "RK4", "SIE", "SYM"]), st.floats(0.7, 0.99), st.floats(0.7, 0.99)
)
@settings(max_examples=40, deadline=None)
def test_regions_nest(name: str, one: float, other: float) -> None:
    small, large = (region(lookup(name), level) for level in sorted((one, other)))
    assert small.area <= large.area * (1 + 1e-12)
    for curve in small.boundary:
        assert (spectral_radius(lookup(name), *curve.T) <= large.level + 1e-3).all()


@pytest.mark.parametrize(
    ("name", "least"), [("B2", 3**-0.5), ("B3", 0.6069769786668), ("B4", 0.6258835020274), ("AB4", 0.8070073480794)]
)
def test_a_region_is_empty_exactly_below_the_least_modulus(name: str, least: float) -> None:
    assert region(lookup(name), least - 1e-6) == Region(lookup(name), least - 1e-6, 0.0, (), None)
    assert region(lookup(name), least + 1e-5).area > 0


def test_extents_known_in_closed_form() -> None:
    expected = {"RK1": ((0, 4), (0, 4)), "AB2": ((0, 2), (0, 1)), "SYM": ((0, 2), (0, 4))}
    for name, extent in expected.items():
        found = region(lookup(name)).extent
        assert found is not None
        assert np.array(found) == pytest.approx(np.array(extent), abs=1e-12)  # solved, not sampled
    found = region(lookup("B4")).extent
    assert found is not None
    assert found[0][1] == pytest.approx(27 / 17, rel=1e-13)  # both mu at rho(-1)/sigma(-1) = -27/34


@pytest.mark.parametrize("name", NAMES)
def test_the_curves_are_closed_and_enclose_the_area(name: str) -> None:
    shape = region(lookup(name))
    for curve in shape.boundary:
        assert (curve[0] == curve[-1]).all()
    a, b = np.concatenate(shape.boundary).T if len(shape.boundary) == 1 else shape.boundary[0].T
    shoelace = abs(np.sum(a[:-1] * b[1:] - a[1:] * b[:-1])) / 2
    assert shoelace == pytest.approx(shape.area, rel=1e-3)  # chords of 400 points an arc


def test_a_step_multiple_shrinks_the_region() -> None:
    assert region(lookup("RK4@5")).area == pytest.approx(region(lookup("RK4")).area / 125, rel=1e-13)


def test_symplectic_euler_is_a_shear_of_euler() -> None:
    for level in (0.3, 0.8, 1.0):
        assert region(lookup("SYM"), level).area == pytest.approx(region(lookup("RK1"), level).area, rel=1e-12)


def test_roots_that_stay_on_the_circle_leave_no_region() -> None:
    scheme = LinearMultistep(tuple(map(rational, ("1", "0", "-1"))), tuple(map(rational, ("0", "2", "0"))))
    assert region(Method("leapfrog", scheme, "")).area == 0


def test_separate_components_all_count() -> None:
    tableau = tuple(tuple(map(rational, row)) for row in (("0", "0", "0"), ("2", "0", "0"), ("0", "1", "0")))
    method = Method("odd", RungeKutta(tableau, tuple(map(rational, ("0", "0", "1")))), "")  # R = 1 + mu + mu^2 + 2 mu^3
    exact = region(method, 0.5)
    assert len(exact.boundary) > 1
    (a, b), (c, d) = window(region(method))
    x, y = np.meshgrid(np.linspace(a, b, 801), np.linspace(c, d, 801))
    counted = (independent_radius(method, x, y) < 0.5).mean() * (b - a) * (d - c)
    assert exact.area == pytest.approx(counted, rel=0.02)  # one cell in 800 along the boundary


def test_the_map_is_the_dominant_pole_on_the_mesh() -> None:
    method, a, b = lookup("AB3"), np.linspace(-0.2, 1.1, 57), np.linspace(0, 0.6, 1201)
    stacked = np.concatenate(list(pole_map(method, a, b)))
    assert stacked == pytest.approx(dominant_pole(method, a, b[:, None]), abs=1e-9)
