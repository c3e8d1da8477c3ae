"""What `import bezstab` offers: functions that take names of methods and scenes, with units stated.

A point is given in one of two ways: `alpha_hat=` and `beta_hat=` (dimensionless, alpha_hat = 2 alpha h and
beta_hat = beta^2 h^2, paper Eq. 16), or `alpha=` and `beta=` in 1/s with the step `h=` in s. A method is a name as on
the command line ("B4", "RK4@5", "mine.toml"), or what `method` returns. A scene is the name of a shipped one, the path
of a TOML file, or what `scene` returns.
"""

from __future__ import annotations  # so that help() shows annotations as they are written

import inspect
from collections.abc import Callable, Mapping
from fractions import Fraction
from typing import Any, Generic, TypedDict, TypeVar, Unpack, get_args, get_origin, get_type_hints

from numpy.typing import ArrayLike

from bezstab.arguments import Number, exact_or_none, in_keywords, plane_point
from bezstab.methods.registry import method as method_named
from bezstab.methods.schemes import Method
from bezstab.methods.schur import Verdict
from bezstab.questions.motions import motion_of
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


Function = TypeVar("Function", bound=Callable[..., Any])


def _spelled_out(function: Function) -> Function:
    """Have help() and notebooks show one by one the keywords that a function gathers in its last parameter."""
    signature = inspect.signature(function)
    *others, gathered = signature.parameters.values()
    (kind,) = get_args(get_type_hints(function)[gathered.name])
    for name in (get_origin(kind) or kind).__annotations__:
        others.append(inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=None))
    function.__signature__ = signature.replace(parameters=others)  # type: ignore[attr-defined]
    return function


@_spelled_out
def poles(method: str | Method, **point: Unpack[PointAtStep[ArrayLike]]) -> ComplexArray:
    """Return all poles z of the constraint error: each step multiplies a part of the error by z.

    Parameters
    ----------
    method : str or Method
        The integration method.
    alpha_hat, beta_hat : array_like, optional
        The feedback, dimensionless.
    alpha, beta, h : array_like, optional
        In their place: the feedback in 1/s and the step (s).

    Returns
    -------
    complex array
        Dimensionless, in order of falling |z|: the shape of the broadcast coordinates, and a last axis for the poles.

    Raises
    ------
    InputError
        The point is not given in one of the two ways.
    NumericalError
        A pole leaves the range of float64.

    References
    ----------
    The roots of the paper's Eq. 17.
    """
    return closed_loop.poles(method_named(method), *_plane_arrays(point))


@_spelled_out
def dominant_pole(method: str | Method, **point: Unpack[PointAtStep[ArrayLike]]) -> ComplexArray:
    """Return z_p, the pole of largest modulus: in the long run each step multiplies the error by it.

    Parameters
    ----------
    method : str or Method
        The integration method.
    alpha_hat, beta_hat : array_like, optional
        The feedback, dimensionless.
    alpha, beta, h : array_like, optional
        In their place: the feedback in 1/s and the step (s).

    Returns
    -------
    complex array
        Dimensionless, of the shape of the broadcast coordinates; of a conjugate pair the pole with Im z >= 0.

    Raises
    ------
    InputError
        The point is not given in one of the two ways.
    NumericalError
        A pole leaves the range of float64.

    References
    ----------
    The paper's section 4.
    """
    return closed_loop.dominant_pole(method_named(method), *_plane_arrays(point))


@_spelled_out
def spectral_radius(method: str | Method, **point: Unpack[PointAtStep[ArrayLike]]) -> FloatArray:
    """Return |z_p|, the factor by which each step multiplies the constraint error in the long run.

    Parameters
    ----------
    method : str or Method
        The integration method.
    alpha_hat, beta_hat : array_like, optional
        The feedback, dimensionless.
    alpha, beta, h : array_like, optional
        In their place: the feedback in 1/s and the step (s).

    Returns
    -------
    float64 array
        Dimensionless, of the shape of the broadcast coordinates. Errors decay below 1; close to 1 rounding can decide,
        and `verdict` is exact.

    Raises
    ------
    InputError
        The point is not given in one of the two ways.
    NumericalError
        A pole leaves the range of float64.

    References
    ----------
    The paper's Figs. 1 to 3.
    """
    return closed_loop.spectral_radius(method_named(method), *_plane_arrays(point))


