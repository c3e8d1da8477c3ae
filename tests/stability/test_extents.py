"""Extents of regions, those without end above all, against exact polygons and proven verdicts far out."""

from fractions import Fraction

import numpy as np
import pytest

from bezstab.methods.recipes import recipe
from bezstab.methods.registry import lookup
from bezstab.methods.schemes import Method
from bezstab.regions.answer import region_answer
from bezstab.regions.columns import REGION
from bezstab.show.columns import row_of
from bezstab.stability.regions import region
from bezstab.stability.stretches import SHORT
from tests.methods.kinds import sampled
from tests.reference.one_evaluation_schemes import one_evaluation_schemes, polygon_extent

SCHEMES = {method.name: method for method in one_evaluation_schemes()}
QUICK = [
    "by new velocity; at end, old velocity",  # an implicit spring, an explicit damper
    "by mean velocity; at middle, mean velocity",
    "by new velocity; at predicted, mean velocity",
]


SLANTED = 10 * SHORT
"""Of a place: corners below level one are told to where a stretch is SHORT, between edges of slopes up to ten."""


@pytest.mark.parametrize("level", ["1", "1/2"])
@pytest.mark.parametrize("name", sampled(list(SCHEMES), quick=QUICK))
def test_a_scheme_with_one_evaluation_has_the_extent_of_its_polygons(name: str, level: str) -> None:
    found, expected = region(SCHEMES[name], float(Fraction(level))), polygon_extent(SCHEMES[name], Fraction(level))
    assert (found.extent is None) == (expected is None)
    if found.extent and expected:
        allowed = 1e-9 if level == "1" else SLANTED
        assert np.array(found.extent) == pytest.approx(np.array(expected, float), rel=allowed, abs=allowed)
        assert not np.array(found.approached).any()  # polygons have their corners


def test_an_end_of_what_is_bounded_is_reached_however_far_out() -> None:
    """The last line of constant alpha_hat meets gauss4's region at beta_hat = 13,000."""
    found = region(lookup("gauss4"), 0.9)
    assert found.bounded
    assert not np.array(found.approached).any()


def test_beta_hat_may_come_near_its_limit_as_alpha_hat_grows() -> None:
    equations = {
        "x1": "x0 + v0 + 1/2 first",
        "v1": "v0 + second",
        "first": "acceleration(x0, 1/2 v0 + 1/2 v1)",
        "second": "acceleration(x0, v0)",
    }
    found = region(Method("two evaluations", recipe(equations), ""))
    assert np.array(found.extent) == pytest.approx(np.array([(0, np.inf), (0, 4)]), rel=1e-8)
    assert found.approached == ((False, False), (False, True))
    row = row_of(REGION, region_answer(found.method))
    assert row["beta_hat_range"] == [0, pytest.approx(4)]
