"""One mutant against the quick tests, in a process of its own that ends at the first test to fail.

The process is forked from one that has imported what takes long (numpy, sympy, pytest) but nothing of the package. It
runs in a copy of the tree, so that the tree itself is never touched.
"""

import json
import os
import resource
import shutil
import signal
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from types import FrameType

import pytest

from tests.mutation.mutants import ROOT

COPIED_FOLDERS = ("bezstab", "tests", "configs", "figures")
COPIED_FILES = ("pyproject.toml", "README.md", "Makefile")
LEAST_PATIENCE = 20.0  # s of processor time for one test: most take less than one
PATIENCE = 10.0  # times what a test takes without a mutant; what exceeds both does not end
MEMORY = 8 * 2**30  # bytes of address space: a mutant that asks for more is stopped, not the machine
HYPOTHESIS_SEED = 0  # so that a verdict does not depend on the day


@dataclass
class Watch:
    """A pytest plugin: quickest tests first, each on a limited time, all on a limited time, the first failure noted.

    `seconds`: processor time of each test without a mutant. `own`: the mutated module's test file, asked first.
    `budget`: processor time in s for all tests. `took`: what each test has taken here.
    """

    seconds: dict[str, float]
    own: str
    budget: float
    failed: str | None = None
    left: int = 0
    took: dict[str, float] = field(default_factory=dict)

    @pytest.hookimpl(trylast=True)  # after what is not asked for has been taken out: the slow tests
    def pytest_collection_modifyitems(self, items: list[pytest.Item]) -> None:
        """Put the tests in order: those of the own file first, and of either group new ones, then the quickest."""
        items.sort(key=lambda item: (not item.nodeid.startswith(self.own), self.seconds.get(item.nodeid, 0.0)))
        self.left = len(items)

    @pytest.hookimpl(hookwrapper=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Iterator[None]:
        """Run one test against its clock."""

        def too_long(_signal: int, _frame: FrameType | None) -> None:
            raise _DoesNotEnd(item.nodeid)

        patience = max(LEAST_PATIENCE, PATIENCE * self.seconds.get(item.nodeid, 0.0))
        signal.signal(signal.SIGPROF, too_long)
        signal.setitimer(signal.ITIMER_PROF, patience)
        before = time.process_time()
        yield
        signal.setitimer(signal.ITIMER_PROF, 0)
        self.took[item.nodeid] = time.process_time() - before
        self.left -= 1
        if time.process_time() > self.budget:
            item.session.shouldstop = "out of time"

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Note the first test that fails."""
        if report.failed and self.failed is None:
            self.failed = report.nodeid

    def pytest_collectreport(self, report: pytest.CollectReport) -> None:
        """A test file that cannot be imported has failed too."""
        if report.failed and self.failed is None:
            self.failed = report.nodeid


class _DoesNotEnd(BaseException):
    """A test takes many times as long as it should; no test catches this."""


@dataclass(frozen=True)
class Tree:
    """A copy of the tree in which one mutant at a time stands."""

    folder: Path

    @staticmethod
    def copied_to(folder: Path) -> "Tree":
        """Return a fresh copy of the tree."""
        shutil.rmtree(folder, ignore_errors=True)
        for name in COPIED_FOLDERS:
            shutil.copytree(ROOT / name, folder / name, ignore=shutil.ignore_patterns("__pycache__"))
        for name in COPIED_FILES:
            shutil.copy(ROOT / name, folder / name)
        return Tree(folder)

    @contextmanager
    def mutated(self, path: Path | None, source: str) -> Iterator[None]:
        """Have `source` stand in the file at `path` for a while; nothing is changed if that is None."""
        if path is None:
            yield
            return
        (self.folder / path).write_text(source, encoding="utf-8")
        try:
            yield
        finally:
            shutil.copy2(ROOT / path, self.folder / path)


def asked_in_a_child(tree: Tree, tests: Sequence[str], watch: Watch, answer: Path) -> int:
    """Fork a process that runs the tests in the tree and writes what came out to `answer`; return its number."""
    number = os.fork()
    if number:
        return number
    status = 1
    try:
        os.setsid()  # so that it can be ended together with the processes that its tests start
        resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
        _enter(tree, answer)
        _ask(tests, watch)
        found = {"failed": watch.failed, "left": watch.left, "took": watch.took}
        answer.write_text(json.dumps(found), encoding="utf-8")
        status = 0
    except BaseException as error:
        answer.write_text(json.dumps({"broken": repr(error)}), encoding="utf-8")
        raise
    finally:
        os._exit(status)


def _enter(tree: Tree, answer: Path) -> None:
    """Make this process one that knows nothing of any other tree, nor of the campaign that started it."""
    signal.signal(signal.SIGINT, signal.default_int_handler)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    os.chdir(tree.folder)
    os.environ.update(PYTHONPATH=str(tree.folder), PYTHONDONTWRITEBYTECODE="1", TMPDIR=str(answer.parent))
    sys.dont_write_bytecode = True  # a mutant must not be found compiled by the next one
    sys.path.insert(0, str(tree.folder))
    for name in list(sys.modules):
        if name.split(".")[0] in ("tests", "bezstab"):
            del sys.modules[name]
    log = os.open(answer.with_suffix(".log"), os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
    os.dup2(log, 1)
    os.dup2(log, 2)


def _ask(tests: Sequence[str], watch: Watch) -> None:
    """Run the tests; RuntimeError if pytest itself fails, which says nothing of the mutant."""
    plain = ["-x", "-q", "-m", "not slow", "-p", "no:cacheprovider", "-p", "no:xdist", "--tb=line"]
    # hypothesis is imported before pytest could rewrite its assertions, of which none is asked
    plain += ["-W", "ignore::pytest.PytestAssertRewriteWarning"]
    try:
        status = pytest.main([*plain, f"--hypothesis-seed={HYPOTHESIS_SEED}", *tests], plugins=[watch])
    except _DoesNotEnd as test:
        watch.failed = f"{test} (does not end)"
    else:
        if status != pytest.ExitCode.OK and watch.failed is None and status != pytest.ExitCode.INTERRUPTED:
            raise RuntimeError(f"pytest ended with status {int(status)}")
