"""Logs of runs that were chosen at random, as a user's simulator would write them: with nine digits."""

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from itertools import chain, pairwise

import numpy as np

from bezstab.evidence.kicks import kicked_motions
from bezstab.evidence.measured_poles import SURROUNDINGS
from bezstab.mechanism import (
    Mechanism,
    compiled_mechanism,
    constraint_jacobian,
    load_scene,
    shipped_scenes,
    turning_normals,
)
from bezstab.mechanism.motions import motion
from bezstab.methods import REGISTRY, Method, lookup
from bezstab.rationals import exact
from bezstab.stability import FloatArray, region, spectral_radius, window

H = 1e-3  # s
DIGITS = 9
LARGEST = 1.0  # m: beyond it a simulator has long stopped
KICK, SMALL_KICK = 1e-4, 1e-8  # m: the smaller one where it grows
LASTS = 0.25  # s: of a log of 250 rows
FORMS = ("up and down", "kicked and not", "one run")
BREAKS_DOWN = "andrews"  # at this step


@dataclass(frozen=True)
class RandomLog:
    """A method, a point and a scene, and what their run has written; `minus` is None where one run is all there is.

    `turning` is how fast the directions of the constraints turn in that scene, at most, in 1/s.
    """

    method: Method
    scene: str
    alpha_hat: Fraction
    beta_hat: Fraction
    form: str
    turning: float
    c: FloatArray
    minus: FloatArray | None


def random_logs(count: int, seed: int, rows: int) -> Iterator[RandomLog]:
    """Yield logs of random methods at random points in and around their regions, in random scenes, always the same."""
    random = np.random.default_rng(seed)
    names = list(REGISTRY)
    scenes = [name for name in sorted(shipped_scenes()) if name != BREAKS_DOWN]
    for _ in range(count):
        method, scene = lookup(str(random.choice(names))), str(random.choice(scenes))
        low, high = np.transpose(window(region(method)))
        margin = SURROUNDINGS * (high - low)
        alpha_hat, beta_hat = np.round(random.uniform(low - margin, high + margin), 6).tolist()
        form = str(random.choice(FORMS))
        up, down, alone = _written(method, scene, alpha_hat, beta_hat, rows)
        minus = {"up and down": down, "kicked and not": alone, "one run": None}[form]
        yield RandomLog(method, scene, exact(alpha_hat), exact(beta_hat), form, _turning(scene), up, minus)


def _written(method: Method, scene: str, alpha_hat: float, beta_hat: float, rows: int) -> FloatArray:
    """Return c_1 kicked up, kicked down and not kicked, rounded to DIGITS, until a run is useless; shape (3, rows)."""
    stable = float(spectral_radius(method, alpha_hat, beta_hat)) < 1
    kicks = (KICK if stable else SMALL_KICK, 0.0)
    written: list[list[float]] = []
    with np.errstate(all="ignore"):
        blocks = kicked_motions(
            _mechanism(scene), method, H, np.array([alpha_hat]), np.array([beta_hat]), kicks, rows - 1
        )
        for c in chain.from_iterable(c for c, _ in blocks):
            row = [float(c[0, 0, 0, 0]), float(c[0, 1, 0, 0]), float(c[0, 0, 1, 0])]
            if not np.abs(row).max() < LARGEST:
                break
            written.append([float(f"{value:.{DIGITS}g}") for value in row])
    return np.array(written).reshape(-1, 3).T


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
