"""What the Bezier methods tend to as their number of steps grows: the limit's formula on the paper's page."""

import mpmath as mp
import numpy as np
import pytest

from bezstab.methods import lookup
from bezstab.stability import best_point, region


def mu(z: mp.mpc) -> mp.mpc:
    return (z - 1) ** 2 / (z * mp.expm1((z - 1) / z))


@pytest.mark.slow
def test_the_methods_tend_to_the_limit() -> None:
    """As L + c/m + d/m^2 + ..., m = n - 1: a polynomial through the methods gives L."""
    m = np.arange(2, 12)
    found = []
    for method in (lookup(f"B{n}") for n in m + 1):
        shape, best = region(method), best_point(method)
        assert shape.area
        assert shape.extent
        assert best
        found.append((shape.area, shape.extent[0][1], best.z_abs))
    area, alpha_hat_max, z_abs = np.polynomial.polynomial.polyfit(1 / m, found, len(m) - 1)[0]

    def density(theta: mp.mpf) -> mp.mpf:
        return 2 * mp.im(mu(mp.expj(theta))) ** 2 * mp.diff(lambda t: mp.re(mu(mp.expj(t))), theta)

    length = -mp.re(mu(mp.mpc(-1)))  # of the real interval; complex pairs inside the locus, by Green
    assert area == pytest.approx(float(abs(mp.quad(density, mp.linspace(0, mp.pi, 9))) + length**3 / 6), abs=1e-7)
    assert area == pytest.approx(0.61962308, abs=1e-7)
    assert alpha_hat_max == pytest.approx(float(2 * length), abs=1e-7)
    assert z_abs == pytest.approx(float(mp.findroot(lambda r: mp.re(mu(r) - mu(-r)), 0.687)), abs=1e-7)
