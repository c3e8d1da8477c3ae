import pytest

from bezstab.paper import methods


def test_everything_but_the_orders_is_confirmed() -> None:
    assert [
        found.where for found in methods.report(lambda runs, label: runs).findings if found.agreement != "confirmed"
    ] == ["Table 1"]


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
