"""What `import bezstab` offers: the rooms behind one door, with names for methods and scenes, and units said aloud.

Wherever a point of the plane is asked for, keywords say which numbers it is: `alpha_hat=` and `beta_hat=`
(dimensionless, alpha_hat = 2 alpha h and beta_hat = beta^2 h^2, paper Eq. 16), or `alpha=` and `beta=` in 1/s together
with the step `h=` in s. A method is a name as on the command line ("B4", "RK4@5", "mine.toml") or what `method` made
of one; a scene is a shipped scene's name, the path of a TOML file, or what `scene` made of one.
"""

from __future__ import annotations  # so that help() shows annotations as they are written

import math
import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from fractions import Fraction

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bezstab import evidence, mechanism, questions, stability
from bezstab.engines import Drive, engine_and_values, engine_named
from bezstab.errors import InputError, shown
from bezstab.goals import Goal
from bezstab.mechanism import Scene, Simulation
from bezstab.methods import REGISTRY, Method, Verdict, lookup
from bezstab.rationals import exact, rational, within_float64
from bezstab.units import check_step, to_dimensionless

FloatArray = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]
Number = int | float | str | Fraction
"""A number that is read exactly: a float as the decimal it shows, a text as a decimal or a fraction such as "6/11"."""


def method(name: str | Method) -> Method:
    """Return the integration method of that name, or the one in a .toml file.

    Its steps last h, the user's step (s), or m h with @m appended to the name: "RK4@5". InputError, with the nearest
    name, if there is none. `Method.source` names the book or paper.
    """
    if not isinstance(name, str | Method):
        raise InputError(f"method {shown(name)}: expected one name such as 'B4', or what bezstab.method makes of one")
    return name if isinstance(name, Method) else lookup(name)


def scene(name: str | Scene, speed: float = 1.0) -> Scene:
    """Return the shipped scene of that name, or the one in a .toml file; SI units and rad.

    Its drivers and initial velocities are `speed` times as fast as given there. InputError, naming the file and the
    key, if it cannot be read, and where a speed has nothing to multiply. "slider_crank" is that of the paper's
    section 5.2.
    """
    if not isinstance(name, str | Scene):
        raise InputError(
            f"scene {shown(name)}: expected one name such as 'pendulum', or what bezstab.scene makes of one"
        )
    given = name if isinstance(name, Scene) else mechanism.load_scene(name)
    return mechanism.at_speed(given, _real(speed, "speed"))


def poles(
    method: str | Method,
    *,
    alpha_hat: ArrayLike | None = None,
    beta_hat: ArrayLike | None = None,
    alpha: ArrayLike | None = None,
    beta: ArrayLike | None = None,
    h: float | None = None,
) -> ComplexArray:
    """Return all poles z of the constraint error, dimensionless, descending by modulus.

    Complex; shape of the two coordinates broadcast, plus one axis for the poles. InputError unless the point is given
    in one of the two ways; NumericalError if a pole leaves the range of float64. The roots of paper Eq. 17.
    """
    a, b = _plane_arrays(alpha_hat, beta_hat, alpha, beta, h)
    return stability.poles(_method(method), a, b)


def dominant_pole(
    method: str | Method,
    *,
    alpha_hat: ArrayLike | None = None,
    beta_hat: ArrayLike | None = None,
    alpha: ArrayLike | None = None,
    beta: ArrayLike | None = None,
    h: float | None = None,
) -> ComplexArray:
    """Return z_p, the pole of largest modulus, dimensionless; of a conjugate pair the one with Im >= 0.

    Complex; shape of the two coordinates broadcast. Errors as for `poles`. The paper's dominant pole, section 4.
    """
    a, b = _plane_arrays(alpha_hat, beta_hat, alpha, beta, h)
    return stability.dominant_pole(_method(method), a, b)


def spectral_radius(
    method: str | Method,
    *,
    alpha_hat: ArrayLike | None = None,
    beta_hat: ArrayLike | None = None,
    alpha: ArrayLike | None = None,
    beta: ArrayLike | None = None,
    h: float | None = None,
) -> FloatArray:
    """Return |z_p|, by which the constraint error shrinks in a step, dimensionless; it decays where that is below 1.

    float64; shape of the two coordinates broadcast. Errors as for `poles`. The quantity of the paper's Figs. 1 to 3.
    """
    a, b = _plane_arrays(alpha_hat, beta_hat, alpha, beta, h)
    return stability.spectral_radius(_method(method), a, b)


