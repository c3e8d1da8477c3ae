"""Nothing that a caller does with an answer changes a later one: results are read-only, plain arrays the caller's."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np
import pytest

import bezstab

RESULTS: dict[str, Callable[[], Any]] = {
    "region": lambda: bezstab.region("B4"),
    "simulate": lambda: bezstab.simulate("slider_crank", "B4", alpha_hat=0.5, beta_hat=0.1, h=0.001, duration=0.01),
}


def arrays_in(value: object) -> Iterator[np.ndarray[Any, Any]]:
    """Yield every array that a result holds."""
    if isinstance(value, np.ndarray):
        yield value
    elif is_dataclass(value):
        for field in fields(value):
            yield from arrays_in(getattr(value, field.name))
    elif isinstance(value, Mapping):
        yield from arrays_in(tuple(value.values()))
    elif isinstance(value, (tuple, list)):
        for each in value:
            yield from arrays_in(each)


@pytest.mark.parametrize("name", RESULTS)
@pytest.mark.slow
def test_every_array_of_a_result_is_read_only(name: str) -> None:
    assert {array.flags.writeable for array in arrays_in(RESULTS[name]())} == {False}
