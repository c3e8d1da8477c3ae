import math
from typing import Any

import numpy as np

from bezstab.runs.tables import table_arrays
from bezstab.show.columns import Column

COLUMNS = [
    Column[dict[str, Any]]("", "seconds", lambda answer: answer["seconds"], ""),
    Column[dict[str, Any]]("", "order", lambda answer: answer["order"], ""),
    Column[dict[str, Any]]("", "failure", lambda answer: answer["failure"], ""),
]


def test_tables_leave_out_times_and_say_what_is_missing_among_numbers_and_among_texts() -> None:
    first: dict[str, Any] = {"seconds": 1.0, "order": None, "failure": "too far"}
    arrays = table_arrays(COLUMNS, [first, {"seconds": 2.0, "order": 2.0, "failure": None}])
    assert list(arrays) == ["order", "failure"]
    assert np.array_equal(arrays["order"], [math.nan, 2.0], equal_nan=True)
    assert arrays["failure"].tolist() == ["too far", ""]
