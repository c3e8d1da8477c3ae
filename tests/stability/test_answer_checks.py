"""Deliberately wrong best points, choices and margins: each is a NumericalError."""

from fractions import Fraction

import pytest

from bezstab.errors import NumericalError
from bezstab.methods import lookup
from bezstab.rationals import exact
from bezstab.stability import (
    choose,
    path_crossings,
    stability_margins,
    verdict,
)
from bezstab.stability.answer_checks import check_margin
from bezstab.stability.path_crossings import Path
from tests.reference.made_methods import runge_kutta
from tests.reference.settling import settling


@pytest.mark.parametrize("rate", [0.99, 0.9, 0.7])
@pytest.mark.slow
def test_margins_of_a_fourfold_pole_are_where_the_verdict_turns(rate: float) -> None:
    """On alpha = beta four poles of ABM2 meet, and float64 alone is off by more than the check allows."""
    gentle = choose(lookup("ABM2"), "gentle", h=Fraction(1), settle=settling(rate))
    assert gentle.margins
    for side, expected in ((Fraction(1, 10**9), "diverges"), (-Fraction(1, 10**9), "converges")):
        factor = Fraction(gentle.margins.h) * (1 + side)
        point = exact(gentle.alpha_hat) * factor, exact(gentle.beta_hat) * factor**2
        assert verdict(lookup("ABM2"), *point) == expected


PATHS = [(1, 2), (1, 0), (0, 2)]


@pytest.mark.parametrize("name", ["B4", "RK4", "SYM", "verlet-kdk"])
@pytest.mark.parametrize("off", [1 - 1e-8, 1 + 1e-8])
def test_a_margin_beside_its_place_is_no_answer(name: str, off: float) -> None:
    found = stability_margins(lookup(name), 0.3, 0.06)
    for powers, ends in zip(PATHS, [(0.0, found.h), found.alpha, found.beta], strict=True):
        path = Path(lookup(name), Fraction(3, 10), Fraction(6, 100), powers)
        check_margin(path, ends)
        with pytest.raises(NumericalError, match="margin"):
            check_margin(path, (ends[0], off * ends[1]))


@pytest.mark.parametrize("name", ["B4", "RK4"])
def test_a_crossing_that_was_missed_is_no_answer(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(path_crossings, "crossing_factors", lambda path: ())
    with pytest.raises(NumericalError, match="before the margin"):
        stability_margins(lookup(name), 0.3, 0.06)


def test_a_gap_is_no_margin_however_mildly_errors_grow_in_it() -> None:
    """R = 1 + mu + 3/25 mu^2 is below -1 from mu = -10/3 to -5, by a twelfth at most; at -25/3 it is one again."""
    path = Path(runge_kutta("gap", "3/25", "0 1"), Fraction(1), Fraction(1, 4), (1, 2))  # both mu are -s/2
    check_margin(path, (0.0, 20 / 3))
    with pytest.raises(NumericalError, match="unstable before the margin"):
        check_margin(path, (0.0, 50 / 3))
