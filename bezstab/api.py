"""What `import bezstab` offers: functions that take names of methods and scenes, with units stated.

A point is given in one of two ways: `alpha_hat=` and `beta_hat=` (dimensionless, alpha_hat = 2 alpha h and
beta_hat = beta^2 h^2, paper Eq. 16), or `alpha=` and `beta=` in 1/s with the step `h=` in s. A method is a name as on
the command line ("B4", "RK4@5", "mine.toml"), or what `method` returns. A scene is the name of a shipped one, the path
of a TOML file, or what `scene` returns.
"""

from __future__ import annotations  # so that help() shows annotations as they are written

from typing import Any

from numpy.typing import ArrayLike

from bezstab.arguments import Number, exact_or_none, in_keywords, plane_point
from bezstab.methods.registry import method as method_named
from bezstab.methods.schemes import Method
from bezstab.methods.schur import Verdict
from bezstab.questions.motions import motion_of
from bezstab.stability import arrays, best_points, closed_loop, feedback_costs
from bezstab.stability.arrays import ComplexArray, FloatArray


def poles(
    method: str | Method,
    *,
    alpha_hat: ArrayLike | None = None,
    beta_hat: ArrayLike | None = None,
    alpha: ArrayLike | None = None,
    beta: ArrayLike | None = None,
    h: Number | None = None,
) -> ComplexArray:
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
    return closed_loop.poles(method_named(method), *_plane_arrays(alpha_hat, beta_hat, alpha, beta, h))


def dominant_pole(
    method: str | Method,
    *,
    alpha_hat: ArrayLike | None = None,
    beta_hat: ArrayLike | None = None,
    alpha: ArrayLike | None = None,
    beta: ArrayLike | None = None,
    h: Number | None = None,
) -> ComplexArray:
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
    return closed_loop.dominant_pole(method_named(method), *_plane_arrays(alpha_hat, beta_hat, alpha, beta, h))


def spectral_radius(
    method: str | Method,
    *,
    alpha_hat: ArrayLike | None = None,
    beta_hat: ArrayLike | None = None,
    alpha: ArrayLike | None = None,
    beta: ArrayLike | None = None,
    h: Number | None = None,
) -> FloatArray:
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
    return closed_loop.spectral_radius(method_named(method), *_plane_arrays(alpha_hat, beta_hat, alpha, beta, h))


def verdict(
    method: str | Method,
    *,
    alpha_hat: Number | None = None,
    beta_hat: Number | None = None,
    alpha: Number | None = None,
    beta: Number | None = None,
    h: Number | None = None,
) -> Verdict:
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
    return closed_loop.verdict(method_named(method), *plane_point(alpha_hat, beta_hat, alpha, beta, h))


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


@in_keywords()
def feedback_cost(
    method: str | Method,
    *,
    omega: Number | None = None,
    omega_h: Number | None = None,
    alpha_hat: Number | None = None,
    beta_hat: Number | None = None,
    alpha: Number | None = None,
    beta: Number | None = None,
    h: Number | None = None,
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
        exact_or_none(h, "h"),
        omega_h=exact_or_none(omega_h, "omega_h"),
    )
    first, second = plane_point(alpha_hat, beta_hat, alpha, beta, h)
    return feedback_costs.feedback_cost(method_named(method), first, second, motion.omega_h)


def _plane_arrays(*given: Any) -> tuple[FloatArray, FloatArray]:
    """Return a point, given as for `plane_point`, as float64 arrays, broadcast; errors as `plane_arrays`."""
    return arrays.plane_arrays(*plane_point(*given, read=arrays.real_array))
