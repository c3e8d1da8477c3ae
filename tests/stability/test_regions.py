from functools import cache
from math import atan, pi, sin, sqrt

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from matplotlib.path import Path
from mpmath import mp, mpf, polyroots
from numpy.polynomial import chebyshev, polynomial
from numpy.typing import NDArray

from bezstab.errors import NumericalError
from bezstab.methods import REGISTRY, LinearMultistep, Method, RungeKutta, closed_loop_polynomial, lookup
from bezstab.rationals import rational
from bezstab.stability import (
    ComplexArray,
    Extent,
    FloatArray,
    Region,
    dominant_pole,
    pole_map,
    region,
    spectral_radius,
    stable_mask,
    window,
)

BoolArray = NDArray[np.bool_]

EPS = float(np.finfo(float).eps)
NAMES = [*REGISTRY, "RK4@5"]
LEVELS = [1.0, 0.95, 0.8]


def multistep(name: str, rho: str, sigma: str) -> Method:
    return Method(name, LinearMultistep(tuple(map(rational, rho.split())), tuple(map(rational, sigma.split()))), "")


def runge_kutta(name: str, rows: str, weights: str) -> Method:
    b = tuple(map(rational, weights.split()))
    below = [[], *(row.split() for row in rows.split(";"))]
    tableau = tuple(tuple(map(rational, [*row, *["0"] * (len(b) - len(row))])) for row in below)
    return Method(name, RungeKutta(tableau, b), "")


@cache
def closed_loop_tables(method: Method) -> FloatArray:
    """Return C with P(z) = sum_kij C[k, i, j] alpha_hat^i beta_hat^j z^(n - k), rounded from the exact P."""
    coefficients = [
        c.as_poly(*closed_loop_polynomial(method).domain.symbols).terms()
        for c in closed_loop_polynomial(method).all_coeffs()
    ]
    degree = max(max(powers) for terms in coefficients for powers, _ in terms)
    table = np.zeros((len(coefficients), degree + 1, degree + 1))
    for k, terms in enumerate(coefficients):
        for (i, j), c in terms:
            table[k, i, j] = float(c)
    return table


def polynomial_at(method: Method, alpha_hat: FloatArray, beta_hat: FloatArray, level: float = 1.0) -> FloatArray:
    """Return P's coefficients in z / level, descending powers along the first axis."""
    table = closed_loop_tables(method)
    return np.array([polynomial.polyval2d(alpha_hat, beta_hat, c) / level**k for k, c in enumerate(table)])


def eigenvalues(method: Method, alpha_hat: FloatArray, beta_hat: FloatArray) -> ComplexArray:
    """Return P's roots as eigenvalues of its companion matrix."""
    c = polynomial_at(method, alpha_hat, beta_hat)
    n = len(c) - 1
    companion = np.zeros((*alpha_hat.shape, n, n))
    companion[..., 0, :] = -np.moveaxis(c[1:], 0, -1)
    companion[..., range(1, n), range(n - 1)] = 1
    return np.linalg.eigvals(companion).astype(complex)


def radius(method: Method, alpha_hat: FloatArray, beta_hat: FloatArray) -> FloatArray:
    return np.asarray(np.abs(eigenvalues(method, alpha_hat, beta_hat)).max(axis=-1))


def stable(method: Method, level: float, alpha_hat: FloatArray, beta_hat: FloatArray) -> BoolArray:
    """Return where P's roots are inside |z| < level: every reflection coefficient of Schur's recursion below one."""
    c = polynomial_at(method, alpha_hat, beta_hat, level)
    inside = np.ones(c.shape[1:], bool)
    while len(c) > 1:
        k = np.where(inside, c[-1] / c[0], 0)
        inside &= np.abs(k) < 1
        c = c[:-1] - np.where(inside, k, 0) * c[:0:-1]
    return inside


def schur_determinant(c: FloatArray) -> FloatArray:
    """Return det(X - Y) = +-prod over i < j of (1 - z_i z_j), zero wherever a complex pair is on the unit circle.

    X is upper triangular Toeplitz of c_0 .. c_(n-2), Y lower anti-triangular Hankel of c_n .. c_2 (Jury 1964).
    """
    n = len(c) - 1
    matrix = np.zeros((*c.shape[1:], n - 1, n - 1))
    for i in range(n - 1):
        for j in range(n - 1):
            if j >= i:
                matrix[..., i, j] += c[j - i]
            if i + j >= n - 2:
                matrix[..., i, j] -= c[2 * n - 2 - i - j]
    return np.asarray(np.linalg.det(matrix))


