"""Logs of runs at points that were chosen at random, kicked up and down, as a user's simulator would write them."""

from collections.abc import Iterator
from fractions import Fraction
from typing import NamedTuple

import numpy as np

from bezstab.mechanism.equations import compiled_mechanism
from bezstab.mechanism.scene_files import load_scene
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
POINTS = 5
SCENES = {"pendulum": 2.43, "four_bar": 17.1, "driven_four_bar": 27.4, "slider_crank_300rpm": 9.21}
"""With how fast the directions of their constraints turn while a log is written, at most (1/s).

With A = C_q M^-1/2 and its rate B along the motion that is the norm of B, in units in which A A' = 1: of a pendulum
the angular speed.
"""


class KickedLog(NamedTuple):
    """A point, by how much the constraints of the scene turn in a step at most (rad), and c_1 of both runs (m)."""

    alpha_hat: Fraction
    beta_hat: Fraction
    turned: float
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
    scenes = list(SCENES)
    for scene in (scenes[place % 4], scenes[(place + 1 + place // 4 % 3) % 4]):
        a, b = np.round(random.uniform(low - margin, high + margin, (POINTS, 2)), 6).T
        a[0] = round(random.uniform(0.02, 0.3), 6)
        b[0] = a[0] ** 2 / 4
        mechanism = compiled_mechanism(load_scene(scene))
        with np.errstate(all="ignore"):
            blocks = kicked_motions(mechanism, method, H, a, b, (KICK, SMALL_KICK), ROWS - 1)
            c = np.concatenate([c[:, 0] for c, _ in blocks])
        grows = spectral_radius(method, a, b) >= 1
        for k, point in enumerate(zip(map(exact, a.tolist()), map(exact, b.tolist()), strict=True)):
            runs = c[:, :, int(grows[k]), k]
            usable = np.logical_and.accumulate((np.abs(runs) < LARGEST).all(axis=1))
            yield KickedLog(*point, H * SCENES[scene], *runs[usable].T)
