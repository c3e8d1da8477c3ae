"""The exact Schur-Cohn verdict, on polynomials multiplied together from roots that are known exactly."""

from collections import Counter
from fractions import Fraction
from functools import reduce

import pytest
import sympy as sp
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from bezstab.methods import Polynomial, Verdict, is_schur, recursion_verdict

Factor = tuple[
    Fraction, ...
]  # monic, irreducible over the reals: z - r, or z^2 - 2 a z + a^2 + b^2 for the pair a +- ib

ONE = Fraction(1)
TINY = Fraction(1, 10**20)

exactly = settings(deadline=None, max_examples=60)  # exact arithmetic has no bounded time per example


def real(r: Fraction) -> Factor:
    return ONE, -r


def pair(a: Fraction, b: Fraction) -> Factor:
    return ONE, -2 * a, a * a + b * b


def squared_modulus(factor: Factor) -> Fraction:
    return factor[-1] ** 2 if len(factor) == 2 else factor[-1]


def product(factors: list[Factor]) -> list[Fraction]:
    def times(p: list[Fraction], q: Factor) -> list[Fraction]:
        return [
            sum((p[i] * q[k - i] for i in range(len(p)) if 0 <= k - i < len(q)), Fraction(0))
            for k in range(len(p) + len(q) - 1)
        ]

    return reduce(times, factors, [ONE])


def scaled(p: Polynomial, s: Fraction) -> list[Fraction]:
    """The polynomial whose roots are s times those of p."""
    return [a * s**k for k, a in enumerate(p)]


def reciprocal(factor: Factor) -> Factor:
    """The factor with the roots 1/z."""
    return tuple(a / factor[-1] for a in factor[::-1])


def expected(factors: list[Factor]) -> Verdict:
    """Whatever the definition says of the known roots: irreducible factors share a root only if they are equal."""
    if any(squared_modulus(f) > 1 or (squared_modulus(f) == 1 and n > 1) for f, n in Counter(factors).items()):
        return "diverges"
    return "marginal" if any(squared_modulus(f) == 1 for f in factors) else "converges"


rationals = st.fractions(-2, 2, max_denominator=12)
anywhere = st.builds(real, rationals) | st.builds(pair, rationals, rationals.filter(bool))
inside = anywhere.filter(lambda f: squared_modulus(f) < 1)
outside = anywhere.filter(lambda f: squared_modulus(f) > 1)
# t = tan(theta/2) rational gives every rational point of the circle but -1: Pythagorean triples
on_circle = st.sampled_from([real(ONE), real(-ONE)]) | st.fractions(-3, 3, max_denominator=9).filter(bool).map(
    lambda t: pair((1 - t * t) / (1 + t * t), 2 * t / (1 + t * t))
)


def several(factors: st.SearchStrategy[Factor], least: int = 0) -> st.SearchStrategy[list[Factor]]:
    """Up to four draws, each of multiplicity one to three."""
    repeated = st.tuples(factors, st.integers(1, 3)).map(lambda drawn: [drawn[0]] * drawn[1])
    return st.lists(repeated, min_size=least, max_size=4).map(lambda lists: [f for fs in lists for f in fs])


@exactly
@given(several(inside | on_circle | outside))
def test_verdict_is_that_of_the_known_roots(factors: list[Factor]) -> None:
    assert recursion_verdict(product(factors)) == expected(factors)


@exactly
@given(several(inside), st.lists(on_circle, unique=True, max_size=4))
def test_bounded_if_and_only_if_the_roots_on_the_circle_are_simple(inner: list[Factor], circle: list[Factor]) -> None:
    assert recursion_verdict(product(inner + circle)) == ("marginal" if circle else "converges")
    for repeated in circle:
        assert recursion_verdict(product([*inner, *circle, repeated])) == "diverges"


@exactly
@given(several(inside | on_circle | outside))
def test_schur_if_and_only_if_every_known_root_is_inside(factors: list[Factor]) -> None:
    assert is_schur(product(factors)) == all(squared_modulus(f) < 1 for f in factors)


