"""What bezstab/paper/README.md says of the limit of the Bézier methods."""

from fractions import Fraction

import numpy as np
import pytest
from numpy.typing import NDArray

from bezstab.methods.orders import accuracy
from bezstab.methods.registry import lookup
from bezstab.stability.best_points import best_point
from bezstab.stability.regions import region

CIRCLE = np.exp(1j * np.linspace(0, np.pi, 4097)[1:])
LENGTH = 4 / np.expm1(2)  # -mu(-1)


def mu(z: NDArray[np.complex128] | float) -> NDArray[np.complex128]:
    return np.asarray((z - 1) ** 2 / (z * np.expm1((z - 1) / z)))


def test_the_numbers_of_its_region() -> None:
    x, y = mu(CIRCLE).real, mu(CIRCLE).imag
    # by pairs of complex mu = x + iy, whose area is the integral of 2 y² dx, and by pairs of real ones
    complex_pairs = ((y[1:] ** 2 + y[:-1] ** 2) * np.diff(x)).sum()
    assert abs(complex_pairs) + LENGTH**3 / 6 == pytest.approx(0.619623, abs=5e-7)
    assert max(2 * LENGTH, -2 * x.min()) == pytest.approx(1.252141, abs=5e-7)
    assert np.abs(mu(CIRCLE)).max() ** 2 == pytest.approx(0.741419, abs=5e-7)
    assert mu(0.687350).real == pytest.approx(mu(-0.687350).real, abs=1e-5)
    assert accuracy(lookup("B12")) == (2, Fraction(1, 4) + Fraction(1, 6 * 11))


@pytest.mark.slow
def test_the_regions_of_the_methods_tend_to_it() -> None:
    """As L + c/m + d/m² + ..., m = n - 1: a polynomial through the methods gives L."""
    m = np.arange(2, 12)
    found = []
    for method in (lookup(f"B{n}") for n in m + 1):
        shape, best = region(method), best_point(method)
        assert shape.area
        assert shape.extent
        assert best
        found.append((shape.area, shape.extent[0][1], best.z_abs))
    limits = np.polynomial.polynomial.polyfit(1 / m, found, len(m) - 1)[0]
    # areas and extents are good to 1e-9, which the polynomial through ten of them multiplies by some thousands
    assert limits == pytest.approx([0.61962308, 2 * LENGTH, 0.68734989], abs=1e-5)
