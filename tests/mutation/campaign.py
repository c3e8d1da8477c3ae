"""Do the quick tests notice when the code is wrong? `make mutants` changes one thing at a time and looks.

Once, every quick test is run on the code as it is, and recorded which lines it executes. A mutant is caught if a test
that can notice it fails on it or does not end: those that execute its line are asked, of the module's own test file
first, then the quickest, up to the first failure (executed_lines.py says which others are asked). What survives is
listed in harmless.toml with the reason why nothing that is promised changes, or it calls for a test. A mutant is out of
time if the tests asked within its budget of processor time found nothing and some were not asked, or if a test waited
for ever: that counts as survived.

    python -m tests.mutation.campaign --count 200 --seed 1 --workers 2 --results /tmp/mutants

What is found is appended to results.jsonl in the results' folder; an interrupted campaign goes on from there. Delete
the folder after a change of the code or the tests. `--again` judges those anew that survived.
"""

import argparse
import importlib
import json
import os
import signal
import sys
import tempfile
import time
import tomllib
from collections import Counter
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, TypedDict

from tests.mutation.executed_lines import RECORDED, ExecutedLines, read_lines, rings
from tests.mutation.judging import Tree, Watch, asked_in_a_child
from tests.mutation.mutants import Mutant, all_mutants, sampled

HARMLESS = Path(__file__).parent / "harmless.toml"
PROMISED = 0.95  # the share of mutants that must be caught
TAKES_LONG = (
    *("numpy", "numpy.testing", "numpy.random", "sympy", "mpmath", "hypothesis", "hypothesis.strategies", "click"),
    *("matplotlib.figure", "mujoco", "numba", "jsonschema"),
)
"""Imported once for all mutants, where it is installed."""

LAST_RESORT = 3600.0  # s by the clock for one mutant: it waits for something, or gets no processor; tells nothing
POLL = 0.05  # s between two looks at the running processes
PROBES = [
    "tests/methods/test_schemes.py",
    "tests/stability/test_pencils.py",
    "tests/mechanism/test_start.py",
    "tests/evidence/test_pareto.py",
]
"""Quick test files, one of each room, that pass before any mutant is judged."""

Outcome = Literal["caught", "survived", "out of time"]


class Result(TypedDict):
    """One line of results.jsonl."""

    key: str
    kind: str
    outcome: Outcome
    by: str
    left: int
    seconds: float


@dataclass(frozen=True)
class Running:
    """A process that judges a mutant, in the tree of one worker."""

    mutant: Mutant
    worker: int
    answer: Path
    started: float
    ends: ExitStack


def recorded(results: Path, tree: Tree) -> tuple[dict[str, float], ExecutedLines]:
    """Return the processor time in s of each quick test, and the lines that each executes.

    RuntimeError if one fails on the code as it is: a judge that calls everything caught would be worse than none.
    What was recorded before is taken from the results' folder, but a few tests of each room are asked again.
    """
    seconds: dict[str, float] = {}
    files = []
    for folder in RECORDED:
        name = folder.replace("/", "-")
        file, lines = results / f"{name}.seconds.json", results / f"{name}.lines"
        if not file.exists():
            print(f"which lines {folder} executes", flush=True)
            file.write_text(json.dumps(_unchanged(results, tree, [folder], lines)), encoding="utf-8")
        seconds |= json.loads(file.read_text(encoding="utf-8"))
        files.append(lines)
    _unchanged(results, tree, PROBES)
    return seconds, ExecutedLines(read_lines(files, tree.folder))


def _unchanged(results: Path, tree: Tree, tests: list[str], record: Path | None = None) -> dict[str, float]:
    """Run tests on the code as it is; return the processor time of each. RuntimeError if one fails."""
    if not tests:
        return {}
    answer = results / "unchanged.json"
    answer.unlink(missing_ok=True)
    number = asked_in_a_child(tree, [tests], Watch(seconds={}, budget=float("inf")), answer, record)
    os.waitpid(number, 0)
    found = _read_answer(answer)
    if found["failed"] or not found["took"]:
        raise RuntimeError(f"without any mutant: failed {found['failed']}, {len(found['took'])} tests asked")
    took: dict[str, float] = found["took"]
    return took


def _read_answer(answer: Path) -> dict[str, Any]:
    """Return what a judging process wrote; RuntimeError if the judging itself failed."""
    found: dict[str, Any] = json.loads(answer.read_text(encoding="utf-8"))
    if "broken" in found:
        raise RuntimeError(f"the judge is broken: {found['broken']}; see {answer.with_suffix('.log')}")
    return found