def verdict(
    method: str | Method,
    *,
    alpha_hat: Number | None = None,
    beta_hat: Number | None = None,
    alpha: Number | None = None,
    beta: Number | None = None,
    h: Number | None = None,
) -> Verdict:
    """Return "converges", "marginal" or "diverges" for one point (dimensionless, or in 1/s with h), proven exactly.

    Numbers are read exactly: 0.1 is one tenth. InputError unless they are finite and the point is given in one of the
    two ways. The Schur-Cohn test (I. Schur, J. reine angew. Math. 147, 1917) on the polynomial of paper Eq. 17.
    """
    a, b = _plane_point(alpha_hat, beta_hat, alpha, beta, h)
    return stability.verdict(_method(method), a, b)


def region(method: str | Method, level: float = 1.0) -> stability.Region:
    """Return the exact region |z_p| < level, 0 < level <= 1, in the dimensionless plane.

    `boundary` has its closed curves as arrays of shape (points, 2), columns alpha_hat and beta_hat; `area`, `extent`,
    and `contains(alpha_hat, beta_hat)`. InputError for another level; NumericalError if an edge cannot be found.
    Boundary locus of paper Eq. 17.
    """
    return stability.region(_method(method), _real(level, "level"))


def best_point(method: str | Method) -> stability.BestPoint | None:
    """Return the point with the smallest |z_p| and what meets there, dimensionless; None if no point is stable.

    None, too, where |z_p| falls on as the parameters grow, as for implicit Euler: then no point has the least.
    NumericalError if no solution of the defining equations is as small as a sampled |z_p|. The paper's section 5.1.
    """
    return stability.best_point(_method(method))


def choose(
    method: str | Method | None = None,
    *,
    goal: Goal | None = None,
    spread: float = 0.1,
    h: Number | None = None,
    h_min: Number | None = None,
    h_max: Number | None = None,
    hold: bool = False,
    settle: Number | None = None,
    equal: bool = False,
    omega: Number | None = None,
    omega_h: Number | None = None,
    engine: str | None = None,
    pd: Sequence[Number] | None = None,
    scene: str | Scene | None = None,
    speed: Number = 1,
    chain: int | None = None,
    mass_ratio: Number | None = None,
    iterations: int | None = None,
) -> questions.Answer:
    """Return the point that a goal asks for, dimensionless, proven stable, with the margins that remain.

    accurate, the usual goal: the least error forced on a motion of `omega` (1/s, with the step `h` in s) or `omega_h`
    (rad a step, 0.01 unless given), among what settles within `settle` (s), or while that motion turns by 14 rad.
    robust: fastest at worst over smaller steps and over alpha, beta off by the share `spread`; both with `h`, `h_max`
    (s) for the steps up to h_max, for use at h, and then omega_h is that of h_max. fastest: least |z_p|. critical: the
    fastest dominant pole that is double, real and positive. gentle: the mildest alpha = beta whose error falls a
    thousandfold within `settle` (s) at the step `h` (s). `equal` keeps alpha = beta. What else `check` says of a point
    this says of the choice: `engine` is a name, and `setting` the line to paste; with `pd` `gains` are those to set.
    With a `chain`, or a scene in an engine that sweeps, it is at most the strongest feedback that this allows with the
    spread to spare. `from_dimensionless` turns the answer into 1/s. Without a method it is the engine's own. InputError
    if nothing stable meets the goal, and for a goal, spread, time or motion that is none. The poles are those of paper
    Eq. 17, the goals this package's.
    """
    named = None if engine is None else engine_named(engine)
    drive = _drive(pd)
    if method is None and drive:
        raise InputError("pd: name one method, such as 'SYM' where the drive is applied explicitly")
    with _in_keywords():
        question = questions.Question(
            methods=() if method is None else (_method(method),),
            goal=goal or questions.usual_goal(named, drive),
            h=_exact_if_given(h, "h"),
            h_min=_exact_if_given(h_min, "h_min"),
            h_max=_exact_if_given(h_max, "h_max"),
            hold=hold,
            engine=named,
            drive=drive,
            omega=_exact_if_given(omega, "omega"),
            omega_h=_exact_if_given(omega_h, "omega_h"),
            scene=_scene_or_name(scene),
            speed=_exact(speed, "speed"),
            spread=_real(spread, "spread"),
            settle=_exact_if_given(settle, "settle"),
            equal=equal,
            chain=_chain(chain, mass_ratio),
            iterations=_whole(iterations, "iterations"),
        )
        (chosen,) = questions.answers(question)
    return chosen


