"""What `import bezstab` offers: functions that take names of methods and scenes, with units stated.

A point is given in one of two ways: `alpha_hat=` and `beta_hat=` (dimensionless, alpha_hat = 2 alpha h and
beta_hat = beta^2 h^2, paper Eq. 16), or `alpha=` and `beta=` in 1/s with the step `h=` in s. A method is a name as on
the command line ("B4", "RK4@5", "mine.toml"), or what `method` returns. A scene is the name of a shipped one, the path
of a TOML file, or what `scene` returns.
"""

from __future__ import annotations  # so that help() shows annotations as they are written

import inspect
from collections.abc import Callable, Iterable, Mapping
from typing import Any, Generic, TypedDict, TypeVar, Unpack, get_args, get_origin, get_type_hints

from numpy.typing import ArrayLike

from bezstab.arguments import Number, exact_number, in_keywords, plane_point, point_if_given, real_number, whole_number
from bezstab.engines.engine_list import engine_and_values, engine_named
from bezstab.goals import Goal
from bezstab.mechanism import scene_files
from bezstab.mechanism.scenes import Scene
from bezstab.methods.registry import method as method_named
from bezstab.methods.schemes import Method
from bezstab.methods.schur import Verdict
from bezstab.questions import answering, question
from bezstab.stability import arrays, best_points, closed_loop, feedback_costs
from bezstab.stability.arrays import ComplexArray, FloatArray

Given = TypeVar("Given")


class Point(TypedDict, Generic[Given], total=False):
    """A point: alpha_hat and beta_hat, dimensionless, or alpha and beta in 1/s."""

    alpha_hat: Given | None
    beta_hat: Given | None
    alpha: Given | None
    beta: Given | None


class PointAtStep(Point[Given], total=False):
    """A point, with the step in s for one in 1/s."""

    h: Number | None


class AboutFeedback(TypedDict, total=False):
    """What `choose` and `check` may be told alike; `Question` in `bezstab.questions` has the usual values."""

    h: Number | None
    spread: float
    omega: Number | None
    omega_h: Number | None
    scene: str | Scene | None
    speed: Number


Function = TypeVar("Function", bound=Callable[..., Any])
Asked = TypeVar("Asked")


def _spelled_out(function: Function) -> Function:
    """Have help() and notebooks show one by one the keywords that a function gathers in its last parameter."""
    signature = inspect.signature(function)
    *others, gathered = signature.parameters.values()
    (kind,) = get_args(get_type_hints(function)[gathered.name])
    for name in (get_origin(kind) or kind).__annotations__:
        usual = getattr(question.Question, name, None)
        others.append(inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=usual))
    function.__signature__ = signature.replace(parameters=others)  # type: ignore[attr-defined]
    return function


@_spelled_out
def poles(method: str | Method, **point: Unpack[PointAtStep[ArrayLike]]) -> ComplexArray:
    """Return all poles z of the constraint error: each step multiplies a part of the error by z.

    The point is `alpha_hat` and `beta_hat`, or `alpha` and `beta` in 1/s with the step `h` in s.
    Numbers or arrays.

    Returns complex numbers, dimensionless, in order of falling |z|. The shape is that of the two
    coordinates, broadcast, with one more axis at the end for the poles.

    InputError unless the point is given in one of the two ways. NumericalError if a pole leaves the
    range of float64. Source: the roots of paper Eq. 17.
    """
    return closed_loop.poles(method_named(method), *_plane_arrays(point))


@_spelled_out
def dominant_pole(method: str | Method, **point: Unpack[PointAtStep[ArrayLike]]) -> ComplexArray:
    """Return z_p, the pole of largest modulus: in the long run each step multiplies the error by it.

    The point is `alpha_hat` and `beta_hat`, or `alpha` and `beta` in 1/s with the step `h` in s.
    Numbers or arrays.

    Returns complex numbers, dimensionless, in the shape of the two coordinates, broadcast. Of a
    conjugate pair it is the one with Im z >= 0.

    Errors as for `poles`. Source: the paper's section 4.
    """
    return closed_loop.dominant_pole(method_named(method), *_plane_arrays(point))


@_spelled_out
def spectral_radius(method: str | Method, **point: Unpack[PointAtStep[ArrayLike]]) -> FloatArray:
    """Return |z_p|, the factor by which each step multiplies the constraint error in the long run.

    The error decays where it is below 1. The point is `alpha_hat` and `beta_hat`, or `alpha` and `beta`
    in 1/s with the step `h` in s. Numbers or arrays.

    Returns float64, dimensionless, in the shape of the two coordinates, broadcast.

    Errors as for `poles`. Close to 1 rounding may decide: `verdict` is exact. Source: the paper's Figs.
    1 to 3.
    """
    return closed_loop.spectral_radius(method_named(method), *_plane_arrays(point))


