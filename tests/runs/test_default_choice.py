"""The default choice, held against runs at gains of all sizes: none beats it threefold in both errors at once.

Its trajectory stands beside those of a grid of stable points with at most twice its |c|, all of them multiples of the
motion's own rate: the later half of 40 rad, 50 steps a radian.
"""

from fractions import Fraction
from functools import cache

import numpy as np
import pytest

from bezstab.feedback.choosing import ChooseAnswer, choose
from bezstab.mechanism.constraint_normals import constraint_motion
from bezstab.mechanism.equations import compiled_mechanism
from bezstab.mechanism.programs import even_steps
from bezstab.mechanism.runner import march, simulate
from bezstab.mechanism.scene_files import load_scene
from bezstab.mechanism.start import constraint_errors, initial_state
from bezstab.methods.registry import lookup
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


@cache
def choice_on(scene: str, name: str) -> ChooseAnswer:
    h = exact(float(OMEGA_H) / constraint_motion(compiled_mechanism(load_scene(scene)), 1.0).omega)
    return choose(name, scene=scene, h=h, goal="accurate", margins=False, cost=False)


def stable_points(name: str, scene: str) -> FloatArray:
    """Return alpha_hat and beta_hat of a grid, damping ratios from 0.02 to 2, and last those of the choice."""
    method = lookup(name)
    largest = 0.995 * search_box(region(method))[0][1][1] ** 0.5
    ratio, beta_h = np.meshgrid(
        np.geomspace(0.02, 2, POINTS), np.geomspace(0.05 * float(OMEGA_H), largest, POINTS), indexing="ij"
    )
    points = np.array([2 * (ratio * beta_h).ravel(), beta_h.ravel() ** 2])
    chosen = choice_on(scene, name)
    return np.column_stack([points[:, spectral_radius(method, *points) < 1], [chosen.alpha_hat, chosen.beta_hat]])


def worse_than_the_choice(scene: str, name: str) -> FloatArray:
    """Return errors of constraints, coordinates and velocities, a row each, over those at the choice."""
    mechanism, method = compiled_mechanism(load_scene(scene)), lookup(name)
    h = float(OMEGA_H) / constraint_motion(mechanism, mechanism.scene.duration).omega
    exact = simulate(mechanism, lookup("tsit5"), h / 4, STEPS * h, (0.0, 0.0))
    alpha_hat, beta_hat = stable_points(name, scene)
    lanes = len(alpha_hat)
    state = np.repeat(np.concatenate(initial_state(mechanism))[:, np.newaxis], lanes, axis=1)
    largest, taken = np.zeros((3, lanes)), 0
    with np.errstate(all="ignore"):
        for block in march(mechanism, method, even_steps(h, STEPS, (alpha_hat / h, beta_hat / h**2), (lanes,)), state):
            for after in block.states:
                taken += 1
                if 2 * taken > STEPS:
                    q, v = np.split(after, 2)
                    off = [constraint_errors(mechanism, taken * h, list(q))]
                    off += [q - exact.q[4 * taken][:, np.newaxis], v - exact.v[4 * taken][:, np.newaxis]]
                    sizes = [np.abs(each).max(axis=0) for each in off]
                    largest = np.maximum(largest, np.nan_to_num(sizes, nan=np.inf))
    assert taken == STEPS
    return largest[:, :-1] / largest[:, -1:]


@pytest.mark.slow
@pytest.mark.parametrize("scene", ["driven_four_bar", "four_bar"])
@pytest.mark.parametrize("name", ["SYM", "verlet-half", "bs3", "AB2", "AB4", "ABM4", "B4", "heun", "RK2", "SIE", "RK4"])
def test_none_that_settles_is_three_times_nearer_with_velocities_no_worse(name: str, scene: str) -> None:
    """Of those that settle within the runs: others are not looked at."""
    alpha_hat, beta_hat = stable_points(name, scene)[:, :-1]
    settles = spectral_radius(lookup(name), alpha_hat, beta_hat) < THOUSANDFOLD ** (float(OMEGA_H) / TURNED)
    of_c, of_q, of_v = worse_than_the_choice(scene, name)
    assert settles.sum() > 100
    assert not (settles & (of_c <= 2) & (of_q < 1 / 3) & (of_v <= 1)).any()


def test_what_runs_choose_is_nearer_at_other_steps_and_in_longer_runs() -> None:
    found = choose("RK4", scene="pendulum", h="0.02", settle=3, margins=False, cost=False)
    assert found.trials
    assert found.settle_seconds
    assert found.settle_seconds <= 3
    rule = choose_point(lookup("RK4"), h=Fraction(1, 50), settle=Fraction(3), omega_h=found.conditions.motion.omega_h)
    for h, seconds in ((0.02, found.trials.seconds), (0.01, 2 * found.trials.seconds)):
        share = h / 0.02
        far, near = (
            farthest("pendulum", h, seconds, (point[0] * share, point[1] * share**2))
            for point in ((rule.alpha_hat, rule.beta_hat), (found.alpha_hat, found.beta_hat))
        )
        assert near < far / 3


def farthest(scene: str, h: float, seconds: float, point: tuple[float, float]) -> float:
    """Return how far (m or rad) RK4 is off in the later half of a run."""
    mechanism, duration = compiled_mechanism(load_scene(scene)), h * round(seconds / h)
    run = simulate(mechanism, lookup("RK4"), h, duration, (point[0] / h, point[1] / h**2))
    exactly = simulate(mechanism, lookup("tsit5"), h / 4, duration, (0.0, 0.0))
    return float(np.abs(run.q - exactly.q[::4])[len(run.q) // 2 :].max())