def check(
    method: str | Method | None = None,
    *,
    alpha_hat: Number | None = None,
    beta_hat: Number | None = None,
    alpha: Number | None = None,
    beta: Number | None = None,
    h: Number | None = None,
    h_min: Number | None = None,
    h_max: Number | None = None,
    hold: bool = False,
    spread: float = 0.1,
    omega: Number | None = None,
    omega_h: Number | None = None,
    engine: str | None = None,
    as_typed: bool = False,
    pd: Sequence[Number] | None = None,
    scene: str | Scene | None = None,
    speed: Number = 1,
    chain: int | None = None,
    mass_ratio: Number | None = None,
    iterations: int | None = None,
) -> questions.Answer:
    """Return what there is to say of a point of your own: proven verdict, dominant pole, margins; dimensionless.

    The point is also what an engine makes of its values (`engine="mujoco=0.02,1"`), or a drive of its gains
    (`pd=(kp, kd, inertia)`), each with the step `h` (s). `safe` is whether errors shrink: with a `scene`, as it moves
    `speed` times as fast as given there; with `h_min` and `h_max` (s), for every sequence of such steps. An engine that
    solves one constraint after another is safe for `swept_over`: for one alone, for a `chain` of so many bodies, the
    last `mass_ratio` times as heavy, or for those of a scene at its start, in `iterations` sweeps. `margins` has
    the factors by which h, alpha and beta may be scaled alone; None unless the point is stable. Found when asked for:
    `cost` (of accuracy, on a motion of `omega` in 1/s or `omega_h` in rad a step), `instead`, `moving`, `varying`,
    `swept`, `setting`, `gains`. Without a method it is the engine's own. Of several points that an engine takes, or
    ways of applying a drive, the answer is the first that is not safe. Errors as for `verdict`, whose sources it
    shares; InputError, too, for a `spread` outside 0 to 1, and NumericalError if a pole leaves the range of float64.
    """
    named, values = (None, None) if engine is None else engine_and_values(engine)
    drive = _drive(pd)
    point = None
    if not (named or drive) or any(each is not None for each in (alpha_hat, beta_hat, alpha, beta)):
        point = _plane_point(alpha_hat, beta_hat, alpha, beta, h_max if h is None else h)
    with _in_keywords():
        question = questions.Question(
            methods=() if method is None else (_method(method),),
            point=point,
            h=_exact_if_given(h, "h"),
            h_min=_exact_if_given(h_min, "h_min"),
            h_max=_exact_if_given(h_max, "h_max"),
            hold=hold,
            engine=named,
            values=values,
            as_typed=as_typed,
            drive=drive,
            omega=_exact_if_given(omega, "omega"),
            omega_h=_exact_if_given(omega_h, "omega_h"),
            scene=_scene_or_name(scene),
            speed=_exact(speed, "speed"),
            spread=_real(spread, "spread"),
            chain=_chain(chain, mass_ratio),
            iterations=_whole(iterations, "iterations"),
        )
        given = list(questions.answers(question))
    return next((answer for answer in given if not answer.safe), given[0])


def check_drive(
    pd: Sequence[Number],
    *,
    h: Number,
    every: int = 1,
    late: Number = 0,
    filter_seconds: Number = 0,
    method: str | Method | None = None,
) -> questions.HeldAnswer:
    """Return what a drive does whose torque is held or late: proven verdict, |z_p| a step, limits, what is used up.

    `pd` is (kp, kd, inertia) in SI units, `h` (s) the step of the physics. The torque is computed every so many steps,
    applied so many steps `late`, and sees the velocity through a first-order filter of `filter_seconds` (s). Without a
    method all four ways of applying a drive are asked, and the answer is the first that is not safe. InputError for
    numbers out of range and for a method that is no way of applying a drive. Gil et al. 2009.
    """
    step, drive = _exact(h, "h"), _drive(pd)
    assert drive
    with _in_keywords():
        check_step(step, "h")
        timing = stability.Timing(every, _exact(late, "late"), _exact(filter_seconds, "filter_seconds") / step)
        question = questions.HeldQuestion(drive=drive, h=step, timing=timing)
        if method is not None:
            question = questions.HeldQuestion(drive=drive, h=step, timing=timing, methods=(_method(method),))
        found = list(questions.held_answers(question))
    return next((answer for answer in found if not answer.safe), found[0])


