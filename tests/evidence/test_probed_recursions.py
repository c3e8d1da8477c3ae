"""Methods named by their recursions, where a log shows no pole; and logs that follow none."""

from fractions import Fraction

import numpy as np
import pytest

from bezstab.errors import InputError
from bezstab.evidence import Likeness, probed_pole, recursion_likenesses
from bezstab.evidence.linear_prediction import SPREAD
from bezstab.evidence.probed_recursions import AT_THE_KICK, EQUATIONS
from bezstab.methods import REGISTRY, lookup
from bezstab.stability import FloatArray, poles
from tests.reference.sampled_responses import of_poles

ALL = [lookup(name) for name in REGISTRY]
HALF, TENTH, FIFTH = Fraction(1, 2), Fraction(1, 10), Fraction(1, 5)


def response(name: str, alpha_hat: float, beta_hat: float, rows: int, every: int = 1) -> FloatArray:
    """Return rows that the method makes, with nine digits."""
    c = 1e-4 * of_poles(poles(lookup(name), alpha_hat, beta_hat) ** every, rows, seed=3)
    return np.array([float(f"{value:.9g}") for value in c])


def nearest(like: list[Likeness]) -> set[str]:
    return {like[0].method.name, *like[0].same_as.split(", ")}


def by_recursion(like: list[Likeness]) -> list[Likeness]:
    return [one for one in like if one.judged_by == "recursion"]


@pytest.mark.parametrize("name", ["SYM", "RK4", "AB2", "ABM2", "verlet-kdk", "newmark(1/4,1/2)", "implicit-euler"])
def test_a_few_rows_name_the_method(name: str) -> None:
    c = response(name, 0.7, 0.3, rows=11)
    assert probed_pole(c, 0 * c).pole is None  # eleven are too few for one
    like = recursion_likenesses(c, ALL, Fraction(7, 10), Fraction(3, 10), minus=0 * c)
    assert any(one.method.scheme == lookup(name).scheme for one in like if one.distance <= like[0].distance + 1e-9)
    assert like[0].fits
    assert like[0].judged_by == "recursion"
    assert like[0].distance < 1e-6  # nine digits, of rows that fall to a hundredth
    distances = [one.distance for one in by_recursion(like)]
    assert distances == sorted(distances)
    assert like[: len(distances)] == by_recursion(like)


def test_the_distance_is_the_share_by_which_poles_must_shift() -> None:
    shift = 1e-4
    c = of_poles((1 + shift) * poles(lookup("SYM"), 0.2, 0.1), 20, seed=1)
    (one,) = recursion_likenesses(c, [lookup("SYM")], FIFTH, TENTH, minus=0 * c)
    assert one.distance == pytest.approx(shift, rel=1e-2)  # to first order, and terms of the second are a share of it


def test_a_blow_up_within_nine_rows_is_told_although_it_saturates() -> None:
    z = poles(lookup("RK4"), 5.0, 1.5)
    assert abs(z[0]) > 10
    c = np.tanh(1e-6 * of_poles(z, 9, seed=2))
    like = recursion_likenesses(c, ALL, Fraction(5), Fraction(3, 2), minus=0 * c)
    assert [one.method.name for one in by_recursion(like) if one.fits] == ["RK4"]


def test_growth_that_has_long_saturated_is_told() -> None:
    """For thirty rows it is linear, then it swings between two values, as what is near a limit cycle does."""
    z = poles(lookup("forest-ruth"), 0.06, -4.08)
    assert -1.7 < z[0].real < -1.4
    c = np.tanh(1e-6 * of_poles(z, 250, seed=2))
    like = recursion_likenesses(c, ALL, Fraction(6, 100), Fraction(-408, 100), minus=0 * c)
    assert nearest(like) & {"forest-ruth"}


def test_poles_that_a_motion_shifts_are_no_obstacle() -> None:
    pair = [0.9 * np.exp(0.3j), 0.9 * np.exp(-0.3j)]
    growth = 1 + 1e-3 * np.sin(0.05 * np.arange(120))  # as where a motion shifts the poles this way and that
    c = np.cumprod(growth) * of_poles(np.array(pair), 120, seed=4)
    # alpha_hat and beta_hat of that pair under SYM: z^2 - (2 - a - b) z + (1 - a)
    a, b = 1 - 0.81, 2 - (1 - 0.81) - 1.8 * np.cos(0.3)
    point = Fraction(a).limit_denominator(10**9), Fraction(b).limit_denominator(10**9)
    like = recursion_likenesses(c, ALL, *point, minus=0 * c)
    assert nearest(like) & {"SYM"}


