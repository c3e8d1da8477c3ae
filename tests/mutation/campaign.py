"""Do the quick tests notice when the code is wrong? `make mutants` changes one thing at a time and looks.

    the tree, copied ── pytest-testmon records which test executes which function (once)
          │
    one mutant written ── pytest-testmon runs the tests that execute what was changed ── caught │ survived │ out of time

What survives is printed with its line. It calls for a test, unless nothing that is promised changes: that is for the
reader to judge. Results are appended to a file in the folder of results, and the same command goes on from there;
delete the folder after a change of the code or the tests.

    python -m tests.mutation.campaign --count 200 --seed 1 --results mutants
"""

import argparse
import json
import os
import shutil
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Iterable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from queue import SimpleQueue
from typing import Literal

from tests.mutation.mutants import ROOT, Mutant, all_mutants, sampled

TREE = ("bezstab", "configs", "tests", "figures", "pyproject.toml", "README.md", "Makefile")
"""What the tests read: the parts of the project that are copied."""

NOTHING_FAILED = {0: "every test passed", 5: "no test executes it"}  # pytest's exit status, and what it means

Outcome = Literal["caught", "survived", "out of time"]


def copied_tree(folder: Path) -> Path:
    """Copy what the tests read into a new folder, and return it."""
    shutil.rmtree(folder, ignore_errors=True)
    for part in TREE:
        if (ROOT / part).is_dir():
            shutil.copytree(ROOT / part, folder / part, ignore=shutil.ignore_patterns("__pycache__"))
        else:
            shutil.copy(ROOT / part, folder / part)
    return folder


def quick_tests(tree: Path, *options: str, seconds: float | None = None) -> int:
    """Run the quick tests that pytest-testmon selects in a tree; return pytest's exit status.

    Random tests have a fixed seed, so that the same mutant is caught again. subprocess.TimeoutExpired if the tests
    take longer than so many seconds.
    """
    selected = ["-m", "not slow", "--testmon", "--testmon-forceselect", "--hypothesis-seed", "1"]
    command = [sys.executable, "-m", "pytest", "-q", *selected, *options]
    environment = os.environ | {"OPENBLAS_NUM_THREADS": "1", "PYTHONPATH": str(tree)}
    return subprocess.run(
        command, cwd=tree, env=environment, timeout=seconds, stdout=subprocess.DEVNULL, check=False
    ).returncode


def recorded_tree(folder: Path) -> Path:
    """Return a copy of the tree in which is recorded which test executes which function.

    RuntimeError if a test fails on the code as it is: then it would be said to catch every mutant.
    """
    if not (folder / ".testmondata").exists():
        status = quick_tests(copied_tree(folder))
        if status != 0:
            (folder / ".testmondata").unlink(missing_ok=True)
            raise RuntimeError(f"without any mutant the quick tests end with exit status {status}")
    return folder


def outcome(mutant: Mutant, tree: Path, seconds: float) -> Outcome:
    """Return what the quick tests say of a mutant, written into a recorded tree for as long as they run."""
    changed = tree / mutant.path
    original = changed.read_text(encoding="utf-8")
    changed.write_text(mutant.source, encoding="utf-8")
    try:
        status = quick_tests(tree, "--testmon-nocollect", "--exitfirst", seconds=seconds)
    except subprocess.TimeoutExpired:
        return "out of time"
    finally:
        changed.write_text(original, encoding="utf-8")
    return "survived" if status in NOTHING_FAILED else "caught"


def judged(mutants: Iterable[Mutant], results: Path, workers: int, seconds: float) -> None:
    """Judge the mutants, so many at a time, each in a tree of its own; append each result as it comes."""
    first = recorded_tree(results / "tree0")
    trees: SimpleQueue[Path] = SimpleQueue()
    trees.put(first)
    for worker in range(1, workers):
        trees.put(shutil.copytree(first, results / f"tree{worker}", dirs_exist_ok=True))

    def judge(mutant: Mutant) -> None:
        tree = trees.get()
        try:
            found = outcome(mutant, tree, seconds)
        finally:
            trees.put(tree)
        with (results / "results.jsonl").open("a", encoding="utf-8") as lines:
            lines.write(json.dumps({"key": mutant.key, "outcome": found}) + "\n")
        print(f"{found:12}{mutant.path}:{mutant.line}: {mutant.key}", flush=True)

    with ThreadPoolExecutor(workers) as pool:
        for _ in pool.map(judge, mutants):  # raises what a judge raised
            pass


def read_outcomes(results: Path) -> dict[str, Outcome]:
    """Return the outcome of each mutant judged so far, by its key."""
    file = results / "results.jsonl"
    lines = file.read_text(encoding="utf-8").splitlines() if file.exists() else []
    return {line["key"]: line["outcome"] for line in map(json.loads, lines)}


def main() -> None:
    """Judge a sample of mutants; print the share that is caught, and each that is not."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--seconds", type=float, default=600.0, help="For the tests of one mutant, by the clock.")
    parser.add_argument("--results", type=Path, default=Path(tempfile.gettempdir()) / "bezstab-mutants")
    options = parser.parse_args()
    results = options.results.resolve()
    results.mkdir(parents=True, exist_ok=True)

    chosen = sampled(all_mutants(), options.count, options.seed)
    known = read_outcomes(results)
    judged([mutant for mutant in chosen if mutant.key not in known], results, options.workers, options.seconds)

    known = read_outcomes(results)
    print()
    for mutant in chosen:
        if known[mutant.key] != "caught":
            print(f"{known[mutant.key]}: {mutant.path}:{mutant.line}: {mutant.key}")
    counts = Counter(known[mutant.key] for mutant in chosen)
    print(f"{len(chosen)} mutants, seed {options.seed}: {', '.join(f'{n} {what}' for what, n in counts.most_common())}")


if __name__ == "__main__":
    main()
