"""Sweeps over many constraints: the numbers of runs and tables, exact verdicts, and limits that are known."""

from fractions import Fraction

import mpmath
import numpy as np
import pytest
import sympy
from hypothesis import given, settings
from hypothesis import strategies as st

from bezstab.engines.sweeping import Move, Pass, SweptStep, hard_velocity_step
from bezstab.errors import NumericalError
from bezstab.methods.schur import recursion_verdict
from bezstab.stability.arrays import FloatArray
from bezstab.stability.sweeps import Growth, chain, fewest_sweeps, inverse_effective_masses, swept_growth
from tests.reference.swept_chains import columns, hard_step, inverse_masses, position_step, soft_step


@pytest.mark.parametrize(
    ("bodies", "ratio", "fewest"),
    [(5, 1, (1, 2, 5)), (20, 1, (16, 30, 66)), (10, 100, (89, 170, 376))],
)
def test_the_fewest_stable_sweeps(bodies: int, ratio: float, fewest: tuple[int, ...]) -> None:
    masses = chain(bodies, ratio)

    def found(share: float) -> int | None:
        return fewest_sweeps(lambda sweeps: swept_growth(masses, hard_velocity_step(share, sweeps, kept=1.0)))

    assert tuple(map(found, (0.1, 0.2, 0.5))) == fewest


def spectral_radius(columns_of_step: list[list[float]]) -> float:
    return float(np.abs(np.linalg.eigvals(np.array(columns_of_step).T)).max())


@settings(max_examples=30, deadline=None)
@given(
    st.integers(1, 7), st.floats(0.1, 30), st.integers(1, 12), st.floats(0.1, 1.5), st.floats(0, 1), st.floats(0.5, 1.5)
)
def test_matrices_are_what_loops_over_links_do(
    bodies: int, ratio: float, sweeps: int, share: float, kept: float, relaxation: float
) -> None:
    step = hard_velocity_step(share, sweeps, kept=kept, relaxation=relaxation)
    of_loops = spectral_radius(
        columns(hard_step(inverse_masses(bodies, ratio), sweeps, share, kept, relaxation), bodies)
    )
    # eigvals of the loops' matrix loses digits where it has many eigenvalues at 0, not those of the largest
    assert swept_growth(chain(bodies, ratio), step).factor == pytest.approx(of_loops, abs=1e-4)


@pytest.mark.parametrize("bodies", [2, 6])
def test_soft_sweeps_and_moves_of_positions_are_what_loops_do(bodies: int) -> None:
    soft = SweptStep(1.0, (Pass("velocity", 1, 0.28, 0.38), Move(), Pass("velocity", 2)))
    of_loops = spectral_radius(columns(soft_step(inverse_masses(bodies, 3), 0.28, 1 / 1.38, relaxing=2), bodies))
    assert swept_growth(chain(bodies, 3), soft).factor == pytest.approx(of_loops, abs=1e-9)
    jolt = SweptStep(1.0, (Pass("velocity", 4), Move(), Pass("position", 2, 1.0, relaxation=0.2)))
    of_loops = spectral_radius(columns(position_step(inverse_masses(bodies, 3), 4, 0.2, 2), bodies))
    assert swept_growth(chain(bodies, 3), jolt).factor == pytest.approx(of_loops, abs=1e-9)


@pytest.mark.parametrize("ratio", [1, 40])
@pytest.mark.parametrize("sweeps", [1, 5])
@pytest.mark.parametrize("share", ["1/5", "13/10"])
def test_verdicts_are_those_of_exact_arithmetic(ratio: int, sweeps: int, share: str) -> None:
    """The step's matrix in fractions, its characteristic polynomial, and Schur's test: a proof of each verdict."""
    bodies = 3
    exact = columns(hard_step(inverse_masses(bodies, Fraction(ratio)), sweeps, Fraction(share)), bodies, Fraction(1))
    matrix = sympy.Matrix([[sympy.Rational(x.numerator, x.denominator) for x in map(Fraction, row)] for row in exact])
    coefficients = [Fraction(int(c.p), int(c.q)) for c in matrix.charpoly().all_coeffs()[::-1]]
    growth = swept_growth(chain(bodies, ratio), hard_velocity_step(Fraction(share), sweeps, kept=1.0))
    assert growth.decays is (recursion_verdict(coefficients) == "converges")


