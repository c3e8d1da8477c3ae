from pathlib import Path

import pytest

from bezstab.compiling import COMPILED_CHOICE


@pytest.fixture(autouse=True)
def _in_an_empty_directory(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("COLUMNS", raising=False)  # as on a pipe, unless a test sets it
    monkeypatch.setenv(COMPILED_CHOICE, "auto")  # which --compiled sets, and this restores
