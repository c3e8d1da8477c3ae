"""Sweeps over many constraints: loops over links that know no matrices, in float64 and in fifty digits."""

import mpmath
import numpy as np
import pytest

from bezstab.engines.sweeping import Move, Pass, SweptStep, hard_velocity_step
from bezstab.errors import NumericalError
from bezstab.stability.sweeps import Growth, chain, inverse_effective_masses, swept_growth
from tests.reference.swept_chains import columns, hard_step, inverse_masses, position_step, soft_step


def spectral_radius(columns_of_step: list[list[float]]) -> float:
    return float(np.abs(np.linalg.eigvals(np.array(columns_of_step).T)).max())


@pytest.mark.parametrize("bodies", [2, 6])
def test_soft_sweeps_and_moves_of_positions_are_what_loops_do(bodies: int) -> None:
    soft = SweptStep(1.0, (Pass("velocity", 1, 0.28, 0.38), Move(), Pass("velocity", 2)))
    of_loops = spectral_radius(columns(soft_step(inverse_masses(bodies, 3), 0.28, 1 / 1.38, relaxing=2), bodies))
    assert swept_growth(chain(bodies, 3), soft).factor == pytest.approx(of_loops, abs=1e-9)
    jolt = SweptStep(1.0, (Pass("velocity", 4), Move(), Pass("position", 2, 1.0, relaxation=0.2)))
    of_loops = spectral_radius(columns(position_step(inverse_masses(bodies, 3), 4, 0.2, 2), bodies))
    assert swept_growth(chain(bodies, 3), jolt).factor == pytest.approx(of_loops, abs=1e-9)


def test_free_motions_and_units_change_nothing() -> None:
    """A planar chain that may swing, a body that nothing ties, other units: as before."""
    step = hard_velocity_step(0.3, 3, kept=1.0)
    jacobian = np.eye(3, 8) - np.eye(3, 8, k=-1)
    scaled = inverse_effective_masses(1e6 * np.eye(8), np.diag([1e-8, 1, 1e5]) @ jacobian)
    assert swept_growth(scaled, step).factor == pytest.approx(swept_growth(chain(3), step).factor, rel=1e-9)


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
