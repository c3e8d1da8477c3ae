from fractions import Fraction

import pytest

from bezstab.errors import NumericalError
from bezstab.methods import Method, lookup, stable_cells


def test_numbers_so_long_that_it_would_take_minutes_are_refused() -> None:
    recipe = Method("ABM3 as a recipe", lookup("ABM3").scheme.second_order, "")
    with pytest.raises(NumericalError, match=r"of degree 8 with coefficients of \d+ bits, .* of fewer digits"):
        stable_cells(recipe, Fraction("0.612345678901234567"))
