import pytest

from bezstab.errors import NumericalError
from bezstab.stability import region
from tests.stability.made_methods import composed


def test_of_too_many_stages_there_is_no_region() -> None:
    """Float64 rounds the squares of twenty implicit Euler steps' (1 + 2)^20 by more than the one they differ by."""
    with pytest.raises(NumericalError, match="composed: float64 keeps no digits"):
        region(composed(20))
