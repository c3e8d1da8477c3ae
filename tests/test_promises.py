"""The page of promises (promises.md) is what the marks of the tests say, and nothing else."""

from pathlib import Path

import pytest

from tests import promises

ROOT = Path(__file__).parent.parent


def test_the_page_is_fresh() -> None:
    assert promises.PAGE.read_text(encoding="utf-8") == promises.page()


def marked(folder: Path, *marks: str) -> None:
    tests = "\n".join(f"@pytest.mark.promise({mark})\ndef test_{n}() -> None: ..." for n, mark in enumerate(marks))
    (folder / "tests").mkdir()
    (folder / "tests" / "test_file.py").write_text(tests, encoding="utf-8")


@pytest.mark.parametrize("marks", [['"Poles"'], ['"Poles", guessed="well"'], ['"P", proven="a"', '"P", proven="b"']])
def test_a_mark_that_says_too_little_or_too_much_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, marks: list[str]
) -> None:
    marked(tmp_path, *marks)
    monkeypatch.setattr(promises, "FOLDER", tmp_path / "tests")
    with pytest.raises(ValueError, match=r"test_file\.py::test_"):
        promises.page()
