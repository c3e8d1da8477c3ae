"""Logs of runs at points that were chosen at random, kicked up and down, as a user's simulator would write them."""

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from itertools import pairwise

import numpy as np

from bezstab.mechanism.constraint_normals import turning_normals
from bezstab.mechanism.equations import Mechanism, compiled_mechanism
from bezstab.mechanism.motions import motion
from bezstab.mechanism.scene_files import load_scene
from bezstab.mechanism.start import constraint_jacobian
from bezstab.methods.registry import REGISTRY, lookup
from bezstab.rationals import exact
from bezstab.runs.kicks import kicked_motions
from bezstab.runs.measured_poles import SURROUNDINGS
from bezstab.stability.arrays import FloatArray
from bezstab.stability.closed_loop import spectral_radius
from bezstab.stability.regions import region, window

H = 1e-3  # s
LARGEST = 1.0  # m: beyond it a simulator has long stopped
KICK, SMALL_KICK = 1e-4, 1e-8  # m: the smaller one where it grows
ROWS = 250
LASTS = ROWS * H  # s
POINTS = 5
SCENES = ("pendulum", "four_bar", "driven_four_bar", "slider_crank_300rpm")


@dataclass(frozen=True)
class KickedLog:
    """A method, a point and a scene, and c_1 of its runs, kicked up and down, in m, shape (rows,).

    `turning` is how fast the directions of the constraints turn in that scene, at most, in 1/s.
    """

    method: str
    scene: str
    alpha_hat: Fraction
    beta_hat: Fraction
    turning: float
    up: FloatArray
    down: FloatArray


def rounded(c: FloatArray, digits: int) -> FloatArray:
    """Return numbers as they are written with so many digits."""
    return np.array([float(f"{value:.{digits}g}") for value in c])


def kicked_logs(name: str) -> Iterator[KickedLog]:
    """Yield logs of a method at random points in and around its region, in two scenes, always the same.

    One point of each scene is critically damped, as users like it: two poles meet there.
    """
    place, method = list(REGISTRY).index(name), lookup(name)
    random = np.random.default_rng(place)
    low, high = np.transpose(window(region(method)))
    margin = SURROUNDINGS * (high - low)
    for scene in (SCENES[place % 4], SCENES[(place + 1 + place // 4 % 3) % 4]):
        a, b = np.round(random.uniform(low - margin, high + margin, (POINTS, 2)), 6).T
        a[0] = round(random.uniform(0.02, 0.3), 6)
        b[0] = a[0] ** 2 / 4
        with np.errstate(all="ignore"):
            blocks = kicked_motions(_mechanism(scene), method, H, a, b, (KICK, SMALL_KICK), ROWS - 1)
            c = np.concatenate([c[:, 0] for c, _ in blocks])
        for k, point in enumerate(zip(a.tolist(), b.tolist(), strict=True)):
            grows = float(spectral_radius(method, *point)) >= 1
            runs = c[:, :, int(grows), k]
            usable = np.logical_and.accumulate((np.abs(runs) < LARGEST).all(axis=1))
            up, down = runs[usable].T
            yield KickedLog(name, scene, exact(point[0]), exact(point[1]), _turning(scene), up, down)


@cache
def _mechanism(scene: str) -> Mechanism:
    return compiled_mechanism(load_scene(scene))


@cache
def _turning(scene: str) -> float:
    """Return how fast the constraints turn while a log is written: against each other, or at all, the faster of both.

    With A = C_q M^-1/2 and its rate B along the motion the latter is the norm of B, in units in which A A' = 1: of a
    pendulum it is the angular speed, while K is zero.
    """
    mechanism = _mechanism(scene)
    along = motion(mechanism, LASTS)
    root = np.sqrt(mechanism.mass)
    jacobians = [constraint_jacobian(mechanism, t, q) / root for t, q in zip(along.t.tolist(), along.q, strict=True)]
    against_each_other = turning_normals(mechanism, LASTS).rates
    size = np.linalg.norm(jacobians[0], axis=1)  # each constraint's error in units of its own size at the start
    rates = [float(np.linalg.norm(against_each_other / size[:, np.newaxis] * size, ord=2, axis=(1, 2)).max())]
    for (before, after), passed in zip(pairwise(jacobians), np.diff(along.t), strict=True):
        own_units = np.linalg.inv(np.linalg.cholesky(before @ before.T))
        rates.append(float(np.linalg.norm(own_units @ (after - before) / passed, ord=2)))
    return max(rates)