@_spelled_out
def verdict(method: str | Method, **point: Unpack[PointAtStep[Number]]) -> Verdict:
    """Return "converges", "marginal" or "diverges": what the error does at one point.

    The point is `alpha_hat` and `beta_hat`, or `alpha` and `beta` in 1/s with the step `h` in s. Each
    number is read as it is written. 0.1 is one tenth, and "6/11" is a fraction.

    Returns one of the three words. It is proven in exact arithmetic.

    InputError unless the numbers are finite and the point is given in one of the two ways. Source: the
    Schur-Cohn test (I. Schur, J. reine angew. Math. 147, 1917) on the polynomial of paper Eq. 17.
    """
    return closed_loop.verdict(method_named(method), *_plane_point(point))


def best_point(method: str | Method) -> best_points.BestPoint | None:
    """Return the point of the plane with the smallest |z_p|, where the constraint error decays fastest.

    Returns a BestPoint with `alpha_hat`, `beta_hat` and `z_abs`, which is good to 1e-7, dimensionless.
    Returns None if no point is stable, or if |z_p| keeps falling as the parameters grow, as for
    implicit Euler.

    NumericalError if a pole leaves the range of float64. Source: the paper's section 5.1.
    """
    return best_points.best_point(method_named(method))


@_spelled_out
@in_keywords()
def choose(
    method: str | Method | None = None,
    *,
    goal: Goal | None = None,
    settle: Number | None = None,
    h_max: Number | None = None,
    equal: bool = False,
    engine: str | None = None,
    **asked: Unpack[AboutFeedback],
) -> answering.Answer:
    """Return the alpha and beta to use: the point that a goal asks for, proven stable, with its margins.

    method: your integration method. Without one it is the engine's own.

    goal: what the point is for.
      "accurate", the usual one: the least error that the feedback makes on a motion, among the points
          that settle within `settle` (s). Without `settle` they may take as long as the motion needs to
          turn by 14 rad. The motion turns by `omega` (1/s, with the step `h` in s), or by `omega_h` rad
          a step. Where alpha and beta are multiples of omega, whatever the step, as with most
          Runge-Kutta methods, one of them or a scene is needed. There `omega` alone will do: `alpha`,
          `beta` and `h_limit` of the answer do not depend on `h`, which is then 0.01 / omega. With
          other methods `omega_h` is 0.01 unless given.
      "robust": the fastest decay in the worst case. alpha and beta may be off by the share `spread`,
          and the step may be smaller. The usual goal with an engine whose alpha and beta depend on
          each other.
      "fastest": the least |z_p|.
      "critical": the fastest among the points with alpha = beta whose dominant pole is double, real and
          positive; not for methods that step position and velocity differently.
      "gentle": the mildest alpha = beta whose error falls a thousandfold within `settle` (s) at the
          step `h` (s).

    equal: only points with alpha = beta.
    h, h_max: the step and the largest step in s. With both, accurate and robust allow for steps up to
        h_max. The answer is for use at h. `omega_h` is then that of h_max.
    engine: a name, such as "mujoco"; only what that engine can express is searched, and `setting` is
        the line to paste.
    scene, speed: a mechanism that moves so many times as fast as given there; `moving` says what the
        motion changes.

    Returns an Answer, dimensionless: `alpha_hat`, `beta_hat`, `pole`, `margins`, `safe` and all else
    that `check` says. `from_dimensionless` turns it into alpha and beta in 1/s.

    InputError if nothing stable meets the goal, or if an argument is out of range. Source: the poles of
    paper Eq. 17; the goals are this package's.
    """
    named = None if engine is None else engine_named(engine)
    given = () if method is None else READ["methods"](method, "methods")
    wanted = _asked(
        question.Question,
        methods=method,
        goal=goal or question.usual_goal(named, given),
        settle=settle,
        h_max=h_max,
        equal=equal,
        engine=named,
        **asked,
    )
    (chosen,) = answering.answers(wanted)
    return chosen


@_spelled_out
@in_keywords()
def check(
    method: str | Method | None = None,
    *,
    alpha_hat: Number | None = None,
    beta_hat: Number | None = None,
    alpha: Number | None = None,
    beta: Number | None = None,
    engine: str | None = None,
    as_typed: bool = False,
    **asked: Unpack[AboutFeedback],
) -> answering.Answer:
    """Return whether a point of your own is safe, how fast errors decay there, and how far the point may move.

    The point is one of these:
      `alpha_hat` and `beta_hat`, dimensionless;
      `alpha` and `beta` in 1/s with the step `h` in s;
      `engine`, an engine's own values, such as "mujoco=0.02,1", with `h`. `as_typed` leaves out the
          engine's clamps.

    method: your integration method. Without one it is the engine's own.
    spread: the share by which alpha and beta may be off, for `worst`.
    omega, omega_h: how fast the motion is, in 1/s or in rad a step, for `cost`: only where one of them
        or a scene is given, it says how many times the least error it is.
    scene, speed: a mechanism that moves so many times as fast as given there.

    Returns an Answer, dimensionless. If there are several, as of the ways of applying a drive, it is
    the first that is not safe. `sentence` says it in words, and begins the repr. `verdict` is proven.
    `pole` is the dominant one. `safe`, and bool() of the answer, is whether errors shrink: with a
    scene also as it moves. `margins` has the factors by which h, alpha and beta may each be scaled
    alone; None unless the point is stable. These are computed when you first ask for them: `cost`
    (of accuracy), `instead` (what `choose` gives), `moving`, `swept` (many constraints) and `setting`
    (the engine's line).

    InputError unless the point is given in one of these ways and the numbers are in range.
    NumericalError if a pole leaves the range of float64. Sources as for `verdict`.
    """
    named, values = (None, None) if engine is None else engine_and_values(engine)
    typed = {"alpha_hat": alpha_hat, "beta_hat": beta_hat, "alpha": alpha, "beta": beta, "h": asked.get("h")}
    wanted = _asked(
        question.Question,
        methods=method,
        point=_point_if_given(typed, needed=engine is None),
        engine=named,
        values=values,
        as_typed=as_typed,
        **asked,
    )
    return _first_unsafe(answering.answers(wanted))


