"""What `region` shows of a method: its map as a figure and as a table, and its rows."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from bezstab.show.fields import Row, cells
from bezstab.show.row_kinds import ACCURACY
from bezstab.show.rows import region_row
from bezstab.stability import ComplexArray, Region

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from bezstab.evidence import Arrays
    from bezstab.questions import MapAnswer, MapQuestion


def map_figure(answer: MapAnswer, z: ComplexArray) -> Figure:
    """Return the map of |z_p|, below the errors that feedback forces where they are asked about.

    z are the dominant poles over the axes of the answer, of shape (beta_hat.size, alpha_hat.size). With a step the axes
    are 2 alpha and beta^2, marked in alpha and beta if that is asked for.
    """
    from bezstab.show.accuracy_figures import accuracy_map_figure
    from bezstab.show.plane_figures import PlaneMap, region_figure

    question, stable, (alpha_hat, beta_hat) = answer.question, answer.stable, answer.axes
    shown = PlaneMap(
        region=stable.region,
        alpha_hat=alpha_hat,
        beta_hat=beta_hat,
        z_abs=np.abs(z),
        best=stable.best,
        chosen=answer.chosen,
        h=_seconds(question),
        marks=question.marks,
    )
    if question.motion:
        return accuracy_map_figure(shown, float(question.motion.omega_h), answer.errors(z), answer.drawn_levels)
    return region_figure(shown, answer.faster, answer.moving, question.alpha_beta, question.scene_name)


def map_table(answer: MapAnswer, z: ComplexArray) -> Arrays:
    """Return the same map as arrays of shape (points,), as `map_arrays`; with the errors where they are asked about."""
    from bezstab.show.arrays import map_arrays

    question = answer.question
    arrays = map_arrays(*answer.axes, z, _seconds(question))
    return {**arrays, "combined_error": answer.errors(z).ravel()} if question.motion else arrays


def compared_figure(question: MapQuestion, regions: Sequence[Region]) -> Figure:
    """Return the boundaries of regions in the plane that is asked about."""
    from bezstab.show.plane_figures import comparison_figure

    return comparison_figure(
        regions, question.alpha_range, question.beta_range, _seconds(question), question.alpha_beta
    )


def compared_table(question: MapQuestion, regions: Sequence[Region]) -> Arrays:
    """Return the same boundaries as arrays, as `boundary_arrays`."""
    from bezstab.show.arrays import boundary_arrays

    return boundary_arrays(regions, _seconds(question))


def _seconds(question: MapQuestion) -> float | None:
    return None if question.h is None else float(question.h)


def map_rows(answer: MapAnswer) -> list[Row]:
    """Return a row for the stable region, or for it at each speed of the scene, and one for each level below 1."""
    stable, *faster = [region_row(each) for each in answer.regions]
    if answer.question.motion:
        forced = cells(ACCURACY, answer)
        return [{**row, **forced} for row in (stable, *faster)]
    if not answer.moving:
        return [stable, *faster]
    kappas = {float(speed): turning.kappa for speed, turning in answer.question.turnings.items()}
    return [
        *(
            {**stable, "speed": speed, "kappa": kappas[speed], "area_moving": moving.area}
            for speed, moving in answer.moving.items()
        ),
        *({**row, "speed": None, "kappa": None, "area_moving": None} for row in faster),
    ]
