"""Which quick tests execute which lines of the package: only those can notice a change there.

Recorded once for a campaign, folder of tests by folder of tests, by the `coverage` package, whose contexts are here the
names of tests. What Python executes once in a process is recorded with the one test that happened to come first, and
machine code not at all; so the tests to be asked are sought in widening rings:

    1  tests that execute the changed statement; of a constant, those that execute a line with its name
    2  tests that execute the function it stands in, or a line anywhere that names this function, and the own test file
    3  tests that execute any function of the module: asked only if the first ring is empty
"""

import ast
import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from tests.mutation.mutants import ROOT, Mutant

RECORDED = (
    "tests/methods",
    "tests/stability",
    "tests/mechanism",
    "tests/evidence",
    "tests/engines",
    "tests/show",
    "tests/cli",
    "tests/paper",
    "tests/test_api.py",
    "tests/test_readme.py",
)
"""Folders and files of tests, each recorded in a process of its own."""
LinesOfFile = Callable[[Path], Mapping[int, frozenset[str]]]

FIRST = 20  # tests of the first ring that are asked before the files of the rest of it are even imported


class Recorder:
    """Records the lines of the package that are executed from now on, each with the test that is running."""

    def __init__(self, tree: Path, file: Path) -> None:
        import coverage

        file.unlink(missing_ok=True)
        self._coverage = coverage.Coverage(
            data_file=str(file), include=[f"{tree}/bezstab/*"], config_file=False, messages=False
        )
        self._coverage.start()

    def enter(self, test: str) -> None:
        """Say which test runs next."""
        self._coverage.switch_context(test)

    def close(self) -> None:
        """Write what was recorded."""
        self._coverage.stop()
        self._coverage.save()


def read_lines(files: Iterable[Path], tree: Path) -> LinesOfFile:
    """Return a function from a file of the package to its executed lines: for each the tests that execute it.

    `files`: what recorders have written, of the package in `tree`. What is executed by imports is left out.
    """
    from coverage import CoverageData

    recorded = [CoverageData(basename=str(file)) for file in files]
    for data in recorded:
        data.read()

    @cache
    def lines_of_file(path: Path) -> dict[int, frozenset[str]]:
        lines: dict[int, set[str]] = {}
        for data in recorded:
            for line, tests in data.contexts_by_lineno(str(tree / path)).items():
                lines.setdefault(line, set()).update(test for test in tests if test)
        return {line: frozenset(tests) for line, tests in lines.items()}

    return lines_of_file


@dataclass(frozen=True)
class ExecutedLines:
    """Which tests execute which lines of the package's files."""

    of_file: LinesOfFile

    def tests_of(self, path: Path, lines: Iterable[int]) -> set[str]:
        """Return the tests that execute any of these lines."""
        executed = self.of_file(path)
        return {test for line in lines for test in executed.get(line, ())}

    def naming(self, name: str) -> set[str]:
        """Return the tests that execute, inside a function, a line with this name anywhere in the package."""
        found: set[str] = set()
        for path in _files():
            inside = _lines_of_functions(path)
            lines = [number for number in inside if re.search(rf"\b{re.escape(name)}\b", _text(path)[number - 1])]
            found |= self.tests_of(path, lines)
        return found


def rings(mutant: Mutant, own: str, executed: ExecutedLines, seconds: dict[str, float]) -> list[list[str]]:
    """Return the tests to be asked, ring by ring: `own` file first, then the quickest of `seconds`."""
    place = _place(mutant.path, mutant.line)
    first = executed.tests_of(mutant.path, place.statement) if place.function else set()
    if place.named:
        first |= executed.naming(place.named)
    of_own_file = {test for test in seconds if test.startswith(f"{own}::")}
    second = of_own_file | executed.tests_of(mutant.path, place.body)
    if place.function:
        second |= executed.naming(place.function)
    third = set() if first else executed.tests_of(mutant.path, _lines_of_functions(mutant.path))

    def in_order(tests: set[str]) -> list[str]:
        return sorted(tests, key=lambda test: (test not in of_own_file, seconds.get(test, 0.0), test))

    others = in_order(first - of_own_file)
    return [
        in_order(first & of_own_file),
        others[:FIRST],
        others[FIRST:],
        in_order(second - first),
        in_order(third - second),
    ]


class _Place:
    """Where a line stands: the lines of its statement, the name it defines, its function's name and body."""

    def __init__(self, tree: ast.Module, line: int) -> None:
        self.statement: range = range(line, line + 1)
        self.named: str | None = None
        self.function: str | None = None
        self.body: range = range(0)
        for node in ast.walk(tree):  # from the outside in
            if not isinstance(node, ast.stmt) or not node.lineno <= line <= (node.end_lineno or node.lineno):
                continue
            inner = getattr(node, "body", None)
            in_header = inner is not None and line < inner[0].lineno
            self.statement = range(node.lineno, inner[0].lineno if inner else (node.end_lineno or node.lineno) + 1)
            if isinstance(node, ast.FunctionDef):
                self.function = node.name
                self.body = range(node.body[0].lineno, (node.end_lineno or node.lineno) + 1)
                if in_header:  # a default value: it matters where the function runs
                    self.statement = self.body
            elif self.function is None and isinstance(node, ast.Assign | ast.AnnAssign):
                target = node.targets[0] if isinstance(node, ast.Assign) else node.target
                self.named = target.id if isinstance(target, ast.Name) else None


@cache
def _parsed(path: Path) -> ast.Module:
    return ast.parse((ROOT / path).read_text(encoding="utf-8"))


@cache
def _place(path: Path, line: int) -> _Place:
    return _Place(_parsed(path), line)


@cache
def _text(path: Path) -> list[str]:
    return (ROOT / path).read_text(encoding="utf-8").splitlines()


@cache
def _files() -> list[Path]:
    return [path.relative_to(ROOT) for path in sorted((ROOT / "bezstab").rglob("*.py"))]


@cache
def _lines_of_functions(path: Path) -> frozenset[int]:
    """Return the numbers of the lines inside functions: what is executed when a module is called, not imported."""
    inside: set[int] = set()
    for node in ast.walk(_parsed(path)):
        if isinstance(node, ast.FunctionDef):
            inside.update(range(node.body[0].lineno, (node.end_lineno or node.lineno) + 1))
    return frozenset(inside)
