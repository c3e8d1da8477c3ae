"""Which integrator made the log of a constraint error, and with which feedback?

a log, a point or methods, steps   →   probed   →   Probe: the pole, and which methods or points have it
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from fractions import Fraction

import numpy as np
from numpy.typing import ArrayLike

from bezstab.arguments import Number, exact_or_none, in_keywords, plane_point, whole_number
from bezstab.engines.conversions import Point
from bezstab.errors import InputError, shown
from bezstab.methods.registry import lookup
from bezstab.methods.registry import method as method_named
from bezstab.methods.schemes import Method
from bezstab.probes.probed_poles import TURNED, Likeness, LikePoint, likenesses, point_like, probed_pole
from bezstab.stability.arrays import FloatArray, real_array
from bezstab.words import point_words

MOST_USED = ("SYM", "RK1", "RK2", "RK4", "AB2", "verlet-kdk", "implicit-euler", "trapezoid", "bdf2", "hht")
"""The methods that most simulators use, and their own: what is compared where less than two are named."""

NONE_FITS = "none of these methods has this pole there"

ONE_POLE = "a single real pole, or one that no such method has: it gives no α and β"


@dataclass(frozen=True, repr=False)
class Probe:
    """The pole in a column of a log, per row, and what has it; None if none can be told.

    `uncertainty` is how far the pole may be off in the plane. `likenesses`: how near it is to the pole of each method
    at the point, the nearest first; `fitting`: the names of the methods that have it there, none where more is allowed
    than methods differ by. Without a point `points`: where each method has it. `reason`: why there is no answer, ""
    where there is one. `sentence`: the answer in words.
    """

    column: str
    pole: complex | None
    uncertainty: float
    likenesses: Sequence[Likeness]
    fitting: tuple[str, ...]
    points: Sequence[LikePoint]
    reason: str
    sentence: str = field(compare=False)

    def __repr__(self) -> str:
        return f"Probe({self.sentence})"


@in_keywords()
def probe(
    c: ArrayLike,
    *,
    minus: ArrayLike | None = None,
    methods: Sequence[str | Method] | None = None,
    every: int = 1,
    turning: Number | None = None,
    alpha_hat: Number | None = None,
    beta_hat: Number | None = None,
    alpha: Number | None = None,
    beta: Number | None = None,
    h: Number | None = None,
) -> Probe:
    """Return the dominant pole in samples of a decaying error, and which integrator could have made them.

    Parameters
    ----------
    c : array_like, shape (samples,)
        Samples of one constraint error, in any unit.
    minus : array_like, shape (samples,), optional
        Another run, to subtract.
    methods : sequence of str or Method, optional
        Integrators to compare; with fewer than two also the ten most used.
    every : int
        Steps of h from one sample to the next.
    turning : number, optional
        Rate (1/s) at which the normals of the constraints turn; needs h.
    alpha_hat, beta_hat : number, optional
        The feedback, dimensionless.
    alpha, beta : number, optional
        The same in 1/s, in their place. Without a point, the one is found at which each method has the pole.
    h : number, optional
        Step (s).

    Returns
    -------
    Probe
        `pole` per sample, dimensionless, or `reason`, why there is none. `likenesses` has the methods, the nearest
        first, `fitting` the names of those that have the pole, `points` the points that were found.

    Raises
    ------
    InputError
        Point, shapes and h do not fit together.

    References
    ----------
    Linear prediction (Prony).
    """
    if methods is not None and (isinstance(methods, str | Method) or not isinstance(methods, Iterable)):
        raise InputError(f"methods = {shown(methods)}: expected a list of methods")
    return probed(
        "c",
        real_array(c, "c"),
        None if minus is None else real_array(minus, "minus"),
        tuple(map(method_named, methods or ())),
        plane_point(alpha_hat, beta_hat, alpha, beta, h, needed=False),
        whole_number(every, "every"),
        exact_or_none(h, "h"),
        exact_or_none(turning, "turning"),
    )


def probed(
    column: str,
    c: FloatArray,
    minus: FloatArray | None,
    methods: Sequence[Method],
    point: Point | None,
    every: int,
    h: Fraction | None,
    turning: Fraction | None,
) -> Probe:
    """Return what `probe` does of a column of a log; at a point one method alone, or none, is joined by MOST_USED.

    InputError for `every` below 1, or no whole number of a method's own steps, for a rate `turning` (1/s) below 0 or
    without a step, and as `probed_pole`. NumericalError as `point_like`.
    """
    compared = dict.fromkeys((*methods, *map(lookup, MOST_USED if point and len(methods) < 2 else ())))
    for method in compared:
        if every < 1 or Fraction(every) % method.step_multiple:
            own = float(method.step_multiple)
            raise InputError(f"--every {every}: expected a multiple of {own:g}: a step of {method.name}")
    if turning is not None and (turning < 0 or h is None):
        raise InputError(f"--turning {float(turning):g}: expected 0 or more, in 1/s, with --h")
    turned = TURNED if turning is None or h is None else float(turning * h)
    fit, reason = probed_pole(c, minus)
    if fit is None:
        return Probe(column, None, np.nan, (), (), (), reason, f"{column}: {reason}.")
    alike = likenesses(fit, compared, every, *point, turned) if point else []
    fitting = tuple(one.method.name for one in alike if one.fits)
    points = [] if point else [found for method in compared if (found := point_like(fit, method, every, h))]
    words = f"{column}: |z_p| = {abs(fit.pole):.6g} ± {fit.uncertainty:.1g}"
    if point and fitting:
        words += f", the pole of {' and '.join(fitting)} at {point_words(float(point[0]), float(point[1]), h)}"
    elif point:
        near = [one for one in alike if one.fits is None]
        reason = f"more is allowed ({near[0].allowed:.1g}) than methods differ by" if near else NONE_FITS
    elif compared and not points:
        reason = ONE_POLE
    sentence = f"{words}; {reason}." if reason else f"{words}."
    return Probe(column, fit.pole, fit.uncertainty, alike, fitting, points, reason, sentence)
