import sys

import pytest

from bezstab.cli.terminal import UNLIMITED, text_width


@pytest.mark.parametrize(
    ("columns", "width"), [("80", 80), ("", UNLIMITED), ("0", UNLIMITED), ("-1", UNLIMITED), ("wide", UNLIMITED)]
)
def test_the_width_is_that_of_columns_and_without_a_terminal_there_is_none(
    columns: str, width: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", columns)
    monkeypatch.setattr(sys, "__stdout__", None)
    assert text_width() == width
