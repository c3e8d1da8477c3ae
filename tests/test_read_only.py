"""Nothing that a caller does with an answer changes a later one: results are read-only, plain arrays the caller's."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np
import pytest

import bezstab
from bezstab.runs.accuracy_costs import reference_run
from bezstab.runs.verdict_maps import VerdictMap, map_rows, simulated_verdicts, verdict_map

ERROR = 1e-4 * 0.7 ** np.arange(60) * np.cos(0.9 * np.arange(60))


def small_map() -> VerdictMap:
    """Return a map of two by two runs."""
    rows = map_rows(bezstab.scene("slider_crank"), bezstab.method("B1"), h=0.001, count=2)
    return verdict_map(rows, [simulated_verdicts(each) for each in rows])


RESULTS: dict[str, Callable[[], Any]] = {
    "region": lambda: bezstab.region("B4"),
    "region without end": lambda: bezstab.region("trapezoid"),
    "check": lambda: bezstab.check("B4", alpha_hat=1, beta_hat=1),
    "simulate": lambda: bezstab.simulate("slider_crank", "B4", alpha_hat=0.5, beta_hat=0.1, h=0.001, duration=0.01),
    "verify": lambda: bezstab.verify("slider_crank", "B4", alpha_hat=0.5, beta_hat=0.1, h=0.001),
    "probe": lambda: bezstab.probe(ERROR, differenced=True, methods=["B4"], alpha_hat=0.5, beta_hat=0.1),
    "a map": small_map,
    "a reference motion": lambda: reference_run(bezstab.scene("slider_crank"), h=0.001, duration=0.01),
}
WITHOUT_ARRAYS = {"check", "verify", "probe"}


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
    found = list(arrays_in(RESULTS[name]()))
    assert bool(found) == (name not in WITHOUT_ARRAYS)
    assert not any(array.flags.writeable for array in found)
