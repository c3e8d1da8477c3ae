"""Maps of simulated verdicts: a run at every cell of the plane, diverging or not, against |z_p| from the polynomial."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from bezstab.evidence.linear_prediction import SETTLED
from bezstab.evidence.measured_poles import (
    GROWN,
    LINEAR,
    kicked_constraint_errors,
    kicked_constraint_errors_in_groups,
)
from bezstab.mechanism import CHEAPER_TOGETHER, Scene, compiled_mechanism, runs_compiled
from bezstab.methods import Method, evaluations
from bezstab.read_only import ReadOnlyArrays
from bezstab.stability import FloatArray, pole_map, region, useful_window

BoolArray = NDArray[np.bool_]

MAP_RUN = 2000
"""Steps after the kick."""

BATCH = 2000
"""Cells at a time: more make no step cheaper."""

MAP_KICK = 1e-6
"""SI units: a thousandth of the linear range, so that a decaying run stays in it and a growing one needs time."""

TOO_CLOSE = 10.0
"""Over the number of steps: with | |z_p| - 1 | below this growth or decay may not show in a run."""

PARTS = 8
"""Of a run, compared by the largest difference in each."""


@dataclass(frozen=True)
class VerdictMap(ReadOnlyArrays):
    """Predicted |z_p| and what `run` simulated steps of h (s) did; masks of shape (beta_hat.size, alpha_hat.size).

    `broken` is where the mechanism itself left the linear range, whatever the kick: no verdict.
    """

    scene: Scene = field(repr=False)
    method: Method = field(repr=False)
    h: float
    run: int
    alpha_hat: FloatArray = field(repr=False)
    beta_hat: FloatArray = field(repr=False)
    z_abs: FloatArray = field(repr=False)
    diverges: BoolArray = field(repr=False)
    broken: BoolArray = field(repr=False)

    @property
    def disagrees(self) -> BoolArray:
        """Where simulated and predicted verdict differ; shape (beta_hat.size, alpha_hat.size)."""
        differs: BoolArray = (self.diverges != (self.z_abs >= 1)) & ~self.broken
        return differs

    @property
    def judged(self) -> int:
        """The number of runs with a verdict: all but those that broke down."""
        return self.broken.size - int(self.broken.sum())

    @property
    def agreement(self) -> float | None:
        """The share of the judged runs whose verdict is the predicted one; None if none was judged."""
        if not self.judged:
            return None
        return 1 - int(self.disagrees.sum()) / self.judged

    @property
    def band(self) -> float:
        """How far |z_p| must be from one for a run of this length to show it."""
        return TOO_CLOSE / self.run

    @property
    def farthest_disagreement(self) -> float | None:
        """The largest | |z_p| - 1 | at which the verdicts differ; None where they nowhere do."""
        distance = self._distances_of_disagreement()
        return float(distance.max()) if distance.size else None

    @property
    def disagreements_beyond_band(self) -> int:
        """The number of runs that disagree although |z_p| is farther from one than the band."""
        return int((self._distances_of_disagreement() > self.band).sum())

    def _distances_of_disagreement(self) -> FloatArray:
        distance: FloatArray = np.abs(self.z_abs - 1)[self.disagrees]
        return distance


@dataclass(frozen=True)
class MapRows:
    """Some rows of a map of simulated verdicts, to be run as one batch; h in s."""

    scene: Scene = field(repr=False)
    method: Method = field(repr=False)
    h: float
    alpha_hat: FloatArray = field(repr=False)
    beta_hat: FloatArray = field(repr=False)
    compiled: bool = False


def map_rows(scene: Scene, method: Method, h: float, count: int) -> list[MapRows]:
    """Return the count x count cells of the window that shows the region, by rows (constant beta_hat); h in s.

    They are compiled where that is asked for or pays. InputError where it is asked for and numba is missing;
    NumericalError as `region`.
    """
    mechanism = compiled_mechanism(scene)
    compiled = runs_compiled(mechanism, method, 2 * count**2 * MAP_RUN * evaluations(method) // CHEAPER_TOGETHER)
    centres = (np.arange(count) + 0.5) / count
    alpha_window, beta_window = useful_window(region(method))
    alpha_hat = _inside(alpha_window, centres)
    beta_hat = _inside(beta_window, centres)
    rows_at_once = max(1, BATCH // count)
    return [
        MapRows(scene, method, h, alpha_hat, beta_hat[first : first + rows_at_once], compiled)
        for first in range(0, count, rows_at_once)
    ]


def _inside(interval: tuple[float, float], shares: FloatArray) -> FloatArray:
    """Return the points that lie at these shares of an interval."""
    low, high = interval
    return low + (high - low) * shares


def simulated_verdicts(rows: MapRows) -> dict[str, BoolArray]:
    """Return where runs diverge, and where they broke down; shape (beta_hat.size, alpha_hat.size).

    A run diverges if the difference after the kick grows until c leaves the linear range, or is larger in the last
    eighth of the run than in the eighth before its middle without having decayed to what is forced. InputError for a
    scene that cannot start, and where rows are to be compiled without numba.
    """
    alpha_grid, beta_grid = np.meshgrid(rows.alpha_hat, rows.beta_hat)
    alpha_hat, beta_hat = alpha_grid.ravel(), beta_grid.ravel()
    steps_of_a_part = MAP_RUN // PARTS
    largest = np.zeros((PARTS + 1, alpha_hat.size))  # the one step more than eight eighths is a part of its own
    linear = np.full(alpha_hat.size, True)
    mechanism, method, h = compiled_mechanism(rows.scene), rows.method, rows.h
    kicked: Iterator[FloatArray] = iter(())
    with np.errstate(all="ignore"):  # what diverges runs into infinity, and is cut off there
        if rows.compiled:
            groups = kicked_constraint_errors_in_groups(mechanism, method, h, alpha_hat, beta_hat, [MAP_KICK], MAP_RUN)
            for some, blocks in groups:
                linear[some] = _largest_in_parts(blocks, largest[:, some])
        else:
            kicked = kicked_constraint_errors(mechanism, method, h, alpha_hat, beta_hat, [MAP_KICK])
        for k, c in zip(range(MAP_RUN + 1), kicked, strict=False):
            linear &= np.abs(c).max(axis=(0, 1, 2)) < LINEAR[0]  # not so where it is not a number
            up, down = c[0, :, 0]
            part = largest[k // steps_of_a_part]
            np.maximum(part, np.abs(up - down) / 2, out=part, where=linear)
    peak = largest.max(axis=0)
    before_middle, last = largest[PARTS // 2 - 1], largest[PARTS - 1]
    grows_within = (last > before_middle) & (last > SETTLED * peak)
    grows_out = peak > GROWN * MAP_KICK
    diverges = np.where(linear, grows_within, grows_out)
    shape = (rows.beta_hat.size, rows.alpha_hat.size)
    return {"diverges": diverges.reshape(shape), "broken": (~linear & ~diverges).reshape(shape)}


def _largest_in_parts(blocks: Iterator[FloatArray], largest: FloatArray) -> BoolArray:
    """Return which runs of a group stay linear; `largest` gets the largest difference in each part while they do.

    A block of c has shape (steps, constraints, 2, 1, points). Where no run is linear any more, the rest is left out.
    """
    linear = np.full(largest.shape[1], True)
    steps_of_a_part = MAP_RUN // PARTS
    k = 0
    for c in blocks:
        still = np.logical_and.accumulate(np.abs(c).max(axis=(1, 2, 3)) < LINEAR[0], axis=0) & linear
        differences = np.where(still, np.abs(c[:, 0, 0, 0] - c[:, 0, 1, 0]) / 2, 0.0)
        part_of_step = np.arange(k, k + len(c)) // steps_of_a_part
        for part in np.unique(part_of_step):
            in_part = differences[part_of_step == part].max(axis=0)
            largest[part] = np.maximum(largest[part], in_part)
        linear = still[-1]
        k += len(c)
        if not linear.any():
            break
    return linear


def verdict_map(chunks: Sequence[MapRows], found: Sequence[Mapping[str, NDArray[np.generic]]]) -> VerdictMap:
    """Return the map that these rows make up, from what `simulated_verdicts` found in each, with what is predicted.

    Dimensionless, arrays of shape (rows of all chunks, columns); predicted is |z_p| at rest, of paper Eq. 17.
    NumericalError where a predicted pole leaves the range of float64.
    """
    first = chunks[0]
    beta_hat = np.concatenate([rows.beta_hat for rows in chunks])
    return VerdictMap(
        scene=first.scene,
        method=first.method,
        h=first.h,
        run=MAP_RUN,
        alpha_hat=first.alpha_hat,
        beta_hat=beta_hat,
        z_abs=np.concatenate([np.abs(block) for block in pole_map(first.method, first.alpha_hat, beta_hat)]),
        diverges=np.concatenate([verdicts["diverges"] for verdicts in found]),
        broken=np.concatenate([verdicts["broken"] for verdicts in found]),
    )
