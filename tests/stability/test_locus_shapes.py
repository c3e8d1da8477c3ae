from dataclasses import replace
from fractions import Fraction

import pytest

from bezstab.errors import NumericalError
from bezstab.methods import Method, RungeKutta
from bezstab.stability import pencil_of, region
from bezstab.stability.boundary_locus import bounds_of
from bezstab.stability.locus_shapes import _edge_noise, _known, locus_shape
from tests.stability.made_methods import FAR_INTERVAL


def composed(steps: int) -> Method:
    """Return implicit Euler steps composed: z = (1 - mu / n)^-n."""
    h = Fraction(1, steps)
    rows = tuple((h,) * (k + 1) + (Fraction(0),) * (steps - 1 - k) for k in range(steps))
    return Method("composed", RungeKutta(rows, (h,) * steps), "")


def test_of_too_many_stages_there_is_no_region() -> None:
    """Float64 rounds the squares of twenty implicit Euler steps' (1 + 2)^20 by more than the one they differ by."""
    with pytest.raises(NumericalError, match="composed: float64 keeps no digits"):
        region(composed(20))
    noise = [_edge_noise(pencil_of(composed(steps)), 1.0) for steps in (4, 8, 12, 16)]
    assert noise == sorted(noise)
    assert noise[-1] < 0.05


def test_each_part_of_a_one_step_methods_region_has_a_zero_of_r() -> None:
    """FAR_INTERVAL has a real one at -122.2, in an interval of 4e-8; its complex ones lie inside the curves."""
    pencil = pencil_of(FAR_INTERVAL)
    bounds = bounds_of(pencil, 1.0, 1)
    assert len(bounds.intervals) == 2
    with pytest.raises(NumericalError, match=r"around mu = -122\.203"):
        _known(pencil, 1.0, replace(bounds, intervals=bounds.intervals[1:]))
    shape = locus_shape(pencil, 1.0, finer=1)
    assert shape
    known = _known(pencil, 1.0, bounds)
    assert len(known)
    assert region(FAR_INTERVAL).contains(known[:, 0], known[:, 1]).all()
