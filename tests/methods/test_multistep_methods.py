"""Multistep families against independent routes to their weights, and what each member says of itself."""

from collections.abc import Callable
from fractions import Fraction
from functools import cache

import mpmath as mp
import pytest

from bezstab.methods import (
    Family,
    LinearMultistep,
    Method,
    PredictorCorrector,
    adams_bashforth,
    adams_bashforth_moulton,
    bezier,
    closed_loop_at,
    is_schur,
    lookup,
    recursion_verdict,
)
from bezstab.methods.multistep_methods import bdf
from tests.methods.exact_lists import fractions
from tests.reference.bezier_curves import de_casteljau_weights, limit_weight


def multistep(method: Method) -> LinearMultistep:
    assert isinstance(method.scheme, LinearMultistep)
    return method.scheme


def pece(method: Method) -> PredictorCorrector:
    assert isinstance(method.scheme, PredictorCorrector)
    return method.scheme


def weights(method: Method) -> tuple[Fraction, ...]:
    """b_0, b_1, ... of y_{k+1} = y_k + h sum_j b_j f_{k-j}."""
    scheme = multistep(method)
    assert scheme.rho == (1, -1, *[0] * (scheme.steps - 1))
    assert scheme.sigma[0] == 0
    return scheme.sigma[1:]


@pytest.mark.parametrize(
    ("n", "expected"),
    [
        (1, "1"),
        (2, "3/2 -1/2"),
        (3, "19/12 -2/3 1/12"),
        (4, "175/108 -3/4 5/36 -1/108"),
    ],
)
def test_bezier_weights_are_those_of_theory(n: int, expected: str) -> None:
    assert weights(bezier(n)) == fractions(expected)


def test_bezier_two_is_adams_bashforth_two() -> None:
    assert bezier(2).scheme == adams_bashforth(2).scheme


def test_bezier_one_is_adams_bashforth_one() -> None:
    assert bezier(1).scheme == adams_bashforth(1).scheme


@pytest.mark.promise(
    "Coefficients of the built-in methods",
    proven="are exact; each family has a second route to its weights",
)
@pytest.mark.parametrize("n", range(2, 13))
def test_bezier_step_integrates_the_curve_of_de_casteljau(n: int) -> None:
    assert list(weights(bezier(n))) == de_casteljau_weights(n)


@pytest.mark.parametrize("n", range(2, 13))
def test_bezier_weights_alternate_and_integrate_straight_lines_only(n: int) -> None:
    b = weights(bezier(n))
    assert all(b_j * (-1) ** j > 0 for j, b_j in enumerate(b))
    moments = [sum(b_j * (-j) ** p for j, b_j in enumerate(b)) for p in range(3)]
    # the Bernstein curve of t^2, t in steps, is t^2 plus the variance of the binomial law, -t (t + m)/m
    assert moments == [1, Fraction(1, 2), Fraction(1, 3) - (Fraction(1, 3 * (n - 1)) + Fraction(1, 2))]


@cache
def long_bezier_weights(m: int) -> tuple[Fraction, ...]:
    """Return the weights of the Bezier method of m + 1 steps: made once, and looked at for every j."""
    return weights(bezier(m + 1))


@pytest.mark.parametrize("j", range(6))
def test_bezier_weights_converge_to_their_limit_like_one_over_m(j: int) -> None:
    limit, slope = limit_weight(j)

    def slope_error(m: int) -> mp.mpf:
        b = long_bezier_weights(m)[j]
        return m * (mp.mpf(b.numerator) / b.denominator - limit) - slope

    assert abs(slope_error(128)) < abs(slope) / 8
    # what is left is of order 1/m again: doubling m halves it, up to O(1/m)
    assert abs(slope_error(64) / slope_error(128) - 2) < 0.2


@pytest.mark.parametrize(
    ("n", "expected"),
    [
        (2, "3/2 -1/2"),
        (3, "23/12 -4/3 5/12"),
        (4, "55/24 -59/24 37/24 -9/24"),
        (5, "1901/720 -2774/720 2616/720 -1274/720 251/720"),
    ],
)
def test_adams_bashforth_weights_are_classical(n: int, expected: str) -> None:
    assert weights(adams_bashforth(n)) == fractions(expected)


@pytest.mark.promise("Coefficients of the built-in methods")
@pytest.mark.parametrize("n", range(1, 9))
def test_adams_bashforth_integrates_every_polynomial_its_points_determine(n: int) -> None:
    b = weights(adams_bashforth(n))
    for p in range(n):
        assert sum(b_j * (-j) ** p for j, b_j in enumerate(b)) == Fraction(1, p + 1)
    assert sum(b_j * (-j) ** n for j, b_j in enumerate(b)) != Fraction(1, n + 1)


