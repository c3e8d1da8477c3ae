import pytest

from bezstab.paper import methods
from bezstab.paper.findings import Agreement

FOUND = methods.findings()


@pytest.mark.parametrize(
    ("words", "agreement", "number"),
    [
        ("characteristic polynomial of B2", "confirmed", "25 of 25"),
        ("of order n", "confirmed with a correction", "B4: 2"),
    ],
)
def test_the_questions_to_settle(words: str, agreement: Agreement, number: str) -> None:
    (found,) = (finding for finding in FOUND if words in finding.claim)
    assert found.agreement == agreement
    assert number in found.here


def test_everything_but_the_orders_is_confirmed() -> None:
    assert [found.where for found in FOUND if found.agreement != "confirmed"] == ["Table 1"]


def test_with_the_sign_of_alpha_changed_eq_17_holds_only_where_alpha_is_zero(monkeypatch: pytest.MonkeyPatch) -> None:
    printed = methods.printed_polynomial_of_b2
    monkeypatch.setattr(methods, "printed_polynomial_of_b2", lambda alpha_hat, beta_hat: printed(-alpha_hat, beta_hat))
    found = methods.polynomial_of_b2()
    assert (found.agreement, found.here) == ("not confirmed", "the same at 5 of 25 rational points")
