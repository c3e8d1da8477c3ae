from fractions import Fraction
from typing import cast

import numpy as np
import pytest
from numpy.typing import ArrayLike

from bezstab.errors import InputError
from bezstab.stability.arrays import real_array


@pytest.mark.parametrize("values", [2, 2.0, Fraction(2), "2", np.float32(2), np.uint8(2)])
def test_a_real_number_of_any_kind_is_one(values: ArrayLike) -> None:
    assert real_array(values, "alpha_hat").dtype == np.float64
    assert real_array(cast(ArrayLike, [values, values]), "alpha_hat").tolist() == [2.0, 2.0]


@pytest.mark.parametrize(
    "values",
    [
        1j,
        np.ma.masked_array([1.0, 2.0], [False, True]),
        [[1], [1, 2]],
        None,
        True,
    ],
)
def test_what_would_lose_a_part_or_is_no_number_is_refused_by_name(values: ArrayLike) -> None:
    with pytest.raises(InputError, match=r"^alpha_hat (=|is) .*: expected ") as caught:
        real_array(values, "alpha_hat")
    assert len(str(caught.value).splitlines()) == 1
