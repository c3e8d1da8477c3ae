from fractions import Fraction

import mpmath
import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from bezstab.errors import NumericalError
from bezstab.methods.derivation import closed_loop_at
from bezstab.methods.registry import lookup
from bezstab.methods.schemes import Method, RungeKutta
from bezstab.stability.closed_loop import all_within, dominant_pole, feedback_roots, poles, spectral_radius, verdict
from tests.methods.kinds import FEW, sampled
from tests.reference.fifty_digit_poles import poles_with_errors
from tests.reference.rationals import rationals
from tests.reference.second_order_methods import second_order

F = Fraction
POINTS = [
    (0.5, 0.1), (1e-12, 1e-12), (1e-12, 1e12), (1e12, 1e-12), (1e12, 1e12), (1e6, 1e-6), (0.0, 0.3), (0.3, 0.0),
    (1.0, 0.25), (0.1, 0.0025), (0.7, 0.1225), (1e-6, 2.5e-13), (-0.3, 0.2), (0.2, -0.4), (2.0, 2.0), (0.0, 0.0),
    (1.0, 2.0), (1.5, 0.5), (2.0, 1.0), (1.0, 0.0), (27 / 17, (27 / 34) ** 2),  # on one boundary or another
]  # fmt: skip


OTHERS = ["ABM4", "RK4@5", "AB8", "B12", "dopri5", "bdf3", "gauss4"]


@pytest.mark.parametrize("name", sampled([*FEW, *OTHERS], quick=["AB4", "ABM3", "RK4", "SIE"]))
def test_poles_agree_with_fifty_digits(name: str) -> None:
    method = lookup(name)
    with mpmath.workdps(50):
        for alpha_hat, beta_hat in POINTS:
            found = list(poles(method, alpha_hat, beta_hat))
            for exact, allowed in sorted(poles_with_errors(method, alpha_hat, beta_hat), key=lambda pair: pair[1]):
                k = min(range(len(found)), key=lambda i: abs(found[i] - exact))
                assert abs(found.pop(k) - exact) <= allowed, (alpha_hat, beta_hat, complex(exact))


def test_shapes_broadcast_with_the_root_axis_last() -> None:
    method = lookup("B3")
    assert poles(method, np.zeros((4, 1)), np.zeros(5)).shape == (4, 5, 6)
    assert dominant_pole(method, np.zeros((4, 1)), np.zeros(5)).shape == (4, 5)
    assert poles(method, 0.1, 0.1).shape == (6,)
    assert spectral_radius(method, np.empty((0, 3)), 0.1).shape == (0, 3)


@pytest.mark.parametrize(
    ("name", "alpha_hat", "beta_hat"), [("SYM", F(1), F(2)), ("AB2", F(3, 2), F(1, 2)), ("RK1", F(2), F(2))]
)
def test_the_verdict_is_right_on_the_boundary_itself(name: str, alpha_hat: Fraction, beta_hat: Fraction) -> None:
    method, tiny = lookup(name), F(1, 10**20)
    assert verdict(method, alpha_hat, beta_hat) == "marginal"
    for da, db in ((tiny, F(0)), (F(0), tiny)):
        sides = {verdict(method, alpha_hat + sign * da, beta_hat + sign * db) for sign in (-1, 1)}
        assert sides == {"converges", "diverges"}


@pytest.mark.parametrize("name", [*FEW, "RK4@5", "bdf2", "radau3"])
@given(rationals(-1, 6, max_denominator=30), rationals(-1, 9, max_denominator=30))
@settings(max_examples=15, deadline=None)
def test_away_from_the_boundary_the_proof_agrees_with_the_number(name: str, a: Fraction, b: Fraction) -> None:
    z_abs = float(spectral_radius(lookup(name), float(a), float(b)))
    assume(abs(z_abs - 1) > 1e-3)  # ABM4's quadruple root at z = 1 keeps a quarter of the digits
    assert verdict(lookup(name), a, b) == ("converges" if z_abs < 1 else "diverges")


# Implicit methods: on P's leading coefficient a pole is infinite.


@pytest.mark.parametrize(
    ("method", "point"),
    [
        (lookup("bdf2"), (F(-3), F(9, 4))),
        (second_order("implicit euler"), (F(-2), F(1))),
    ],
    ids=str,
)
def test_where_a_step_has_no_solution_a_pole_is_infinite(method: Method, point: tuple[Fraction, Fraction]) -> None:
    assert closed_loop_at(method, *point)[-1] == 0
    assert verdict(method, *point) == "diverges"
    assert np.isinf(spectral_radius(method, *map(float, point)))
    for ask in (poles, dominant_pole):
        with pytest.raises(NumericalError, match="no solution"):
            ask(method, *map(float, point))


@pytest.mark.parametrize("name", ["AB3", "ABM3", "bdf3", "verlet-old"])
def test_all_poles_are_within_a_level_where_the_largest_is(name: str) -> None:
    alpha_hat, beta_hat, level = np.random.default_rng(5).uniform(0, (3, 3, 1.2), (2000, 3)).T
    z_abs = spectral_radius(lookup(name), alpha_hat, beta_hat)
    clear = np.abs(z_abs - level) > 1e-6
    assert (all_within(lookup(name), alpha_hat, beta_hat, level) == (z_abs < level))[clear].all()


def both_mu(alpha_hat: float, beta_hat: float) -> tuple[complex, complex]:
    first, real, other = feedback_roots(lookup("B4"), np.array([alpha_hat]), np.array([beta_hat]))
    return complex(first[0]), complex(other[0] if real.size else first[0].conjugate())


@given(st.floats(1e-6, 1e6), st.floats(-1e-12, 1e-12))
@settings(deadline=None)
def test_next_to_the_parabola_both_mu_keep_their_digits(alpha_hat: float, off: float) -> None:
    beta_hat = alpha_hat**2 / 4 * (1 + off)
    with mpmath.workdps(50):
        p, q = mpmath.mpf(alpha_hat), mpmath.mpf(beta_hat)
        root = mpmath.sqrt(p * p / 4 - q)
        for mu in both_mu(alpha_hat, beta_hat):
            error = min(abs(mu - (-p / 2 + sign * root)) for sign in (1, -1))
            assert error <= 4 * 2.0**-52 * alpha_hat


def test_coefficients_beyond_float64_are_reported() -> None:
    huge, none = F(10) ** 90, F(0)
    rows = tuple(tuple(huge if column == row - 1 else none for column in range(4)) for row in range(4))
    method = Method("huge", RungeKutta(rows, (1 - huge, none, none, huge)), "constructed")  # R has huge^4 mu^4
    with pytest.raises(NumericalError, match="huge: products of its coefficients"):
        poles(method, 0.5, 0.1)
