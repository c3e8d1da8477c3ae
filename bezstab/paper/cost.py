"""Table 6: what 10 s of simulation cost."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from bezstab.paper.printed import TABLE_6
from bezstab.paper.reports import Finding, Progress, Report, captioned_table

EQUAL = 0.04  # of the least: by how much the paper's times differ

RECORDED = Path(__file__).parent / "table6_times.json"
"""What `make times` measured once, as no two runs share their times: rows of `Cost`."""


@dataclass(frozen=True)
class Cost:
    """What 10 s of simulation take: evaluations of f (exact), and processor time (s, measured)."""

    method: str
    evaluations: int
    seconds: float


def report(_progress: Progress) -> Report:
    """Return Table 6 and what it claims, with the times recorded once: the same on every machine."""
    recorded = recorded_costs()
    caption = (
        "Table 6: what 10 s of simulation cost (h = 1 ms, RK4 at 5 ms). The paper's times are of its three cases. "
        "Ours are not of this run: they were recorded once (processor time, the fastest of 5, one core, not compiled)."
    )
    ratios = time_ratios(recorded)
    rows = [
        {
            "method": cost.method,
            "evaluations of f in 10 s": f"{cost.evaluations}",
            "paper (s)": ", ".join(f"{seconds:.2f}" for seconds in TABLE_6[cost.method]),
            "recorded (s)": f"{cost.seconds:.3f}",
            "recorded / B4's": f"{ratios[cost.method]:.2f}",
        }
        for cost in recorded
    ]
    return Report(
        tables={"table6": captioned_table(caption, rows)},
        findings=[same_evaluations(recorded), same_times(recorded), one_step_methods_take_longer()],
    )


def time_ratios(of: Sequence[Cost]) -> Mapping[str, float]:
    """Return each method's processor time over B4's."""
    seconds = {cost.method: cost.seconds for cost in of}
    return {method: taken / seconds["B4"] for method, taken in seconds.items()}


def recorded_costs() -> list[Cost]:
    """Return the costs that were recorded once."""
    return [Cost(**row) for row in json.loads(RECORDED.read_text(encoding="utf-8"))]


def same_evaluations(recorded: Sequence[Cost]) -> Finding:
    """Return how often f is evaluated in the runs of Table 6."""
    counts = ", ".join(f"{cost.method} {cost.evaluations}" for cost in recorded)
    spread = _spread([cost.evaluations for cost in recorded])
    return Finding(
        "Table 6",
        "the four methods cost the same (RK4 at 5 ms, the others at 1 ms)",
        "“computational costs are almost the same”",
        f"evaluations of f: {counts}; the largest is {spread:.0%} above the smallest",
        [spread < EQUAL],
    )


def same_times(recorded: Sequence[Cost]) -> Finding:
    """Return the processor times that were recorded, as multiples of B4's."""
    ratios = time_ratios(recorded)
    here = "recorded once, over B4's: " + ", ".join(f"{method} {ratio:.2f}" for method, ratio in ratios.items())
    return Finding(
        "Table 6",
        "they take the same processor time",
        "“the difference between CPU times of each method is less than 4%”",
        here,
        [_spread(list(ratios.values())) < EQUAL],
    )


def one_step_methods_take_longer() -> Finding:
    """Return by how much the paper's own times differ, and whether by chance.

    Chance would not put both one-step methods above both multistep methods in each of the three cases.
    """
    cases = [dict(zip(TABLE_6, times, strict=True)) for times in zip(*TABLE_6.values(), strict=True)]
    spreads = [_spread(list(times.values())) for times in cases]
    longer = [min(times["RK4@5"], times["SIE"]) > max(times["B4"], times["AB4"]) for times in cases]
    return Finding(
        "Table 6",
        "what differs is due to other programs",
        "“less than 4%, which is caused by background apps running on the computer”",
        f"its times differ by up to {max(spreads):.1%}, but RK4 and Euler take longer than B4 and AB4 in "
        f"{sum(longer)} of {len(cases)} cases",
        [max(spreads) < EQUAL, not all(longer)],
    )


def _spread(numbers: Sequence[float]) -> float:
    """Return by how much the largest lies above the smallest, as a part of the smallest."""
    return max(numbers) / min(numbers) - 1