def largest_step(method: str | Method, *, alpha: Number, beta: Number) -> float:
    """Return the step (s) up to which every one is stable with alpha and beta (1/s), proven where the verdict turns.

    Infinite where every step is, zero where small ones are not. InputError unless the numbers are finite. The path of
    all steps through the plane of paper Eq. 17.
    """
    return questions.largest_step(_method(method), _exact(alpha, "alpha"), _exact(beta, "beta")).h_limit


def feedback_cost(
    method: str | Method,
    *,
    alpha_hat: Number | None = None,
    beta_hat: Number | None = None,
    alpha: Number | None = None,
    beta: Number | None = None,
    h: Number | None = None,
    omega: Number | None = None,
    omega_h: Number | None = None,
) -> stability.FeedbackCost:
    """Return the error that a feedback forces on a motion, as a share of its amplitude; and which order it leaves.

    The motion turns by `omega_h` (rad a step, 0.01 unless given), or by `omega` (1/s) at the step `h` (s).
    `forced_error` is that of the constraint in the steady state, `total_error` what is left in a run, `times_least`
    that over what the goal accurate of `choose` has; None where errors do not decay. `order_left` is the order in h
    where alpha_hat and beta_hat are held, of `order`, the method's own. InputError unless the point is given in one of
    the two ways, and omega h is 1e-6 to 1. The test equation of Prothero and Robinson (Math. Comp. 28, 1974).
    """
    a, b = _plane_point(alpha_hat, beta_hat, alpha, beta, h)
    with _in_keywords():
        step = _exact_if_given(h, "h")
        rate, turned = _exact_if_given(omega, "omega"), _exact_if_given(omega_h, "omega_h")
        motion = questions.motion_of(rate, None, Fraction(1), step, omega_h=turned)
    return stability.feedback_cost(_method(method), a, b, motion.omega_h)


def simulate(
    scene: str | Scene,
    method: str | Method,
    *,
    h: float,
    duration: float,
    alpha_hat: float | None = None,
    beta_hat: float | None = None,
    alpha: float | None = None,
    beta: float | None = None,
    start: mechanism.Start = "rk4",
    perturb: float = 0.0,
) -> Simulation:
    """Return a run of `duration` (s) with steps of h (s): t, q, v, c, cdot, multipliers and energy as arrays, SI units.

    t has shape (steps + 1,), the others a row for each time. The initial state is the scene's, its first constraint
    off by `perturb`. A run that breaks down ends early and says when and why in `failure`. InputError for a scene
    that cannot start, a duration below one step, and unless the point is given in one of the two ways; NumericalError
    for one that cannot be perturbed. Paper Eqs. 6 to 9.
    """
    a, b = _plane_point(alpha_hat, beta_hat, alpha, beta, h)
    return mechanism.simulated(
        mechanism.compiled_mechanism(_scene(scene)),
        _method(method),
        h=_real(h, "h"),
        duration=_real(duration, "duration"),
        alpha_hat=float(a),
        beta_hat=float(b),
        perturb=_real(perturb, "perturb"),
        start=start,
    )


def verify(
    scene: str | Scene,
    method: str | Method,
    *,
    h: float,
    alpha_hat: ArrayLike | None = None,
    beta_hat: ArrayLike | None = None,
    alpha: ArrayLike | None = None,
    beta: ArrayLike | None = None,
) -> list[evidence.Measurement]:
    """Return predicted and measured dominant pole for each of a row of points, at steps of h (s); dimensionless.

    `measured` is None, and `reason` says why, where no pole can be measured. InputError for a scene that cannot
    start, or unless the points are given in one of the two ways. Method: opposite kicks and linear prediction (Prony).
    """
    h = _real(h, "h")
    check_step(h)
    a, b = np.broadcast_arrays(*_plane_arrays(alpha_hat, beta_hat, alpha, beta, h))
    compiled = mechanism.compiled_mechanism(_scene(scene))
    return evidence.measure_poles(compiled, _method(method), h, np.atleast_1d(a).ravel(), np.atleast_1d(b).ravel())


