"""What a subject of the paper hands over: tables, what draws its figures, and what came of each sentence."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal

from bezstab.paper.experiments import Experiment
from bezstab.show import Field, Row, render

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Agreement = Literal["confirmed", "confirmed with a correction", "not confirmed", "cannot be tested"]


@dataclass(frozen=True)
class Finding:
    """A sentence of the paper, what it says, what came out here, and whether each of its conditions holds."""

    where: str
    claim: str
    paper: str
    here: str
    holds: Sequence[bool]

    @property
    def agreement(self) -> Agreement:
        """Whether all conditions hold, only some, or none; without a condition nothing can be tested."""
        if not self.holds:
            return "cannot be tested"
        if all(self.holds):
            return "confirmed"
        return "confirmed with a correction" if any(self.holds) else "not confirmed"


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
