"""What a subject of the paper hands over: tables, what draws its figures, and what came of each claim."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal

from bezstab.show import Row, column, render

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Agreement = Literal["confirmed", "confirmed with a correction", "not confirmed", "cannot be tested"]


@dataclass(frozen=True)
class Finding:
    """A claim of the paper: where it stands, what the paper says, what came out here, and which conditions hold."""

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


Outcome = tuple[str, Sequence[bool]]
"""What came out of a claim, in words, and whether each of its conditions holds."""

Progress = Callable[[Sequence[Any], str], Iterable[Any]]
"""Passes on what says which run is next, and may show how far it is: it is told all of them, and their label."""


@dataclass(frozen=True)
class Report:
    """Tables as Markdown and what draws the figures, by the name of their part; and what came of the claims."""

    tables: Mapping[str, str] = field(default_factory=dict)
    figures: Mapping[str, Callable[[], "Figure"]] = field(default_factory=dict)
    findings: Sequence[Finding] = ()


def captioned_table(caption: str, rows: Sequence[Row]) -> str:
    """Return rows, their values by heading, as Markdown below a caption."""
    columns = [column(heading, heading) for heading in rows[0]]
    return f"{caption}\n\n{render(rows, columns, 'markdown')}\n"