def judged(mutants: list[Mutant], results: Path, workers: int, budget: float) -> None:
    """Judge the mutants, so many at a time, and append each result to results.jsonl as it comes."""
    trees = [Tree.copied_to(results / f"tree{worker}") for worker in range(workers)]
    seconds, executed = recorded(results, trees[0])
    waiting, running, idle = list(reversed(mutants)), dict[int, Running](), list(range(workers))
    with (results / "results.jsonl").open("a", encoding="utf-8") as lines, _ended_at_last(running):
        while waiting or running:
            while waiting and idle:
                mutant, worker = waiting.pop(), idle.pop()
                own = f"tests/{mutant.path.parts[1]}/test_{mutant.path.stem}.py"
                asked = rings(mutant, own, executed, seconds)
                answer = results / f"worker{worker}" / "answer.json"
                answer.parent.mkdir(exist_ok=True)
                answer.unlink(missing_ok=True)
                ends = ExitStack()
                ends.enter_context(trees[worker].mutated(mutant.path, mutant.source))
                number = asked_in_a_child(trees[worker], asked, Watch(seconds, budget), answer)
                running[number] = Running(mutant, worker, answer, time.monotonic(), ends)
            time.sleep(POLL)
            for number, run in list(running.items()):
                took = time.monotonic() - run.started
                ended, status = os.waitpid(number, os.WNOHANG)
                if not ended and took < LAST_RESORT:
                    continue
                _end_with_all_it_started(number, reaped=bool(ended))
                result = _result(run, took, died_of=os.WTERMSIG(status) if ended else signal.SIGKILL)
                lines.write(json.dumps(result) + "\n")
                lines.flush()
                print(f"{result['outcome']:12}{took:6.0f} s  {result['key']}  [{result['by']}]", flush=True)
                run.ends.close()
                del running[number]
                idle.append(run.worker)
    # without a mutant they passed among all others: do they when asked by themselves?
    _unchanged(results, trees[0], sorted({result["by"] for result in read_results(results).values()} & seconds.keys()))


@contextmanager
def _ended_at_last(running: dict[int, Running]) -> Iterator[None]:
    """Leave no judging process behind when the campaign is interrupted."""
    try:
        yield
    finally:
        for number in running:
            _end_with_all_it_started(number, reaped=False)


def _end_with_all_it_started(number: int, *, reaped: bool) -> None:
    """End a judging process, and those that its tests have left behind: they share its group."""
    with suppress(ProcessLookupError):
        os.killpg(number, signal.SIGKILL)
    if not reaped:
        os.waitpid(number, 0)


def _result(run: Running, took: float, died_of: int) -> Result:
    """Return what came of a mutant; a process that was killed, by us or for want of memory, tells nothing."""
    mutant, left = run.mutant, 0
    outcome, by = ("out of time", "") if died_of == signal.SIGKILL else ("caught", f"the process died of {died_of}")
    if run.answer.exists():
        found = _read_answer(run.answer)
        left = found["left"]
        by = found["failed"] or ""
        outcome = "caught" if by else "out of time" if left else "survived"
    return Result(
        key=mutant.key,
        kind=mutant.kind,
        outcome=outcome,  # type: ignore[typeddict-item]
        by=by,
        left=left,
        seconds=round(took, 1),
    )


def read_results(results: Path) -> dict[str, Result]:
    """Return the last result of each mutant, by its key."""
    file = results / "results.jsonl"
    if not file.exists():
        return {}
    lines = [json.loads(line) for line in file.read_text(encoding="utf-8").splitlines()]
    return {line["key"]: line for line in lines}


def harmless_reasons() -> dict[str, str]:
    """Return why nothing changes, for each mutant listed in harmless.toml, by its key."""
    entries = tomllib.loads(HARMLESS.read_text(encoding="utf-8")).get("harmless", [])
    return {entry["mutant"]: entry["because"] for entry in entries}


def main() -> int:
    """Judge a sample of mutants and print the share that is caught; exit status 1 below what is promised."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--budget", type=float, default=300.0, help="Processor time for one mutant, in s.")
    parser.add_argument("--results", type=Path, default=Path(tempfile.gettempdir()) / "bezstab-mutants")
    parser.add_argument("--again", action="store_true", help="Judge survivors anew, after a change of the tests.")
    parser.add_argument("--match", default="", help="Judge only mutants with this text in their key.")
    options = parser.parse_args()
    signal.signal(signal.SIGTERM, signal.default_int_handler)  # ends like Ctrl-C, with what was started
    results = options.results.resolve()
    results.mkdir(parents=True, exist_ok=True)
    os.environ.update(OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1", MPLBACKEND="Agg")
    for module in TAKES_LONG:
        with suppress(ImportError):
            importlib.import_module(module)

    harmless = harmless_reasons()
    mutants = all_mutants()
    for key in sorted(set(harmless) - {mutant.key for mutant in mutants}):
        print(f"{HARMLESS.name}: no such mutant any more: {key}")
    chosen = sampled(mutants, options.count, options.seed)
    known = read_results(results)
    telling = [mutant for mutant in chosen if mutant.key not in harmless]
    to_judge = [
        mutant
        for mutant in telling
        if options.match in mutant.key
        and (mutant.key not in known or (options.again and known[mutant.key]["outcome"] != "caught"))
    ]
    judged(to_judge, results, options.workers, options.budget)

    known = read_results(results)
    outcomes = Counter(known[mutant.key]["outcome"] if mutant.key in known else "not judged" for mutant in telling)
    share = outcomes["caught"] / max(1, len(telling))
    for mutant in telling:
        if mutant.key in known and known[mutant.key]["outcome"] != "caught":
            print(f"{known[mutant.key]['outcome']}: {mutant.path}:{mutant.line}: {mutant.key}")
    counted = ", ".join(f"{number} {outcome}" for outcome, number in sorted(outcomes.items()))
    print(f"{len(chosen)} mutants, seed {options.seed}: {len(chosen) - len(telling)} harmless; of the others {counted}")
    print(f"{share:.1%} of {len(telling)} caught; {PROMISED:.0%} is promised")
    return 0 if share >= PROMISED else 1


if __name__ == "__main__":
    try:
        sys.exit(main())
    except KeyboardInterrupt:
        sys.exit("interrupted: what was judged is kept, and the same command goes on from there")
