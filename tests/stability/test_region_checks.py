"""Deliberately wrong regions: each is a NumericalError."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from fractions import Fraction
from itertools import combinations

import numpy as np
import pytest

from bezstab.errors import NumericalError
from bezstab.methods import Method, lookup
from bezstab.stability import boundary_locus, locus_shapes, region
from bezstab.stability.boundary_locus import Bounds, bounds_of
from bezstab.stability.locus_tracks import Arc, tracks
from bezstab.stability.mu_pencils import MuPencil
from bezstab.stability.pencils import pencil_of
from bezstab.stability.region_checks import check_region
from bezstab.stability.shapes import Shape
from tests.reference.made_methods import CLOSE_BRANCHES, FAR_INTERVAL
from tests.reference.second_order_methods import RECIPES, second_order

REGIONS = [
    *((lookup(name), level) for name, level in [("B4", 1.0), ("AB4", 0.93), ("RK4", 0.93), ("ABM2", 1.0)]),
    *((CLOSE_BRANCHES, 0.93), (FAR_INTERVAL, 1.0)),
]

Wrong = Callable[[Bounds], Bounds]


@pytest.mark.parametrize("level", ["0.99", "0.97", "0.9", "0.5"])
def test_a_triangle_with_a_corner_near_one_end_has_its_area(level: str) -> None:
    """Newmark's polynomial at gamma = 1/2, beta = 1/6 (Hughes 1987) has three lines for edges: the area is exact."""
    r = Fraction(level)

    half, sixth = Fraction(1, 2), Fraction(1, 6)
    edges = [
        *(((z - 1) ** 2, half * (z**2 - 1), sixth * (z**2 + 4 * z + 1)) for z in (r, -r)),  # P(z) = 0
        (1 - r**2, -half * (1 + r**2), sixth * (1 - r**2)),  # |z|^2 = the last over the first coefficient
    ]
    corners = []
    for (c, a, b), (f, d, e) in combinations(edges, 2):
        corners.append(((b * f - c * e) / (a * e - b * d), (c * d - a * f) / (a * e - b * d)))
    (ax, ay), (bx, by), (cx, cy) = corners
    area = abs((bx - ax) * (cy - ay) - (cx - ax) * (by - ay)) / 2
    assert region(lookup("linear-acceleration"), float(level)).area == pytest.approx(float(area), rel=1e-9)


@pytest.fixture(autouse=True)
def nothing_remembered() -> Iterator[None]:
    """What is wrong on purpose must not be remembered, nor what is right hide it."""
    for remembered in (region, bounds_of):
        remembered.cache_clear()
    yield
    for remembered in (region, bounds_of):
        remembered.cache_clear()


def identify(case: object) -> str:
    return case.name if isinstance(case, Method) else str(case)


def without_arc(bounds: Bounds) -> Bounds:
    return replace(bounds, arcs=bounds.arcs[1:])


def without_interval(bounds: Bounds) -> Bounds:
    return replace(bounds, intervals=bounds.intervals[1:])


def with_a_bulge(bounds: Bounds) -> Bounds:
    """The first arc as that of a level a thousandth higher: closed to the eye, and wrong."""
    first, *others = bounds.arcs
    return replace(bounds, arcs=(Arc(first.pencil, first.level * 1.001, first.theta, first.mu * 1.001), *others))


