"""All subjects of the paper in order, and the ledger: a row for every claim that can be tested."""

from collections import Counter
from collections.abc import Callable, Sequence
from typing import get_args

from bezstab.paper import comparison, cost, drift, influence, methods, regions, slider_crank
from bezstab.paper.printed import PARTS
from bezstab.paper.reports import Agreement, Finding, Progress, Report, captioned_table
from bezstab.show import CLAIMS

MAKERS: Sequence[Callable[[Progress], Report]] = (
    methods.report,
    regions.report,
    slider_crank.report,
    drift.collapse_report,
    drift.growth_report,
    influence.report,
    comparison.report,
    cost.report,
)

SUBJECTS = dict(zip(PARTS, MAKERS, strict=True))
"""Tables and figures that come together, and what makes them, in the order of the ledger."""


def ledger_text(findings: Sequence[Finding]) -> str:
    """Return every claim with what came out, as Markdown."""
    counts = Counter(finding.agreement for finding in findings)
    total = ", ".join(f"{counts[agreement]} {agreement}" for agreement in get_args(Agreement))
    caption = f"# What the paper claims, and what came out\n\nWritten by `bezstab paper`: {total}."
    return captioned_table(caption, [CLAIMS.row(finding) for finding in findings])
