import pytest

from bezstab.paper import methods
from bezstab.paper.reports import Agreement

FOUND = methods.findings()


@pytest.mark.parametrize(
    ("words", "agreement", "number"),
    [
        ("characteristic polynomial of B2", "confirmed", "25 of 25"),
        ("of order n", "confirmed with a correction", "B4: 2"),
        ("the step enters", "confirmed", "50 of 50"),
        ("the feedback is stable", "confirmed", "9 of 9"),
        ("several stages", "confirmed", "B4 4 and 1, AB4 4 and 1, RK4 1 and 4"),
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


def test_without_the_square_of_the_step_eq_15_holds_only_for_steps_of_1_s(monkeypatch: pytest.MonkeyPatch) -> None:
    printed = methods.printed_polynomial_of_b2_by_step
    monkeypatch.setattr(
        methods, "printed_polynomial_of_b2_by_step", lambda alpha, beta, h: printed(alpha / h, beta / h, h)
    )
    found = methods.step_enters_with_parameters()
    assert (found.agreement, found.here) == ("not confirmed", "Eq. 15 is Eq. 17 at 26 of 50 rational points")
