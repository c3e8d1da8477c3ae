"""Whether every sequence of steps decays: sympy confirms what proves it, and what refutes it."""

import math
from fractions import Fraction

import numpy as np
import pytest
import sympy as sp

from bezstab.methods.registry import lookup
from bezstab.methods.step_matrices import step_matrix
from bezstab.step_sequences.growing_sequences import grows
from bezstab.step_sequences.lyapunov_quadratics import proves_decay
from bezstab.step_sequences.varying_steps import Steps, VaryingSteps, varying_steps
from tests.reference.symbolic_steps import form_decreases, spectral_radius, symplectic_euler

TINY = Fraction(1, 10**9)


def symplectic(
    ratio: str, share: str, shortest: Fraction, hold: bool = False
) -> tuple[VaryingSteps, tuple[Fraction, Fraction], Steps]:
    """Return the verdict at alpha / beta = ratio, the point, and the steps, up to a share of the longest stable one."""
    damping = Fraction(ratio)
    longest = Fraction(2 * (math.sqrt(damping**2 + 1) - damping)).limit_denominator(10**6)  # beta h, at z = -1
    h = longest * Fraction(share)
    point, steps = (2 * damping * h, h * h), Steps(h * shortest, h, hold)
    return varying_steps(lookup("SYM"), *point, steps), point, steps


@pytest.mark.parametrize(
    ("ratio", "share", "shortest", "hold"),
    [("1/2", "0.94", TINY, False), ("2", "0.999", TINY, False), ("1", "0.9", Fraction(1, 2), True)],
)
def test_sympy_confirms_a_quadratic_certificate(ratio: str, share: str, shortest: Fraction, hold: bool) -> None:
    found, point, steps = symplectic(ratio, share, shortest, hold)
    assert (found.verdict, found.kind) == ("proven", "quadratic")
    assert found.certificate
    form = sp.Matrix([[sp.Rational(number) for number in row] for row in found.certificate])
    assert form_decreases(form, symplectic_euler(*point, hold), steps.shortest, Fraction(1))


@pytest.mark.parametrize(("ratio", "share"), [("1/10", "2/5"), ("1/5", "7/10"), ("1/2", "0.99")])
def test_sympy_confirms_a_growing_sequence(ratio: str, share: str) -> None:
    found, point, steps = symplectic(ratio, share, TINY)
    assert found.verdict == "refuted"
    assert found.sequence
    assert all(steps.h_min <= step <= steps.h_max for step in found.sequence)
    lengths = [step / steps.h_max for step in found.sequence]
    radius = spectral_radius(symplectic_euler(*point), lengths)
    assert radius >= 1
    assert found.growth == pytest.approx(float(radius), rel=1e-9)  # float64, of a product of few steps


BETWEEN = [  # shares of the longest stable step, steps from next to nothing
    ("1/10", TINY, False, "0.21", "0.345"),
    ("1/5", TINY, False, "0.44", "0.625"),
    ("1/2", TINY, False, "0.968", "0.980"),
    # held, it is weak feedback that grows: what is proven lies above what is refuted
    ("7/10", Fraction(1, 10), True, "0.53", "0.30"),
]


@pytest.mark.slow
@pytest.mark.parametrize(("ratio", "shortest", "hold", "proven", "refuted"), BETWEEN)
def test_between_the_best_form_and_the_first_sequence_it_is_not_known(
    ratio: str, shortest: Fraction, hold: bool, proven: str, refuted: str
) -> None:
    between = str((Fraction(proven) + Fraction(refuted)) / 2)
    for share, verdict in ((proven, "proven"), (between, "not known"), (refuted, "refuted")):
        assert symplectic(ratio, share, shortest, hold)[0].verdict == verdict


@pytest.mark.parametrize("ratio", ["7/10", "1", "3/2", "2"])
def test_with_enough_damping_the_limit_is_that_of_constant_steps(ratio: str) -> None:
    assert symplectic(ratio, "0.995", TINY)[0].verdict == "proven"
    beyond = symplectic(ratio, "1.005", TINY)[0]
    assert beyond.verdict == "refuted"
    assert beyond.sequence
    assert len(beyond.sequence) == 1


def test_steps_that_commute_need_only_be_stable_alone() -> None:
    for name in ("RK4@2", "implicit-euler", "gauss4"):
        found = varying_steps(lookup(name), Fraction("0.1"), Fraction(1, 4), Steps(TINY, Fraction(1)))
        assert (found.verdict, found.kind, found.certificate) == ("proven", "commuting", None)


@pytest.mark.parametrize("name", ["verlet-half", "verlet-predicted", "hht", "generalized-alpha"])
def test_a_state_of_three_is_proven_by_a_form(name: str) -> None:
    h = Fraction(1, 2)
    found = varying_steps(lookup(name), h / 2, h * h, Steps(h / 10, h))
    assert (found.verdict, found.kind) == ("proven", "quadratic")
    assert found.certificate
    assert len(found.certificate) == 3


# What proves and what refutes, each alone

ZERO, HALF, ONE = Fraction(0), Fraction(1, 2), Fraction(1)
IDENTITY = np.eye(2, dtype=object)


def test_a_product_on_the_unit_circle_does_not_decay() -> None:
    # average acceleration without damping keeps the energy, whatever the step
    matrix = step_matrix(lookup("average-acceleration"), ZERO, ONE)
    assert grows(matrix, [ONE, HALF])
    # with damping it loses some
    assert not grows(step_matrix(lookup("average-acceleration"), HALF, ONE), [ONE, HALF])


def test_a_form_that_is_not_positive_proves_nothing() -> None:
    # explicit Euler without damping: M^T M = 1 + s^2, so that -|x|^2 falls with each step
    assert not proves_decay(-IDENTITY, step_matrix(lookup("RK1"), ZERO, ONE), HALF)
