from fractions import Fraction

from bezstab.methods import lookup
from bezstab.questions import Question, answers
from bezstab.show import ROW_KINDS, answer_row
from bezstab.show.sentences import answer_sentence

SYM = (lookup("SYM"),)
H = Fraction(1, 240)


def test_every_kind_of_row_that_tells_one_thing_has_a_sentence() -> None:
    assert {name for name, kinds in ROW_KINDS.items() for kind in kinds if kind.sentence is None} == {"lint", "probe"}


def test_the_sentence_says_whether_it_is_safe_what_a_step_does_and_how_far_it_may_go() -> None:
    point = (Fraction(1), Fraction(1, 4))
    asked = Question(methods=SYM, point=point, h=H)
    assert answer_sentence(answer_row(next(answers(asked)))) == (
        "Safe. Each step multiplies the error by 0.75. The step may grow to 6.9 ms, α 1.88-fold, β 2.83-fold."
    )
    without_a_step = answer_row(next(answers(Question(methods=SYM, point=point))))
    assert "The step may grow 1.66-fold, α 1.88-fold" in answer_sentence(without_a_step)
    unknown = answer_sentence({**without_a_step, "margins_reason": "rounding"})
    assert unknown.endswith("How far the step, α and β may grow is not known: rounding.")
