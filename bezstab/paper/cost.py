"""Table 6: what 10 s of simulation cost."""

import time
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bezstab.mechanism import compiled_mechanism, load_scene, simulate
from bezstab.methods import lookup
from bezstab.paper.experiments import DURATION, STEP
from bezstab.paper.findings import Finding, finding
from bezstab.paper.printed import COMPARED
from bezstab.paper.reports import Progress, Report, captioned_table
from bezstab.show import Row, column, render
from bezstab.units import feedback_gains

REPEATS = 5  # as many as the paper averages; here the fastest counts, which other programs disturb least
ALPHA_HAT = BETA_HAT = 0.1  # case 1 of Table 5; the cost does not depend on the point

COSTS = [column("method", "method"), column("evaluations of f in 10 s", "evaluations", "d")]
TIMED_COSTS = [*COSTS, column("processor time / B4's", "time_ratio", ".2f")]


@dataclass(frozen=True)
class Cost:
    """Evaluations of f for 10 s of simulation (exact), and processor time relative to B4's (measured)."""

    method: str
    evaluations: int
    time_ratio: float


def report(_progress: Progress) -> Report:
    """Return Table 6 and what it claims; the measured times aside."""
    measured = costs()
    rows: list[Row] = [
        {"method": cost.method, "evaluations": cost.evaluations, "time_ratio": cost.time_ratio} for cost in measured
    ]
    caption = "Table 6: what 10 s of simulation cost (h = 1 ms, RK4 at 5 ms)."
    return Report(
        tables={"table6": captioned_table(caption, rows, COSTS)},
        findings=findings(measured),
        aside=render(rows, TIMED_COSTS, "text"),
    )


def costs() -> list[Cost]:
    """Return the cost of Table 6's runs; all in one process, interleaved, the fastest of several."""
    mechanism = compiled_mechanism(load_scene("slider_crank"))
    gains = feedback_gains(ALPHA_HAT, BETA_HAT, STEP)
    fastest = dict.fromkeys(COMPARED, np.inf)
    evaluations = dict.fromkeys(COMPARED, 0)
    for _ in range(REPEATS):
        for name in COMPARED:
            begin = time.process_time()
            evaluations[name] = simulate(mechanism, lookup(name), STEP, DURATION, gains).evaluations
            fastest[name] = min(fastest[name], time.process_time() - begin)
    return [Cost(name, evaluations[name], time_ratio=fastest[name] / fastest["B4"]) for name in COMPARED]


def findings(measured: Sequence[Cost]) -> list[Finding]:
    """Return what Table 6 claims of the cost; from the exact counts, so that it is the same on every machine."""
    counts = ", ".join(f"{cost.method} {cost.evaluations}" for cost in measured)
    least, most = min(cost.evaluations for cost in measured), max(cost.evaluations for cost in measured)
    spread = most / least - 1
    return [
        finding(
            where="Table 6",
            claim="the four methods cost the same (RK4 at 5 ms, the others at 1 ms)",
            paper="within 4 %",
            here=f"evaluations of f: {counts}; the largest is {spread:.0%} above the smallest",
            holds=[spread < 0.04],
        )
    ]