def test_the_row_of_the_kick_need_not_follow() -> None:
    """As where a simulator remembers an acceleration of before it, which later rows have forgotten."""
    c = np.append(2e-4, response("trapezoid", 2.0, 1.5, rows=2 + EQUATIONS))
    like = recursion_likenesses(c, ALL, Fraction(2), Fraction(3, 2), minus=0 * c)
    assert nearest(like) & {"trapezoid"}
    assert like[0].distance < 1e-6


def test_few_rows_of_one_run_are_not_tested_but_of_two() -> None:
    c = response("SYM", 5.0, 2.0, rows=7)
    assert by_recursion(recursion_likenesses(c, ALL, Fraction(5), Fraction(2))) == []
    assert by_recursion(recursion_likenesses(c, ALL, Fraction(5), Fraction(2), minus=0 * c)) != []


@pytest.mark.parametrize(("name", "every"), [("SYM", 1), ("verlet-half", 1), ("SYM", 2)])
def test_a_pole_at_zero_is_seen_in_the_first_row_and_held_against_nothing(name: str, every: int) -> None:
    """At alpha_hat = 1 symplectic Euler has poles 1 - beta_hat and 0: the first row alone says where it began."""
    c = np.append(1e-4, 0.3e-4 * 0.75 ** (every * np.arange(5.0)))
    like = recursion_likenesses(c, ALL, Fraction(1), Fraction(1, 4), minus=0 * c, between=every)
    (own,) = [one for one in like if one.method.name == name]
    assert own.fits
    assert own.distance < 1e-9
    assert own.judged_by == "recursion"


def test_rows_several_steps_apart_have_powers_of_the_poles() -> None:
    c = response("SYM", 0.5, 0.25, rows=9, every=3)
    like = recursion_likenesses(c, ALL, HALF, Fraction(1, 4), minus=0 * c, between=3)
    assert "SYM" in nearest(like)
    assert like[0].predicted == pytest.approx(complex(poles(lookup("SYM"), 0.5, 0.25)[0]) ** 3, abs=1e-9)


def test_what_a_motion_forces_on_one_run_is_differenced_off() -> None:
    c = response("SYM", 0.2, 0.3, rows=30) + 1e-3 * np.cos(0.005 * np.arange(30))
    like = recursion_likenesses(c, ALL, FIFTH, Fraction(3, 10))
    assert "SYM" in nearest(like)


def test_zeros_after_the_last_decimal_do_not_hide_the_rows_before() -> None:
    c = np.round(1e-2 * of_poles(poles(lookup("RK2"), 0.7, 0.3), 40, seed=3), 7)
    assert not c[-5:].any()
    like = recursion_likenesses(c, ALL, Fraction(7, 10), Fraction(3, 10), minus=0 * c)
    assert "RK2" in nearest(like)
    assert like[0].judged_by == "recursion"


def test_of_several_responses_the_one_that_shows_most_counts() -> None:
    c = response("RK2", 0.7, 0.3, rows=11)
    both = np.stack([np.random.default_rng(1).normal(size=11), c], axis=1)
    like = recursion_likenesses(both, ALL, Fraction(7, 10), Fraction(3, 10), minus=0 * both)
    assert "RK2" in nearest(like)
    with pytest.raises(InputError, match="minus has 1 responses, c has 2"):
        recursion_likenesses(both, ALL, HALF, HALF, minus=c)


def test_a_method_whose_recursion_is_too_long_is_not_excluded() -> None:
    c = response("SYM", 0.5, 0.1, rows=2 + EQUATIONS + AT_THE_KICK)
    like = recursion_likenesses(c, ALL, HALF, TENTH, minus=0 * c)
    names = {one.method.name for one in by_recursion(like)}
    assert {"SYM", "RK4"} <= names
    by_name = {one.method.name: one for one in like}
    assert set(by_name) == {method.name for method in ALL}
    assert not {"AB3", "AB8"} & names  # six terms and more
    assert by_name["AB8"].fits
    assert np.isnan(by_name["AB8"].distance)
    assert by_name["AB8"].reason == "not excluded: too few rows for its recursion"
    assert by_recursion(recursion_likenesses(c[:-1], ALL, HALF, TENTH, minus=0 * c)) == []


