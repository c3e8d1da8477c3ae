"""Which integrator made the log of a constraint error, and with which feedback?

a response, a point or methods, steps   →   probe_response   →   Probe: the pole, and which methods or points have it
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from fractions import Fraction

from numpy.typing import ArrayLike

from bezstab.arguments import Number, exact_or_none, in_keywords, plane_point, whole_number
from bezstab.engines.conversions import Point
from bezstab.errors import InputError, shown
from bezstab.methods.registry import lookup
from bezstab.methods.registry import method as method_named
from bezstab.methods.schemes import Method
from bezstab.probes.probed_poles import (
    TURNED,
    Likeness,
    LikePoint,
    ProbedPole,
    kicked_responses,
    likenesses,
    point_like,
    probed_pole,
    told,
)
from bezstab.stability.arrays import FloatArray, real_array
from bezstab.words import point_words

MOST_USED = ("SYM", "RK1", "RK2", "RK4", "AB2", "verlet-kdk", "implicit-euler", "trapezoid", "bdf2", "hht")
"""The methods that most simulators use, and their own: what is compared where less than two are named."""

MOST_STEPS = 10**4
"""From one row of a log to the next."""

ONE_POLE = "a single real pole, or one that no such method has: it gives no α and β"


@dataclass(frozen=True)
class Compared:
    """What the pole of a log is compared with: the `methods` at a `point`, or without one at whichever has the pole.

    The integrator takes `every` steps of `h` (s) from row to row; constraints turn by `turned` rad in a step.
    """

    point: Point | None
    methods: Sequence[Method]
    every: int
    h: Fraction | None
    turned: float


def compared_with(
    point: Point | None = None,
    methods: Sequence[Method] = (),
    every: int = 1,
    h: Fraction | None = None,
    turning: Fraction | None = None,
) -> Compared:
    """Return what a log is compared with; at a point one method alone, or none, is joined by MOST_USED.

    Constraints turn at the rate `turning` (1/s); None: by TURNED in a step. InputError for a rate below 0 or without a
    step, and for rows that are no whole number of a method's own steps apart, or more than MOST_STEPS.
    """
    if not 1 <= every <= MOST_STEPS:
        raise InputError(f"--every {every}: expected 1 to {MOST_STEPS} steps")
    turned = TURNED
    if turning is not None:
        if turning < 0:
            raise InputError(f"--turning {float(turning):g}: expected 0 or more, in 1/s")
        if h is None:
            raise InputError("--turning is a rate in 1/s: it needs --h")
        turned = float(turning * h)
    beside = map(lookup, MOST_USED if point and len(methods) < 2 else ())
    compared = tuple(dict.fromkeys((*methods, *beside)))
    for method in compared:
        if Fraction(every) % method.step_multiple:
            own = float(method.step_multiple)
            raise InputError(f"--every {every}: expected a multiple of {own:g}: a step of {method.name}")
    return Compared(point, compared, every, h, turned)


@dataclass(frozen=True, repr=False)
class Probe:
    """The pole in a column of a log, per row, and what has it; None if none can be told.

    `likenesses`: how near it is to the pole of each method at the point, the nearest first; `fitting`: the names of the
    methods that have it there, none where more is allowed than methods differ by. Without a point `points`: where each
    method has it. `reason`: why there is no answer, "" where there is one. `sentence`: the answer in words.
    """

    column: str
    pole: complex | None
    found: ProbedPole
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
    differenced: bool = False,
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
    c : array_like, shape (samples,) or (samples, responses)
        Samples of one constraint error, in any unit, or of several errors of one system.
    minus : array_like of that shape, optional
        Another run, to subtract.
    differenced : bool
        Whether c is such a difference already.
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
    compared = compared_with(
        plane_point(alpha_hat, beta_hat, alpha, beta, h, needed=False),
        tuple(map(method_named, methods or ())),
        whole_number(every, "every"),
        exact_or_none(h, "h"),
        exact_or_none(turning, "turning"),
    )
    c = real_array(c, "c")
    minus = None if minus is None else real_array(minus, "minus")
    return probe_response("c", probed_pole(c, minus, differenced), compared)


def probe_step(
    step: Callable[[FloatArray], FloatArray],
    state: ArrayLike,
    constraint: Callable[[FloatArray], float],
    kick: ArrayLike,
    *,
    steps: int = 600,
    methods: Sequence[str | Method] | None = None,
    turning: Number | None = None,
    alpha_hat: Number | None = None,
    beta_hat: Number | None = None,
    alpha: Number | None = None,
    beta: Number | None = None,
    h: Number | None = None,
) -> Probe:
    """Return what `probe` does, for a function that takes the state of your simulator to the next.

    Parameters
    ----------
    step : callable
        Takes the state, an array, and returns the next one. It is called six times `steps` times.
    state : array_like
        The first state.
    constraint : callable
        Takes a state and returns the constraint error, in any unit.
    kick : array_like, shape of the state
        Added to the state and subtracted from it, whole and in parts.
    steps : int
        Length of each run.
    methods, turning, alpha_hat, beta_hat, alpha, beta, h
        As for `probe`.

    Returns
    -------
    Probe
        As of `probe`.

    Raises
    ------
    InputError
        As of `probe`, and if shapes differ.
    """
    responses = kicked_responses(step, state, constraint, kick, steps)
    return probe(
        responses,
        differenced=True,
        methods=methods,
        turning=turning,
        alpha_hat=alpha_hat,
        beta_hat=beta_hat,
        alpha=alpha,
        beta=beta,
        h=h,
    )


def probe_response(column: str, found: ProbedPole, compared: Compared) -> Probe:
    """Return whose the pole of a response is, called by its column's name. NumericalError as `point_like`."""
    alike: Sequence[Likeness] = ()
    points: Sequence[LikePoint] = ()
    if compared.point:
        alike = likenesses(found, compared.methods, compared.every, *compared.point, compared.turned)
    else:
        candidates = (point_like(found, method, compared.every) for method in compared.methods)
        points = [point for point in candidates if point]
    fitting = tuple(one.method.name for one in told(alike))
    reason = _reason(found, compared, alike, fitting, points)
    sentence = _sentence(column, found, compared, fitting, reason)
    return Probe(column, found.pole, found, alike, fitting, points, reason, sentence)


