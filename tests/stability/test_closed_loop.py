import contextlib
from collections.abc import Sequence
from decimal import ROUND_DOWN, ROUND_HALF_EVEN, Decimal
from fractions import Fraction
from typing import Any

import mpmath
import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from bezstab.errors import NumericalError
from bezstab.methods import (
    LinearMultistep,
    closed_loop_at,
    lookup,
)
from bezstab.rationals import rational
from bezstab.stability import dominant_pole, poles, spectral_radius, verdict
from tests.methods.kinds import EXPLICIT, FEW, IMPLICIT, sampled
from tests.reference.companion_poles import radius
from tests.reference.fifty_digit_poles import poles_with_errors

F = Fraction
NAMES = [*EXPLICIT, "RK4@5"]
LONG = {"B6", "B7", "B8", "B9", "B10", "B11", "B12", "AB6", "AB7"}
"""Methods of many steps, whose polynomials are long: AB8 is looked at each time, these in make test-slow."""


def by_length(names: Sequence[str]) -> list[Any]:
    """Return the names as parameters, the long ones marked as slow."""
    return [pytest.param(name, marks=[pytest.mark.slow] if name in LONG else []) for name in names]


TABLE_5 = {  # paper, as printed: real, imaginary part, modulus, angle
    ("B4", "0.1", "0.1"): "0.898 0.299 0.947 18.45",
    ("B4", "0.5", "0.1"): "0.763 0.142 0.776 10.55",
    ("B4", "0.5", "0.101"): "0.762 0.144 0.776 10.69",
    ("AB4", "0.1", "0.1"): "0.906 0.291 0.952 17.83",
    ("AB4", "0.5", "0.1"): "-0.903 0.428 0.999 154.6",
    ("AB4", "0.5", "0.101"): "-0.903 0.433 1.001 154.4",
    ("RK4@5", "0.1", "0.1"): "0.074 0.740 0.744 84.27",
    ("RK4@5", "0.5", "0.1"): "0.095 0.237 0.255 68.15",
    ("RK4@5", "0.5", "0.101"): "0.090 0.241 0.258 69.45",
    ("SIE", "0.1", "0.1"): "0.855 0.281 0.9 18.19",
    ("SIE", "0.5", "0.1"): "0.775 0.097 0.781 7.12",
    ("SIE", "0.5", "0.101"): "0.774 0.098 0.780 7.22",
}

PRESETS = {  # shared derivation of each engine's preset: spectral radius for SYM RK1 RK2 RK3 RK4 AB2 AB3 AB4
    (2, 2): "2.4142 1.0000 0.0000 0.4714 0.3727 1.6801 2.5147 3.3330",
    (2, 1): "1.6180 0.0000 0.5000 0.3333 0.3750 1.0000 1.7910 2.5283",
    (1, 0.25): "0.7500 0.5000 0.6250 0.6042 0.6068 0.6404 0.9239 1.4373",
    (1, 0.2): "0.8000 0.7236 0.7618 0.7583 0.7585 0.7659 1.3041 1.9231",
    (0.2, 0.01): "0.9270 0.9000 0.9050 0.9048 0.9048 0.9052 0.9048 0.9048",
    (0.01, 2.5e-5): "0.9953 0.9950 0.9950 0.9950 0.9950 0.9950 0.9950 0.9950",
}


@pytest.mark.parametrize("case", TABLE_5, ids=str)
def test_the_papers_table_5_comes_out_to_every_digit_it_prints(case: tuple[str, str, str]) -> None:
    name, alpha_hat, beta_hat = case
    z = complex(dominant_pole(lookup(name), float(alpha_hat), float(beta_hat)))
    computed = (z.real, z.imag, abs(z), np.degrees(np.angle(z)))
    for value, printed in zip(computed, TABLE_5[case].split(), strict=True):
        unit = Decimal(1).scaleb(-len(printed.partition(".")[2]))
        roundings = [Decimal(float(value)).quantize(unit, way) for way in (ROUND_DOWN, ROUND_HALF_EVEN)]
        assert Decimal(printed) in roundings  # the paper rounds some digits and truncates others


@pytest.mark.parametrize("point", PRESETS, ids=str)
def test_the_preset_points_of_the_engines(point: tuple[float, float]) -> None:
    names = ["SYM", "RK1", "RK2", "RK3", "RK4", "AB2", "AB3", "AB4"]
    for name, printed in zip(names, PRESETS[point].split(), strict=True):
        assert float(spectral_radius(lookup(name), *point)) == pytest.approx(
            float(printed), abs=5.1e-5
        )  # four decimals


POINTS = [
    (0.5, 0.1), (1e-12, 1e-12), (1e-12, 1e12), (1e12, 1e-12), (1e12, 1e12), (1e6, 1e-6), (0.0, 0.3), (0.3, 0.0),
    (1.0, 0.25), (0.1, 0.0025), (0.7, 0.1225), (1e-6, 2.5e-13), (-0.3, 0.2), (0.2, -0.4), (2.0, 2.0), (0.0, 0.0),
    (1.0, 2.0), (1.5, 0.5), (2.0, 1.0), (1.0, 0.0), (27 / 17, (27 / 34) ** 2),  # on one boundary or another
]  # fmt: skip


