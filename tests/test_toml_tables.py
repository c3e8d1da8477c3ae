"""What a TOML table hands out, and what it says of what it does not."""

import math
from collections.abc import Callable

import pytest

from bezstab.errors import InputError
from bezstab.toml_tables import TomlTable


def refusal(ask: Callable[[], object]) -> str:
    with pytest.raises(InputError) as caught:
        ask()
    return str(caught.value)


def test_what_is_absent_without_a_default_is_missing() -> None:
    assert refusal(lambda: TomlTable({}, "bob").positive_number("mass")) == "bob: mass is missing: found nothing"
    assert refusal(lambda: TomlTable({"mas": 1}).positive_number("mass")) == "mass is missing: found mas"


def test_an_unknown_key_of_a_table_within_is_found_from_outside() -> None:
    top = TomlTable({"body": [{}, {"mas": 1.0}], "initial": {}})
    for body in top.tables("body"):
        body.number("mass", default=0.0)
    top.table("initial")
    assert refusal(top.refuse_unknown_keys) == "body 2: unknown key 'mas': known are mass"


@pytest.mark.parametrize("value", [True, "1", None, math.nan, 1e101, 1e-101, 10**400, [1.0], {}])
def test_what_is_no_number_of_ordinary_size_is_refused(value: object) -> None:
    assert "expected a number" in refusal(lambda: TomlTable({"x": value}).number("x"))


@pytest.mark.parametrize("value", ["", " ", "a\nb", "a\u2028b", 4])
def test_what_is_not_one_line_of_text_is_refused(value: object) -> None:
    assert "expected one line of text" in refusal(lambda: TomlTable({"x": value}).text("x"))
