from dataclasses import dataclass
from fractions import Fraction

import numpy as np
import pytest

from bezstab.engines import ENGINES
from bezstab.methods import Method, lookup
from bezstab.show.columns import Row
from bezstab.show.rows import (
    LIMITS,
    alpha_and_beta,
    choice_row,
    engine_row,
    region_row,
    row,
    stable_steps_words,
    whole_row,
    with_unbounded,
)
from bezstab.stability import best_point, describe_point, region
from bezstab.units import to_dimensionless


@dataclass(frozen=True)
class Sample:
    method: Method
    pole: complex
    share: Fraction
    missing: str | None
    values: object


SAMPLE = Sample(lookup("B4"), 0.6 + 0.8j, Fraction(1, 4), None, np.zeros(2))
KNOWN = {
    "method": "B4",
    "z_real": 0.6,
    "z_imag": 0.8,
    "z_abs": 1.0,
    "z_angle_deg": pytest.approx(53.13010235415598),
    "share": 0.25,
    "missing": None,
}


def test_a_row_has_names_parts_and_numbers() -> None:
    assert row(SAMPLE, without={"values"}) == KNOWN


def test_a_row_refuses_a_type_that_it_does_not_know() -> None:
    with pytest.raises(TypeError, match=r"Sample\.values is a ndarray"):
        row(SAMPLE)


def test_a_row_takes_what_is_said_instead_of_a_field() -> None:
    assert row(SAMPLE, values=2, more="text") == {**KNOWN, "values": 2, "more": "text"}


def test_a_whole_row_says_that_b4_is_of_order_two() -> None:
    whole = whole_row(lookup("B4"), region(lookup("B4")), best_point(lookup("B4")), latex=False)
    assert (whole["order"], whole["error_constant_exact"], whole["steps"], whole["evaluations"]) == (2, "11/36", 4, 1)
    assert whole["error_constant"] == 11 / 36


def test_alpha_and_beta_come_back() -> None:
    alpha_hat, beta_hat = to_dimensionless(Fraction(50), Fraction(30), Fraction(1, 500))
    assert alpha_and_beta(float(alpha_hat), float(beta_hat), 0.002) == pytest.approx((50, 30))
    assert alpha_and_beta(0.1, -0.1, 0.002)[1] is None


def test_a_choice_has_its_margins_or_none() -> None:
    stable = choice_row(describe_point(lookup("SYM"), "as given", Fraction(1), Fraction(1, 2)), 0.002)
    unstable = choice_row(describe_point(lookup("SYM"), "as given", Fraction(2), Fraction(2)), 0.002)
    assert list(stable) == list(unstable)
    assert (stable["safe"], unstable["safe"]) == (True, False)
    assert stable["h_limit"] == pytest.approx(0.002 * float(str(stable["h_factor"])))
    assert (unstable["h_limit"], unstable["alpha_factor_max"], unstable["settle_seconds"]) == (None, None, None)
    assert unstable["alpha"] == 500


def test_an_engine_without_a_setting_says_why() -> None:
    point = (Fraction(1), Fraction(1, 5))
    assert engine_row(ENGINES["ode"], point, Fraction(1, 500))["setting"] == "ERP = 0.2"
    beside = (Fraction(1, 2), point[1])
    assert "box2d is" in str(engine_row(ENGINES["box2d"], beside, Fraction(1, 500))["setting"])
    assert engine_row(ENGINES["ode"], None, Fraction(1, 500))["setting"] is None


def region_words(name: str) -> Row:
    return with_unbounded(region_row(region(lookup(name)), None))


def test_a_region_without_limits_says_so_in_words_and_has_no_numbers() -> None:
    row = region_row(region(lookup("bdf3")), None)
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
    assert stable_steps_words(region_row(region(lookup(name)), None)) == words


def test_other_words_for_stable_steps() -> None:
    row = region_row(region(lookup("B2")), None)
    assert stable_steps_words({**row, "critical_damping_limit": 0.0}) == "0"
    unsure: Row = {**row, "critical_damping_limit": None}
    assert stable_steps_words(unsure) == "all"
    assert stable_steps_words({**unsure, "unconditional_damping_ratio": 0.0}) == "all (no unstable α, β found)"
