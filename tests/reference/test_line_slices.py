"""Slices of constant q against the proven verdict, and their sum in closed form."""

from fractions import Fraction
from itertools import pairwise
from math import pi

import numpy as np
import pytest

from bezstab.methods import lookup
from bezstab.stability.closed_loop import decays_faster
from bezstab.stability.mu_pencils import mu_pencil_of
from tests.reference.line_slices import mu_bound, real_events, slices
from tests.reference.slice_integral import slice_area

NAMES = ["B4", "AB4", "RK4"]


@pytest.mark.parametrize("level", [1.0, 0.8])
@pytest.mark.parametrize("name", NAMES)
def test_between_its_ends_a_slice_is_proven(name: str, level: float) -> None:
    pencil = mu_pencil_of(lookup(name))
    q = np.array([0.003, 0.02, 0.1, 0.3, 1.1])
    found = slices(pencil, level, q, real_events(pencil, level), mu_bound(pencil, level))
    for row, line in enumerate(q.tolist()):
        ends = found.ends[row][np.isfinite(found.ends[row])].tolist()
        for k, (low, high) in enumerate(pairwise(ends)):
            if high - low > 1e-6:
                for share in (0.01, 0.5, 0.99):
                    p = Fraction(low + share * (high - low))
                    # the feedback is mu^2 + p mu + q: p and q are these methods' own parameters
                    assert decays_faster(pencil.method, Fraction(level), p, Fraction(line)) == found.stable[row, k]


def test_slices_add_up_to_areas_in_closed_form() -> None:
    assert slice_area(lookup("RK2"), 1.0).value == pytest.approx(4 + 2 * pi, rel=1e-8)