def test_free_motions_and_units_change_nothing() -> None:
    """A planar chain that may swing, a body that nothing ties, other units: as before."""
    step = hard_velocity_step(0.3, 3, kept=1.0)
    alone = swept_growth(chain(3), step).factor
    jacobian = np.zeros((3, 8))
    jacobian[:, :3] = np.eye(3) - np.eye(3, k=-1)
    free = swept_growth(inverse_effective_masses(np.eye(8), jacobian), step)
    assert free.factor == pytest.approx(alone, abs=1e-10)
    scaled = swept_growth(inverse_effective_masses(1e6 * np.eye(8), np.diag([1e-8, 1, 1e5]) @ jacobian), step)
    assert scaled.factor == pytest.approx(alone, rel=1e-9)


def joints_step(inverse_masses: FloatArray, joints: tuple[int, ...], sweeps: int, share: float) -> FloatArray:
    """Return the matrix of a step whose joints are solved one after another, each exactly: errors, rates, impulses."""
    count = len(joints)

    def step(state: FloatArray) -> FloatArray:
        errors, rates, impulses = np.split(state, 3)
        rates = rates + inverse_masses @ impulses
        for _ in range(sweeps):
            for joint in dict.fromkeys(joints):
                own = [index for index in range(count) if joints[index] == joint]
                added = -np.linalg.solve(inverse_masses[np.ix_(own, own)], (rates + share * errors)[own])
                impulses[own] += added
                rates = rates + inverse_masses[:, own] @ added
        return np.concatenate([errors + rates, rates, impulses])

    return np.stack([step(unit) for unit in np.eye(3 * count)], axis=1)


@pytest.mark.parametrize("joints", [(0, 0, 1, 1, 2), (0, 0, 0, 0, 0)])
def test_constraints_of_a_joint_are_solved_together(joints: tuple[int, ...]) -> None:
    jacobian = np.random.default_rng(5).standard_normal((5, 7))
    masses = inverse_effective_masses(np.eye(7), jacobian)
    for sweeps in (1, 3):
        of_loops = float(np.abs(np.linalg.eigvals(joints_step(masses, joints, sweeps, 0.6))).max())
        found = swept_growth(masses, hard_velocity_step(0.6, sweeps, kept=1.0), joints).factor
        assert found == pytest.approx(of_loops, abs=1e-6)
    apart = swept_growth(masses, hard_velocity_step(0.6, 3, kept=1.0)).factor
    assert abs(found - apart) > 1e-3
    if set(joints) == {0}:  # solved exactly, as direct solvers do: 1 - share, whatever the masses
        assert found == pytest.approx(0.4, abs=1e-9)


def test_what_rounding_leaves_open_is_refused() -> None:
    with pytest.raises(NumericalError, match="too near 1"):
        Growth(1.000001, 1e-5).check_settled()
    assert not Growth(0.999999, 1e-5).decays
    assert Growth(0.99, 1e-3).decays
    assert not Growth(1.01, 1e-3).decays


@pytest.mark.slow
def test_the_stated_accuracy_holds_against_fifty_digits() -> None:
    bodies, ratio, sweeps = 6, 1000, 7
    with mpmath.workdps(50):
        step = hard_step(inverse_masses(bodies, mpmath.mpf(ratio)), sweeps, mpmath.mpf(0.1))
        eigenvalues, _ = mpmath.eig(mpmath.matrix(columns(step, bodies, mpmath.mpf(1))))
        largest = max(abs(value) for value in eigenvalues)
    growth = swept_growth(chain(bodies, ratio), hard_velocity_step(0.1, sweeps, kept=1.0))
    assert abs(growth.factor - largest) <= growth.accuracy <= 1e-8


def test_no_number_of_sweeps_helps_a_share_beyond_two() -> None:
    assert fewest_sweeps(lambda sweeps: swept_growth(chain(2), hard_velocity_step(2.5, sweeps, kept=1.0))) is None
