"""What can come of comparing a sentence of the paper with a result."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

Agreement = Literal["confirmed", "confirmed with a correction", "not confirmed", "cannot be tested"]


@dataclass(frozen=True)
class Finding:
    """A sentence of the paper, what it says, what came out here, and whether they agree."""

    where: str
    claim: str
    paper: str
    here: str
    agreement: Agreement


def finding(*, where: str, claim: str, paper: str, here: str, holds: Sequence[bool]) -> Finding:
    """Return what came of a claim, given the conditions it makes and whether each of them holds.

    If all hold it is confirmed, if only some do, confirmed with a correction; without a condition nothing can be
    tested.
    """
    return Finding(where=where, claim=claim, paper=paper, here=here, agreement=_agreement(holds))


def _agreement(holds: Sequence[bool]) -> Agreement:
    if not holds:
        return "cannot be tested"
    if all(holds):
        return "confirmed"
    if any(holds):
        return "confirmed with a correction"
    return "not confirmed"
