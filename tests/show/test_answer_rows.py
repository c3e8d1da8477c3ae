from fractions import Fraction

from bezstab.methods import lookup
from bezstab.questions import Question, answers
from bezstab.show import answer_row, costs_words, motion_words, trade_words

SYM = (lookup("SYM"),)
H = Fraction(1, 240)


def test_rows_of_safe_and_unsafe_points_have_the_same_keys() -> None:
    stable, unstable = (
        answer_row(next(answers(Question(methods=SYM, point=(Fraction(alpha), Fraction(1, 2)), h=H))))
        for alpha in (1, 2)
    )
    assert list(stable) == list(unstable)
    assert (stable["safe"], unstable["safe"]) == (True, False)
    assert stable["omega_h"] == unstable["omega_h"] == 0.01
    for key in ("forced_error", "total_error", "velocity_error", "times_least", "times_least_velocity"):
        assert unstable[key] is None


def test_only_what_costs_much_is_said_to() -> None:
    strong, weak = (
        next(answers(Question(methods=(lookup("RK4"),), point=point)))
        for point in ((Fraction("1.6"), Fraction(1)), (Fraction("0.011"), Fraction("0.00007")))
    )
    assert "RK4 keeps order 2 of 4" in str(costs_words(strong))
    assert costs_words(weak) is None


def test_the_trade_is_told_in_options_to_type() -> None:
    chosen = next(answers(Question(methods=SYM, goal="accurate", h=H)))
    faster, slower = trade_words(chosen)
    assert "Faster decay: --goal fastest takes |z_p| from" in faster
    assert "--settle" in slower
    assert "ωh = 0.01" in motion_words(chosen.question.motion)