@pytest.mark.parametrize("name", ["SYM", "RK4", "AB2", "verlet-kdk", "implicit-euler", "forest-ruth"])
def test_rows_too_few_for_a_test_exclude_what_contradicts_them_and_nothing_else(name: str) -> None:
    """Of a recursion of three terms four rows are two equations: too few to follow it, enough to contradict it."""
    point = Fraction(59, 10), Fraction(111, 10)
    c = response(name, 5.9, 11.1, rows=4)
    like = {one.method.name: one for one in recursion_likenesses(c, ALL, *point, minus=0 * c)}
    assert like[name].fits
    excluded = {one.method.name for one in like.values() if not one.fits}
    assert excluded
    for one in like.values():
        own = poles(one.method, 5.9, 11.1)
        if len(own) == 2:
            equations = [(c[k + 2], -c[k + 1] * own.sum().real, c[k] * own.prod().real) for k in range(2)]
            share = min(abs(sum(terms)) / max(map(abs, terms)) for terms in equations)
            assert one.distance == pytest.approx(share, rel=1e-6, abs=1e-8)
            assert one.fits == (share <= 0.5)
        elif len(own) > 2:
            assert one.fits
    three = recursion_likenesses(c[:3], ALL, *point, minus=0 * c)
    assert all(one.fits and one.judged_by == "exclusion" for one in three)


def test_one_row_is_too_few_to_say_anything_and_of_one_run_it_takes_one_more() -> None:
    c = response("SYM", 6.0, 2.0, rows=4)
    assert recursion_likenesses(c[:1], ALL, Fraction(6), Fraction(2), minus=0 * c) == []
    assert all(one.fits for one in recursion_likenesses(c, ALL, Fraction(6), Fraction(2)))


def test_the_faster_the_mechanism_the_more_is_allowed() -> None:
    c = response("B4", 0.5, 0.1, rows=40)

    def allowed(turned: float | None) -> float:
        (one,) = recursion_likenesses(c, [lookup("B4")], HALF, TENTH, minus=0 * c, turned=turned)
        return one.allowed

    assert allowed(0.0) == SPREAD  # nothing is ever claimed to be known better
    first_order = allowed(1e-3) - SPREAD - 1e-6  # without the square of the angle
    assert allowed(2e-3) - SPREAD - 4e-6 == pytest.approx(2 * first_order, rel=1e-9)


@pytest.mark.parametrize("rows", [6, 12, 30, 250])
def test_noise_follows_no_recursion(rows: int) -> None:
    random = np.random.default_rng(rows)
    for _ in range(3):
        noise = random.normal(size=rows)
        for c in (noise, np.cumsum(noise), np.round(noise, 1)):
            point = (Fraction(int(random.integers(1, 150)), 100), Fraction(int(random.integers(1, 80)), 100))
            assert by_recursion(recursion_likenesses(c, ALL, *point)) == []
            assert by_recursion(recursion_likenesses(c, ALL, *point, minus=0 * c)) == []


@pytest.mark.parametrize("c", [np.zeros(50), np.full(50, 0.25), np.zeros(0), np.full(20, np.nan)])
def test_what_shows_nothing_says_nothing(c: FloatArray) -> None:
    assert recursion_likenesses(c, ALL, HALF, TENTH) == []


def test_what_a_motion_forces_follows_no_recursion() -> None:
    assert by_recursion(recursion_likenesses(2 + np.cos(0.01 * np.arange(50)), ALL, HALF, TENTH)) == []


def test_what_fits_nowhere_near_is_excluded() -> None:
    c = response("AB4", 0.5, 0.1, rows=40)
    like = {one.method.name: one for one in recursion_likenesses(c, ALL, HALF, TENTH, minus=0 * c)}
    assert like["AB4"].fits
    assert not like["RK4"].fits
    assert like["RK4"].distance > 0.05
