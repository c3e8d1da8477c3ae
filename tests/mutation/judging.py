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

from tests.mutation.executed_lines import Recorder
from tests.mutation.mutants import ROOT

COPIED_FOLDERS = ("bezstab", "tests", "configs", "figures")
COPIED_FILES = ("pyproject.toml", "README.md", "Makefile")
LEAST_PATIENCE = 20.0  # s of processor time for one test: most take less than one
PATIENCE = 10.0  # times what a test takes without a mutant; what exceeds both does not end
SLOWEST = 60.0  # s of processor time for one test without a mutant, recorded: none takes longer
MEMORY = 8 * 2**30  # bytes of address space: a mutant that asks for more is stopped, not the machine
HYPOTHESIS_SEED = 0  # so that a verdict does not depend on the day


@dataclass(eq=False)  # pytest keeps its plugins in sets
class Watch:
    """A pytest plugin: the tests asked for, each on a limited time, all on a limited time, the first failure noted.

    `seconds`: processor time of each test without a mutant. `budget`: processor time in s for all tests. `asked_for`:
    names of tests in their order; all that there are if that is empty. `recorder`: writes which lines each executes.
    `took`: what each test has taken here.
    """

    seconds: dict[str, float]
    budget: float
    asked_for: list[str] = field(default_factory=list)
    recorder: Recorder | None = None
    failed: str | None = None
    took: dict[str, float] = field(default_factory=dict)

    @pytest.hookimpl(trylast=True)  # after the slow tests have been taken out
    def pytest_collection_modifyitems(self, items: list[pytest.Item]) -> None:
        """Keep the tests asked for, in their order, and tests not known yet: a mutant may have changed their names."""
        if self.asked_for:
            order = {test: number for number, test in enumerate(self.asked_for)}
            known = self.seconds or {item.nodeid for item in items}
            items[:] = [item for item in items if item.nodeid in order or item.nodeid not in known]
            items.sort(key=lambda item: order.get(item.nodeid, -1))

    @pytest.hookimpl(hookwrapper=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Iterator[None]:
        """Run one test against its clock."""

        def too_long(_signal: int, _frame: FrameType | None) -> None:
            raise _DoesNotEnd(item.nodeid)

        if self.recorder is not None:
            self.recorder.enter(item.nodeid)
        patience = max(LEAST_PATIENCE, PATIENCE * self.seconds.get(item.nodeid, 0.0))
        signal.signal(signal.SIGPROF, too_long)
        signal.setitimer(signal.ITIMER_PROF, patience if self.seconds else 0.0)
        before = time.process_time()
        yield
        signal.setitimer(signal.ITIMER_PROF, 0)
        self.took[item.nodeid] = time.process_time() - before
        if self.out_of_time():
            item.session.shouldstop = "out of time"

    def out_of_time(self) -> bool:
        """Return whether the budget is used up."""
        return time.process_time() > self.budget

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


def asked_in_a_child(
    tree: Tree, rings: Sequence[Sequence[str]], watch: Watch, answer: Path, record: Path | None = None
) -> int:
    """Fork a process that runs the tests in the tree, ring by ring, until one fails; return the process's number.

    What came out is written to `answer`: the test that failed, how many were not asked, what each took. A ring of
    folders or files stands for all quick tests in them. Where the lines executed are to be recorded: `record`.
    """
    number = os.fork()
    if number:
        return number
    status = 1
    try:
        os.setsid()  # so that it can be ended together with the processes that its tests start
        resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
        if watch.budget < float("inf"):  # what no Python code can end, since no Python code runs, ends by SIGXCPU
            seconds = int(watch.budget + PATIENCE * SLOWEST)
            resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds + 1))
        _enter(tree, answer)
        if record is not None:
            watch.recorder = Recorder(tree.folder, record)
        _ask_ring_by_ring(rings, watch)
        if watch.recorder is not None:
            watch.recorder.close()
        left = sum(test not in watch.took for ring in rings for test in ring if "::" in test)
        found = {"failed": watch.failed, "left": left, "took": watch.took}
        answer.write_text(json.dumps(found), encoding="utf-8")
        status = 0
    except BaseException as error:
        answer.write_text(json.dumps({"broken": repr(error)}), encoding="utf-8")
        raise
    finally:
        os._exit(status)


def _ask_ring_by_ring(rings: Sequence[Sequence[str]], watch: Watch) -> None:
    for ring in rings:
        if watch.failed or watch.out_of_time():
            return
        if ring:
            watch.asked_for = [test for test in ring if "::" in test]
            _ask(list(dict.fromkeys(test.split("::")[0] for test in ring)), watch)


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
        # no tests: a mutant took their names
        fine = (pytest.ExitCode.OK, pytest.ExitCode.INTERRUPTED, pytest.ExitCode.NO_TESTS_COLLECTED)
        if status not in fine and watch.failed is None:
            raise RuntimeError(f"pytest ended with status {int(status)}")
