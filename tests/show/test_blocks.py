import math

from hypothesis import given
from hypothesis import strategies as st

from bezstab.show import Row, block, column, fits, wrapped
from bezstab.show.columns import shown_width

COLUMNS = [column("method", "method"), column("α̂", "alpha_hat", ".3f"), column("why", "reason")]
ROW: Row = {"method": "B4", "alpha_hat": 0.5, "reason": "one two three four five six seven eight nine ten"}


def test_a_block_has_a_line_for_each_value_below_the_sentence() -> None:
    assert block(ROW, COLUMNS, 40, "It is so.").split("\n") == [
        "It is so.",
        "",
        "method  B4",
        "α̂       0.500",
        "why     one two three four five six",
        "        seven eight nine ten",
    ]


def test_what_is_missing_has_no_line() -> None:
    assert block({**ROW, "alpha_hat": math.inf, "reason": ""}, COLUMNS, 80) == "method  B4"


@given(st.text("abc -/\N{COMBINING CIRCUMFLEX ACCENT}", max_size=300), st.integers(20, 120))
def test_only_a_word_is_wider_than_the_line_and_no_word_is_lost(text: str, width: int) -> None:
    lines = wrapped(text, width).split("\n")
    assert all(shown_width(line) <= width or " " not in line.strip() for line in lines)
    assert " ".join(lines).split() == text.split()


def test_a_table_fits_if_every_line_does() -> None:
    assert fits("12345\nα̂2345", 5)
    assert not fits("12345\n123456", 5)