@pytest.mark.parametrize(
    ("n", "predictor", "corrector"),
    [
        (2, "3/2 -1/2", "1/2 1/2 0"),
        (3, "23/12 -4/3 5/12", "5/12 8/12 -1/12 0"),
        (4, "55/24 -59/24 37/24 -9/24", "9/24 19/24 -5/24 1/24 0"),
    ],
)
def test_adams_bashforth_moulton_weights_are_classical(n: int, predictor: str, corrector: str) -> None:
    scheme = pece(adams_bashforth_moulton(n))
    assert scheme.predictor.sigma == (0, *fractions(predictor))
    assert scheme.corrector.sigma == fractions(corrector)
    assert scheme.predictor.rho == scheme.corrector.rho == (1, -1, *[0] * (n - 1))


@pytest.mark.parametrize(
    ("name", "rho", "sigma"),
    [
        ("implicit-euler", "1 -1", "1 0"),
        ("trapezoid", "1 -1", "1/2 1/2"),
        ("bdf1", "1 -1", "1 0"),
        ("bdf2", "1 -4/3 1/3", "2/3 0 0"),
        ("bdf3", "1 -18/11 9/11 -2/11", "6/11 0 0 0"),
        ("bdf4", "1 -48/25 36/25 -16/25 3/25", "12/25 0 0 0 0"),
        ("am2", "1 -1", "1/2 1/2"),
        ("am3", "1 -1 0", "5/12 8/12 -1/12"),
        ("am4", "1 -1 0 0", "9/24 19/24 -5/24 1/24"),
        ("am5", "1 -1 0 0 0", "251/720 646/720 -264/720 106/720 -19/720"),
    ],
)
def test_multistep_coefficients_are_classical(name: str, rho: str, sigma: str) -> None:
    assert multistep(lookup(name)) == LinearMultistep(fractions(rho), fractions(sigma))


@pytest.mark.parametrize("n", range(1, 7))
def test_bdf_differentiates_every_polynomial_its_points_determine(n: int) -> None:
    scheme = multistep(bdf(n))
    assert scheme.sigma[1:] == (0,) * n
    for p in range(n + 1):
        at_points = sum(c * Fraction(-j) ** p for j, c in enumerate(scheme.rho))
        assert at_points == scheme.sigma[0] * (1 if p == 1 else 0)  # the slope of t^p at t = 0, the new point
    assert sum(c * Fraction(-j) ** (n + 1) for j, c in enumerate(scheme.rho)) != 0


def test_there_is_no_seventh_bdf() -> None:
    with pytest.raises(ValueError, match="zero-unstable"):
        bdf(7)


@pytest.mark.parametrize("n", range(2, 7))
def test_adams_moulton_integrates_every_polynomial_its_points_determine(n: int) -> None:
    scheme = multistep(lookup(f"am{n}"))
    assert scheme.rho == (1, -1, *[0] * (n - 2))
    for p in range(n):
        assert sum(b * Fraction(1 - j) ** p for j, b in enumerate(scheme.sigma)) == Fraction(1, p + 1)


@pytest.mark.parametrize(
    ("name", "ratio"), [("bdf3", "0.0692"), ("bdf4", "0.2865"), ("bdf5", "0.6179"), ("bdf6", "0.9519")]
)
def test_bdf_is_stable_at_all_steps_above_the_damping_ratio_of_theory(name: str, ratio: str) -> None:
    """To its four digits: on a grid of steps above it, and somewhere unstable just below it."""
    method = lookup(name)
    step_grid = [Fraction(3, 2) ** k for k in range(-6, 12)] + [Fraction(k, 8) for k in range(1, 48)]

    def stable(zeta: Fraction) -> bool:
        return all(is_schur(closed_loop_at(method, 2 * zeta * beta_h, beta_h**2)) for beta_h in step_grid)

    assert stable(Fraction(ratio) + Fraction(1, 10**4))
    assert not stable(Fraction(ratio) - Fraction(1, 10**3))


@pytest.mark.parametrize(
    ("name", "limit"),
    [("am3", Fraction(6)), ("am4", Fraction(3)), ("am5", Fraction(90, 49)), ("am6", Fraction(45, 38))],
)
def test_adams_moulton_limits_where_alpha_is_beta_are_those_of_theory(name: str, limit: Fraction) -> None:
    tiny = Fraction(1, 10**20)
    for beta_h, verdict in ((limit - tiny, "converges"), (limit + tiny, "diverges")):
        assert recursion_verdict(closed_loop_at(lookup(name), 2 * beta_h, beta_h**2)) == verdict


@pytest.mark.parametrize("n", [2, 3, 4, 12])
@pytest.mark.parametrize(
    ("make", "name"),
    [(bezier, "Bezier"), (adams_bashforth, "Adams-Bashforth"), (adams_bashforth_moulton, "Adams-Bashforth-Moulton")],
)
def test_a_member_carries_its_family(make: Callable[[int], Method], name: str, n: int) -> None:
    assert make(n).family == Family(name, n)
