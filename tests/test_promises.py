"""The page of promises (tests/README.md): every test that it names exists, every promise names one."""

import ast
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
PAGE = (ROOT / "tests" / "README.md").read_text(encoding="utf-8")
NAMED = sorted(set(re.findall(r"`(tests/[\w/]+\.py)::(\w+)`", PAGE)))
SECTIONS = {"Proven": 1, "Computed": 2, "Measured": 2}
"""Kinds of promises, and the column of the tests that hold them."""


def rows(kind: str) -> list[list[str]]:
    """Return the cells of each promise of one kind."""
    (section,) = re.findall(rf"^### {kind}.*?\n(.*?)(?=^#|\Z)", PAGE, re.DOTALL | re.MULTILINE)
    lines = [line for line in section.splitlines() if line.startswith("|")]
    return [re.split(r"(?<!\\)\|", line)[1:-1] for line in lines[2:]]


@pytest.mark.parametrize(("file", "test"), NAMED)
def test_a_test_that_holds_a_promise_exists(file: str, test: str) -> None:
    tree = ast.parse((ROOT / file).read_text(encoding="utf-8"))
    assert test in {node.name for node in tree.body if isinstance(node, ast.FunctionDef)}


@pytest.mark.parametrize("kind", SECTIONS)
def test_every_promise_names_a_test(kind: str) -> None:
    promises = rows(kind)
    assert promises
    for cells in promises:
        assert re.search(r"`tests/[\w/]+\.py::test_\w+`", cells[SECTIONS[kind]]), cells[0]


def test_whatever_looks_like_a_test_is_read_as_one() -> None:
    assert PAGE.count("::test_") == len(re.findall(r"`tests/[\w/]+\.py::test_\w+`", PAGE))


@pytest.mark.parametrize("target", sorted(set(re.findall(r"`make ([\w-]+)`", PAGE))))
def test_a_target_on_the_page_is_in_the_makefile(target: str) -> None:
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    assert re.search(rf"^{target}:", makefile, re.MULTILINE)


def test_the_readme_leads_to_the_page() -> None:
    assert "](tests/README.md)" in (ROOT / "README.md").read_text(encoding="utf-8")
