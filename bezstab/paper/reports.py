"""What a subject of the paper hands over: its tables, what draws its figures, its findings."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from bezstab.paper.experiments import Experiment
from bezstab.paper.findings import Finding
from bezstab.show import Field, Row, render

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Progress = Callable[[Iterator[Experiment], str, int], Iterable[Experiment]]
"""Passes runs on as they are made, and may show how far it is: it is told their label and their number."""


@dataclass(frozen=True)
class Report:
    """Tables as Markdown and what draws the figures, by the name of their part; and what came of the claims."""

    tables: Mapping[str, str] = field(default_factory=dict)
    figures: Mapping[str, Callable[[], "Figure"]] = field(default_factory=dict)
    findings: Sequence[Finding] = ()


def captioned_table(caption: str, rows: Sequence[Row], columns: Sequence[Field]) -> str:
    """Return a table as Markdown below its caption."""
    return f"{caption}\n\n{render(rows, columns, 'markdown')}\n"
