from fractions import Fraction

from bezstab.engines import ENGINES
from bezstab.methods import lookup
from bezstab.questions import region_answer
from bezstab.show.rows import engine_row, whole_row


def test_a_whole_row_says_that_b4_is_of_order_two() -> None:
    whole = whole_row(region_answer(lookup("B4")), latex=False)
    assert (whole["order"], whole["error_constant_exact"], whole["steps"], whole["evaluations"]) == (2, "11/36", 4, 1)
    assert whole["error_constant"] == 11 / 36


def test_an_engine_without_a_setting_says_why() -> None:
    point = (Fraction(1), Fraction(1, 5))
    assert engine_row(ENGINES["ode"], point, Fraction(1, 500))["setting"] == "ERP = 0.2"
    beside = (Fraction(1, 2), point[1])
    assert "box2d is" in str(engine_row(ENGINES["box2d"], beside, Fraction(1, 500))["setting"])
    assert engine_row(ENGINES["ode"], None, Fraction(1, 500))["setting"] is None
