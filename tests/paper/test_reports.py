import pytest

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
    found = Finding(where="Eq. 1", claim="c = 0", paper="0", here="1e-16", holds=holds)
    assert found.agreement == agreement
    assert (found.where, found.claim, found.paper, found.here) == ("Eq. 1", "c = 0", "0", "1e-16")
