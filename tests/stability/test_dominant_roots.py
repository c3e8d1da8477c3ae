from fractions import Fraction

import numpy as np
import pytest

from bezstab.methods import LinearMultistep, Method, lookup
from bezstab.stability import (
    ComplexArray,
    FloatArray,
    dominant_roots,
    pencil_of,
    poles,
    roots_in_z,
    spectral_radius,
)
from bezstab.stability.dominant_roots import _follow, _twins
from bezstab.stability.neighbourhoods import LINE, blocks_of_neighbours
from tests.methods.kinds import EXPLICIT, IMPLICIT, SOLVED, sampled


@pytest.mark.parametrize("name", sampled(EXPLICIT))
def test_a_map_follows_the_pole_that_is_largest_everywhere(name: str) -> None:
    method = lookup(name)
    for low, high in (((-3, -2), (5, 6)), ((0, 0), (40, 900))):  # kinks and branch points; far outside
        alpha_hat, beta_hat = np.linspace(low, high, 120).T
        grid = (alpha_hat, beta_hat[:, np.newaxis])
        every = np.abs(poles(method, *grid)).max(axis=-1)
        # of ABM four roots meet at z = 1 along a curve of the plane, and float64 keeps a quarter of the digits there
        assert np.allclose(spectral_radius(method, *grid), every, rtol=1e-4 if "ABM" in name else 1e-12, atol=0)


def test_a_map_whose_rows_leap_over_branch_points_follows_no_pole_across_them() -> None:
    """From the end of one row, mu = -85, to the start of the next, mu = -5, the slopes at the former mean nothing."""
    weights = (tuple(map(Fraction, text.split())) for text in ("1 -1 0 1/3 -1/3", "0 4/5 1 2/5 -13/15"))
    method = Method("leap", LinearMultistep(*weights), "")
    grid = (np.linspace(8.673741, 86.61854885, 211), np.linspace(-28.26979122, 65.9313013, 197)[:, np.newaxis])
    every = np.abs(poles(method, *grid)).max(axis=-1)
    assert np.allclose(spectral_radius(method, *grid), every, rtol=1e-12, atol=0)


def test_a_conjugate_is_no_rival_where_mu_is_real_and_it_cannot_reach_the_axis() -> None:
    z = np.array([[0.9 + 0.3j], [0.9 - 0.3j], [0.1 + 0j]])
    real, complex_ = np.full((1, 16), -0.2 + 0j), np.full((1, 16), -0.2 + 0.1j)
    near, far = np.full((3, 1), 0.2), np.full((3, 1), 0.4)  # how far the roots may come
    assert _twins(real, z, z[0], near).ravel().tolist() == [False, True, False]
    assert not _twins(real, z, z[0], far).any()
    assert not _twins(complex_, z, z[0], near).any()


@pytest.mark.parametrize("name", ["B4", "AB3", "ABM3"])
def test_along_a_smooth_row_every_root_is_followed_and_none_solved_for_again(name: str) -> None:
    pencil = pencil_of(lookup(name))
    for start, end in ((-0.35 + 0.02j, -0.1 + 0.25j), (-0.3 + 0j, -0.05 + 0j)):
        blocks = np.linspace(start, end, 1600, dtype=np.complex128)[blocks_of_neighbours(1, 1600)]
        found = np.full(blocks.shape, np.nan, complex)
        _follow(pencil, blocks, found)
        assert np.isfinite(found).all()
        every = roots_in_z(pencil, blocks.ravel())
        largest = np.take_along_axis(every, np.argmax(np.abs(every), axis=0)[np.newaxis], axis=0)[0]
        assert found.ravel() == pytest.approx(largest, rel=1e-13)


@pytest.mark.parametrize("name", ["B4", "AB3", "ABM3"])
def test_newtons_starts_are_off_by_the_square_of_the_spacing(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    def starts_alone(_table: FloatArray, _mu: ComplexArray, starts: ComplexArray, _bound: FloatArray) -> ComplexArray:
        return starts

    monkeypatch.setattr(dominant_roots, "followed_roots", starts_alone)
    pencil, errors = pencil_of(lookup(name)), []
    for reach in (2e-3, 1e-3):
        row = np.linspace(-reach, reach, LINE, dtype=np.complex128) * (1 + 1j) + (-0.2 + 0.15j)
        blocks = row[blocks_of_neighbours(1, LINE)]
        found = np.empty(blocks.shape, complex)
        _follow(pencil, blocks, found)
        every = roots_in_z(pencil, blocks.ravel())
        errors.append(np.abs(found.ravel() - every).min(axis=0).max())
    assert errors[0] / errors[1] == pytest.approx(4, rel=0.05)


@pytest.mark.parametrize("name", sampled(IMPLICIT, quick=SOLVED))
def test_the_pole_of_an_implicit_method_is_followed_past_where_one_is_infinite(name: str) -> None:
    method = lookup(name)
    for low, high in (((-9, -6), (9, 12)), ((0, 0), (40, 900))):  # infinite at positive mu; far outside
        alpha_hat, beta_hat = np.linspace(low, high, 120).T
        grid = (alpha_hat, beta_hat[:, np.newaxis])
        every = np.abs(poles(method, *grid)).max(axis=-1)
        # where a pole is 1e6, of P's leading coefficient a millionth is left: it is that much less well known
        apart = np.abs(spectral_radius(method, *grid) - every) / every
        assert (apart < 1e-10 * np.maximum(1, every)).all()
