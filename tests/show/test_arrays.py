import csv
import io
from typing import Literal

import numpy as np
import pytest

from bezstab.methods import lookup
from bezstab.show.arrays import boundary_arrays, map_arrays, untimed_arrays, write_arrays
from bezstab.stability import region


@pytest.mark.parametrize("h", [None, 0.001])
def test_written_arrays_come_back_exactly(h: float | None) -> None:
    a, b = np.linspace(0, 1, 3) / 3, np.linspace(0, 2, 4) / 7
    z = np.asarray((a + 1j * b[:, None]) / np.pi, complex)
    arrays = map_arrays(a, b, z, h)
    assert ("two_alpha" in arrays) == (h is not None)
    assert (arrays["alpha_hat"][:3] == a).all()  # alpha_hat runs fastest
    forms: tuple[Literal["csv", "npz"], ...] = ("csv", "npz")
    for form in forms:
        files = [io.BytesIO(), io.BytesIO()]
        for file in files:
            write_arrays(arrays, form, file)
        assert files[0].getvalue() == files[1].getvalue()
        files[0].seek(0)
        if form == "npz":
            back = dict(np.load(files[0]))
        else:
            lines = list(csv.reader(io.TextIOWrapper(files[0], encoding="utf-8")))
            back = {name: np.array(column, float) for name, *column in zip(*lines, strict=True)}
        assert back.keys() == arrays.keys()
        assert all((back[name] == arrays[name]).all() for name in arrays)


def test_texts_come_back_from_csv_as_they_are() -> None:
    texts = ["B4", "newmark(1/4,1/2)", 'said "so"', "two\nlines", ""]
    file = io.BytesIO()
    write_arrays({"a,b": np.array(texts), "n": np.arange(len(texts))}, "csv", file)
    rows = list(csv.reader(io.StringIO(file.getvalue().decode("utf-8"), newline="")))
    assert rows == [["a,b", "n"], *([text, str(number)] for number, text in enumerate(texts))]


def test_boundaries_as_arrays() -> None:
    shapes = [region(lookup("B4")), region(lookup("B4"), 0.5), region(lookup("RK4"), 0.25)]
    arrays = boundary_arrays(shapes, 0.5)
    assert set(arrays["method"]) == {"B4", "RK4"}
    assert set(arrays["curve"][arrays["method"] == "RK4"]) == {0, 1}
    assert arrays["two_alpha"].tolist() == [2 * a for a in arrays["alpha_hat"].tolist()]


def test_no_boundary_is_no_point() -> None:
    assert [len(array) for array in boundary_arrays([region(lookup("B4"), 0.5)], None).values()] == [0, 0, 0, 0]


def test_times_are_left_out_and_what_is_missing_is_nan_or_empty() -> None:
    arrays = untimed_arrays([{"seconds": 1.0, "seconds_max": 2.0, "order": None, "failure": None}])
    assert list(arrays) == ["order", "failure"]
    assert np.isnan(arrays["order"].astype(float)).all()
    assert arrays["failure"].tolist() == [""]
