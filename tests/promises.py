"""The page of promises (promises.md), made from the marks of the tests that hold them.

    @pytest.mark.promise("Overflow", computed="is reported, never returned")

marks the test that holds a promise, with its kind and its words. A further test of it gives its name alone.

    python -m tests.promises
"""

import ast
from dataclasses import dataclass, field
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


@dataclass
class Promise:
    """A promise: its name, its kind and words (empty until the test that has them is read), the tests that hold it."""

    name: str
    kind: str = ""
    words: str = ""
    tests: list[str] = field(default_factory=list)


def marks(file: Path) -> list[tuple[str, ast.Call]]:
    """Return the name of each marked test of a file, with its mark as a syntax tree."""
    found = []
    text = file.read_text(encoding="utf-8")
    if "mark.promise(" not in text:
        return []  # a second saved
    tests = [node for node in ast.parse(text).body if isinstance(node, ast.FunctionDef)]
    for test in tests:
        for mark in test.decorator_list:
            if isinstance(mark, ast.Call) and ast.unparse(mark.func) == "pytest.mark.promise":
                found.append((test.name, mark))
    return found


def promises() -> list[Promise]:
    """Return the promises of all tests, in the order of their files.

    ValueError if a mark is none of ours, if a promise has no words, or has them twice.
    """
    found: dict[str, Promise] = {}
    for file in sorted(FOLDER.rglob("test_*.py")):
        for test, mark in marks(file):
            place = f"{file.relative_to(FOLDER.parent).as_posix()}::{test}"
            name = ast.literal_eval(mark.args[0])
            promise = found.setdefault(name, Promise(name))
            promise.tests.append(place)
            for keyword in mark.keywords:
                if keyword.arg not in KINDS or promise.kind:
                    raise ValueError(f"{place}: {keyword.arg} of {name!r} is no kind of promise, or its second words")
                promise.kind, promise.words = keyword.arg, ast.literal_eval(keyword.value)
    for promise in found.values():
        if not promise.kind:
            raise ValueError(f"{promise.tests[0]}: {promise.name!r} has no words in any test")
    return list(found.values())


def page() -> str:
    """Return the text of the page."""
    lines = [OPENING]
    everything = promises()
    for kind, heading in KINDS.items():
        lines += [f"## {heading}", "", "| what | how far | held by |", "|---|---|---|"]
        for promise in everything:
            if promise.kind == kind:
                tests = ", ".join(f"`{test}`" for test in promise.tests)
                what, how_far = (text.replace("|", r"\|") for text in (promise.name, promise.words))
                lines.append(f"| {what} | {how_far} | {tests} |")
        lines.append("")
    return "\n".join(lines)


def main() -> None:
    """Write the page anew."""
    PAGE.write_text(page(), encoding="utf-8")


if __name__ == "__main__":
    main()
