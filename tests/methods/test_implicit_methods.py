"""BDF, Adams-Moulton and implicit Runge-Kutta methods: classical coefficients, order conditions, limits of theory."""

from fractions import Fraction

import pytest

from bezstab.methods import (
    LinearMultistep,
    Method,
    RungeKutta,
    closed_loop_at,
    coefficient_table,
    is_schur,
    lookup,
    recursion_verdict,
)
from bezstab.methods.implicit_methods import bdf
from tests.methods.exact_lists import fractions

F = Fraction
FORTY_DIGITS = F(
    1, 10**39
)  # each coefficient is within 1e-40 of the irrational one, sums of a few within ten times that


def multistep(name: str) -> LinearMultistep:
    scheme = lookup(name).scheme
    assert isinstance(scheme, LinearMultistep)
    return scheme


def runge_kutta(name: str) -> RungeKutta:
    scheme = lookup(name).scheme
    assert isinstance(scheme, RungeKutta)
    return scheme


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
    assert multistep(name) == LinearMultistep(fractions(rho), fractions(sigma))


@pytest.mark.parametrize("n", range(1, 7))
def test_bdf_differentiates_every_polynomial_its_points_determine(n: int) -> None:
    scheme = multistep(f"bdf{n}")
    assert scheme.sigma[1:] == (0,) * n
    for p in range(n + 1):
        at_points = sum(c * F(-j) ** p for j, c in enumerate(scheme.rho))
        assert at_points == scheme.sigma[0] * (1 if p == 1 else 0)  # the slope of t^p at t = 0, the new point
    assert sum(c * F(-j) ** (n + 1) for j, c in enumerate(scheme.rho)) != 0


def test_there_is_no_seventh_bdf() -> None:
    with pytest.raises(ValueError, match="zero-unstable"):
        bdf(7)


@pytest.mark.parametrize("n", range(2, 7))
def test_adams_moulton_integrates_every_polynomial_its_points_determine(n: int) -> None:
    scheme = multistep(f"am{n}")
    assert scheme.rho == (1, -1, *[0] * (n - 2))
    for p in range(n):
        assert sum(b * F(1 - j) ** p for j, b in enumerate(scheme.sigma)) == F(1, p + 1)


@pytest.mark.parametrize(
    ("name", "ratio"), [("bdf3", "0.0692"), ("bdf4", "0.2865"), ("bdf5", "0.6179"), ("bdf6", "0.9519")]
)
def test_bdf_is_stable_at_all_steps_above_the_damping_ratio_of_theory(name: str, ratio: str) -> None:
    """To its four digits: on a grid of steps above it, and somewhere unstable just below it."""
    method = lookup(name)
    step_grid = [F(3, 2) ** k for k in range(-6, 12)] + [F(k, 8) for k in range(1, 48)]

    def stable(zeta: Fraction) -> bool:
        return all(is_schur(closed_loop_at(method, 2 * zeta * beta_h, beta_h**2)) for beta_h in step_grid)

    assert stable(F(ratio) + F(1, 10**4))
    assert not stable(F(ratio) - F(1, 10**3))


@pytest.mark.parametrize(("name", "limit"), [("am3", F(6)), ("am4", F(3)), ("am5", F(90, 49)), ("am6", F(45, 38))])
def test_adams_moulton_limits_where_alpha_is_beta_are_those_of_theory(name: str, limit: Fraction) -> None:
    tiny = F(1, 10**20)
    for beta_h, verdict in ((limit - tiny, "converges"), (limit + tiny, "diverges")):
        assert recursion_verdict(closed_loop_at(lookup(name), 2 * beta_h, beta_h**2)) == verdict


def growth(method: Method) -> tuple[list[Fraction], list[Fraction]]:
    """Return numerator and denominator of R(mu), ascending: pi = denominator z - numerator."""
    constant, linear = coefficient_table(method)
    return [-c for c in constant], list(linear)


def test_the_growth_of_gauss_is_the_diagonal_pade_approximant() -> None:
    assert growth(lookup("implicit-midpoint")) == ([1, F(1, 2)], [1, F(-1, 2)])
    numerator, denominator = growth(lookup("gauss4"))
    assert all(abs(c - e) < FORTY_DIGITS for c, e in zip(numerator, (F(1), F(1, 2), F(1, 12)), strict=True))
    assert [(-1) ** j * c for j, c in enumerate(denominator)] == numerator  # so |R| = 1 on the axis, exactly: A-stable


