"""The page of promises (promises.md) is what the marks of the tests say, and nothing else."""

from pathlib import Path

import pytest

from tests import promises

ROOT = Path(__file__).parent.parent


def test_the_page_is_fresh() -> None:
    assert promises.PAGE.read_text(encoding="utf-8") == promises.page()


def test_every_kind_of_promise_is_on_it() -> None:
    assert {promise.kind for promise in promises.promises()} == set(promises.KINDS)


def marked(folder: Path, *marks: str) -> None:
    tests = "\n".join(f"@pytest.mark.promise({mark})\ndef test_{n}() -> None: ..." for n, mark in enumerate(marks))
    (folder / "tests").mkdir()
    (folder / "tests" / "test_file.py").write_text(tests, encoding="utf-8")


def test_a_promise_with_two_tests_is_one_row(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    marked(tmp_path, '"Poles", computed="to 1e-12"', '"Poles"')
    monkeypatch.setattr(promises, "FOLDER", tmp_path / "tests")
    assert "| Poles | to 1e-12 | `tests/test_file.py::test_0`, `tests/test_file.py::test_1` |" in promises.page()


@pytest.mark.parametrize("marks", [['"Poles"'], ['"Poles", guessed="well"'], ['"P", proven="a"', '"P", proven="b"']])
def test_a_mark_that_says_too_little_or_too_much_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, marks: list[str]
) -> None:
    marked(tmp_path, *marks)
    monkeypatch.setattr(promises, "FOLDER", tmp_path / "tests")
    with pytest.raises(ValueError, match=r"test_file\.py::test_"):
        promises.page()


def test_the_readme_leads_to_the_page() -> None:
    assert "](tests/README.md)" in (ROOT / "README.md").read_text(encoding="utf-8")
    assert "](promises.md)" in (ROOT / "tests" / "README.md").read_text(encoding="utf-8")
