"""The default choice, held against runs at gains of all sizes: none beats it threefold in both errors at once.

Its trajectory stands beside those of a grid of stable points with at most twice its |c|, all of them multiples of the
motion's own rate: the later half of 40 rad, 50 steps a radian.
"""

from fractions import Fraction

import numpy as np
import pytest

from bezstab.feedback.choosing import choose
from bezstab.mechanism.constraint_normals import constraint_motion
from bezstab.mechanism.equations import Mechanism, compiled_mechanism
from bezstab.mechanism.programs import even_steps
from bezstab.mechanism.runner import march, simulate
from bezstab.mechanism.scene_files import load_scene
from bezstab.mechanism.start import constraint_errors, initial_state
from bezstab.methods.registry import lookup
from bezstab.methods.schemes import Method
from bezstab.questions.trial_runs import TURNED
from bezstab.rationals import exact
from bezstab.stability.arrays import FloatArray
from bezstab.stability.choices import THOUSANDFOLD, search_box
from bezstab.stability.choices import choose as choose_point
from bezstab.stability.closed_loop import spectral_radius
from bezstab.stability.regions import region

OMEGA_H = Fraction(1, 50)
STEPS = 2000
POINTS = 16  # per axis


def stable_points(method: Method, scene: str, h: float) -> FloatArray:
    """Return alpha_hat and beta_hat of a grid, damping ratios from 0.02 to 2, and last those of the choice."""
    largest = 0.995 * search_box(region(method))[0][1][1] ** 0.5
    ratio, beta_h = np.meshgrid(
        np.geomspace(0.02, 2, POINTS), np.geomspace(0.05 * float(OMEGA_H), largest, POINTS), indexing="ij"
    )
    points = np.array([2 * (ratio * beta_h).ravel(), beta_h.ravel() ** 2])
    chosen = choose(method, scene=scene, h=exact(h), goal="accurate", margins=False, cost=False)
    return np.column_stack([points[:, spectral_radius(method, *points) < 1], [chosen.alpha_hat, chosen.beta_hat]])


def errors(mechanism: Mechanism, method: Method, h: float, count: int, points: FloatArray) -> FloatArray:
    """Return the largest errors of constraints, coordinates and velocities in the later half, shape (3, points)."""
    exactly = simulate(mechanism, lookup("tsit5"), h / 4, count * h, (0.0, 0.0))
    lanes, later = points.shape[1], slice(count // 2 + 1, None)
    state = np.repeat(np.concatenate(initial_state(mechanism))[:, np.newaxis], lanes, axis=1)
    steps = even_steps(h, count, (points[0] / h, points[1] / h**2), (lanes,))
    with np.errstate(all="ignore"):
        states = [state[np.newaxis], *(block.states for block in march(mechanism, method, steps, state))]
        q, v = np.split(np.concatenate(states)[later], 2, axis=1)
        off = [constraint_errors(mechanism, steps.times[later, np.newaxis], list(np.moveaxis(q, 1, 0)))]
        off += [q - exactly.q[::4][later, :, np.newaxis], v - exactly.v[::4][later, :, np.newaxis]]
        return np.array([np.nan_to_num(np.abs(each).max(axis=(0, 1)), nan=np.inf) for each in off])


@pytest.mark.slow
@pytest.mark.parametrize("scene", ["driven_four_bar", "four_bar"])
@pytest.mark.parametrize("name", ["SYM", "verlet-half", "bs3", "AB2", "AB4", "ABM4", "B4", "heun", "RK2", "SIE", "RK4"])
def test_none_that_settles_is_three_times_nearer_with_velocities_no_worse(name: str, scene: str) -> None:
    """Of those that settle within the runs: others are not looked at."""
    method, mechanism = lookup(name), compiled_mechanism(load_scene(scene))
    h = float(OMEGA_H) / constraint_motion(mechanism, 1.0).omega
    points = stable_points(method, scene, h)
    settles = spectral_radius(method, *points) < THOUSANDFOLD ** (float(OMEGA_H) / TURNED)
    found = errors(mechanism, method, h, STEPS, points)
    of_c, of_q, of_v = found / found[:, -1:]
    assert settles.sum() > 100
    assert not (settles & (of_c <= 2) & (of_q < 1 / 3) & (of_v <= 1)).any()


@pytest.mark.parametrize(
    ("name", "scene", "step", "settle", "shares"),
    [
        ("RK4", "pendulum", "0.02", 3, (1, 2)),
        pytest.param("SIE", "pendulum", "0.0042", None, (0.95, 1.05), marks=pytest.mark.slow),
    ],
)
def test_what_runs_choose_is_nearer_at_other_steps_and_in_longer_runs(
    name: str, scene: str, step: str, settle: int | None, shares: tuple[float, float]
) -> None:
    """SIE's errors cancel in a valley between the points of a grid, at steps about as long."""
    method, h = lookup(name), Fraction(step)
    found = choose(method, scene=scene, h=h, settle=settle, margins=False, cost=False)
    assert found.trials
    assert settle is None or (found.settle_seconds or 4) <= settle
    within = None if settle is None else Fraction(settle)
    rule = choose_point(method, h=h, settle=within, omega_h=found.conditions.motion.omega_h)
    points = np.array([[rule.alpha_hat, found.alpha_hat], [rule.beta_hat, found.beta_hat]])
    for share, times in zip(shares, (1, 2), strict=True):
        at, shorter = points / [[share], [share**2]], float(h) / share
        count = round(times * found.trials.seconds / shorter)
        far, near = errors(compiled_mechanism(load_scene(scene)), method, shorter, count, at)[1]
        assert near < far / 3