def test_the_growth_of_radau_is_the_subdiagonal_pade_approximant() -> None:
    numerator, denominator = growth(lookup("radau3"))
    assert numerator[:2] == [1, F(1, 3)]
    assert not any(numerator[2:])
    assert denominator == [1, F(-2, 3), F(1, 6)]


@pytest.mark.parametrize("name", ["sdirk2", "dirk3", "radau3"])
def test_stiffly_accurate_methods_end_with_their_last_stage_and_forget_what_is_infinitely_stiff(name: str) -> None:
    scheme = runge_kutta(name)
    assert scheme.tableau[-1] == scheme.weights
    numerator, denominator = growth(lookup(name))
    highest = max(j for j, c in enumerate(numerator) if c)
    assert highest < max(j for j, c in enumerate(denominator) if c)


@pytest.mark.parametrize("name", ["sdirk2", "dirk3"])
def test_singly_diagonal_methods_have_one_gamma_on_the_diagonal_and_none_above(name: str) -> None:
    tableau = runge_kutta(name).tableau
    assert len({row[i] for i, row in enumerate(tableau)}) == 1
    assert not any(any(row[i + 1 :]) for i, row in enumerate(tableau))


def test_sdirk2_is_a_stable_as_rounded() -> None:
    """|R(iy)| <= 1 if and only if (1 - 2 g)^2 <= 2 g^2 (|Q|^2 - |P|^2 in powers of y)."""
    gamma = runge_kutta("sdirk2").tableau[0][0]
    assert (1 - 2 * gamma) ** 2 <= 2 * gamma**2
    assert abs(2 * gamma**2 - 4 * gamma + 1) < 10 * FORTY_DIGITS


def test_alexanders_gamma_is_the_root_of_his_cubic() -> None:
    scheme = runge_kutta("dirk3")
    gamma = scheme.tableau[0][0]
    assert abs(gamma**3 - 3 * gamma**2 + F(3, 2) * gamma - F(1, 6)) < FORTY_DIGITS
    assert round(float(gamma), 10) == 0.4358665215
    nodes = [sum(row) for row in scheme.tableau]
    assert sum(b * c for b, c in zip(scheme.weights, nodes, strict=True)) == F(1, 2)
    assert abs(sum((b * c**2 for b, c in zip(scheme.weights, nodes, strict=True)), F(0)) - F(1, 3)) < FORTY_DIGITS


def test_gauss_nodes_are_half_minus_and_plus_root_three_sixths() -> None:
    nodes = [sum(row, F(0)) for row in runge_kutta("gauss4").tableau]
    assert sum(nodes) == 1
    assert abs(12 * (nodes[1] - F(1, 2)) ** 2 - 1) < 10 * FORTY_DIGITS


def test_radau_coefficients_are_classical() -> None:
    assert runge_kutta("radau3") == RungeKutta((fractions("5/12 -1/12"), fractions("3/4 1/4")), fractions("3/4 1/4"))


def test_radau5_is_scipys() -> None:
    """Hairer & Wanner II, Table IV.5.6: the nodes, and the weights (16 -+ sqrt 6)/36 and 1/9."""
    scheme = runge_kutta("radau5")
    first, second, third = (sum(row, F(0)) for row in scheme.tableau)
    assert third == 1
    for node in (first, second):
        assert abs(10 * node**2 - 8 * node + 1) < 100 * FORTY_DIGITS
    for weight in scheme.weights[:2]:
        assert abs((36 * weight - 16) ** 2 - 6) < 1000 * FORTY_DIGITS  # 36 * 2 sqrt 6 times what the weight is off
    assert abs(scheme.weights[2] - F(1, 9)) < FORTY_DIGITS
    assert scheme.tableau[-1] == scheme.weights


def test_radau5_is_a_stable_as_rounded() -> None:
    """|Q(iy)|^2 - |P(iy)|^2 of R = P/Q is c y^6 with c > 0 and nothing else, exactly."""
    numerator, denominator = growth(lookup("radau5"))

    def squared(polynomial: list[Fraction]) -> list[Fraction]:
        a0, a1, a2, a3 = [*polynomial, F(0)][:4]
        return [a0**2, a1**2 - 2 * a0 * a2, a2**2 - 2 * a1 * a3, a3**2]

    difference = [q - p for q, p in zip(squared(denominator), squared(numerator), strict=True)]
    assert not any(difference[:3])
    assert difference[3] > 0
