"""Runs as equally long arrays by name, for tables: the history of one, a map of verdicts, runs without their times."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from bezstab.mechanism.simulation import Simulation
from bezstab.runs.verdict_maps import VerdictMap
from bezstab.show.arrays import over_the_plane
from bezstab.show.cells import Value
from bezstab.show.columns import Answer, Column, row_of
from bezstab.stability.arrays import Arrays


def verdict_arrays(verdicts: VerdictMap) -> Arrays:
    """Return a map of verdicts as arrays of shape (runs,), alpha_hat running fastest; 1 for diverges, for undecided."""
    judged = {"diverges": verdicts.diverges.astype(int), "undecided": verdicts.undecided.astype(int)}
    return over_the_plane(verdicts.alpha_hat, verdicts.beta_hat, z_abs=verdicts.z_abs, **judged)


def history_arrays(simulation: Simulation) -> Arrays:
    """Return t, every q and d/dt q, c_1, cdot_1, lambda_1, ..., energy and work: shape (times,), SI units."""
    coordinates = simulation.mechanism.scene.coordinates
    constraint_histories = {"c": simulation.c, "cdot": simulation.cdot, "lambda": simulation.multipliers}
    return {
        "t": simulation.t,
        **dict(zip(coordinates, simulation.q.T, strict=True)),
        **{f"d/dt {name}": rate for name, rate in zip(coordinates, simulation.v.T, strict=True)},
        **{
            f"{name}_{number}": history
            for name, histories in constraint_histories.items()
            for number, history in enumerate(histories.T, start=1)
        },
        "energy": simulation.energy,
        "driver_work": simulation.driver_work,
        "force_work": simulation.force_work,
    }


def table_arrays(columns: Sequence[Column[Answer]], answers: Sequence[Answer]) -> Arrays:
    """Return answers as arrays of shape (answers,) by key, without processor times, which no two runs share.

    What is missing is nan among numbers, and an empty text among texts and where nothing is known.
    """
    rows = [row_of(columns, answer) for answer in answers]
    values = {key: [row[key] for row in rows] for key in rows[0] if not key.startswith("seconds")}
    return {key: _column(of_key) for key, of_key in values.items()}


def _column(values: Sequence[Value]) -> NDArray[np.generic]:
    missing = math.nan if any(isinstance(value, int | float) for value in values) else ""
    return np.array([missing if value is None else value for value in values])