def _reason(
    found: ProbedPole,
    compared: Compared,
    alike: Sequence[Likeness],
    fitting: Sequence[str],
    points: Sequence[LikePoint],
) -> str:
    """Return why there is no answer; "" where there is one."""
    if found.pole is None:
        return found.reason
    if compared.point is None:
        return "" if points or not compared.methods else ONE_POLE
    fits = [one for one in alike if one.fits]
    if not fits:
        return "none of these methods has this pole there"
    if fitting:
        return ""
    names, allowed = ", ".join(one.method.name for one in fits), max(one.allowed for one in fits)
    return f"{names} cannot be told from others: {allowed:.1g} is allowed to the pole, and theirs differ by less"


def _sentence(column: str, found: ProbedPole, compared: Compared, fitting: Sequence[str], reason: str) -> str:
    """Return the pole and whose it is.

    c: |z_p| = 0.577373 ± 0.001, as SYM has it at α̂ = 0.666667, β̂ = 0.25.
    """
    if found.pole is None:
        return f"{column}: {reason}."
    z = f"{column}: |z_p| = {abs(found.pole):.6g} ± {found.uncertainty:.1g}"
    if reason:
        return f"{z}; {reason}."
    if not compared.point:
        return f"{z}."
    alpha_hat, beta_hat = map(float, compared.point)
    place = point_words(alpha_hat, beta_hat, compared.h)
    return f"{z}, as {' and '.join(fitting)} {'has' if len(fitting) == 1 else 'have'} it at {place}."
