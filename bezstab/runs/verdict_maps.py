"""Maps of simulated verdicts: a run at every cell of the plane, diverging or not, against |z_p| from the polynomial."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bezstab.errors import InputError, NumericalError
from bezstab.mechanism.compiled_stepping import runs_compiled
from bezstab.mechanism.constraint_normals import turning_normals
from bezstab.mechanism.equations import compiled_mechanism
from bezstab.mechanism.scenes import Scene
from bezstab.methods.schemes import Method
from bezstab.read_only import ReadOnlyArrays
from bezstab.runs.kicks import TOO_CLOSE, kicked_fates
from bezstab.stability.arrays import BoolArray, FloatArray
from bezstab.stability.closed_loop import pole_map
from bezstab.stability.regions import region, window
from bezstab.stability.turning import moving_modulus

MAP_RUN = 2000
"""Steps after the kick."""

BATCH = 2000
"""Cells at a time: more make no step cheaper."""


@dataclass(frozen=True, repr=False)
class VerdictMap(ReadOnlyArrays):
    """Predicted |z_p| and what `run` simulated steps of h (s) did; masks of shape (beta_hat.size, alpha_hat.size).

    `undecided` is where a run gave no verdict, as where the mechanism itself left the linear range. `moved` says
    how much more than |z_p| the motion can make of any pole's modulus; same shape.

    `disagrees`: where simulated and predicted verdict differ. `band`: how far |z_p| must be from one for a run of this
    length to show it. `too_close`: where it is nearer, or nearer than the motion moves it. `judged`: the number of runs
    with a verdict; `agreeing`: with the predicted one; `disagreements_beyond_band`: of those that disagree and are not
    too close. `farthest_disagreement`: the largest | |z_p| - 1 | at which the verdicts differ; None where they nowhere
    do. Made by `compared`.
    """

    scene: Scene
    method: Method
    h: float
    run: int
    alpha_hat: FloatArray
    beta_hat: FloatArray
    z_abs: FloatArray
    diverges: BoolArray
    undecided: BoolArray
    moved: FloatArray
    disagrees: BoolArray
    band: float
    too_close: BoolArray
    judged: int
    agreeing: int
    disagreements_beyond_band: int
    farthest_disagreement: float | None


def compared(
    *, run: int, z_abs: FloatArray, diverges: BoolArray, undecided: BoolArray, moved: FloatArray, **of_map: Any
) -> VerdictMap:
    """Return a map of simulated verdicts, held against the predicted ones; the arguments are fields of VerdictMap."""
    off = np.abs(z_abs - 1)
    disagrees: BoolArray = (diverges != (z_abs >= 1)) & ~undecided
    band = TOO_CLOSE / run
    too_close: BoolArray = ~(off > np.maximum(band, moved))
    judged = int((~undecided).sum())
    return VerdictMap(
        **of_map,
        run=run,
        z_abs=z_abs,
        diverges=diverges,
        undecided=undecided,
        moved=moved,
        disagrees=disagrees,
        band=band,
        too_close=too_close,
        judged=judged,
        agreeing=judged - int(disagrees.sum()),
        disagreements_beyond_band=int((disagrees & ~too_close).sum()),
        farthest_disagreement=max(off[disagrees].tolist(), default=None),
    )


@dataclass(frozen=True)
class MapRows:
    """Some rows of a map of simulated verdicts, to be run as one batch; h in s."""

    scene: Scene
    method: Method
    h: float
    alpha_hat: FloatArray
    beta_hat: FloatArray
    compiled: bool


def map_rows(scene: Scene, method: Method, h: float, count: int) -> list[MapRows]:
    """Return the count x count cells of the window that shows the region, by rows (constant beta_hat); h in s.

    They are compiled where that is asked for or pays. InputError where it is asked for and numba is missing;
    NumericalError as `region`.
    """
    compiled = runs_compiled(method, 2 * count**2 * MAP_RUN, together=True)
    centres = (np.arange(count) + 0.5) / count
    alpha_hat, beta_hat = (low + (high - low) * centres for low, high in window(region(method)))
    rows_at_once = max(1, BATCH // count)
    return [
        MapRows(scene, method, h, alpha_hat, beta_hat[first : first + rows_at_once], compiled)
        for first in range(0, count, rows_at_once)
    ]


def simulated_verdicts(rows: MapRows) -> dict[str, NDArray[Any]]:
    """Return what `VerdictMap` has of these rows; shape (beta_hat.size, alpha_hat.size).

    A run diverges if the constraint error that the kick made grows, and converges if that error dies, whichever comes
    first (`kicks`). Predicted is |z_p| at rest, of paper Eq. 17, and how far the motion moves it at most. InputError
    for a scene that cannot start, and where rows are to be compiled without numba; NumericalError where a predicted
    pole leaves the range of float64.
    """
    alpha_grid, beta_grid = np.meshgrid(rows.alpha_hat, rows.beta_hat)
    alpha_hat, beta_hat = alpha_grid.ravel(), beta_grid.ravel()
    mechanism = compiled_mechanism(rows.scene)
    diverges, undecided = kicked_fates(
        mechanism, rows.method, rows.h, alpha_hat, beta_hat, MAP_RUN, compiled=rows.compiled
    )
    z_abs = np.abs(np.concatenate(list(pole_map(rows.method, rows.alpha_hat, rows.beta_hat))))
    furthest = moving_modulus(rows.method, _turning_of_a_step(rows))(alpha_hat, beta_hat)
    found = {"diverges": diverges, "undecided": undecided, "moved": furthest - z_abs.ravel(), "z_abs": z_abs}
    return {name: values.reshape(alpha_grid.shape) for name, values in found.items()}


def verdict_map(chunks: Sequence[MapRows], found: Sequence[Mapping[str, NDArray[Any]]]) -> VerdictMap:
    """Return the map that these rows make up, from what `simulated_verdicts` found in each.

    Dimensionless, arrays of shape (rows of all chunks, columns).
    """
    first = chunks[0]
    return compared(
        scene=first.scene,
        method=first.method,
        h=first.h,
        run=MAP_RUN,
        alpha_hat=first.alpha_hat,
        beta_hat=np.concatenate([rows.beta_hat for rows in chunks]),
        **{name: np.concatenate([of_rows[name] for of_rows in found]) for name in found[0]},
    )


def _turning_of_a_step(rows: MapRows) -> float:
    """Return kappa h over a run; infinite where the scene's motion cannot be followed."""
    duration = MAP_RUN * rows.h * float(rows.method.step_multiple)
    try:
        return turning_normals(compiled_mechanism(rows.scene), duration).kappa * rows.h
    except (InputError, NumericalError):
        return np.inf
