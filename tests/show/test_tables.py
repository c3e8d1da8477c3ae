import csv
import io
import json
import math
from typing import Literal

import numpy as np
import pytest

from bezstab.methods import lookup
from bezstab.show import render
from bezstab.show.tables import (
    POLES,
    REGIONS,
    boundary_columns,
    map_columns,
    pole_rows,
    region_row,
    where,
    whole_row,
    write_columns,
)
from bezstab.stability import best_point, region

ROWS = pole_rows(lookup("B4"), 0.5, 0.1, [0.75 + 0.125j, -0.5 + 0j], "converges")


def test_json_and_csv_keep_every_digit() -> None:
    assert json.loads(render(ROWS, POLES, "json")) == ROWS
    (first, _) = csv.DictReader(io.StringIO(render(ROWS, POLES, "csv")))
    assert {key: float(first[key]) for key in ("z_real", "z_imag", "z_abs")} == {
        k: ROWS[0][k] for k in ("z_real", "z_imag", "z_abs")
    }


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_what_is_not_finite_is_missing(value: float) -> None:
    rows = [{**ROWS[0], "z_abs": value}]
    assert json.loads(render(rows, POLES, "json")) == [{**ROWS[0], "z_abs": None}]
    assert next(csv.DictReader(io.StringIO(render(rows, POLES, "csv"))))["z_abs"] == ""
    assert " -  " in render(rows, POLES, "text")


def test_columns_line_up_under_hats() -> None:
    rows = [region_row(region(lookup(name)), best_point(lookup(name))) for name in ("B4", "AB4")]
    for form in ("text", "markdown"):
        header, *lines = render(rows, REGIONS, form).replace("\u0302", "").splitlines()
        column = header.index("least")
        assert [line[column : column + 10] for line in lines if "---" not in line] == ["0.62588350", "0.80700735"]


def test_text_rounds_and_markdown_is_a_table() -> None:
    assert "0.750000 ± 0.125000i" in render(ROWS, POLES, "text")
    assert "-0.500000  " in render(ROWS, POLES, "text")
    assert render(ROWS, POLES, "markdown").splitlines()[1].replace("-", "").replace("|", "").strip() == ""


def test_words_for_the_best_point() -> None:
    words = {name: where(best) for name in ("B2", "B4", "RK4", "ABM4") if (best := best_point(lookup(name)))}
    assert words["B4"] == "z = +0.625884 and -0.625884 meet, each double, on β̂ = α̂²/4"
    assert words["B2"].endswith("the same |z_p| on a whole arc, to (0.444444, 0.444444)")
    assert words["RK4"] == "deadbeat: every pole is 0; also at (0.541112, 6.347103)"
    assert "-0.140131 ± 0.504013i meet" in words["ABM4"]


def test_a_whole_row_says_that_b4_is_of_order_two() -> None:
    row = whole_row(lookup("B4"), region(lookup("B4")), best_point(lookup("B4")), latex=False)
    assert (row["order"], row["error_constant"], row["steps"], row["evaluations"]) == (2, "11/36", 4, 1)


@pytest.mark.parametrize("h", [None, 0.001])
def test_written_columns_come_back_exactly(h: float | None) -> None:
    a, b = np.linspace(0, 1, 3) / 3, np.linspace(0, 2, 4) / 7
    z = np.asarray((a + 1j * b[:, None]) / np.pi, complex)
    columns = map_columns(a, b, z, h)
    assert ("two_alpha" in columns) == (h is not None)
    assert (columns["alpha_hat"][:3] == a).all()  # alpha_hat runs fastest
    forms: tuple[Literal["csv", "npz"], ...] = ("csv", "npz")
    for form in forms:
        files = [io.BytesIO(), io.BytesIO()]
        for file in files:
            write_columns(columns, form, file)
        assert files[0].getvalue() == files[1].getvalue()
        files[0].seek(0)
        if form == "npz":
            back = dict(np.load(files[0]))
        else:
            lines = list(csv.reader(io.TextIOWrapper(files[0], encoding="utf-8")))
            back = {name: np.array(column, float) for name, *column in zip(*lines, strict=True)}
        assert back.keys() == columns.keys()
        assert all((back[name] == columns[name]).all() for name in columns)


def test_boundaries_as_columns() -> None:
    shapes = [region(lookup("B4")), region(lookup("B4"), 0.5), region(lookup("RK4"), 0.25)]
    columns = boundary_columns(shapes, 0.5)
    assert set(columns["method"]) == {"B4", "RK4"}
    assert set(columns["curve"][columns["method"] == "RK4"]) == {0, 1}
    assert columns["two_alpha"].tolist() == [2 * a for a in columns["alpha_hat"].tolist()]
