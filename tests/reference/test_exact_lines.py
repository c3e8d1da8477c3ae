from fractions import Fraction
from math import inf

from bezstab.methods.registry import lookup
from tests.reference.exact_lines import stable_parts
from tests.reference.random_methods import random_method


def test_straight_edges_are_met_exactly() -> None:
    """Symplectic Euler: alpha_hat > 0, beta_hat > 0, 2 alpha_hat + beta_hat < 4."""
    assert stable_parts(lookup("SYM"), 1.0, line=Fraction(1), axis=1) == [(0, Fraction(3, 2))]
    assert stable_parts(lookup("SYM"), 1.0, line=Fraction(1), axis=0) == [(0, 2)]
    assert stable_parts(lookup("SYM"), 1.0, line=Fraction(2), axis=0) == []


def test_a_part_may_have_no_end() -> None:
    """Implicit Euler, (1 + alpha_hat + beta_hat) z^2 - (2 + alpha_hat) z + 1: for beta_hat = 1, alpha_hat > -1."""
    assert stable_parts(lookup("implicit-euler"), 1.0, line=Fraction(1), axis=1) == [(-1, inf)]


def test_a_level_below_one_counts() -> None:
    """Symplectic Euler's z^2 - (2 - alpha_hat - beta_hat) z + 1 - alpha_hat, at alpha_hat = 1: |1 - beta_hat| < 1/2."""
    assert stable_parts(lookup("SYM"), 0.5, line=Fraction(1), axis=0) == [(Fraction(1, 2), Fraction(3, 2))]


def test_a_part_far_below_rounding_is_found() -> None:
    """An island 1e-9 of its distance from the origin: a million millionth of that before its end it is 5e-17 wide."""
    end = Fraction("-200.84684958544068")
    ((low, high),) = stable_parts(random_method(2424), 1.0, end * (1 - Fraction(1, 10**12)), axis=0)
    assert 0 < high - low < 1e-16
