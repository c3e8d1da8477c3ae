"""What bezstab/paper/README.md says of the limit of the Bézier methods."""

from fractions import Fraction

import numpy as np
import pytest

from bezstab.methods.orders import accuracy
from bezstab.methods.registry import lookup
from bezstab.stability.best_points import best_point
from bezstab.stability.regions import region


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
        found.append((shape.area, shape.extent[0][1], shape.extent[1][1], best.z_abs))
    limits = np.polynomial.polynomial.polyfit(1 / m, found, len(m) - 1)[0]
    # areas and extents are good to 1e-9, which the polynomial through ten of them multiplies by some thousands
    assert limits == pytest.approx([0.61962308, 8 / np.expm1(2), 0.741419, 0.68734989], abs=1e-5)
    assert accuracy(lookup("B12")) == (2, Fraction(1, 4) + Fraction(1, 6 * 11))
