"""Columns, rows, and the tables and files that are made of them. Every command's rows: tests/cli/test_examples.py."""

import csv
import io
import json
import math
import re
from importlib import import_module

import numpy as np
import pytest

from bezstab.show.arrays import write_arrays
from bezstab.show.cells import formatted, pole_words
from bezstab.show.columns import POLE, Column, row_of
from bezstab.show.file_forms import TABLE_FORMS
from bezstab.show.tables import for_programs
from tests.imports import PACKAGE
from tests.show.keys_page import COLUMNS, PAGE, page

LISTS = [columns for lists in COLUMNS.values() for columns in lists]


def test_a_key_is_a_plain_word_and_each_kind_of_row_has_it_once() -> None:
    for columns in LISTS:
        keyed = [column for column in columns if column.key]
        assert len({column.key for column in keyed}) == len(keyed)
        for column in keyed:
            assert re.fullmatch(r"[a-z][a-z_]*", column.key)
            assert re.fullmatch(r"(?s)\S.*[^.]", column.meaning), column.key


def test_every_list_of_columns_is_in_the_table_of_keys() -> None:
    """A list that was forgotten would print keys that no page explains."""
    explained = {column.key for columns in LISTS for column in columns}
    for path in PACKAGE.glob("*/columns.py"):
        lists = vars(import_module(f"bezstab.{path.parent.name}.columns")).values()
        columns = [column for each in lists if isinstance(each, list | tuple) for column in each]
        assert {column.key for column in columns if isinstance(column, Column)} - {""} <= explained, path


def test_the_table_of_keys_has_every_key() -> None:
    assert PAGE.read_text(encoding="utf-8") == page(), "python -m tests.show.keys_page"


ROWS = [row_of(POLE, z) for z in (0.75 + 0.125j, -0.5 + 0j)]


def test_json_and_csv_keep_every_digit_and_text_rounds() -> None:
    assert json.loads(for_programs(ROWS, "json")) == ROWS
    first = next(csv.DictReader(io.StringIO(for_programs(ROWS, "csv"))))
    assert (json.loads(first["z"]), float(first["z_abs"])) == ([0.75, 0.125], abs(0.75 + 0.125j))
    assert for_programs([{"a": 1}, {"a": 2, "b": 3}], "csv").splitlines() == ["a,b", "1,", "2,3"]
    assert [pole_words(complex(0.75, imaginary)) for imaginary in (0.125, 1e-9)] == ["0.750000 ± 0.125000i", "0.750000"]
    assert [formatted(None, ".3f"), formatted(""), formatted(-0.0, "g")] == ["-", "-", "0"]
    assert formatted([1 / 3, None], ".3g") == "0.333, -"
    assert [formatted(each, "NO") for each in (True, False, None)] == ["yes", "NO", "-"]
    assert row_of(POLE, complex(math.inf))["z_abs"] is None


@pytest.mark.parametrize("form", TABLE_FORMS)
def test_written_arrays_come_back_exactly(form: str) -> None:
    texts = np.array(["newmark(1/4,1/2)", 'said "so"', "two\nlines", "α̂"])
    arrays = {"z_abs": np.linspace(0, 1, 4) / np.pi, "a,b": texts}
    file = io.BytesIO()
    write_arrays(arrays, form, file)
    file.seek(0)
    if form == "npz":
        back = dict(np.load(file))
    else:
        lines = csv.reader(io.TextIOWrapper(file, "utf-8", newline=""))
        back = {name: np.array(column) for name, *column in zip(*lines, strict=True)}
    assert list(back) == list(arrays)
    for name, array in arrays.items():
        assert back[name].astype(array.dtype).tolist() == array.tolist()
