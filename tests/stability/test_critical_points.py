import pytest

from bezstab.methods import Method, lookup
from bezstab.stability import Extent, region, spectral_radius
from bezstab.stability.charts import chart_of
from bezstab.stability.closed_loop import free_pencil_of
from bezstab.stability.critical_points import critical_place
from tests.reference.second_order_methods import second_order

BOX = ((0.0, 8.0), (0.0, 16.0))


def critical_point(method: Method, box: Extent = BOX) -> tuple[float, float] | None:
    chart = chart_of(free_pencil_of(method), region(method))
    place = critical_place(chart, box)
    return None if place is None else chart.user_point(place)


@pytest.mark.parametrize(
    ("method", "z_abs", "point"),
    [
        pytest.param(second_order("half"), 0, (1, 1), id="all zero"),
        # the triple pole of test_best_points
        pytest.param(second_order("old"), 3**-0.5, (2 * 3**-1.5, 2 - 3**-1.5 - 3**0.5), id="a third pole meets it"),
        # 3/2 - mu, -2, 1/2: z = 1/2 is double at mu = -1/2
        pytest.param(lookup("bdf2"), 1 / 2, (1, 1 / 4), id="a double root of pi"),
    ],
)
def test_the_double_pole_is_followed_down_to_where_it_ends(
    method: Method, z_abs: float, point: tuple[float, float]
) -> None:
    found = critical_point(method)
    assert found == pytest.approx(point, rel=1e-6)
    assert float(spectral_radius(method, *point)) == pytest.approx(z_abs, abs=1e-3)  # of a fourfold pole


def test_it_is_followed_no_further_than_the_box() -> None:
    """z = 1 / (1 - mu) of implicit Euler has no least value: with both mu at -1/2 alpha_hat is one."""
    found = critical_point(lookup("implicit-euler"), ((0.0, 1.0), (0.0, 16.0)))
    assert found == pytest.approx((1, 1 / 4))
