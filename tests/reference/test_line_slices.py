"""Slices of constant q against the proven verdict, and their sum in closed form."""

from fractions import Fraction
from itertools import pairwise
from math import pi

import numpy as np
import pytest

from bezstab.methods import lookup
from bezstab.stability import pencil_of
from bezstab.stability.closed_loop import decays_faster
from bezstab.stability.pencils import moduli_in_z
from tests.reference.line_slices import mu_bound, paired_crossings, real_events, slices
from tests.reference.random_methods import random_method
from tests.reference.slice_integral import slice_area

NAMES = ["B4", "AB4", "RK4", "ABM3"]


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
                    # the feedback is mu^2 + p mu + q: p and q are these methods' own parameters
                    assert decays_faster(pencil.method, Fraction(level), p, Fraction(line)) == found.stable[row, k]


@pytest.mark.parametrize(("number", "level", "near"), [(1045, 0.93, 0.603105)])
def test_where_both_mu_of_pece_swap_sizes_crossings_have_a_root_on_the_circle(
    number: int, level: float, near: float
) -> None:
    """Of this one |mu_1| = |mu_2| at |mu|^2 = 0.603106: the sorted moduli have a kink there, and no turn."""
    pencil = pencil_of(random_method(number))
    q = near + np.linspace(-2e-5, 2e-5, 201)
    real = paired_crossings(pencil, level, np.sqrt(q))
    mu = real + 1j * np.sqrt(np.maximum(q[:, np.newaxis] - real**2, 0))
    found = np.isfinite(real)
    assert found.any(axis=1).all()
    moduli = moduli_in_z(pencil, mu[found])
    # 14 false positions leave 1e-9 of an angle's sample, 1e-3 rad, where the modulus turns nearby
    assert np.abs(moduli - level).min(axis=0).max() < 1e-6


def test_slices_add_up_to_areas_in_closed_form() -> None:
    assert slice_area(lookup("RK2"), 1.0).area == pytest.approx(4 + 2 * pi, rel=1e-8)
