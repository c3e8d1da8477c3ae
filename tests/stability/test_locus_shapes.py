from fractions import Fraction

import pytest

from bezstab.errors import NumericalError
from bezstab.methods import Method, RungeKutta
from bezstab.stability import pencil_of, region
from bezstab.stability.locus_shapes import _edge_noise


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
