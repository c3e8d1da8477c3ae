"""Best points, choices and margins held against sampled points and proven verdicts before they are given."""

from collections.abc import Callable, Sequence
from fractions import Fraction

import numpy as np

from bezstab.errors import NumericalError
from bezstab.methods import Method
from bezstab.rationals import exact
from bezstab.stability.arrays import (
    DOUBLE,
    EPS,
    MULTIPLE,
    ROUNDING,
    SAME,
    BoolArray,
    ComplexArray,
    Extent,
    FloatArray,
    even_points,
)
from bezstab.stability.closed_loop import largest_pole, spectral_radius
from bezstab.stability.path_crossings import Path
from bezstab.stability.searches import bisected

Modulus = Callable[[FloatArray, FloatArray], FloatArray]
"""|z_p|, or what takes its place and is to be least, over arrays of alpha_hat and beta_hat of one shape."""

SAMPLES = 400  # over the region's box: a few thousandths of what the search itself looks at
NEIGHBOURS = 32  # on each ring
RINGS: FloatArray = np.array([1e-1, 1e-2, 1e-3, 1e-4, 1e-5])  # radii, as shares of the region's box
CLOSE_RINGS: FloatArray = RINGS[1:]  # as shares of a point's own coordinates
PARTED = 4.0  # times what rounding of a point does to |z_p|: it is found from poles of the same rounding
ROOT_OF_ROUNDING = 1e-7  # a double pole at zero, as far as float64 tells it
FURTHEST = (1e-8, 1e8)  # factors on the way to which the verdict is asked where there is no end
WAYPOINTS = 8  # factors from one to an end: each verdict takes up to a millisecond


