"""Plots for a notebook or a script: each function draws a result of `import bezstab` and returns what it drew.

Without `axes` each makes a new Figure of its own, as the attribute `figure` of what it returns; pyplot is not involved:
`plot.region(region(method("B4"))).figure.savefig("b4.png")`. With `axes` it draws there, and several results come into
one picture. The plane is alpha_hat, beta_hat (dimensionless); with `h` in s it is 2 alpha (1/s) and beta^2 (1/s^2).
Further keyword arguments are matplotlib's, for the line that is drawn.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, SupportsFloat

import numpy as np
from matplotlib.axes import Axes
from matplotlib.image import AxesImage
from matplotlib.lines import Line2D
from matplotlib.patheffects import withStroke
from numpy.typing import ArrayLike

from bezstab.errors import check_kind
from bezstab.methods.schemes import Method
from bezstab.show.style import (
    DASHES,
    cells,
    line_at,
    new_axes,
    plane_coordinates,
    plane_words,
    styled,
    title_lines,
)
from bezstab.stability.arrays import FloatArray
from bezstab.stability.best_points import BestPoint
from bezstab.stability.choices import Choice
from bezstab.stability.closed_loop import spectral_radius as spectral_radius_at
from bezstab.stability.regions import Region, window

if TYPE_CHECKING:  # so that a picture of the plane does not load what runs mechanisms
    from bezstab.mechanism.scenes import Scene
    from bezstab.mechanism.simulation import Simulation

Range = tuple[SupportsFloat, SupportsFloat]

__all__ = [
    "critical_damping",
    "history",
    "mechanism",
    "modulus_map",
    "point",
    "region",
    "spectral_radius",
]


def __dir__() -> list[str]:
    return sorted(__all__)


PARABOLA = 400  # points of a smooth curve: more than its pixels tell apart
NAME_OFF = 4.0  # points from a body up to its name
FINE = 0.6  # points: lines of histories, so that fast oscillations are told apart


def region(region: Region, axes: Axes | None = None, h: SupportsFloat | None = None, **line: Any) -> Line2D:
    """Draw the boundary of a region |z_p| < level.

    Parameters
    ----------
    region : Region
        What `bezstab.region` returns.
    axes : Axes, optional
        Where to draw; by default a figure of its own.
    h : float, optional
        Step (s) with which the axes are 2 alpha (1/s) and beta^2 (1/s^2); by default they are alpha_hat and beta_hat.
    **line
        Properties of the line. By default its colour and dashes are new in the axes, its label the method's name.

    Returns
    -------
    Line2D
        All curves of the boundary, nan between them. Far curves and islands do not widen the axes.
    """
    check_kind(region, Region, "bezstab.region")
    label = region.method.name if region.bounded else f"{region.method.name} (unbounded)"
    axes = _plane(axes, rf"$|z_p| = {region.level:g}$", h)
    drawn = _line(axes, ([], []), line, label=label)
    gap = np.full((1, 2), np.nan)  # lifts the pen from one closed curve to the next
    points = np.concatenate([part for curve in region.boundary for part in (curve, gap)] or [gap])
    drawn.set_data(*plane_coordinates(points[:, 0], points[:, 1], h))  # which leaves the limits of the axes alone
    alpha_range, beta_range = np.array(window(region))
    axes.update_datalim(np.transpose(plane_coordinates(alpha_range, beta_range, h)))
    axes.autoscale_view()
    return drawn


def spectral_radius(
    method: Method,
    alpha_range: Range,
    beta_range: Range,
    points: int = 200,
    axes: Axes | None = None,
    h: SupportsFloat | None = None,
) -> AxesImage:
    """Draw |z_p| over a rectangle of the plane; blank where |z_p| >= 1.

    Parameters
    ----------
    method : Method
        What `bezstab.method` returns.
    alpha_range, beta_range : (low, high)
        Ranges of alpha_hat and beta_hat, dimensionless whatever the axes.
    points : int
        Points in each direction.
    axes : Axes, optional
        Where to draw; by default a figure of its own.
    h : float, optional
        Step (s) with which the axes are 2 alpha (1/s) and beta^2 (1/s^2); by default they are alpha_hat and beta_hat.

    Returns
    -------
    AxesImage
        Of shape (points, points).
    """
    check_kind(method, Method, "bezstab.method")
    alpha_hat, beta_hat = (np.linspace(float(low), float(high), points) for low, high in (alpha_range, beta_range))
    z_abs = spectral_radius_at(method, alpha_hat, beta_hat[:, np.newaxis])
    return modulus_map(alpha_hat, beta_hat, z_abs, axes=_plane(axes, method.name, h), h=h)


def modulus_map(
    alpha_hat: FloatArray,
    beta_hat: FloatArray,
    z_abs: FloatArray,
    axes: Axes | None = None,
    h: SupportsFloat | None = None,
) -> AxesImage:
    """Draw |z_p| that was computed before on an even grid; blank where |z_p| >= 1.

    Parameters
    ----------
    alpha_hat, beta_hat : array
        Dimensionless, of shapes (n,) and (m,).
    z_abs : array
        |z_p|, of shape (m, n).
    axes : Axes, optional
        Where to draw; by default a figure of its own.
    h : float, optional
        Step (s) with which the axes are 2 alpha (1/s) and beta^2 (1/s^2); by default they are alpha_hat and beta_hat.

    Returns
    -------
    AxesImage
    """
    stable = np.ma.masked_greater_equal(z_abs, 1.0)
    axes = _plane(axes, "$|z_p|$", h)
    return cells(axes, *plane_coordinates(alpha_hat, beta_hat, h), stable, cmap="cividis", vmax=1.0)


def critical_damping(
    alpha_range: Range, axes: Axes | None = None, h: SupportsFloat | None = None, **line: Any
) -> Line2D:
    """Draw the line of critical damping, beta_hat = alpha_hat^2 / 4, where alpha = beta.

    Parameters
    ----------
    alpha_range : (low, high)
        Range of alpha_hat.
    axes : Axes, optional
        Where to draw; by default a figure of its own.
    h : float, optional
        Step (s) with which the axes are 2 alpha (1/s) and beta^2 (1/s^2); by default they are alpha_hat and beta_hat.
    **line
        Properties of the line; by default thin and grey.

    Returns
    -------
    Line2D
    """
    alpha_hat = np.linspace(float(alpha_range[0]), float(alpha_range[1]), PARABOLA)
    return _line(
        _plane(axes, r"$(\hat\alpha, \hat\beta)$", h),
        plane_coordinates(alpha_hat, alpha_hat**2 / 4, h),
        line,
        color="0.6",
        linewidth=0.8,
        linestyle=DASHES[2],
        label="critical damping: " + (r"$\hat\beta = \hat\alpha^2/4$" if h is None else r"$\alpha = \beta$"),
    )


def point(
    at: BestPoint | Choice | tuple[float, float], axes: Axes | None = None, h: SupportsFloat | None = None, **line: Any
) -> Line2D:
    """Draw a marker at a point (alpha_hat, beta_hat).

    Parameters
    ----------
    at : BestPoint, Choice or (alpha_hat, beta_hat)
        A best point is a star with its |z_p|, a choice a circle with its goal and |z_p|.
    axes : Axes, optional
        Where to draw; by default a figure of its own.
    h : float, optional
        Step (s) with which the axes are 2 alpha (1/s) and beta^2 (1/s^2); by default they are alpha_hat and beta_hat.
    **line
        Properties of the marker; by default white.

    Returns
    -------
    Line2D
        Of one point.
    """
    usual: dict[str, Any] = {"linestyle": "none", "color": "white", "markeredgecolor": "black", "markersize": 5}
    if isinstance(at, BestPoint):
        label = "deadbeat: $|z_p| = 0$" if at.z_abs == 0 else f"least $|z_p|$: {at.z_abs:.4f}"
        usual |= {"marker": "*", "markersize": 8, "label": label}
    elif isinstance(at, Choice):
        usual |= {"marker": "o", "label": f"choose {at.goal}: $|z_p| = {abs(at.pole):.4g}$"}
    else:
        check_kind(at, tuple, "bezstab.best_point or bezstab.choose")
        usual |= {"marker": "D"}
    place = at if isinstance(at, tuple) else (at.alpha_hat, at.beta_hat)
    return _line(_plane(axes, r"$(\hat\alpha, \hat\beta)$", h), plane_coordinates(*place, h), line, **usual)


def _line(axes: Axes, points: tuple[ArrayLike, ArrayLike], line: Mapping[str, Any], **usual: Any) -> Line2D:
    """Draw a line through points (x, y) as a caller asks for it, in the usual way where he does not, and return it.

    Its colour and dashes are those that no other line in the axes has, unless the usual way has its own.
    """
    (drawn,) = axes.plot(*points, **{**line_at(len(axes.lines)), **usual, **line})
    return drawn


def history(
    simulation: Simulation,
    constraint: int | None = 1,
    derivative: bool = False,
    axes: Axes | None = None,
    **line: Any,
) -> Line2D:
    """Draw the error of one constraint of a run, or its time derivative, against t (s); SI units.

    Parameters
    ----------
    simulation : Simulation
        What `bezstab.simulate` returns.
    constraint : int or None
        Number of the constraint, from 1. None: the largest |c| over all, on a logarithmic axis, with gaps where it is
        zero; on a linear one if it is zero all the time.
    derivative : bool
        Whether to draw the time derivative.
    axes : Axes, optional
        Where to draw; by default a figure of its own.
    **line
        Properties of the line.

    Returns
    -------
    Line2D
    """
    from bezstab.mechanism.simulation import Simulation

    check_kind(simulation, Simulation, "bezstab.simulate")
    if constraint is None:
        name, errors = "largest $|c|$ (SI)", simulation.largest_c
    else:
        name = rf"$\dot c_{constraint}$ (SI)" if derivative else rf"$c_{constraint}$ (SI)"
        errors = (simulation.cdot if derivative else simulation.c)[:, constraint - 1]
    axes = _axes(axes, title_lines(simulation.mechanism.scene.name, simulation.method.name), "t (s)", name)
    if constraint is None and (errors > 0).any():
        axes.set_yscale("log", nonpositive="mask")
    return _line(axes, (simulation.t, errors), line, linewidth=FINE)


def mechanism(scene: Scene, q: FloatArray, axes: Axes | None = None) -> list[Line2D]:
    """Draw the bodies of a scene as lines through the points of their joints.

    Parameters
    ----------
    scene : Scene
        What `bezstab.scene` returns.
    q : array of shape (n,)
        Coordinates (m, rad).
    axes : Axes, optional
        Where to draw; by default a figure of its own.

    Returns
    -------
    list of Line2D
        A triangle marks a pivot on the ground, a square a body that slides on its only joint.
    """
    from bezstab.mechanism.scenes import Scene

    check_kind(scene, Scene, "bezstab.scene")
    if axes is None:
        axes = _axes(None, title_lines(scene.name), "x (m)", "y (m)", height=0.6)
        axes.set_aspect("equal", adjustable="datalim")
        axes.margins(0.15)  # room for names
        axes.locator_params(axis="y", nbins=4)
    for body in scene.bodies:
        if body.turns_in_place:
            x, y = body.locked.get("x", 0.0), body.locked.get("y", 0.0)
            axes.plot(x, y, marker=6, color="0.6", markersize=9, zorder=1.5)  # a triangle whose tip is the pivot
    sliding = {body.name for body in scene.bodies if {"x", "y"} & set(body.free)}
    lines: list[Line2D] = []
    for place, (name, points) in enumerate(scene.joint_places(q.tolist()).items()):
        x, y = np.transpose(points)
        length = math.dist(points[0], points[-1])
        above = 2 + 1 / (2 + length)  # so that a longer body hides no shorter one
        colour = line_at(place)["color"]
        lines += axes.plot(x, y, color=colour, linewidth=3, solid_capstyle="round", zorder=above, label=name)
        if len(x) == 1 and name in sliding:
            axes.plot(x, y, "s", color="0.8", markeredgecolor="black", markersize=12, zorder=1.5)
        axes.plot(x, y, "o", color="white", markeredgecolor="black", markersize=4, zorder=above)
        axes.annotate(
            name,
            ((x[0] + x[-1]) / 2, (y[0] + y[-1]) / 2),
            xytext=(0, NAME_OFF if length else 2 * NAME_OFF),
            textcoords="offset points",
            ha="center",
            path_effects=[withStroke(linewidth=1.6, foreground="white")],  # lines run below
        )
    return lines


def _plane(axes: Axes | None, title: str, h: SupportsFloat | None) -> Axes:
    """Return the given axes, labelled if they are empty, or those of a new figure for the plane."""
    return _axes(axes, *plane_words(title, h))


def _axes(axes: Axes | None, title: str, xlabel: str, ylabel: str, height: float = 1.0) -> Axes:
    """Return the given axes, labelled if they are empty, or those of a new figure."""
    if axes is None:
        with styled():
            return new_axes(title, xlabel, ylabel, height)[1]
    if not (axes.has_data() or axes.get_xlabel() or axes.get_ylabel()):
        axes.set(xlabel=xlabel, ylabel=ylabel)
    return axes
