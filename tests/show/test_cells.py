"""What cells of tables show."""

import pytest

from bezstab.methods import lookup
from bezstab.questions import region_answer
from bezstab.show import Row
from bezstab.show.cells import (
    LIMITS,
    pole_text,
    range_text,
    safe_step_text,
    stable_steps_text,
    used_up_text,
    with_unbounded,
    yes_no_text,
)
from bezstab.show.rows import region_row
from bezstab.stability import region


def test_a_pole_shows_its_conjugate_unless_it_is_real_to_six_digits() -> None:
    assert pole_text({"z_real": 0.5, "z_imag": 0.25}) == "0.500000 ± 0.250000i"
    assert pole_text({"z_real": 0.5, "z_imag": 1e-9}) == "0.500000"
    assert pole_text({"z_real": -2e6, "z_imag": 0.0}) == "-2.000000e+06"


def test_a_truth_value_is_yes_no_or_a_dash() -> None:
    assert [yes_no_text("held")({"held": value}) for value in (True, False, None)] == ["yes", "NO", "-"]


def test_a_range_without_an_upper_end_goes_to_any() -> None:
    assert range_text("alpha")({"alpha_factor_min": 0.5, "alpha_factor_max": None}) == "0.5 to any"
    assert range_text("alpha")({"alpha_factor_min": None, "alpha_factor_max": None}) == "-"


def test_a_safe_step_is_rounded_down() -> None:
    assert safe_step_text({"safe": True, "h_limit": 0.0123456}) == "0.01234"
    assert safe_step_text({"safe": True, "h_limit": None}) == "unlimited"
    assert safe_step_text({"safe": False, "h_limit": None}) == "none"


def test_a_gain_without_a_limit_has_no_share_of_it() -> None:
    assert used_up_text({"used_up": "kd", "kd": 80.0, "kd_max": 40.0}) == "kd 200 %"
    assert used_up_text({"used_up": "kd", "kd": 80.0, "kd_max": None}) == "kd"


def region_words(name: str) -> Row:
    return with_unbounded(region_row(region_answer(lookup(name))))


def test_a_region_without_limits_says_so_in_words_and_has_no_numbers() -> None:
    row = region_row(region_answer(lookup("bdf3")))
    assert row["bounded"] is False
    assert [row[key] for key in ("area", *LIMITS)] == [None] * 5
    words = with_unbounded(row)
    assert [words[key] for key in ("area", *LIMITS)] == ["unbounded"] * 5
    assert words["critical_damping_limit"] == "unlimited"
    assert region_words("B4")["area"] == region(lookup("B4")).area
    assert region_words("B4")["unconditional_damping_ratio"] == "none"
    assert region_words("trapezoid")["alpha_hat_min"] == 0


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("trapezoid", "all (proven for any α, β)"),
        ("bdf3", "all, as from α/β = 0.0691929"),
        ("am3", "6"),
        ("B2", "1"),
    ],
)
def test_which_steps_are_stable_is_said_in_a_few_words(name: str, words: str) -> None:
    assert stable_steps_text(region_row(region_answer(lookup(name)))) == words


def test_other_words_for_stable_steps() -> None:
    row = region_row(region_answer(lookup("B2")))
    assert stable_steps_text({**row, "critical_damping_limit": 0.0}) == "0"
    unsure: Row = {**row, "critical_damping_limit": None}
    assert stable_steps_text(unsure) == "all"
    assert stable_steps_text({**unsure, "unconditional_damping_ratio": 0.0}) == "all (no unstable α, β found)"
