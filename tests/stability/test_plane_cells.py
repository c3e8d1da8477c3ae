from fractions import Fraction

import numpy as np
import pytest

from bezstab.methods import lookup
from bezstab.stability import region
from bezstab.stability.plane_cells import _split, strips_shape
from tests.reference.random_methods import other_random_method
from tests.reference.second_order_methods import as_second_order

OF_MU = ("SYM", "RK2", "B2", "AB2", "SIE", "B3")
LONGER = ("RK3", "RK4", "B4", "AB3", "AB4", "ABM2", "ABM3")


@pytest.mark.parametrize(
    ("name", "level"),
    [
        *((name, level) for name in OF_MU for level in (1.0, 0.9)),
        *(pytest.param(name, level, marks=pytest.mark.slow) for name in LONGER for level in (1.0, 0.61)),
        *(pytest.param(name, 1.0, marks=pytest.mark.slow) for name in ("ABM4", "B6")),
    ],
)
def test_a_method_of_mu_written_as_second_order_has_the_same_region(name: str, level: float) -> None:
    """B6 at 0.9 takes half a minute. ABM4 at 0.61 is refused: a strip of 2e-5 in beta_hat cannot be integrated."""
    by_strips, by_locus = strips_shape(as_second_order(name), level), region(lookup(name), level)
    if by_strips is None:
        assert by_locus.area == 0
        return
    # what either route promises; of the longer ones' locus 1e-12 absolute
    rel, absolute = (1e-12, 0) if name in OF_MU else (2e-11, 1e-12)
    assert by_strips.area == pytest.approx(by_locus.area, rel=rel, abs=absolute)
    if name in OF_MU:
        assert np.array(by_strips.extent) == pytest.approx(np.array(by_locus.extent), rel=1e-11, abs=1e-12)
        assert len(by_strips.boundary) == len(by_locus.boundary)


def test_where_the_feedback_sees_the_old_velocity_half_the_region_needs_negative_damping() -> None:
    stable = region(lookup("verlet-old"))
    assert stable.area == pytest.approx(4, rel=1e-13)  # two triangles that meet at beta_hat = 2
    assert np.array(stable.extent) == pytest.approx(np.array([(-2, 2), (0, 4)]))


LIMITS = {"central-difference": 4, "fox-goodwin": 6, "linear-acceleration": 12, "average-acceleration": np.inf}


@pytest.mark.parametrize("name", LIMITS)
def test_newmarks_limits_hold_for_any_damping(name: str) -> None:
    stable = region(lookup(name))
    assert (stable.bounded, stable.area) == (False, None)
    assert stable.extent == ((0, np.inf), (0, LIMITS[name]))


def test_where_an_edge_is_lost_at_the_level_zero_nothing_is_looked_for_next_to_it() -> None:
    """At rounding's distance from that level alpha_hat of a double root is known to 2e-3."""
    extent = region(other_random_method(447)).extent
    assert extent
    assert np.array(extent) == pytest.approx(np.array([(0, 30), (0, 25 / 3)]), rel=1e-13)


def test_where_two_crossings_meet_the_extent_keeps_its_digits() -> None:
    """At its furthest alpha_hat a double root lies on a level: float64 alone knows it to 5e-8."""
    extent = region(other_random_method(3)).extent
    assert extent
    assert extent[0][0] == pytest.approx(-22 / 15, rel=1e-13)


@pytest.mark.parametrize("size", [Fraction(10) ** 400, Fraction(1, 10**400)])
def test_coefficients_of_hundreds_of_digits_are_split_relative_to_the_largest(size: Fraction) -> None:
    (((high, low), one),) = _split(((size / 3, -size),))
    assert one == (-1, 0)
    assert abs(Fraction(high) + Fraction(low) - Fraction(1, 3)) < Fraction(1, 2**106)
