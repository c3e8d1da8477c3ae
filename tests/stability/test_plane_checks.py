from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from bezstab.errors import NumericalError
from bezstab.methods import plane_strips
from bezstab.rationals import exact
from bezstab.stability.plane_cells import Edges, PlaneShape, plane_shape
from bezstab.stability.plane_checks import _check_curve, check_plane, contained, proven
from bezstab.stability.plane_pencils import PlanePencil, plane_pencil_of
from tests.reference.second_order_methods import second_order


def found(name: str, level: float) -> tuple[PlanePencil, Edges, PlaneShape]:
    """Return what a region is checked with."""
    method = second_order(name)
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
