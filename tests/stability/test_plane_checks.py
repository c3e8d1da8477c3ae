from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from bezstab.errors import NumericalError
from bezstab.methods import lookup, plane_strips
from bezstab.rationals import exact
from bezstab.stability import region, spectral_radius
from bezstab.stability.plane_cells import Edges, PlaneShape, plane_shape
from bezstab.stability.plane_checks import _check_curve, check_plane, contained, proven
from bezstab.stability.plane_pencils import PlanePencil, plane_pencil_of
from tests.methods.kinds import sampled
from tests.reference.second_order_methods import RECIPES, second_order


@cache
def found(name: str, level: float) -> tuple[PlanePencil, Edges, PlaneShape]:
    """Return what a region is checked with."""
    method = second_order(name) if name in RECIPES else lookup(name)
    strips = plane_strips(method, exact(level))
    assert strips
    edges = Edges(strips)
    shape = plane_shape(strips, edges, name)
    assert shape
    return plane_pencil_of(method), edges, shape


@pytest.mark.parametrize(("name", "level"), [("half", 1.0), ("predicted", 0.9), ("kdk", 0.9), ("imex", 1.0)])
def test_a_right_shape_passes(name: str, level: float) -> None:
    pencil, edges, shape = found(name, level)
    check_plane(pencil, level, edges, shape)


@pytest.mark.parametrize("name", sampled(["ruth3", "forest-ruth", "yoshida4", "rkn4"], quick=["ruth3"]))
@pytest.mark.parametrize("level", [0.75, 0.5, 0.25])
def test_islands_far_from_each_other_pass_and_have_the_area_of_a_grid_on_each(name: str, level: float) -> None:
    """Ruth's at 0.25 are three, of widths 0.02, 0.24 and 0.26 in an extent of 28."""
    method = lookup(name)
    below = region(method, level)
    side, shares = 400, (np.arange(400) + 0.5) / 400
    boxes = [(curve.min(axis=0), curve.max(axis=0)) for curve in below.boundary]
    counted = 0.0
    for k, (low, high) in enumerate(boxes):
        alpha_hat, beta_hat = np.meshgrid(*(low + np.multiply.outer(shares, high - low)).T)
        inside = spectral_radius(method, alpha_hat, beta_hat) < level
        for (left, bottom), (right, top) in boxes[:k]:  # boxes may overlap, and then the first of them counts
            inside &= ~((left < alpha_hat) & (alpha_hat < right) & (bottom < beta_hat) & (beta_hat < top))
        counted += float(inside.sum() * np.prod((high - low) / side))
    # an edge passes through some 4 * 400 of the 160000 cells, about half of which are counted
    assert below.area == pytest.approx(counted, rel=5e-3)


@pytest.mark.parametrize("far", [0, 1, 2])
def test_an_island_whose_curve_is_off_does_not_pass(far: int) -> None:
    pencil, edges, shape = found("ruth3", 0.25)
    assert len(shape.curves) == 3
    off = tuple(curve * [1, 1.01 if k == far else 1] for k, curve in enumerate(shape.curves))
    with pytest.raises(NumericalError, match="contradict the poles"):
        check_plane(pencil, 0.25, edges, replace(shape, curves=off))


CHANGES: dict[str, Any] = {
    "a cell is missing": lambda shape: replace(shape, cells=shape.cells[1:]),
    "the area is off": lambda shape: replace(shape, area=1.2 * shape.area),
    "a curve is off": lambda shape: replace(shape, curves=tuple(curve * [1.05, 1] for curve in shape.curves)),
}


@pytest.mark.parametrize("change", CHANGES)
@pytest.mark.parametrize("name", ["predicted", "kdk"])
def test_a_wrong_shape_does_not(name: str, change: str) -> None:
    pencil, edges, shape = found(name, 0.9)
    with pytest.raises(NumericalError):
        check_plane(pencil, 0.9, edges, CHANGES[change](shape))


def test_a_shape_of_another_level_does_not() -> None:
    pencil, edges, shape = found("half", 0.9)
    with pytest.raises(NumericalError):
        check_plane(pencil, 0.95, edges, shape)


def test_an_empty_shape_where_something_is_stable_does_not() -> None:
    with pytest.raises(NumericalError, match="is wrong at"):
        check_plane(plane_pencil_of(second_order("half")), 1.0, None, None)


def test_points_lie_in_cells_as_schur_proves() -> None:
    pencil, edges, shape = found("implicit", 0.5)
    generator = np.random.default_rng(9)
    alpha_hat, beta_hat = generator.uniform(0, 4, (2, 60))
    inside, _ = contained(edges, shape, alpha_hat, beta_hat)
    expected = [proven(pencil.method, 0.5, a, b) for a, b in zip(alpha_hat, beta_hat, strict=True)]
    assert inside.tolist() == expected


def test_an_edge_may_be_off_by_a_millionth_of_what_is_seen() -> None:
    """The edges of the level 0.5 as those of a level beside it: they move half as far as the level."""
    pencil, edges, shape = found("predicted", 0.5)
    seen = shape.view[0][1] - shape.view[0][0]
    assert seen < 0.1
    _check_curve(pencil, 0.5 + 1e-6 * seen, edges, shape)
    with pytest.raises(NumericalError, match="no edge"):
        _check_curve(pencil, 0.5 + 1e-5 * seen, edges, shape)
