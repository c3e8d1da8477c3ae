import csv
import io
import json
import math
from fractions import Fraction

import pytest

from bezstab.methods import lookup
from bezstab.questions import Question, answers, region_answer
from bezstab.show import POLES, REGIONS, Column, Row, column, formatted, render, transposed
from bezstab.show.rows import pole_rows, region_row

ANSWER = next(answers(Question(methods=(lookup("B4"),), point=(Fraction(1, 2), Fraction(1, 10)))))
ROWS = pole_rows(ANSWER, [0.75 + 0.125j, -0.5 + 0j])
COLUMNS = POLES.columns(ROWS)


def shown(column: Column, **row: object) -> str:
    return column.text(row)


def test_json_and_csv_keep_every_digit() -> None:
    assert json.loads(render(ROWS, COLUMNS, "json")) == ROWS
    (first, _) = csv.DictReader(io.StringIO(render(ROWS, COLUMNS, "csv")))
    assert {key: float(first[key]) for key in ("z_real", "z_imag", "z_abs")} == {
        k: ROWS[0][k] for k in ("z_real", "z_imag", "z_abs")
    }


def test_csv_has_the_keys_of_every_row() -> None:
    rows: list[Row] = [{"a": 1}, {"a": 2, "b": 3}]
    assert render(rows, [], "csv").splitlines() == ["a,b", "1,", "2,3"]


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_what_is_not_finite_is_missing(value: float) -> None:
    rows = [{**ROWS[0], "z_abs": value}]
    assert json.loads(render(rows, COLUMNS, "json")) == [{**ROWS[0], "z_abs": None}]
    assert next(csv.DictReader(io.StringIO(render(rows, COLUMNS, "csv"))))["z_abs"] == ""
    assert " -  " in render(rows, COLUMNS, "text")


def test_columns_line_up_under_hats() -> None:
    rows = [region_row(region_answer(lookup(name))) for name in ("B4", "AB4")]
    for form in ("text", "markdown"):
        header, *lines = render(rows, REGIONS.columns(rows), form).replace("\u0302", "").splitlines()
        column = header.index("least")
        assert [line[column : column + 10] for line in lines if "---" not in line] == ["0.62588350", "0.80700735"]


def test_text_rounds_and_markdown_is_a_table() -> None:
    assert "0.750000 ± 0.125000i" in render(ROWS, COLUMNS, "text")
    assert "-0.500000  " in render(ROWS, COLUMNS, "text")
    assert render(ROWS, COLUMNS, "markdown").splitlines()[1].replace("-", "").replace("|", "").strip() == ""


def test_missing_values_are_dashes_and_minus_zero_is_zero() -> None:
    assert [formatted(None, ".3f"), formatted(""), formatted(-0.0, "g")] == ["-", "-", "0"]
    assert shown(column("x", "x", ".2f"), x=None) == "-"


def test_a_transposed_row_reads_from_top_to_bottom() -> None:
    assert transposed({"h_max": 0.5, "reason": None, "steps": 4}) == [
        {"property": "h max", "value": "0.5"},
        {"property": "reason", "value": "-"},
        {"property": "steps", "value": "4"},
    ]


def test_a_cell_has_nothing_that_would_command_a_terminal() -> None:
    texts = {"a\nb": "a\\nb", "\x1b[2J": "\\x1b[2J", "\u2028": "\\u2028", "a  é中": "a  é中", "\x7f\x9b": "\\x7f\\x9b"}
    for text, shown in texts.items():
        assert column("method", "method").cell({"method": text}) == shown
