"""Do predictions hold? Poles as they are predicted, against those that are measured in runs.

scene, method, a step, points   →   verify   →   a Measurement for each point
"""

from fractions import Fraction

import numpy as np
from numpy.typing import ArrayLike

from bezstab.arguments import Number, in_keywords, plane_point, real_number
from bezstab.engines.conversions import Point
from bezstab.errors import InputError
from bezstab.mechanism.equations import Mechanism, compiled_mechanism
from bezstab.mechanism.scene_files import scene as scene_named
from bezstab.mechanism.scenes import Scene
from bezstab.methods.registry import method as method_named
from bezstab.methods.schemes import Method
from bezstab.runs.measured_poles import Measurement, measure_poles, random_points
from bezstab.stability.arrays import FloatArray, plane_arrays, real_array
from bezstab.units import check_step

RANDOM_POINTS, MOST_POINTS = 20, 1000
MOST_ACROSS = 10**4
"""Of a map: points along each axis."""


@in_keywords()
def verify(
    scene: str | Scene,
    method: str | Method,
    *,
    h: Number,
    alpha_hat: ArrayLike | None = None,
    beta_hat: ArrayLike | None = None,
    alpha: ArrayLike | None = None,
    beta: ArrayLike | None = None,
) -> list[Measurement]:
    """Return the dominant pole as predicted and as measured in a simulation, for each of some points.

    Parameters
    ----------
    scene : str or Scene
        The mechanism that is kicked.
    method : str or Method
        The integration method.
    h : number
        Step (s).
    alpha_hat, beta_hat : array_like, optional
        The points, dimensionless, of one shape.
    alpha, beta : array_like, optional
        The same in 1/s, in their place.

    Returns
    -------
    list of Measurement
        Dimensionless. `measured` is None if no pole can be measured; `reason` says why.

    Raises
    ------
    InputError
        The scene cannot start, or the points are not given in one of the two ways.

    References
    ----------
    Opposite kicks and linear prediction (Prony).
    """
    first, second = plane_arrays(*plane_point(alpha_hat, beta_hat, alpha, beta, h, read=real_array))
    step = real_number(h, "h")
    check_step(step)
    kicked = compiled_mechanism(scene_named(scene))
    return measure_poles(kicked, method_named(method), step, first.ravel(), second.ravel())


def check_points(point: Point | None, points: int | None, across: int | None) -> None:
    """Raise InputError unless one thing at most says which points are verified, and there are not too many."""
    given = {"--alpha": point, "--points": points, "--map": across}
    (first, *others) = [name for name, value in given.items() if value is not None] or [""]
    if others:
        raise InputError(f"{others[0]} does not go with {first}: each says which points are verified")
    if points is not None and not 1 <= points <= MOST_POINTS:
        raise InputError(f"--points {points}: expected 1 to {MOST_POINTS}")
    if across is not None and not 2 <= across <= MOST_ACROSS:
        raise InputError(f"--map {across}: expected 2 to {MOST_ACROSS} points along each axis")


def measurements(
    mechanism: Mechanism, method: Method, h: Fraction, point: Point | None, points: int | None, *, floquet: bool
) -> list[Measurement]:
    """Return predicted and measured poles at a point (alpha_hat, beta_hat), else at so many random ones.

    With `floquet` the exact prediction for a moving mechanism, too. Errors as `measure_poles`.
    """
    alpha_hat: FloatArray
    beta_hat: FloatArray
    if point is None:
        alpha_hat, beta_hat = random_points(method, points or RANDOM_POINTS)
    else:
        alpha_hat, beta_hat = (np.array([float(each)]) for each in point)
    return measure_poles(mechanism, method, float(h), alpha_hat, beta_hat, floquet)