@settings(deadline=None, max_examples=30)  # numbers of 20 digits to the power of the degree take their time
@given(several(inside), st.lists(on_circle, unique=True, min_size=1, max_size=4))
def test_one_part_in_ten_to_the_twenty_off_the_circle_decides(inner: list[Factor], circle: list[Factor]) -> None:
    p = product(inner + circle)
    assert [recursion_verdict(scaled(p, s)) for s in (1 - TINY, ONE, 1 + TINY)] == ["converges", "marginal", "diverges"]


@exactly
@given(several(inside | on_circle), several(outside, least=1))
def test_one_root_outside_diverges_whatever_the_others_do(bounded: list[Factor], unbounded: list[Factor]) -> None:
    assert recursion_verdict(product(bounded + unbounded[:1])) == "diverges"


@exactly
@given(several(inside, least=1), st.lists(on_circle, unique=True, max_size=3))
def test_roots_in_pairs_z_and_one_over_z_diverge(inner: list[Factor], circle: list[Factor]) -> None:
    """Such a polynomial is reciprocal like one with all its roots on the circle: gcd(P, P*) = P for both."""
    assume(all(f[-1] for f in inner))
    assert recursion_verdict(product(inner + list(map(reciprocal, inner)) + circle)) == "diverges"


@exactly
@given(several(inside | on_circle | outside), rationals.filter(bool), st.integers(0, 3))
def test_a_constant_factor_and_leading_zeros_change_nothing(factors: list[Factor], c: Fraction, zeros: int) -> None:
    p = [Fraction(0)] * zeros + [c * a for a in product(factors)]
    assert recursion_verdict(p) == expected(factors)
    assert is_schur(p) == (expected(factors) == "converges")


@exactly
@given(several(inside | on_circle | outside), st.integers(1, 4))
def test_roots_at_zero_change_nothing(factors: list[Factor], zeros: int) -> None:
    assert recursion_verdict(product(factors) + [Fraction(0)] * zeros) == expected(factors)


@pytest.mark.parametrize("c", [Fraction(1), Fraction(-7, 3), TINY])
def test_a_constant_has_no_root_and_converges(c: Fraction) -> None:
    assert is_schur([c])
    assert recursion_verdict([c]) == "converges"


@pytest.mark.parametrize("length", [1, 2, 5])
def test_the_zero_polynomial_has_no_verdict(length: int) -> None:
    with pytest.raises(ZeroDivisionError):
        recursion_verdict([Fraction(0)] * length)


@pytest.mark.parametrize("n", range(1, 25))
def test_roots_of_unity_are_marginal_and_their_squares_diverge(n: int) -> None:
    unity = (ONE, *[Fraction(0)] * (n - 1), -ONE)
    assert recursion_verdict(unity) == "marginal"
    assert recursion_verdict(product([unity, unity])) == "diverges"
    assert not is_schur(unity)


@pytest.mark.parametrize("n", range(1, 25))
def test_cyclotomic_polynomials_are_marginal_and_share_roots_only_with_themselves(n: int) -> None:
    z = sp.Symbol("z")
    this, following = (
        tuple(map(Fraction, map(int, sp.cyclotomic_poly(k, z, polys=True).all_coeffs()))) for k in (n, n + 1)
    )
    assert recursion_verdict(this) == "marginal"
    assert recursion_verdict(product([this, following])) == "marginal"
    assert recursion_verdict(product([this, following, this])) == "diverges"


def test_lehmers_polynomial_diverges_by_the_smallest_known_salem_number() -> None:
    """Eight simple roots on the circle, one at 1.17628..., one at its reciprocal (D. H. Lehmer, 1933)."""
    lehmer = [Fraction(a) for a in (1, 1, 0, -1, -1, -1, -1, -1, 0, 1, 1)]
    assert recursion_verdict(lehmer) == "diverges"
    assert recursion_verdict(scaled(lehmer, Fraction("0.85013"))) == "converges"  # 1 / 1.1762808 = 0.850137
    assert recursion_verdict(scaled(lehmer, Fraction("0.85014"))) == "diverges"
