"""What runs cost at gains of all sizes, and at those that a goal chooses: errors of constraints and of the trajectory.

python -m tests.runs.gain_grids [METHOD ...]      prints errors over the least of 27 gains, in some minutes
"""

import sys
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bezstab.goals import Goal
from bezstab.mechanism.constraint_normals import constraint_motion
from bezstab.mechanism.equations import compiled_mechanism
from bezstab.mechanism.motions import motion
from bezstab.mechanism.scene_files import load_scene
from bezstab.mechanism.simulation import simulated
from bezstab.methods.registry import lookup
from bezstab.methods.schemes import Method
from bezstab.rationals import exact
from bezstab.runs.forced_runs import COMPARED, settled_error
from bezstab.stability.arrays import FloatArray
from bezstab.stability.choices import choose
from bezstab.stability.closed_loop import spectral_radius

METHODS = ("RK4", "dopri5", "bs3", "B4", "AB2", "AB4", "ABM4", "SYM", "verlet-half", "bdf2", "hht", "gauss4")
SCENES = {"slider_crank_light": (0.004, 2.0), "driven_four_bar": (0.003, 1.0), "andrews": (1e-4, 0.03)}
"""Step and duration (s)."""

GOALS: tuple[Goal, ...] = ("accurate", "robust", "fastest", "critical")
SCALES = tuple(3.0**-n for n in range(8))
"""Of the robust choice's beta: down to a two-thousandth, where errors take longer to decay than the runs last."""

DAMPING_RATIOS = (0.5, 1.0, 2.0)

Point = tuple[float, float]


@dataclass(frozen=True)
class Grid:
    """Largest errors (SI) of constraints and coordinates in the later half of runs: of all stable points, and of goals.

    Rows of two, infinite where a run breaks down.
    """

    points: FloatArray
    goals: dict[Goal, FloatArray]

    def beaten(self, goal: Goal) -> float:
        """Return by what factor some point of the grid beats a goal's in both errors at once."""
        return float((self.goals[goal] / self.points).min(axis=1).max())

    def from_best(self, goal: Goal) -> FloatArray:
        """Return how many times the least of all there are a goal's constraint and trajectory errors are."""
        return np.asarray(self.goals[goal] / np.vstack([self.points, *self.goals.values()]).min(axis=0))


def grid(scene: str, name: str, goals: Sequence[Goal] = GOALS) -> Grid:
    """Return the errors of a method on a scene, over the grid and at the choices of goals."""
    h, duration = SCENES[scene]
    method = lookup(name)
    omega = constraint_motion(compiled_mechanism(load_scene(scene)), duration).omega
    strongest = np.sqrt(choose(method, "robust").beta_hat)
    points = [(2 * ratio * scale * strongest, (scale * strongest) ** 2) for scale in SCALES for ratio in DAMPING_RATIOS]
    chosen = {goal: choose(method, goal, omega_h=exact(h) * exact(omega)) for goal in goals}
    return Grid(
        np.array([measured(scene, method, point) for point in points if spectral_radius(method, *point) < 1]),
        {goal: measured(scene, method, (choice.alpha_hat, choice.beta_hat)) for goal, choice in chosen.items()},
    )


def measured(scene: str, method: Method, point: Point) -> FloatArray:
    """Return the two errors of one run."""
    h, duration = SCENES[scene]
    mechanism = compiled_mechanism(load_scene(scene))
    alpha_hat, beta_hat = point
    run = simulated(mechanism, method, h=h, duration=duration, alpha_hat=alpha_hat, beta_hat=beta_hat)
    if run.failure:
        return np.full(2, np.inf)
    later = run.t >= COMPARED * duration
    exactly, _, _ = motion(mechanism, duration).at(run.t[later])
    return np.array([settled_error(run, run.t), np.abs(run.q[later] - exactly).max()])


def print_table(names: Sequence[str]) -> None:
    """Print for each scene and method how far each goal is from the best, and by what the default is beaten."""
    heads = " | ".join(f"{goal}: c, q" for goal in GOALS)
    print(f"| scene | method | {heads} | default beaten |")
    print("|---" * (len(GOALS) + 3) + "|")
    for scene in SCENES:
        for name in names:
            found = grid(scene, name)
            cells = " | ".join("{:.2g}, {:.2g}".format(*found.from_best(goal)) for goal in GOALS)
            print(f"| {scene} | {name} | {cells} | {found.beaten('accurate'):.2f} |", flush=True)


if __name__ == "__main__":
    print_table(sys.argv[1:] or METHODS)
