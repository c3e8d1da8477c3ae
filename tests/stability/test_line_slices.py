"""Slices of constant q against the proven verdict, and their sum in closed form."""

from fractions import Fraction
from itertools import pairwise
from math import pi

import numpy as np
import pytest

from bezstab.methods import lookup
from bezstab.stability import pencil_of
from bezstab.stability.line_slices import all_inside, mu_bound, real_events, slices
from bezstab.stability.self_checks import proven_inside
from tests.reference.slice_integral import slice_area

NAMES = ["B4", "AB4", "RK4", "ABM3", "SYM"]


@pytest.mark.parametrize("level", [1.0, 0.8])
@pytest.mark.parametrize("name", NAMES)
def test_between_its_ends_a_slice_is_proven(name: str, level: float) -> None:
    pencil = pencil_of(lookup(name))
    q = np.array([0.003, 0.02, 0.1, 0.3, 1.1])
    found = slices(pencil, level, q, real_events(pencil, level), mu_bound(pencil, level))
    for row, line in enumerate(q.tolist()):
        ends = found.ends[row][np.isfinite(found.ends[row])].tolist()
        for k, (low, high) in enumerate(pairwise(ends)):
            if high - low > 1e-6:
                for share in (0.01, 0.5, 0.99):
                    p = Fraction(low + share * (high - low))
                    assert proven_inside(pencil, level, p, Fraction(line)) == found.stable[row, k]


def test_slices_add_up_to_areas_in_closed_form() -> None:
    assert slice_area(lookup("SYM"), 1.0).area == pytest.approx(4, rel=1e-12)
    assert slice_area(lookup("RK2"), 1.0).area == pytest.approx(4 + 2 * pi, rel=1e-8)


def test_schurs_recursion_agrees_with_the_roots() -> None:
    pencil = pencil_of(lookup("AB4"))
    mu = np.random.default_rng(2).uniform(-1, 0.3, 200) + 1j * np.random.default_rng(3).uniform(0, 1, 200)
    largest = [np.abs(np.roots([1, *(pencil.table[::-1] @ [1, m])[1:]])).max() for m in mu]
    assert (all_inside(pencil, mu, 0.9) == (np.array(largest) < 0.9)).all()
