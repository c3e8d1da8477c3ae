"""The page of promises (promises.md), made from the marks of the tests that hold them.

    @pytest.mark.promise("Overflow", computed="is reported, never returned")

marks the test that holds a promise, with its kind and its words. A further test of it gives its name alone.

    python -m tests.promises
"""

import ast
from collections.abc import Iterator
from pathlib import Path

FOLDER = Path(__file__).parent
PAGE = FOLDER / "promises.md"

KINDS = {
    "proven": "Proven: in exact rational arithmetic, nothing is rounded",
    "computed": "Computed: in float64, to so many digits, checked by another route",
    "measured": "Measured: in simulation, with an uncertainty",
    "unknown": "Not known, or known to be lost",
}
"""The heading of each kind of promise, in the order of the page."""

OPENING = """# What is promised

Each row names what is promised, how far, and the tests that hold it. Digits are relative unless a unit is given. What
is not on this page is not promised. The page is made from the marks of the tests: `python -m tests.promises`.
"""


def marks() -> Iterator[tuple[str, ast.Call]]:
    """Yield the place of each marked test, in the order of the files, with its mark as a syntax tree."""
    for file in sorted(FOLDER.rglob("test_*.py")):
        text = file.read_text(encoding="utf-8")
        marked = ast.parse(text).body if "mark.promise(" in text else []  # a second saved
        for test in (node for node in marked if isinstance(node, ast.FunctionDef)):
            for mark in test.decorator_list:
                if isinstance(mark, ast.Call) and ast.unparse(mark.func) == "pytest.mark.promise":
                    yield f"{file.relative_to(FOLDER.parent).as_posix()}::{test.name}", mark


def page() -> str:
    """Return the text of the page; ValueError if a promise has no words, words twice, or a kind that is none."""
    tests: dict[str, list[str]] = {}
    words: dict[str, tuple[str, str]] = {}
    for place, mark in marks():
        name = ast.literal_eval(mark.args[0])
        tests.setdefault(name, []).append(f"`{place}`")
        for keyword in mark.keywords:
            if keyword.arg not in KINDS or name in words:
                raise ValueError(f"{place}: {keyword.arg} of {name!r} is no kind of promise, or its second words")
            words[name] = keyword.arg, ast.literal_eval(keyword.value)
    if missing := tests.keys() - words:
        raise ValueError(f"no test has the words of {', '.join(sorted(missing))}")
    lines = [OPENING]
    for kind, heading in KINDS.items():
        lines += [f"## {heading}", "", "| what | how far | held by |", "|---|---|---|"]
        for name, held_by in tests.items():
            of_kind, how_far = words[name]
            if of_kind == kind:
                cells = (name.replace("|", r"\|"), how_far.replace("|", r"\|"), ", ".join(held_by))
                lines.append(f"| {' | '.join(cells)} |")
        lines.append("")
    return "\n".join(lines)


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
