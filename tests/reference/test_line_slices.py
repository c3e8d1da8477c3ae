"""Slices of constant q against the proven verdict, and their sum in closed form."""

from fractions import Fraction
from itertools import pairwise
from math import pi

import numpy as np
import pytest

from bezstab.methods import Method, RungeKutta, lookup
from bezstab.stability import pencil_of
from bezstab.stability.boundary_locus import RIM, rim_radius
from bezstab.stability.closed_loop import decays_faster
from bezstab.stability.pencils import Pencil, all_inside, moduli_in_z
from tests.reference.line_slices import island_radii, mu_bound, paired_crossings, real_events, slices
from tests.reference.random_methods import random_method
from tests.reference.slice_integral import slice_area

NAMES = ["B4", "AB4", "RK4", "ABM3"]


def proven_inside(pencil: Pencil, level: float, p: Fraction, q: Fraction) -> bool:
    """Return whether all poles have |z| < level for the feedback mu^2 + p mu + q: of these methods' own parameters."""
    return decays_faster(pencil.method, Fraction(level), p, q)


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


@pytest.mark.parametrize(("number", "level", "near"), [(1045, 0.93, 0.603105), (1045, 0.93, 0.5)])
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


def test_radii_about_an_island_are_multiples_of_its_size_beside_its_zero() -> None:
    none = Fraction(0)
    method = Method("islands", RungeKutta(((none, none), (Fraction(2, 7), none)), (none, none + 1)), "constructed")
    zeros = np.roots([2 / 7, 1, 1])  # of R = 1 + mu + 2 mu^2 / 7
    level = 0.01
    size = level / np.abs(4 / 7 * zeros + 1)
    radii = island_radii(pencil_of(method), level)
    for zero, reach in zip(np.abs(zeros), size, strict=True):
        for times in (-1, 0, 1, 4):
            assert np.abs(radii - (zero + times * reach)).min() < 1e-12


def test_slices_add_up_to_areas_in_closed_form() -> None:
    assert slice_area(lookup("RK2"), 1.0).area == pytest.approx(4 + 2 * pi, rel=1e-8)


@pytest.mark.parametrize("name", ["AB4", "AB8", "B12", "ABM3", "bdf3", "radau3"])
def test_schurs_recursion_agrees_with_the_roots(name: str) -> None:
    pencil, random = pencil_of(lookup(name)), np.random.default_rng(2)
    mu = random.uniform(-1, 0.3, 200) + 1j * random.uniform(0, 1, 200)
    level = random.uniform(0.5, 1.2, 200)
    powers = mu ** np.arange(pencil.table.shape[1])[:, np.newaxis]
    largest = np.array([np.abs(np.roots(row)).max() for row in (pencil.table[::-1] @ powers).T])
    assert (all_inside(pencil, mu, 0.9) == (largest < 0.9)).all()
    assert (all_inside(pencil, mu, level) == (largest < level)).all()


IMPLICIT_NAMES = ["implicit-euler", "trapezoid", "bdf3", "am4", "radau3", "gauss4"]


@pytest.mark.parametrize("name", IMPLICIT_NAMES)
@pytest.mark.parametrize("level", [1.0, 0.8])
def test_slices_of_an_implicit_method_are_stable_where_proven_within_the_rim(name: str, level: float) -> None:
    pencil = pencil_of(lookup(name))
    bound, events = mu_bound(pencil, level), real_events(pencil, level)
    q = np.array([-2.0, -0.3, 0.2, 1.7, 9.3, 55.0])
    found = slices(pencil, level, q, events, bound)
    for line, (ends, stable) in enumerate(zip(found.ends, found.stable, strict=True)):
        for (low, high), expected in zip(pairwise(ends[np.isfinite(ends)]), stable, strict=False):
            middle = (low + high) / 2
            if high - low > 1e-6 * bound and abs(middle) < 0.9 * bound:
                assert proven_inside(pencil, level, Fraction(middle), Fraction(q[line])) == expected


@pytest.mark.parametrize("name", IMPLICIT_NAMES)
def test_beyond_the_features_of_an_implicit_method_the_verdict_depends_on_the_direction_alone(name: str) -> None:
    pencil = pencil_of(lookup(name))
    far = rim_radius(pencil, 1.0) / RIM * np.array([[4.0], [16.0], [64.0]])
    inside = all_inside(pencil, far * np.exp(1j * np.linspace(0.01, np.pi - 0.01, 101)), 1.0)
    half_plane = np.cos(np.linspace(0.01, np.pi - 0.01, 101)) < -1e-9
    off_axis = np.abs(np.linspace(0.01, np.pi - 0.01, 101) - np.pi / 2) > 0.01
    expected = {"trapezoid": half_plane, "gauss4": half_plane, "am4": np.full(101, False)}
    for row in inside:
        assert (row == expected.get(name, np.full(101, True)))[off_axis].all()