def slice_lengths(method: Method, level: float, alpha_hat: FloatArray, beta_range: tuple[float, float]) -> FloatArray:
    """Return the length of the stable set in beta_hat at each alpha_hat, a sum of intervals.

    Their ends are zeros in beta_hat of P(level), P(-level) and Schur's determinant, each interpolated without error by
    its degree; a zero too many splits an interval in two and changes nothing.
    """
    tables = closed_loop_tables(method)
    n, low, high = len(tables) - 1, *beta_range
    size = (tables.shape[2] - 1) * (n - 1) + 1
    nodes = chebyshev.chebpts1(size)
    alpha_nodes, beta_nodes = np.broadcast_arrays(alpha_hat[:, None], (low + high + (high - low) * nodes) / 2)
    c = polynomial_at(method, alpha_nodes, beta_nodes, level)
    signs = (-1.0) ** np.arange(n + 1)
    events = np.stack([schur_determinant(c), c.sum(axis=0), np.tensordot(signs, c, 1)])
    transform = np.linalg.inv(chebyshev.chebvander(nodes, size - 1)).T
    lengths = np.empty(alpha_hat.size)
    for k in range(alpha_hat.size):
        series = [chebyshev.chebtrim(e, 10 * EPS * np.abs(e).max()) for e in events[:, k] @ transform]
        zeros = np.concatenate([chebyshev.chebroots(e).real for e in series])
        beta = (low + high + (high - low) * np.sort([-1, 1, *zeros[np.abs(zeros) < 1]])) / 2
        middle = (beta[1:] + beta[:-1]) / 2
        lengths[k] = np.diff(beta)[stable(method, level, np.full_like(middle, alpha_hat[k]), middle)].sum()
    return lengths


def sliced_area(method: Method, level: float, panels: int = 8) -> float:
    """Return the area as the integral of the slices' lengths: no mu, no locus, no resultant in theta.

    Clenshaw-Curtis panels are halved until they agree: a corner, a vertical tangent or a jump ends at a width of 2^-40.
    Their nodes include the ends, or a jump just inside one would go unseen.
    """
    box = window(region(method, level))
    nodes, order = chebyshev.chebpts2(13), np.arange(0, 13, 2)
    moments = np.zeros(13)
    moments[order] = 2 / (1 - order**2)  # of T_k over (-1, 1)
    weights = np.linalg.solve(chebyshev.chebvander(nodes, 12).T, moments)

    def integrals(ends: FloatArray) -> FloatArray:
        half = np.diff(ends) / 2
        alpha_hat = ends[:, :1] + half + half * nodes
        lengths = slice_lengths(method, level, alpha_hat.ravel(), box[1]).reshape(alpha_hat.shape)
        return np.asarray(half[:, 0] * (lengths @ weights))

    edges = (
        np.linspace(-0.01 * box[0][1], box[0][1], panels + 1) if box[0][0] == 0 else np.linspace(*box[0], panels + 1)
    )
    ends = np.stack([edges[:-1], edges[1:]], axis=1)
    whole, total = integrals(ends), 0.0
    for _ in range(40):
        middle = ends.mean(axis=1)
        halves = np.stack([ends[:, 0], middle, middle, ends[:, 1]], axis=1).reshape(-1, 2)
        parts = integrals(halves)
        both = parts[::2] + parts[1::2]
        rough = np.abs(both - whole) > 1e-12 * np.diff(box[0])[0] * np.diff(box[1])[0]
        total += float(both[~rough].sum())
        ends, whole = halves[np.repeat(rough, 2)], parts[np.repeat(rough, 2)]
        if not rough.any():
            break
    return total + float(whole.sum())


def inside(curves: tuple[FloatArray, ...], points: FloatArray) -> BoolArray:
    """Return which points the closed curves enclose, by the even-odd rule."""
    crossings = np.sum([Path(curve).contains_points(points) for curve in curves], axis=0) % 2
    return np.broadcast_to(crossings == 1, len(points))


