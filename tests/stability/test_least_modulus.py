from collections.abc import Sequence

import numpy as np
import pytest
from numpy.polynomial.polynomial import polyfromroots

from bezstab.stability import ComplexArray, FloatArray
from bezstab.stability.charts import Chart
from bezstab.stability.least_modulus import Active, least_on, solved

Root = tuple[complex, complex, complex]
"""A root at 0, and how it moves with either parameter."""


def chart_of(*roots: Root, edges: tuple[int, ...] = (), real: bool = False) -> Chart:
    """Return a chart, 4 wide, on which the polynomial has the roots constant + x by_x + y by_y."""

    def coefficients(x: float, y: float) -> ComplexArray:
        z = [constant + x * by_x + y * by_y for constant, by_x, by_y in roots]
        others = [polyfromroots(z[:k] + z[k + 1 :]) for k in range(len(z))]
        slopes = [
            -sum((root[i] * np.append(other, 0) for root, other in zip(roots, others, strict=True)), np.zeros(1))
            for i in (1, 2)
        ]
        return np.array([polyfromroots(z), *slopes], complex)

    def modulus(points: FloatArray) -> FloatArray:
        moved = [constant + points[..., 0] * by_x + points[..., 1] * by_y for constant, by_x, by_y in roots]
        return np.asarray(np.abs(moved).max(axis=0))

    def fold(points: FloatArray) -> FloatArray:
        x = np.minimum(points[..., 0], 0) if 0 in edges else points[..., 0]
        return np.stack([x, np.abs(points[..., 1])], axis=-1)

    axes = np.linspace(-4, 0 if 0 in edges else 4, 41), np.linspace(0, 4, 21)
    return Chart("made", coefficients, modulus, fold, lambda place: place, axes, edges, real)


def touching() -> Chart:
    """Return z^2 - 2 x z + x^2 - (x - 1 - y^2): double at x = 1 + y^2, where z = x."""

    def coefficients(x: float, y: float) -> ComplexArray:
        return np.array([[x**2 - x + 1 + y**2, -2 * x, 1], [2 * x - 1, -2, 0], [2 * y, 0, 0]], complex)

    made = chart_of((0, 0, 0), real=True)
    return Chart("made", coefficients, made.modulus, made.fold, made.user_point, made.axes, (), real=True)


def bowl() -> Chart:
    """Return z = 1 + x^2 + (y - 1)^2, of which the second parameter is one at its least."""

    def coefficients(x: float, y: float) -> ComplexArray:
        return np.array([[-1 - x**2 - (y - 1) ** 2, 1], [-2 * x, 0], [-2 * (y - 1), 0]], complex)

    made = chart_of((0, 0, 0), real=True)
    return Chart("made", coefficients, made.modulus, made.fold, made.user_point, made.axes, (), real=True)


TWO = chart_of((-2j, 1, 1j), (-2 - 2j, 1, 1j))  # 1 + w and -1 + w with w = x - 1 + i (y - 2)
THREE = chart_of((1, -1, 0), (-1, 0, -1), (2j, 0, -1j))  # 1 - x, -(1 + y) and i (2 - y)
ONE = chart_of((2, 1 + 1j, 1 - 1j), edges=(0, 1))  # |z|^2 = (2 + x + y)^2 + (x - y)^2


@pytest.mark.parametrize(
    ("chart", "start", "active", "held", "place"),
    [
        pytest.param(
            TWO, (1.1, 2.2), [Active(1.1 + 0.2j), Active(-0.9 + 0.2j)], {}, (1, 2), id="two against each other"
        ),
        pytest.param(
            THREE, (-0.4, 0.4), [Active(1.4), Active(-1.4), Active(1.6j)], {}, (-0.5, 0.5), id="three as large"
        ),
        pytest.param(bowl(), (0.2, 0.9), [Active(1.05, real=True)], {}, (0, 1), id="one without a slope"),
        pytest.param(touching(), (1.1, 0.2), [Active(1.1, 2, real=True)], {}, (1, 0), id="a double one on its curve"),
        pytest.param(ONE, (-0.2, -0.8), [Active(1 + 0.6j)], {0: 0.0}, (0, -1), id="on the first edge"),
        pytest.param(ONE, (-0.8, -0.2), [Active(1 - 0.6j)], {1: 0.0}, (-1, 0), id="on the second edge"),
        pytest.param(ONE, (-0.8, 0.3), [Active(1.5 - 1.1j)], {1: 0.5}, (-1, 0.5), id="where a parameter is given"),
    ],
)
def test_newtons_method_ends_where_the_poles_of_a_set_hold_each_other(
    chart: Chart,
    start: tuple[float, float],
    active: Sequence[Active],
    held: dict[int, float],
    place: tuple[float, float],
) -> None:
    found = solved(chart, start, active, held)
    assert found
    assert found.parameters == pytest.approx(place, abs=1e-12)
    assert found.residual < 1e-12
    polynomial = chart.coefficients(*place)[0]
    for z in found.z:
        assert abs(polynomial @ z ** np.arange(len(polynomial))) < 1e-12


def test_what_leads_far_away_is_no_minimum_nearby() -> None:
    """The pole 1 + x + iy is least at (-1, 0)."""
    assert solved(chart_of((1, 1, 1j)), (5.0, 5.0), [Active(6 + 5j)]) is None


@pytest.mark.parametrize("number", range(6))
@pytest.mark.parametrize("edges", [(1,), (0, 1)])
def test_the_least_of_roots_that_move_with_mu_is_where_no_way_leads_down(number: int, edges: tuple[int, ...]) -> None:
    """Moduli of a + b mu are convex, and so is the largest of some: what is least nearby is the least."""
    random = np.random.default_rng(number)
    a, b = complex(*random.normal(size=2)), complex(*random.normal(1, 0.5, 2))
    roots = [(random.normal(), random.normal(1, 0.5)), (a, b), (a.conjugate(), b.conjugate())]
    chart = chart_of(*((a, b, 1j * b) for a, b in roots), edges=edges)
    sampled, least = least_on(chart)
    assert least
    assert least.z_abs <= sampled * (1 + 1e-12)
    here = np.array(least.place)
    assert float(chart.modulus(here)) == pytest.approx(least.z_abs, rel=1e-12)
    angles = np.linspace(0, 2 * np.pi, 64)
    around = here + np.array([[1e-6], [1e-3]])[..., np.newaxis] * np.stack([np.cos(angles), np.sin(angles)], axis=-1)
    assert chart.modulus(chart.fold(around)).min() >= least.z_abs * (1 - 1e-12)