@pytest.mark.promise(
    "Poles",
    computed="50 roundings times their condition, against fifty digits; of 2 n poles none missing",
)
@pytest.mark.parametrize("name", sampled(NAMES, quick=[*FEW, "AB8", "dopri5"]))
@pytest.mark.slow_except("RK4", "dopri5", "SIE", "ABM3", "B4")
def test_poles_agree_with_fifty_digits(name: str) -> None:
    method = lookup(name)
    with mpmath.workdps(50):
        for alpha_hat, beta_hat in POINTS:
            found = list(poles(method, alpha_hat, beta_hat))
            for exact, allowed in sorted(poles_with_errors(method, alpha_hat, beta_hat), key=lambda pair: pair[1]):
                k = min(range(len(found)), key=lambda i: abs(found[i] - exact))
                assert abs(found.pop(k) - exact) <= allowed, (alpha_hat, beta_hat, complex(exact))


@pytest.mark.promise("Near-double poles")
@pytest.mark.parametrize("name", sampled(NAMES))
def test_a_pole_does_not_depend_on_its_neighbours_in_the_array(name: str) -> None:
    method, random = lookup(name), np.random.default_rng(1)
    axis = np.concatenate([[0.0], np.geomspace(1e-12, 1e12, 13), np.linspace(-2, 4, 27)])
    a, b = (x.ravel() for x in np.meshgrid(axis, axis))
    shuffle = random.permutation(a.size)
    together = spectral_radius(method, a, b)
    assert np.isfinite(together).all()
    # 1e-4: the fourth root of eps, for ABM4 has a quadruple root at z = 1
    assert spectral_radius(method, a[shuffle], b[shuffle]) == pytest.approx(together[shuffle], rel=1e-3, abs=1e-3)
    few = random.permutation(a.size)[:40]
    alone = [float(spectral_radius(method, a[i], b[i])) for i in few]
    assert together[few] == pytest.approx(alone, rel=1e-3, abs=1e-3)


@pytest.mark.parametrize("name", NAMES)
def test_the_poles_satisfy_vieta(name: str) -> None:
    z = poles(lookup(name), 0.37, 0.21)
    exact = [float(c) for c in closed_loop_at(lookup(name), F(0.37), F(0.21))]
    assert np.poly(z).real == pytest.approx(exact, abs=1e-12 * max(map(abs, exact)))  # sums of products, rounded


def test_shapes_broadcast_with_the_root_axis_last() -> None:
    method = lookup("B3")
    assert poles(method, np.zeros((4, 1)), np.zeros(5)).shape == (4, 5, 6)
    assert dominant_pole(method, np.zeros((4, 1)), np.zeros(5)).shape == (4, 5)
    assert poles(method, 0.1, 0.1).shape == (6,)
    assert spectral_radius(method, np.empty((0, 3)), 0.1).shape == (0, 3)


@pytest.mark.parametrize("name", sampled(NAMES))
@given(st.floats(-1, 4), st.floats(-1, 4))
@settings(max_examples=25, deadline=None)
def test_the_dominant_pole_is_the_largest_and_in_the_upper_half(name: str, alpha_hat: float, beta_hat: float) -> None:
    z = complex(dominant_pole(lookup(name), alpha_hat, beta_hat))
    assert z.imag >= 0
    # 1e-3: two paths to the same roots, which near multiple ones agree to the fourth root of eps only
    assert abs(z) == pytest.approx(np.abs(poles(lookup(name), alpha_hat, beta_hat)).max(), abs=1e-3)


@pytest.mark.promise("A verdict", proven="is right on the boundary itself, and 1e-20 to either side")
@pytest.mark.parametrize(
    ("name", "alpha_hat", "beta_hat"), [("SYM", F(1), F(2)), ("AB2", F(3, 2), F(1, 2)), ("RK1", F(2), F(2))]
)
def test_the_verdict_is_right_on_the_boundary_itself(name: str, alpha_hat: Fraction, beta_hat: Fraction) -> None:
    method, tiny = lookup(name), F(1, 10**20)
    assert verdict(method, alpha_hat, beta_hat) == "marginal"
    for da, db in ((tiny, F(0)), (F(0), tiny)):
        sides = {verdict(method, alpha_hat + sign * da, beta_hat + sign * db) for sign in (-1, 1)}
        assert sides == {"converges", "diverges"}


MULTISTEP = [name for name in EXPLICIT if isinstance(lookup(name).scheme, LinearMultistep)]


