import numpy as np
import pytest

from bezstab.methods import lookup
from bezstab.stability import pencil_of, region, spectral_radius
from bezstab.stability.charts import _axis, chart_of
from bezstab.stability.plane_pencils import plane_pencil_of


@pytest.mark.parametrize("name", ["B3", "trapezoid", "RK2"])
def test_both_charts_of_a_method_have_its_poles(name: str) -> None:
    method = lookup(name)
    for pencil in (pencil_of(method), plane_pencil_of(method)):
        chart = chart_of(pencil, region(method))
        for place in ((-0.3, 0.2), (-0.1, 0.4)) if not chart.real else ((0.3, 0.2), (0.1, 0.4)):
            z = np.roots(chart.coefficients(*place)[0, ::-1])
            z_abs = float(spectral_radius(method, *chart.user_point(place)))
            assert np.abs(z).max() == pytest.approx(z_abs, rel=1e-12)
            assert float(chart.modulus(np.array(place))) == pytest.approx(z_abs, rel=1e-12)
            for slope, beside in zip(chart.coefficients(*place)[1:], 1e-6 * np.eye(2), strict=True):
                after, before = (chart.coefficients(*(place + side * beside))[0] for side in (1, -1))
                assert slope == pytest.approx((after - before) / 2e-6, abs=1e-8)


def test_where_least_values_lie_a_grid_has_no_wide_gaps_however_far_it_goes() -> None:
    axis = _axis(1e4, 121)
    assert axis[-1] == pytest.approx(1e4)
    assert np.diff(axis[axis <= 8]).max() < 0.11