def found_extent(shape: Region) -> Extent:
    assert shape.extent is not None
    return shape.extent


def least_modulus(name: str) -> float:
    """Return p in (0, 1) with rho(p)/sigma(p) = rho(-p)/sigma(-p): a corner with z = p and z = -p both double."""
    scheme = lookup(name).scheme
    assert isinstance(scheme, LinearMultistep)
    rho, sigma = (np.array(c, float) for c in (scheme.rho, scheme.sigma))
    signs = (-1.0) ** np.arange(len(rho))
    roots = np.roots(np.trim_zeros(np.polymul(rho, sigma * signs) - np.polymul(rho * signs, sigma)))
    return float(max(root.real for root in roots if abs(root.imag) < 1e-9 and 0 < root.real < 0.99))


# Areas in closed form. With w = mu + const the map (alpha_hat, beta_hat) -> (s, p) = (w1 + w2, w1 w2) has unit
# determinant. |z1|, |z2| < r means z1 z2 < r^2 and (r -+ z1)(r -+ z2) > 0 (Jury).


@pytest.mark.parametrize("level", [1.0, 0.9, 0.5, 0.01])
@pytest.mark.parametrize("name", ["RK1", "B1", "AB1", "SYM"])
def test_euler_and_its_shear_have_area_4_r_cubed(name: str, level: float) -> None:
    # z = w = mu + 1: the triangle p < r^2, |s| < (r^2 + p) / r with corners (0, -r^2), (+-2r, r^2).
    # SYM's P is Euler's with alpha_hat + beta_hat for alpha_hat: a shear of unit determinant.
    assert region(lookup(name), level).area == pytest.approx(4 * level**3, rel=1e-12)  # rounding of 1 - level


@pytest.mark.parametrize("level", [1.0, 0.9, 0.6, 0.5, 0.3])
def test_midpoint_has_the_area_of_a_disc_in_a_wedge(level: float) -> None:
    # z = (w^2 + 1) / 2, w = mu + 1: z1 z2 < r^2 is the disc s^2 + (p - 1)^2 < 4 r^2; z = r, with k = 2r - 1, the wedge
    # p + k > sqrt(k) |s| from the disc's lowest point (none if k <= 0); z = -r is never met. At r = 1: 4 + 2 pi.
    phi = atan(sqrt(max(2 * level - 1, 0)))
    exact = 4 * level**2 * (pi - 2 * phi + sin(2 * phi))
    assert region(lookup("RK2"), level).area == pytest.approx(exact, rel=1e-12)  # sqrt(eps)^2 at the double points


@pytest.mark.parametrize("level", [1.0, 0.9, 0.75, 0.4])
def test_matsuno_has_the_area_of_an_ellipse_in_a_wedge(level: float) -> None:
    # z = w^2 + 3/4, w = mu + 1/2: the ellipse (p - 3/4)^2 + 3/4 s^2 < r^2; k = r - 3/4, the wedge p + k > sqrt(k) |s|
    phi = atan(2 * sqrt(max(level - 0.75, 0) / 3))
    exact = 2 / sqrt(3) * level**2 * (pi - 2 * phi + sin(2 * phi))
    assert region(lookup("SIE"), level).area == pytest.approx(exact, rel=1e-12)


@pytest.mark.parametrize("multiple", ["5", "2", "1/3"])
@pytest.mark.parametrize(("name", "level"), [("RK4", 1.0), ("B3", 0.9), ("SYM", 1.0)])
def test_a_step_of_m_h_divides_the_area_by_m_cubed(name: str, level: float, multiple: str) -> None:
    # alpha_hat by m, beta_hat by m^2
    scaled, plain = (region(lookup(text), level).area for text in (f"{name}@{multiple}", name))
    assert scaled == pytest.approx(plain / float(rational(multiple)) ** 3, rel=1e-13)  # rounding alone


FAST = ["B2", "B3", "B4", "AB2", "AB3", "AB4", "ABM2", "RK2", "RK3", "RK4", "SIE", "SYM"]


