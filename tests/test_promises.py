"""The page of promises (tests/README.md): every test that it names exists, every promise names one."""

import ast
import re
from itertools import groupby
from pathlib import Path

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


def test_a_test_that_holds_a_promise_exists() -> None:
    for file, tests in groupby(NAMED, lambda named: named[0]):
        tree = ast.parse((ROOT / file).read_text(encoding="utf-8"))
        defined = {node.name for node in tree.body if isinstance(node, ast.FunctionDef)}
        assert {test for _, test in tests} <= defined, file


def test_every_promise_names_a_test() -> None:
    for kind, column in SECTIONS.items():
        promises = rows(kind)
        assert promises, kind
        for cells in promises:
            assert re.search(r"`tests/[\w/]+\.py::test_\w+`", cells[column]), cells[0]


def test_whatever_looks_like_a_test_is_read_as_one() -> None:
    assert PAGE.count("::test_") == len(re.findall(r"`tests/[\w/]+\.py::test_\w+`", PAGE))


def test_a_target_on_the_page_is_in_the_makefile() -> None:
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    for target in set(re.findall(r"`make ([\w-]+)`", PAGE)):
        assert re.search(rf"^{target}:", makefile, re.MULTILINE), target


def test_the_readme_leads_to_the_page() -> None:
    assert "](tests/README.md)" in (ROOT / "README.md").read_text(encoding="utf-8")
