from collections.abc import Callable, Iterator
from itertools import islice
from pathlib import Path

import pytest

from bezstab import evidence
from bezstab.compiling import COMPILED_CHOICE


@pytest.fixture(autouse=True)
def _in_an_empty_directory(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("COLUMNS", raising=False)  # as on a pipe, unless a test sets it
    monkeypatch.setenv(COMPILED_CHOICE, "auto")  # which --compiled sets, and this restores


@pytest.fixture
def _few_extremes(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let `extremes` make its first checks only: all of them take half a minute."""
    every = evidence.extreme_checks

    def first_checks(full: bool) -> Iterator[Callable[[], evidence.Check]]:
        return islice(every(full), 2)

    monkeypatch.setattr(evidence, "extreme_checks", first_checks)