def probe(
    c: ArrayLike,
    *,
    minus: ArrayLike | None = None,
    differenced: bool = False,
    methods: Sequence[str | Method] | None = None,
    alpha_hat: Number | None = None,
    beta_hat: Number | None = None,
    alpha: Number | None = None,
    beta: Number | None = None,
    h: Number | None = None,
    every: int = 1,
    turning: float | None = None,
) -> evidence.Probe:
    """Return the dominant pole in samples of a decaying error, and which integrator has it; poles are dimensionless.

    `c` has shape (samples,), or (samples, responses) of one system, in any unit; `minus` is another run of that shape
    to subtract, unless c is such a difference already (`differenced`). With a point, given in one of the two ways,
    `likenesses` compares each of `methods` [all built-in ones], the nearest first; without one `points` are those at
    which `methods` have the pole. `every` steps of h (s) lie between two samples. `turning` is how fast the directions
    of the constraints turn, in 1/s, and needs h. Where no pole can be told `found.reason` says why, and
    nothing is compared. InputError unless point, shapes and h fit together. Method: linear prediction (Prony).
    """
    has_point = not (alpha_hat is None and beta_hat is None and alpha is None and beta is None)
    point = _plane_point(alpha_hat, beta_hat, alpha, beta, h) if has_point else None
    if turning is not None and h is None:
        raise InputError("turning in 1/s needs the step h in s")
    turned = None if turning is None or h is None else _real(turning, "turning") * float(_exact(h, "h"))
    c = stability.real_array(c, "c")
    minus = None if minus is None else stability.real_array(minus, "minus")
    if methods is not None and (isinstance(methods, str | Method) or not isinstance(methods, Iterable)):
        raise InputError(f"methods = {shown(methods)}: expected a list of methods")
    found = evidence.probed_pole(c, minus, differenced)
    if point is None:
        named = [_method(name) for name in methods or ()]
        points = [one for own in named for one in evidence.points_like(found, own, every)]
        return evidence.Probe(found, (), tuple(points))
    compared = [_method(name) for name in (REGISTRY if methods is None else methods)]
    return evidence.Probe(found, tuple(evidence.likenesses(found, compared, *point, every, turned)), ())


def probe_step(
    step: Callable[[FloatArray], FloatArray],
    state: ArrayLike,
    constraint: Callable[[FloatArray], float],
    kick: ArrayLike,
    *,
    steps: int = 600,
    methods: Sequence[str | Method] | None = None,
    alpha_hat: Number | None = None,
    beta_hat: Number | None = None,
    alpha: Number | None = None,
    beta: Number | None = None,
    h: Number | None = None,
    turning: float | None = None,
) -> evidence.Probe:
    """Return what `probe` does, of a simulator's own function from a state to the next.

    `constraint` is the error in a state, in any unit, and `kick` is added to `state`, an array of the same shape, and
    subtracted from it; so are parts of it, to see growth as long as decay. `step` is called six times `steps` times.
    The keywords are those of `probe`, dimensionless or 1/s and s, and so are the errors: InputError for shapes that
    differ too.
    """
    return probe(
        evidence.kicked_responses(step, state, constraint, kick, steps),
        differenced=True,
        methods=methods,
        alpha_hat=alpha_hat,
        beta_hat=beta_hat,
        alpha=alpha,
        beta=beta,
        h=h,
        turning=turning,
    )


def _method(method_or_name: str | Method) -> Method:
    return method(method_or_name)


def _scene(scene_or_name: str | Scene) -> Scene:
    return scene(scene_or_name)


def _exact(value: Number, name: str) -> Fraction:
    """Return one number exactly: a text as it reads, a float as the decimal it shows; InputError for what is none."""
    if isinstance(value, np.ndarray | np.generic) and value.ndim == 0 and not isinstance(value, np.ma.MaskedArray):
        value = value.item()
    if isinstance(value, bool) or not isinstance(value, int | float | str | Fraction):
        raise InputError(f"{name} = {shown(value)}: expected one real number")
    if isinstance(value, str):
        try:
            return rational(value)
        except InputError as error:
            raise InputError(f"{name}: {error}") from None
    if isinstance(value, float) and not math.isfinite(value):
        raise InputError(f"{name} = {value} is not a finite number")
    return exact(value) if isinstance(value, float) else within_float64(Fraction(value), name)


def _exact_if_given(value: Number | None, name: str) -> Fraction | None:
    return None if value is None else _exact(value, name)