@pytest.mark.promise("A verdict")
@pytest.mark.parametrize("name", by_length(MULTISTEP))
@given(st.fractions(F(1, 100), F(99, 100), max_denominator=1000), st.booleans())
@settings(max_examples=10, deadline=None)
def test_only_the_exact_verdict_knows_the_straight_edges(name: str, part: Fraction, along_alpha: bool) -> None:
    scheme, tiny = lookup(name).scheme, F(1, 10**20)
    assert isinstance(scheme, LinearMultistep)
    # one mu where z = -1, the other further in: P(-1) = 0 exactly, and that root is simple
    edge = sum(c * (-1) ** k for k, c in enumerate(scheme.rho)) / sum(c * (-1) ** k for k, c in enumerate(scheme.sigma))
    a, b = -(edge + part * edge), edge * part * edge
    step = (tiny, F(0)) if along_alpha else (F(0), tiny)
    verdicts = [verdict(lookup(name), a + sign * step[0], b + sign * step[1]) for sign in (-1, 0, 1)]
    assert verdicts[1] == "marginal"
    assert {verdicts[0], verdicts[2]} == {"converges", "diverges"}


def test_a_repeated_root_on_the_circle_diverges() -> None:
    assert verdict(lookup("AB2"), F(2), F(1)) == "diverges"


@pytest.mark.parametrize("name", NAMES)
def test_without_feedback_the_constraint_error_grows(name: str) -> None:
    assert verdict(lookup(name), F(0), F(0)) == "diverges"
    assert verdict(lookup(name), F(1, 100), F(0)) == "marginal"
    assert verdict(lookup(name), F(1, 100), F(-1, 1000)) == "diverges"
    assert verdict(lookup(name), F(-1, 100), F(1, 1000)) == "diverges"


def test_the_taylor_rule_is_deadbeat_for_midpoint() -> None:
    assert verdict(lookup("RK2"), F(2), F(2)) == "converges"
    assert float(spectral_radius(lookup("RK2"), 2, 2)) == 0


@pytest.mark.parametrize("name", sampled(NAMES, quick=FEW))
@given(st.fractions(-1, 6, max_denominator=1000), st.fractions(-1, 9, max_denominator=1000))
@settings(max_examples=25, deadline=None)
def test_away_from_the_boundary_the_proof_agrees_with_the_number(name: str, a: Fraction, b: Fraction) -> None:
    z_abs = float(spectral_radius(lookup(name), float(a), float(b)))
    assume(abs(z_abs - 1) > 1e-3)  # ABM4's quadruple root at z = 1 keeps a quarter of the digits
    assert verdict(lookup(name), a, b) == ("converges" if z_abs < 1 else "diverges")


@pytest.mark.promise("Overflow", computed="reported, never returned")
@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("point", [(1e300, 1e300), (-1e300, 1e-300), (1e-300, 1e300), (1e160, -1e307)])
def test_overflow_is_reported_never_returned(name: str, point: tuple[float, float]) -> None:
    with contextlib.suppress(NumericalError):
        assert np.isfinite(poles(lookup(name), *point)).all()


# Implicit methods: on P's leading coefficient a pole is infinite.

NO_SOLUTION = [("implicit-euler", "-2", "1"), ("trapezoid", "-3", "2"), ("bdf2", "-3", "9/4"), ("radau3", "-4", "6")]


@pytest.mark.parametrize(("name", "alpha_hat", "beta_hat"), NO_SOLUTION)
def test_where_a_step_has_no_solution_a_pole_is_infinite(name: str, alpha_hat: str, beta_hat: str) -> None:
    method, point = lookup(name), (F(alpha_hat), F(beta_hat))
    assert closed_loop_at(method, *point)[0] == 0
    assert verdict(method, *point) == "diverges"
    assert spectral_radius(method, *map(float, point)) > 1e14  # infinite, or as rounding of its coefficients has it
    for ask in (poles, dominant_pole):
        with pytest.raises(NumericalError, match="no solution"):
            ask(method, *map(float, point))


@pytest.mark.parametrize("name", IMPLICIT)
def test_implicit_poles_are_the_companions_eigenvalues(name: str) -> None:
    random = np.random.default_rng(5)
    alpha_hat, beta_hat = random.uniform(-1, 12, 400), random.uniform(-1, 30, 400)
    z_abs = spectral_radius(lookup(name), alpha_hat, beta_hat)
    assert z_abs == pytest.approx(radius(lookup(name), alpha_hat, beta_hat), rel=1e-6)  # near double poles half of them


@pytest.mark.parametrize("name", IMPLICIT)
def test_the_verdict_of_an_implicit_method_is_that_of_its_poles(name: str) -> None:
    random = np.random.default_rng(6)
    for alpha_hat, beta_hat in np.round(random.uniform(-2, 10, (40, 2)), 3):
        proven = verdict(lookup(name), rational(str(alpha_hat)), rational(str(beta_hat)))
        z_abs = spectral_radius(lookup(name), alpha_hat, beta_hat)
        if abs(z_abs - 1) > 1e-9:
            assert (proven == "converges") == (z_abs < 1)