def largest_step(method: str | Method, *, alpha: Number, beta: Number) -> float:
    """Return the step in s up to which every step is stable with alpha and beta in 1/s.

    Returns a float: infinite if every step is stable, 0 if small ones are not. The verdict is proven on
    both sides.

    InputError unless the numbers are finite. Source: the path of all steps through the plane of paper
    Eq. 17.
    """
    return answering.LargestStep(method_named(method), exact_number(alpha, "alpha"), exact_number(beta, "beta")).h_limit


@_spelled_out
@in_keywords()
def feedback_cost(
    method: str | Method,
    *,
    omega: Number | None = None,
    omega_h: Number | None = None,
    **point: Unpack[PointAtStep[Number]],
) -> feedback_costs.FeedbackCost:
    """Return the errors that a feedback makes on a mechanism that moves.

    The point is `alpha_hat` and `beta_hat`, or `alpha` and `beta` in 1/s with the step `h` in s. The
    motion turns by `omega_h` rad a step (0.01 unless given), or by `omega` in 1/s at the step `h`.

    Returns a FeedbackCost. Errors are shares of the motion's amplitude: `forced_error` is that of the
    constraint in the steady state, `total_error` the error that stays in a run, `velocity_error` that of the
    velocity. `times_least` is the total error over the least that can be had, by the goal accurate of
    `choose`. `order_left` is the order in h that remains of the method's own `order` while alpha_hat
    and beta_hat stay the same. What is not known, as where errors grow, is None.

    InputError unless the point is given in one of the two ways and omega h is from 1e-6 to 1. Source:
    the test equation of Prothero and Robinson (Math. Comp. 28, 1974).
    """
    wanted = _asked(
        question.Question,
        methods=method,
        point=_plane_point(point),
        h=point.get("h"),
        omega=omega,
        omega_h=omega_h,
    )
    return feedback_costs.feedback_cost(wanted.methods[0], *wanted.given.point, wanted.motion.omega_h)


def _scene(scene_or_name: str | Scene, _name: str = "scene") -> Scene:
    return scene_files.scene(scene_or_name)


def _asked(kind: Callable[..., Asked], **given: Any) -> Asked:
    """Return a question of that kind, its keywords as `READ` reads them; those that are None are left to the question.

    TypeError for a keyword that is none.
    """
    told = {name: value for name, value in given.items() if value is not None}
    return kind(**{name: READ[name](value, name) if name in READ else value for name, value in told.items()})


def _first_unsafe(answers: Iterable[answering.Answer]) -> answering.Answer:
    """Return the first answer that is not safe; the first of all where every one is."""
    found = list(answers)
    return next((answer for answer in found if not answer.safe), found[0])


READ: Mapping[str, Callable[[Any, str], Any]] = {
    **dict.fromkeys(("h", "h_max", "omega", "omega_h", "speed", "settle"), exact_number),
    **dict.fromkeys(("late", "filter_seconds", "duration", "perturb"), exact_number),
    **dict.fromkeys(("iterations",), whole_number),
    "spread": real_number,
    "scene": _scene,
    "methods": lambda given, _name: (method_named(given),),
}
"""How keywords are read; the others are taken as they are."""


def _four(point: Mapping[str, Any]) -> tuple[Any, Any, Any, Any, Any]:
    """Return the coordinates of a point in both ways, None where they are not given, and the step."""
    return point.get("alpha_hat"), point.get("beta_hat"), point.get("alpha"), point.get("beta"), point.get("h")


def _plane_point(point: Mapping[str, Any]) -> tuple[Any, Any]:
    """Return alpha_hat and beta_hat from whichever of the two ways was taken, exact."""
    return plane_point(*_four(point))


def _point_if_given(point: Mapping[str, Any], *, needed: bool) -> tuple[Any, Any] | None:
    """Return the same; None if no coordinate is given, unless a point is needed."""
    return _plane_point(point) if needed else point_if_given(*_four(point))


def _plane_arrays(point: Mapping[str, Any]) -> tuple[FloatArray, FloatArray]:
    """Return the same as float64 arrays, broadcast; InputError if their shapes do not fit each other."""
    return arrays.plane_arrays(*plane_point(*_four(point), arrays.real_array))