@pytest.mark.parametrize(
    ("name", "level"),
    [
        pytest.param(name, level, marks=[] if name in FAST and level == 1 else pytest.mark.slow)
        for name in NAMES
        for level in LEVELS
    ],
)
def test_slices_of_constant_alpha_hat_give_the_same_area(name: str, level: float) -> None:
    shape = region(lookup(name), level)
    if shape.extent is None:
        assert name in {"AB4", "AB5", "AB6", "AB7", "AB8"}
        assert level < 1
        return
    # ten digits; the zeros of events of degree 7 and more, and where two meet, cost the rest
    assert sliced_area(lookup(name), level) == pytest.approx(shape.area, rel=1e-10)


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("level", [1.0, 0.9])
def test_counting_cells_converges_to_the_area(name: str, level: float) -> None:
    method = lookup(name)
    box = window(region(method))
    full = np.prod(np.diff(box))
    for size in (24, 96, 288):
        a, b = (low + (high - low) * (np.arange(size) + 0.5) / size for low, high in box)
        counted = stable(method, level, *np.meshgrid(a, b)).mean() * full
        assert abs(counted - region(method, level).area) < full / size  # cells that the edge cuts: a few a row


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("level", LEVELS)
def test_every_boundary_point_has_the_modulus_of_the_level(name: str, level: float) -> None:
    method = lookup(name)
    for curve in region(method, level).boundary:
        z = eigenvalues(method, *curve.T)
        c = polynomial_at(method, *curve.T)
        powers = np.arange(len(c) - 1, -1, -1)[:, None, None]
        terms = c[..., None] * z**powers
        with np.errstate(all="ignore"):  # infinite at a double root
            condition = np.abs(terms).sum(axis=0) / np.abs((powers * terms).sum(axis=0))
        top = np.argmax(np.abs(z), axis=1)
        near = np.abs(z - np.take_along_axis(z, top[:, None], 1)) < 1e-2
        near |= np.abs(z - np.take_along_axis(z, top[:, None], 1).conj()) < 1e-2
        on_circle = np.abs(z) > level - 1e-3
        condition = np.where(on_circle, condition, 0).max(axis=1)
        # first order: eps times the root's condition; where m > 1 meet that is void and eps^(1/m) is what remains
        meeting = near.sum(axis=1)
        bound = np.minimum(100 * EPS * condition, np.where(meeting > 1, 10 * EPS ** (1 / meeting), 1e-10))
        for modulus in (np.abs(z).max(axis=1), spectral_radius(method, *curve.T)):
            error = np.abs(modulus - level)
            assert (error <= bound).all()
            assert (error < 1e-10).mean() > 0.9  # all but corners and the points that crowd around them


