"""The fastest feedback without oscillation: the smallest dominant pole that is double, real and positive.

From one, where both parameters are zero, the double pole is followed down along its curve, until another pole overtakes
it or a parameter leaves the region's box. On the chart of a method with a mu that curve is the real axis, where both
mu are the same; elsewhere P and P' are zero on it.
"""

import numpy as np
from numpy.polynomial.polynomial import polydiv, polyfromroots, polyroots

from bezstab.stability.arrays import EPS, ComplexArray, Extent
from bezstab.stability.charts import Chart, Place
from bezstab.stability.least_modulus import of_multiple_root, stationary

STEP = 1 / 100  # of the pole, from one place to the next; the last is halved until it is rounding
ASIDE = 1e-7  # of mu: a double mu splits by 1e-8 in float64, which must not let a rival of equal modulus win
CONJUGATE = 3e-8  # Im mu of mu, whose square is four roundings: two real mu that rounding parts move margins by 1e-8
NEARBY = 0.2  # of one, and of the parameters: a place further from the last is on another curve


def critical_place(chart: Chart, box: Extent) -> Place | None:
    """Return the place on the chart; None if no double pole below one is dominant."""
    pole, place, step, ended = 1.0, (0.0, 0.0), STEP, False
    while pole > 0 and step > EPS:
        lower = max(0.0, pole - step)
        found = _double_at(chart, lower, place)
        if found and all(0 <= each <= end for each, (_, end) in zip(chart.user_point(found), box, strict=True)):
            pole, place = lower, found
        else:
            ended = True
        if ended:
            step /= 2
    if pole == 1:
        return None
    return place if chart.real else (place[0] * (1 - ASIDE), place[0] * CONJUGATE)


def _double_at(chart: Chart, pole: float, near: Place) -> Place | None:
    """Return the place near another one where a pole is double; None if there is none, or a larger pole."""
    multiplicity = 2 if chart.real else 1  # of a method with a mu two real mu meet

    def functions(points: ComplexArray) -> ComplexArray:
        """Return zero, as nothing is to be least, and what vanishes."""
        at_pole = of_multiple_root(chart.coefficients(points), pole, multiplicity)
        return np.stack([0 * at_pole[0], *at_pole, *([] if chart.real else [points[..., 1]])])

    found = stationary(functions, np.array(near))
    if found is None or np.abs(found - near).max() > NEARBY * (1 + np.abs(near).max()):
        return None
    place = float(found[0]), float(found[1])
    others, _ = polydiv(chart.coefficients(np.array(place)).real, polyfromroots(multiplicity * [pole]))
    return place if np.abs(polyroots(others)).max(initial=0.0) < pole else None
