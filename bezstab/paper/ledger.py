"""All subjects of the paper in order, and the ledger: a row for every claim that can be tested."""

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from typing import get_args

from bezstab.paper import comparison, cost, drift, influence, methods, regions, slider_crank
from bezstab.paper.reports import Agreement, Finding, Progress, Report
from bezstab.show import CLAIMS, Row, render

SUBJECTS: Mapping[tuple[str, ...], Callable[[Progress], Report]] = {
    ("table1", "table2"): methods.report,
    ("fig1", "fig2", "fig3"): regions.report,
    ("table3", "fig4"): slider_crank.report,
    ("fig5",): drift.collapse_report,
    ("fig6",): drift.growth_report,
    ("table4", "fig7", "fig8"): influence.report,
    ("table5", "fig9"): comparison.report,
    ("table6",): cost.report,
}
"""Tables and figures that come together, and what makes them, in the order of the ledger."""


def finding_rows(findings: Sequence[Finding]) -> list[Row]:
    """Return the findings as rows."""
    keys = "where", "claim", "paper", "here", "agreement"
    return [{key: getattr(finding, key) for key in keys} for finding in findings]


def ledger_text(findings: Sequence[Finding]) -> str:
    """Return every claim with what came out, as Markdown."""
    counts = Counter(finding.agreement for finding in findings)
    total = ", ".join(f"{counts[agreement]} {agreement}" for agreement in get_args(Agreement))
    rows = finding_rows(findings)
    table = render(rows, CLAIMS.columns(rows), "markdown")
    return f"# What the paper claims, and what came out\n\nWritten by `bezstab paper`: {total}.\n\n{table}\n"
