"""A new column is one line: all that people and programs see of a field derives from it."""

from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np
import pytest

from bezstab.methods import Method, lookup
from bezstab.show import Field, RowKind, cells, render, row_kinds
from bezstab.show.schemas import _row_schema


@dataclass(frozen=True)
class Sample:
    method: Method
    share: Fraction
    missing: str | None
    values: object


SAMPLE = Sample(lookup("B4"), Fraction(1, 4), None, np.zeros(2))
METHOD = Field("method", "Name of the method", "method", kind="text")
SHARE = Field("share", "What is taken", "taken", ".0%", unit="s", null="never")
MISSING = Field("missing", "What is missing", "missing", kind="text", null="always")


def test_a_row_has_names_and_numbers_of_a_result_unless_they_were_found() -> None:
    assert cells((METHOD, SHARE, MISSING), SAMPLE) == {"method": "B4", "share": 0.25, "missing": None}
    assert cells((METHOD, SHARE), SAMPLE, {"share": 0.5, "other": 1}) == {"method": "B4", "share": 0.5}


def test_a_row_refuses_a_type_that_it_does_not_know() -> None:
    with pytest.raises(TypeError, match=r"Sample\.values is a ndarray"):
        cells((Field("values", "Values"),), SAMPLE)


def test_a_path_leads_through_attributes_places_and_the_parts_of_complex_numbers() -> None:
    result = replace(SAMPLE, values=(3 + 4j, float("inf")))
    for path, value in (("values.0.abs", 5), ("values.0.imag", 4), ("values.1", None), ("missing.any", None)):
        assert cells((SHARE.of(path),), result) == {"share": value}


def test_a_table_shows_what_has_a_heading_and_something_to_show() -> None:
    kind = RowKind("a sample", (METHOD, SHARE.hidden), (MISSING,))
    rows = [cells((*kind.fields, *kind.added), SAMPLE)]
    assert [column.heading for column in kind.columns(rows)] == ["method"]
    shown = RowKind("a sample", (METHOD, SHARE.shown("share", ".1f")))
    assert render(rows, shown.columns(rows), "text").split() == ["method", "share", "B4", "0.2"]
    assert [column.heading for column in shown.columns(rows, without=("method",))] == ["share"]


def test_one_line_makes_a_column_a_key_and_its_documentation() -> None:
    new = Field("settles", "Whether errors settle", "settles", kind="truth", path="method.scheme.has_mu")
    kind = replace(row_kinds.EXTREMES, fields=(METHOD, new))
    rows = [cells(kind.fields, SAMPLE)]
    assert render(rows, kind.columns(rows), "text").split() == ["method", "settles", "B4", "yes"]
    assert render(rows, [], "csv").splitlines() == ["method,settles", "B4,True"]
    assert _row_schema(kind)["properties"]["settles"] == {"description": "Whether errors settle.", "type": "boolean"}