def sampled_points(extent: Extent, alpha_hat: float, beta_hat: float) -> tuple[FloatArray, FloatArray]:
    """Return alpha_hat and beta_hat of points over a region's box, on its parabola of double mu, and around a point."""
    (alpha_low, alpha_high), (beta_low, beta_high) = extent
    across, up = even_points(SAMPLES)
    over_alpha = alpha_low + (alpha_high - alpha_low) * across
    over_beta = beta_low + (beta_high - beta_low) * up**2  # even in |mu|
    on_parabola = np.linspace(0, alpha_high, SAMPLES // 4 + 1)[1:]
    angle = 2 * np.pi * np.arange(NEIGHBOURS) / NEIGHBOURS + 0.1
    ring_alpha = alpha_hat + np.outer(RINGS, (alpha_high - alpha_low) * np.cos(angle)).ravel()
    ring_beta = beta_hat + np.outer(RINGS, (beta_high - beta_low) * np.sin(angle)).ravel()
    return (
        np.concatenate([over_alpha, on_parabola, ring_alpha]),
        np.concatenate([over_beta, on_parabola**2 / 4, ring_beta]),
    )


def check_least(
    method: Method,
    objective: Modulus,
    point: tuple[float, float],
    least: float,
    extents: Sequence[Extent],
    cut: bool = False,
) -> None:
    """Raise NumericalError unless an objective is as said at a point, and smaller at none sampled over the extents.

    Only points with alpha, beta > 0 are answers; cut: only those within the first extent.
    """
    here = float(objective(*np.reshape(point, (2, 1)))[0])
    if abs(here - least) > MULTIPLE:
        raise NumericalError(f"{method.name}: the point chosen has {here:.9g}, not {least:.9g}")
    alpha_hat, beta_hat = np.concatenate([sampled_points(extent, *point) for extent in extents], axis=1)
    answers = (alpha_hat > 0) & (beta_hat > 0)
    if cut:
        answers &= (alpha_hat <= extents[0][0][1]) & (beta_hat <= extents[0][1][1])
    alpha_hat, beta_hat = alpha_hat[answers], beta_hat[answers]
    values = objective(alpha_hat, beta_hat)
    k = int(np.argmin(values))
    if values[k] < least * (1 - DOUBLE) - ROOT_OF_ROUNDING:
        place = f"({alpha_hat[k]:.6g}, {beta_hat[k]:.6g})"
        raise NumericalError(f"{method.name}: the point chosen has {least:.9g}, but {place} has {values[k]:.9g}")


def check_critical(method: Method, alpha_hat: float, beta_hat: float, extent: Extent, cut: bool = False) -> None:
    r"""Raise NumericalError unless the dominant pole is real and positive at a point, and smaller at no neighbour.

    Neighbours are where the dominant pole is double, real and positive, too (cut: and within the extent). Bisection
    finds them on rings around the point, between two real poles and a conjugate pair:

          .--x--.
        / pair ##\       A curve of double poles leads through the point, and on it |z_p| must be least there.
       |     x####|
        \  ##### /        #: two real poles
          'x----'
    """
    name = method.name
    here = complex(largest_pole(method, alpha_hat, beta_hat))
    if abs(here) < MULTIPLE:
        return  # every pole is zero to its rounding: none is faster
    # where a rival is as large as the double pole, on one side of the point it is smaller
    beside = np.array([1 - DOUBLE, 1, 1 + DOUBLE])
    if not _real_and_positive(largest_pole(method, alpha_hat * beside, beta_hat * beside**2), MULTIPLE).any():
        raise NumericalError(f"{name}: the dominant pole {here:.6g} of the critical point is not real and positive")

    def places(radius: FloatArray, angle: FloatArray) -> tuple[FloatArray, FloatArray]:
        return alpha_hat * (1 + radius * np.cos(angle)), beta_hat * (1 + radius * np.sin(angle))

    def real(radius: FloatArray, angle: FloatArray) -> BoolArray:
        return _real_and_positive(largest_pole(method, *places(radius, angle)), EPS)

    angles = np.linspace(0, 2 * np.pi, NEIGHBOURS + 1)
    is_real = real(CLOSE_RINGS[:, np.newaxis], angles)
    ring, k = np.nonzero(is_real[:, 1:] != is_real[:, :-1])
    radius, first = CLOSE_RINGS[ring], is_real[ring, k]
    pair_end, real_end = bisected(
        lambda angle: real(radius, angle),
        before=np.where(first, angles[k + 1], angles[k]),
        after=np.where(first, angles[k], angles[k + 1]),
    )
    alpha_hats, beta_hats = places(radius, real_end)
    poles = largest_pole(method, alpha_hats, beta_hats)
    # else it is another pole that becomes the larger one there
    double = np.abs(poles - largest_pole(method, *places(radius, pair_end))) <= MULTIPLE * np.abs(poles)
    if cut:
        double &= (alpha_hats <= extent[0][1]) & (beta_hats <= extent[1][1])
    smallest = np.abs(poles[double]).min(initial=np.inf)
    near = 1 + ROUNDING * np.linspace(-1, 1, NEIGHBOURS + 1)
    parted = float(np.ptp(spectral_radius(method, alpha_hat * near, beta_hat * near[:, np.newaxis])))
    if smallest < abs(here) * (1 - DOUBLE) - PARTED * parted:
        raise NumericalError(f"{name}: the critical point has {abs(here):.9g}, but a neighbour has {smallest:.9g}")


def _real_and_positive(poles: ComplexArray, tolerance: float) -> BoolArray:
    return np.asarray((np.abs(poles.imag) <= tolerance * np.abs(poles)) & (poles.real > 0))


def check_margin(path: Path, ends: tuple[float, float]) -> None:
    """Raise NumericalError unless the proven verdict turns at both ends of a margin, and is one between them.

    ends: factors below and above one; 0 and infinity for none. The verdict is asked a part in 1e9 to either side of an
    end, and at factors on the way, up to FURTHEST where there is no end.
    """
    name = path.method.name
    for outwards, end, furthest in zip((-1, 1), ends, FURTHEST, strict=True):
        finite = 0 < end < np.inf
        on_the_way = np.geomspace(1, end if finite else furthest, WAYPOINTS)[1:-1].tolist()
        if not all(path.converges_at(Fraction(factor)) for factor in on_the_way):
            raise NumericalError(f"{name}: unstable before the margin {end:.9g}")
        for side, stable in ((-1, True), (1, False)) if finite else ():
            factor = Fraction(end) * (1 + side * outwards * exact(SAME))
            beyond_one = (factor - 1) * outwards > 0  # else the margin is one to rounding
            if beyond_one and path.converges_at(factor) != stable:
                raise NumericalError(f"{name}: the margin {end:.9g} is not where the verdict turns")