@pytest.mark.parametrize("wrong", [without_arc, without_interval, with_a_bulge])
@pytest.mark.parametrize(("method", "level"), REGIONS, ids=identify)
@pytest.mark.slow
def test_a_wrong_region_is_no_answer(
    method: Method, level: float, wrong: Wrong, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert region(method, level).area
    region.cache_clear()
    monkeypatch.setattr(locus_shapes, "bounds_of", lambda pencil, level: wrong(bounds_of(pencil, level)))
    with pytest.raises(NumericalError):
        region(method, level)


def test_a_branch_followed_twice_in_place_of_another_is_no_answer(monkeypatch: pytest.MonkeyPatch) -> None:
    def swapped(pencil: MuPencil, level: float) -> list[Arc]:
        first, _, *others = tracks(pencil, level)
        return [first, first, *others]

    monkeypatch.setattr(boundary_locus, "tracks", swapped)
    with pytest.raises(NumericalError):
        region(CLOSE_BRANCHES, 0.93)


SHAPES = [
    *(("B4", 1.0), ("RK4", 0.93), ("ABM2", 1.0)),
    *(("verlet-kdk", 0.9), ("verlet-half", 0.9), ("ruth3", 0.25), ("bdf3", 1.0), ("imex", 1.0)),
]


def found(name: str, level: float) -> tuple[Method, Shape]:
    """Return the shape of a region, from the locus or from strips."""
    method = second_order(name) if name in RECIPES else lookup(name)
    shape = pencil_of(method, free=True).shape(level)
    assert shape
    return method, shape


def stretched(shape: Shape, number: int) -> Shape:
    """Return a shape with one of its curves off by a millionth."""
    curves = [curve * [1, 1 + 1e-6 if k == number else 1] for k, curve in enumerate(shape.boundary)]
    return replace(shape, boundary=tuple(curves))


def with_extent(shape: Shape, axis: int, end: float) -> Shape:
    """Return a shape with another upper end of alpha_hat (axis 0) or beta_hat."""
    extent = list(shape.extent)
    extent[axis] = (extent[axis][0], end)
    return replace(shape, extent=(extent[0], extent[1]))


WRONG_SIZES: list[tuple[str, Callable[[Shape], Shape]]] = [
    ("by slices", lambda shape: replace(shape, area=(1 + 5e-6) * (shape.area or 0))),
    ("the extent", lambda shape: with_extent(shape, 0, 0.9999 * shape.extent[0][1])),
    ("the extent", lambda shape: with_extent(shape, 0, 1.0001 * shape.extent[0][1])),
    ("the extent", lambda shape: with_extent(shape, 1, np.inf)),
    ("an edge was not found", lambda shape: replace(shape, boundary=tuple(curve[:-2] for curve in shape.boundary))),
]


@pytest.mark.parametrize(("name", "level"), SHAPES[:-2])
@pytest.mark.slow
def test_a_right_shape_passes_and_a_wrong_one_does_not(name: str, level: float) -> None:
    method, shape = found(name, level)
    check_region(method, level, shape)
    with pytest.raises(NumericalError, match="where none is"):
        check_region(method, level * 0.999, shape)
    with pytest.raises(NumericalError, match="was not found"):
        check_region(method, level, None)
    for said, wrong in WRONG_SIZES:
        with pytest.raises(NumericalError, match=said):
            check_region(method, level, wrong(shape))
    for number in range(len(shape.boundary)):
        with pytest.raises(NumericalError, match="where none is"):
            check_region(method, level, stretched(shape, number))
        others = shape.boundary[:number] + shape.boundary[number + 1 :]
        with pytest.raises(NumericalError):
            check_region(method, level, replace(shape, boundary=others))


@pytest.mark.parametrize(("name", "level"), SHAPES[-2:])
@pytest.mark.slow
def test_an_unbounded_shape_passes_but_not_with_a_wrong_edge_or_a_wrong_way_out(name: str, level: float) -> None:
    method, shape = found(name, level)
    check_region(method, level, shape)
    wrong: list[Shape | None] = [None, replace(shape, boundary=()), stretched(shape, 0)]
    for axis, (low, high) in enumerate(shape.extent):
        wrong.append(with_extent(shape, axis, 10.0 if np.isinf(high) else np.inf))
        if np.isfinite(low):
            ends = list(shape.extent)
            ends[axis] = (-np.inf, high)
            wrong.append(replace(shape, extent=(ends[0], ends[1])))
    for each in wrong:
        with pytest.raises(NumericalError):
            check_region(method, level, each)


def test_an_edge_through_what_is_stable_is_no_answer() -> None:
    """A straight edge inside of SYM's triangle, of which nothing else is wrong."""
    method, shape = found("SYM", 1.0)
    line = np.array([[0.5, 0.5], [0.5, 0.5], [0.6, 0.6], [0.6, 0.6], [0.5, 0.5], [0.5, 0.5]])
    with pytest.raises(NumericalError, match="where none is"):
        check_region(method, 1.0, replace(shape, boundary=(*shape.boundary, line)))