@pytest.mark.parametrize(("name", "level"), [("B4", 1.0), ("AB4", 0.95), ("RK4", 0.8), ("ABM3", 1.0), ("SYM", 0.95)])
def test_boundary_points_in_fifty_digits(name: str, level: float) -> None:
    curve = np.concatenate(region(lookup(name), level).boundary)
    with mp.workdps(50):
        for a, b in curve[np.linspace(0, len(curve) - 1, 12, dtype=int)[1:-1]]:
            table = [
                sum(mpf(int(c.p)) / int(c.q) * mpf(a) ** i * mpf(b) ** j for (i, j), c in coefficient.terms())
                for coefficient in (
                    c.as_poly(*closed_loop_polynomial(lookup(name)).domain.symbols)
                    for c in closed_loop_polynomial(lookup(name)).all_coeffs()
                )
            ]
            modulus = max(abs(z) for z in polyroots(table, maxsteps=500, extraprec=300))
            assert float(modulus) == pytest.approx(level, abs=1e-10)  # the point's own rounding


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("level", [1.0, 0.95])
def test_every_edge_separates_stable_from_unstable(name: str, level: float) -> None:
    method = lookup(name)
    shape = region(method, level)
    if shape.extent is None:
        return
    scale = np.diff(shape.extent)[:, 0]
    for curve in shape.boundary:
        points = curve / scale
        points = points[np.append(True, np.abs(np.diff(points, axis=0)).max(axis=1) > 1e-4)]  # corners repeat
        back, ahead = points[1:-1] - points[:-2], points[2:] - points[1:-1]
        tangent = back + ahead
        cosine = np.sum(back * ahead, axis=1) / np.linalg.norm(back, axis=1) / np.linalg.norm(ahead, axis=1)
        corners = np.append(points[1:-1][cosine < 0.9], points[:1], axis=0)
        # where two arcs of S cross on the real axis the region ends in a cusp, thinner than the step at less than 0.02
        smooth = (cosine > 0.99) & (np.linalg.norm(points[1:-1, None] - corners, axis=-1).min(axis=1) > 0.02)
        assert smooth.sum() > 100 * (len(curve) // 400)
        normal = (np.stack([-tangent[:, 1], tangent[:, 0]]) / np.linalg.norm(tangent, axis=1)).T
        left, right = (
            # 1e-6: a hundredth of the least chord, and 1e8 times the rounding of |z_p|
            radius(method, *((points[1:-1] + sign * 1e-6 * normal)[smooth] * scale).T) - level
            for sign in (1, -1)
        )
        assert (left * right < 0).all()


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("level", [1.0, 0.9])
def test_the_boundary_encloses_exactly_the_stable_points(name: str, level: float) -> None:
    method, random = lookup(name), np.random.default_rng(3)
    low, high = np.transpose(window(region(method)))
    points = random.uniform(low, high, (4000, 2))
    modulus = radius(method, *points.T)
    clear = np.abs(modulus - level) > 1e-3  # chords leave the curve by less
    assert (inside(region(method, level).boundary, points) == (modulus < level))[clear].all()


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


@given(st.sampled_from(["B2", "B4", "AB3", "ABM3", "RK3", "RK4", "SIE", "SYM"]), st.floats(0.7, 1), st.floats(0.7, 1))
@settings(max_examples=40, deadline=None)
def test_regions_nest(name: str, one: float, other: float) -> None:
    lower, upper = sorted((one, other))
    assume(upper - lower > 0.02)  # beyond what chords hide
    small, large = region(lookup(name), lower), region(lookup(name), upper)
    assert 0 < small.area < large.area
    assert inside(large.boundary, np.concatenate(small.boundary)).all()


def test_least_moduli_in_closed_form() -> None:
    # the even part of (p - 1) |sigma|(p), by hand: 6p^2 - 2, 38p^2 - 14, 350p^4 - 132p^2 - 2, 55p^4 - 22p^2 - 9
    expected = {"B2": 1 / 3, "B3": 7 / 19, "AB3": 11 / 23}
    expected |= {"B4": (66 + sqrt(5056)) / 350, "AB4": (11 + sqrt(616)) / 55}
    for name, square in expected.items():
        assert least_modulus(name) == pytest.approx(sqrt(square), rel=1e-12)


@pytest.mark.parametrize("name", ["B2", "B3", "B4", "AB2", "AB3", "AB4"])
def test_a_region_is_empty_exactly_below_the_least_modulus(name: str) -> None:
    method, least = lookup(name), least_modulus(name)
    for level in (least - 1e-6, 0.9 * least):
        assert region(method, level) == Region(method, level, 0.0, (), None)
    above = region(method, least + 1e-6)
    assert above.area > 0
    (a_low, a_high), (b_low, b_high) = found_extent(above)
    assert radius(method, np.array([(a_low + a_high) / 2]), np.array([(b_low + b_high) / 2])) < least + 1e-5


def test_an_edge_that_several_roots_reach_together_is_reported() -> None:
    """With mu = rho/sigma of equal modulus in three places of the circle, every arc has other roots on it."""
    method = multistep("together", "1 -1 1 -1", "0 1 -2 3")
    assert radius(method, np.array([0.6]), np.array([0.08])) < 0.8  # there is a region
    with pytest.raises(NumericalError, match="several roots share it"):
        region(method)


def test_an_arc_shorter_than_the_sampling_is_found() -> None:
    """Just above the least |z_p| = 0.79880 the region is a sliver between two arcs, of 2e-3 and 5e-3 rad."""
    method, level = multistep("sliver", "1 -7/8 13/24 -2/3 -1/4 1/4", "0 -7/2 9/2 -1 5/2 -23/24"), 0.8
    shape = region(method, level)
    alpha_hat, beta_hat = (np.linspace(low, high, 1200) for low, high in found_extent(shape))
    inside = (spectral_radius(method, alpha_hat, beta_hat[:, np.newaxis]) < level).sum()
    pixel = (alpha_hat[1] - alpha_hat[0]) * (beta_hat[1] - beta_hat[0])
    assert shape.area == pytest.approx(inside * pixel, rel=0.1)  # some 800 pixels, most of them at an edge


def test_an_arc_that_ends_just_short_of_the_real_axis_bounds_an_interval() -> None:
    method = multistep("short of it", "1 -1 0 -3/8 3/8 1/4 -1/4", "0 1/4 5/3 -1 9/5 -1/4 -191/120")
    assert region(method).area == pytest.approx(sliced_area(method, 1.0), rel=1e-8)  # it ends 4e-9 of |mu| from it


def test_two_roots_that_meet_on_the_circle_outside_every_region_leave_none() -> None:
    assert region(multistep("meet", "1 0 -1", "0 6 -4")).area == 0


def test_the_first_row_of_a_mask_touches_the_region_and_is_outside() -> None:
    method = multistep("touching", "1 -1/2 1/2 -1", "0 5/2 -5 5")  # whose arc starts at mu = 0 only to rounding
    alpha_hat = np.linspace(0, 0.48, 301)
    assert not stable_mask(method, alpha_hat, np.array([0.0])).any()
    assert stable_mask(method, alpha_hat, np.array([1e-4])).any()


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
    assert found_extent(shape)[1][1] > 1e7


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("level", [1.0, 0.9])
def test_the_curves_are_closed_and_enclose_the_area(name: str, level: float) -> None:
    shape = region(lookup(name), level)
    shoelace = 0.0
    for curve in shape.boundary:
        assert (curve[0] == curve[-1]).all()
        (a, b), (next_a, next_b) = curve[:-1].T, curve[1:].T
        shoelace += abs(float(np.sum(a * next_b - next_a * b))) / 2
    assert shoelace == pytest.approx(shape.area, rel=1e-4)  # 400 chords an arc: (pi / 400)^2


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("level", [1.0, 0.9])
def test_extents_contain_the_curve_and_are_attained(name: str, level: float) -> None:
    shape = region(lookup(name), level)
    if shape.extent is None:
        return
    low, high = np.transpose(shape.extent)
    points = (np.concatenate(shape.boundary) - low) / (high - low)
    assert points.min() >= -1e-11  # rounding of |mu|^2 against a small range
    assert points.max() <= 1 + 1e-11
    for attained in (points.min(axis=0), 1 - points.max(axis=0)):
        assert (attained < 1e-4).all()  # a chord's sagitta


X4 = float(np.roots([1, -4, 12, -24])[np.isreal(np.roots([1, -4, 12, -24]))].real[0])  # R(-x) = 1 for RK4


@pytest.mark.parametrize(
    ("name", "extent"),
    [
        ("RK1", (0, 4, 0, 4)),  # the triangle of mu = 0 and -2: (0, 0), (2, 0), (4, 4)
        ("SYM", (0, 2, 0, 4)),
        ("AB2", (0, 2, 0, 1)),  # mu(-1) = -1 twice, and the line of z = -1
        ("RK2", (0, 4, 0, 2 + 2 * sqrt(2))),  # beta_hat = p - s + 1 over the disc s^2 + (p - 1)^2 < 4
    ],
)
def test_extents_in_closed_form(name: str, extent: tuple[float, ...]) -> None:
    assert np.ravel(found_extent(region(lookup(name)))) == pytest.approx(extent, abs=1e-11)  # solved, not sampled


# both mu at rho(-1)/sigma(-1); x = -mu at R = -1 of RK3, x^3 - 3x^2 + 6x - 12, and R = 1 of RK4, x^3 - 4x^2 + 12x - 24
RK3_REAL, RK4_REAL = (
    next(float(x.real) for x in np.roots(c) if abs(x.imag) < 1e-9) for c in ([1, -3, 6, -12], [1, -4, 12, -24])
)
LARGEST = {"B3": 12 / 7, "B4": 27 / 17, "AB3": 12 / 11, "AB4": 0.6, "RK3": 2 * RK3_REAL, "RK4": 2 * RK4_REAL}


@pytest.mark.parametrize("name", LARGEST)
def test_the_largest_alpha_hat_in_closed_form(name: str) -> None:
    assert found_extent(region(lookup(name)))[0][1] == pytest.approx(LARGEST[name], abs=1e-11)  # solved, not sampled


def test_the_limit_of_rk4_is_that_of_the_engines_table() -> None:
    assert found_extent(region(lookup("RK4")))[0][1] == pytest.approx(5.5706, abs=5e-5)  # as printed


@pytest.mark.parametrize("level", [1.0, 0.9, 0.3])
def test_the_extent_of_euler_at_a_level(level: float) -> None:
    # alpha_hat = 2 - s, beta_hat = p - s + 1 at the triangle's corners s = +-2r, p = r^2
    exact = ((2 - 2 * level, 2 + 2 * level), ((1 - level) ** 2, (1 + level) ** 2))
    assert np.array(found_extent(region(lookup("RK1"), level))) == pytest.approx(np.array(exact), abs=1e-12)


@pytest.mark.parametrize("level", [1.0, 0.9])
def test_the_window_shows_the_region_the_origin_and_a_margin(level: float) -> None:
    shape = region(lookup("B3"), level)
    for (low, high), (first, last) in zip(found_extent(shape), window(shape), strict=True):
        assert low >= first == 0
        assert last == pytest.approx(1.05 * high)


USERS = [
    multistep("extrapolated BDF2", "1 -4/3 1/3", "0 4/3 -2/3"),
    multistep("damped leapfrog", "1 -1/4 -3/4", "0 2 -1/4"),
    runge_kutta("SSP RK3", "1; 1/4 1/4", "1/6 1/6 2/3"),
    runge_kutta("two intervals", "1/9", "0 1"),
    runge_kutta("lobes", "2; 0 1", "0 0 1"),
]


@pytest.mark.parametrize("method", USERS, ids=lambda method: method.name)
@pytest.mark.parametrize("level", [1.0, pytest.param(0.8, marks=pytest.mark.slow)])
def test_user_made_methods_have_the_sliced_area(method: Method, level: float) -> None:
    shape = region(method, level)
    if shape.extent is None:
        box = np.meshgrid(np.linspace(-1, 3, 300), np.linspace(-1, 3, 300))
        assert not stable(method, level, *box).any()
        return
    assert sliced_area(method, level, panels=128) == pytest.approx(shape.area, rel=1e-9)  # small lobes in a large box


def test_ssp_rk3_has_the_region_of_rk3() -> None:
    # every 3-stage method of order 3 has R = 1 + mu + mu^2/2 + mu^3/6
    ssp = next(method for method in USERS if method.name == "SSP RK3")
    assert region(ssp).area == pytest.approx(region(lookup("RK3")).area, rel=1e-13)
    assert np.array(region(ssp).extent) == pytest.approx(np.array(region(lookup("RK3")).extent), abs=1e-12)


def test_two_real_intervals_give_three_components() -> None:
    # R = 1 + mu + mu^2/9 is in (-1, 1) on (-9, -6) and (-3, 0): pairs in either, or one mu in each
    method = next(method for method in USERS if method.name == "two intervals")
    assert len(region(method).boundary) == 3
    # the mixed pairs: 6 < alpha_hat < 12, 0 < beta_hat < 27, area 3 * 3 * (-3 - -15) / 2 = 54
    mixed = min(region(method).boundary, key=len)
    (a, b), (next_a, next_b) = mixed[:-1].T, mixed[1:].T
    assert abs(np.sum(a * next_b - next_a * b)) / 2 == pytest.approx(54, rel=1e-13)  # straight edges
    assert [*mixed.min(axis=0), *mixed.max(axis=0)] == pytest.approx([6, 0, 12, 27], abs=1e-12)


def test_roots_that_stay_on_the_circle_leave_no_region() -> None:
    # leapfrog: z1 z2 = -1
    leapfrog = multistep("leapfrog", "1 0 -1", "0 2 0")
    assert region(leapfrog) == Region(leapfrog, 1.0, 0.0, (), None)


TWELFTHS = st.integers(-36, 36).map(lambda n: rational(f"{n}/12"))
FRACTIONS = st.integers(-11, 11).map(lambda n: rational(f"{n}/12"))


@st.composite
def methods(draw: st.DrawFn) -> Method:
    """Draw a zero-stable multistep method of 2 or 3 steps, or a Runge-Kutta method of 2 or 3 stages."""
    kind, one, zero = (
        draw(st.sampled_from(["2 steps", "3 steps", "2 stages", "3 stages"])),
        rational("1"),
        rational("0"),
    )
    if kind == "2 steps":
        q, b = draw(FRACTIONS), draw(TWELFTHS)
        return Method(kind, LinearMultistep((one, -1 - q, q), (zero, b, 1 - q - b)), "")
    if kind == "3 steps":
        v, b, c = draw(FRACTIONS), draw(TWELFTHS), draw(TWELFTHS)
        u = (1 + v) * draw(FRACTIONS)  # z^2 + u z + v inside the circle: |v| < 1, |u| < 1 + v
        return Method(kind, LinearMultistep((one, u - 1, v - u, -v), (zero, b, c, 1 + u + v - b - c)), "")
    stages = int(kind[0])
    rows = tuple(tuple(draw(TWELFTHS) if j < i else zero for j in range(stages)) for i in range(stages))
    weights = [draw(TWELFTHS) for _ in range(stages - 1)]
    return Method(kind, RungeKutta(rows, (*weights, 1 - sum(weights, zero))), "")


@given(methods(), st.sampled_from([1.0, 0.95, 0.8, 0.5]))
@settings(max_examples=50, deadline=None)
def test_random_methods_are_stable_where_the_boundary_says(method: Method, level: float) -> None:
    shape = region(method, level)
    low, high = np.transpose(shape.extent or ((0, 6), (0, 9)))
    size, shift = high - low, 2e-3 * (high - low)  # 200 times what chords leave out
    axes = np.linspace(low - 0.3 * size, high + 0.3 * size, 31).T
    points = np.stack(np.meshgrid(*axes), axis=-1).reshape(-1, 2)
    member = radius(method, *points.T) < level
    near = [radius(method, *(points + shift * step).T) < level for step in ((1, 0), (-1, 0), (0, 1), (0, -1))]
    clear = np.all(np.equal(near, member), axis=0) & (np.abs(radius(method, *points.T) - level) > 1e-7)
    assert (inside(shape.boundary, points) == member)[clear].all()
    assert (shape.area == 0) == (shape.boundary == ()) == (shape.extent is None)


@pytest.mark.parametrize(("name", "columns", "rows"), [("AB3", 57, 1201), ("RK4", 1, 5), ("SYM", 70000, 2)])
def test_the_map_is_the_dominant_pole_on_the_mesh(name: str, columns: int, rows: int) -> None:
    method, a, b = lookup(name), np.linspace(-0.2, 1.1, columns), np.linspace(0.01, 0.6, rows)
    stacked = np.concatenate(list(pole_map(method, a, b)))
    assert stacked.shape == (rows, columns)
    assert np.abs(stacked - dominant_pole(method, a, b[:, None])).max() < 1e-9  # other starts of the iteration
    assert (np.abs(stacked[::97, ::7]) - radius(method, *np.meshgrid(a, b))[::97, ::7]).max() < 1e-6


@pytest.mark.parametrize("name", [*REGISTRY, "RK4@5"])
def test_the_mask_is_where_the_largest_pole_is_below_the_level(name: str) -> None:
    method = lookup(name)
    for level in (1.0, 0.9):
        (left, right), (low, high) = window(region(method, level))
        alpha_hat, beta_hat = np.linspace(left - 0.1, right, 151), np.linspace(low - 0.1, high, 149)
        z_abs = spectral_radius(method, alpha_hat, beta_hat[:, np.newaxis])
        mask = stable_mask(method, alpha_hat, beta_hat, level)
        clear = np.abs(z_abs - level) > 1e-9  # nearer, the pole itself is rounded; ABM's fourfold root at z = 1 more so
        clear &= (np.abs(z_abs - 1) > 1e-3) if "ABM" in name else True
        assert np.array_equal(mask[clear], (z_abs < level)[clear])


def test_the_mask_leaves_out_the_axis_where_errors_never_decay() -> None:
    assert not stable_mask(lookup("B4"), np.linspace(0, 1, 50), np.array([0.0])).any()