@_spelled_out
def verdict(method: str | Method, **point: Unpack[PointAtStep[Number]]) -> Verdict:
    """Return what the error does at one point, proven in exact arithmetic.

    Parameters
    ----------
    method : str or Method
        The integration method.
    alpha_hat, beta_hat : number or str, optional
        The feedback, dimensionless. Read as written: 0.1 is one tenth, "6/11" a fraction.
    alpha, beta, h : number or str, optional
        In their place: the feedback in 1/s and the step (s).

    Returns
    -------
    {"converges", "marginal", "diverges"}

    Raises
    ------
    InputError
        A number is not finite, or the point is not given in one of the two ways.

    References
    ----------
    The Schur-Cohn test (I. Schur, J. reine angew. Math. 147, 1917) on the polynomial of the paper's Eq. 17.
    """
    return closed_loop.verdict(method_named(method), *_plane_point(point))


def best_point(method: str | Method) -> best_points.BestPoint | None:
    """Return the point of the plane with the smallest |z_p|, where the constraint error decays fastest.

    Parameters
    ----------
    method : str or Method
        The integration method.

    Returns
    -------
    BestPoint or None
        `alpha_hat`, `beta_hat` and `z_abs`, dimensionless; `z_abs` within 1e-7. None if no point is stable, or if |z_p|
        falls as the feedback grows without end, as for implicit Euler.

    Raises
    ------
    NumericalError
        A pole leaves the range of float64.

    References
    ----------
    The paper's section 5.1.
    """
    return best_points.best_point(method_named(method))


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

    Parameters
    ----------
    method : str or Method
        The integration method.
    alpha_hat, beta_hat : number or str, optional
        The feedback, dimensionless.
    alpha, beta, h : number or str, optional
        In their place: the feedback in 1/s and the step (s).
    omega, omega_h : number, optional
        Rate of the motion: omega (1/s) with h, or omega_h (rad a step); by default omega_h is 0.01.

    Returns
    -------
    FeedbackCost
        Relative to the amplitude of the motion: `forced_error` of the constraint in the steady state, `total_error`
        that stays in a run, `velocity_error` of the velocity. `times_least` compares `total_error` with that of the
        goal accurate. `order_left` is the order in h if alpha_hat and beta_hat stay constant. None for what is not
        known.

    Raises
    ------
    InputError
        The point is not given in one of the two ways, or omega h is not from 1e-6 to 1.

    References
    ----------
    The test equation of Prothero and Robinson, Math. Comp. 28, 1974.
    """
    motion = motion_of(
        exact_or_none(omega, "omega"),
        None,
        Fraction(1),
        exact_or_none(point.get("h"), "h"),
        omega_h=exact_or_none(omega_h, "omega_h"),
    )
    return feedback_costs.feedback_cost(method_named(method), *_plane_point(point), motion.omega_h)


def _four(point: Mapping[str, Any]) -> tuple[Any, Any, Any, Any, Any]:
    """Return the coordinates of a point in both ways, None where they are not given, and the step."""
    return point.get("alpha_hat"), point.get("beta_hat"), point.get("alpha"), point.get("beta"), point.get("h")


def _plane_point(point: Mapping[str, Any]) -> tuple[Any, Any]:
    """Return alpha_hat and beta_hat from whichever of the two ways was taken, exact."""
    return plane_point(*_four(point))


def _plane_arrays(point: Mapping[str, Any]) -> tuple[FloatArray, FloatArray]:
    """Return the same as float64 arrays, broadcast; InputError if their shapes do not fit each other."""
    return arrays.plane_arrays(*plane_point(*_four(point), arrays.real_array))
