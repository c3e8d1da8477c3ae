from typing import get_args

import pytest

from bezstab.paper import lost, methods, regions, slider_crank
from bezstab.paper.ledger import SUBJECTS, finding_rows, ledger_text
from bezstab.paper.printed import PARTS
from bezstab.paper.reports import Agreement, Finding


def test_every_part_is_made_by_one_subject() -> None:
    assert sorted(part for parts in SUBJECTS for part in parts) == sorted(PARTS)


@pytest.mark.slow
def test_every_row_says_what_the_paper_says_and_what_came_out() -> None:
    found = [*methods.findings(), *regions.findings(), *slider_crank.findings(), *lost.findings()]
    assert all(f.where and f.claim and f.paper and f.here and f.agreement in get_args(Agreement) for f in found)
    assert len({(f.where, f.claim) for f in found}) == len(found) > 25
    assert {f.agreement for f in lost.findings()} == {"cannot be tested"}


def test_the_ledger_counts_and_escapes_and_a_row_says_whether_a_claim_is_confirmed() -> None:
    found = [Finding(where="Fig. 1", claim="|z_p| < 1", paper="yes", here="no", holds=[False])]
    assert "0 confirmed, 0 confirmed with a correction, 1 not confirmed, 0 cannot be tested" in ledger_text(found)
    assert r"\|z_p\| < 1" in ledger_text(found)
    assert [row["agreement"] for row in finding_rows(found)] == ["not confirmed"]
