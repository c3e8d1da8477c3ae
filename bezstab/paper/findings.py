"""What can come of comparing a sentence of the paper with a result."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

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
