import pytest

from bezstab.paper.ledger import ledger_text
from bezstab.paper.reports import Agreement, Finding


@pytest.mark.parametrize(
    ("holds", "agreement"),
    [
        ([True, True], "confirmed"),
        ([True, False], "confirmed with a correction"),
        ([False, False], "not confirmed"),
        ([], "cannot be tested"),
    ],
)
def test_the_agreement_follows_from_the_conditions(holds: list[bool], agreement: Agreement) -> None:
    assert Finding("Eq. 1", "c = 0", "0", "1e-16", holds).agreement == agreement


def test_the_ledger_counts_and_escapes() -> None:
    found = [Finding(where="Fig. 1", claim="|z_p| < 1", paper="yes", here="no", holds=[False])]
    assert "0 confirmed, 0 confirmed with a correction, 1 not confirmed, 0 cannot be tested" in ledger_text(found)
    assert r"\|z_p\| < 1" in ledger_text(found)
