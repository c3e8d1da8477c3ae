"""When a scheme evaluates, against what the authors of the schemes say."""

from fractions import Fraction

import pytest

from bezstab.methods.registry import lookup
from bezstab.methods.scheme_motions import evaluation_times
from bezstab.methods.schemes import RungeKutta
from tests.methods.kinds import RUNGE_KUTTA


@pytest.mark.parametrize("name", RUNGE_KUTTA)
def test_stages_are_evaluated_at_the_sums_of_their_rows(name: str) -> None:
    scheme = lookup(name).scheme
    assert isinstance(scheme, RungeKutta)
    times = evaluation_times(scheme.second_order)
    assert list(times.values()) == [sum(row, Fraction(0)) for row in scheme.tableau]