def _drive(gains: Sequence[Number] | None) -> Drive | None:
    """Return the drive of gains (kp, kd, inertia); InputError for another number of them."""
    if gains is None:
        return None
    if isinstance(gains, str) or not isinstance(gains, Sequence) or len(gains) != 3:
        raise InputError(f"pd = {shown(gains)}: expected (kp, kd, inertia)")
    return Drive(*(_exact(gain, name) for gain, name in zip(gains, ("kp", "kd", "inertia"), strict=True)))


def _chain(bodies: int | None, mass_ratio: Number | None) -> questions.Chain | None:
    """Return the chain that is asked about, None without one; InputError as `typed_chain`."""
    return questions.typed_chain(_whole(bodies, "chain"), _exact_if_given(mass_ratio, "mass_ratio"))


def _whole(value: int | None, name: str) -> int | None:
    if value is not None and (isinstance(value, bool) or not isinstance(value, int)):
        raise InputError(f"{name} = {shown(value)}: expected a whole number")
    return value


def _scene_or_name(given: str | Scene | None) -> str | Scene | None:
    """Return a scene or its name as given; InputError for anything else."""
    return given if given is None or isinstance(given, str) else scene(given)


@contextmanager
def _in_keywords() -> Iterator[None]:
    """Turn the options that an InputError names (--h-max) into the keywords of a function (h_max)."""
    try:
        yield
    except InputError as error:
        said = re.sub(r"--([a-z]+(?:-[a-z]+)*)", lambda option: option[1].replace("-", "_"), str(error))
        raise InputError(said) from None


def _real(value: Number, name: str) -> float:
    """Return one number as float64, infinite and nan ones too, which whoever takes it refuses in its own words."""
    if isinstance(value, float) and not math.isfinite(value):
        return value
    return float(_exact(value, name))


def _is_dimensionless(*, alpha_hat: object, beta_hat: object, alpha: object, beta: object, h: object) -> bool:
    """Return whether a point was given as alpha_hat and beta_hat; InputError unless so, or as alpha, beta and h."""
    has_dimensionless = alpha_hat is not None and beta_hat is not None and alpha is None and beta is None
    has_physical = alpha is not None and beta is not None and alpha_hat is None and beta_hat is None
    if has_physical and h is None:
        raise InputError("alpha and beta in 1/s need the step h in s")
    if not has_dimensionless and not has_physical:
        raise InputError("a point is given as alpha_hat= and beta_hat=, or as alpha= and beta= in 1/s with h= in s")
    return has_dimensionless


def _plane_arrays(
    alpha_hat: ArrayLike | None,
    beta_hat: ArrayLike | None,
    alpha: ArrayLike | None,
    beta: ArrayLike | None,
    h: float | None,
) -> tuple[FloatArray, FloatArray]:
    """Return alpha_hat and beta_hat as float64 arrays, from whichever of the two ways was taken."""
    if _is_dimensionless(alpha_hat=alpha_hat, beta_hat=beta_hat, alpha=alpha, beta=beta, h=h):
        return _broadcastable(stability.real_array(alpha_hat, "alpha_hat"), stability.real_array(beta_hat, "beta_hat"))
    assert h is not None
    in_seconds = _broadcastable(stability.real_array(alpha, "alpha"), stability.real_array(beta, "beta"))
    return to_dimensionless(*in_seconds, _real(h, "h"))


def _broadcastable(first: FloatArray, second: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return two arrays; InputError if their shapes do not fit each other."""
    try:
        np.broadcast_shapes(first.shape, second.shape)
    except ValueError:
        shapes = f"{first.shape} and {second.shape}"
        raise InputError(f"shapes {shapes}: alpha and beta, or their hats, must broadcast, as numpy calls it") from None
    return first, second


def _plane_point(
    alpha_hat: Number | None, beta_hat: Number | None, alpha: Number | None, beta: Number | None, h: Number | None
) -> tuple[Fraction, Fraction]:
    """Return alpha_hat and beta_hat as exact numbers, from whichever of the two ways was taken."""
    if _is_dimensionless(alpha_hat=alpha_hat, beta_hat=beta_hat, alpha=alpha, beta=beta, h=h):
        assert alpha_hat is not None
        assert beta_hat is not None
        return _exact(alpha_hat, "alpha_hat"), _exact(beta_hat, "beta_hat")
    assert alpha is not None
    assert beta is not None
    assert h is not None
    return to_dimensionless(_exact(alpha, "alpha"), _exact(beta, "beta"), _exact(h, "h"))
