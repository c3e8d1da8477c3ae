"""Every answer held against a second route before it is given: what contradicts it is a NumericalError.

A region's area is a sum over arcs and intervals. The check looks along lines of constant q instead:

      q |       . - - .           on each line three lengths must agree:
        |  ----/-------\\-----        inside by the poles      (line_slices: neither arcs nor intervals)
        |     (         )            inside by the edges      (what the area is made of)
        |  ----\\-------/-----        inside by the curves     (what is drawn)
        |        ' - - '          and by the nodes' weights the first add up to the area
        +---------------------- p
"""

from fractions import Fraction
from itertools import product

import numpy as np
from numpy.polynomial.legendre import leggauss
from numpy.polynomial.polynomial import polyder, polyval
from numpy.typing import NDArray

from bezstab.errors import NumericalError
from bezstab.stability.arrays import FloatArray
from bezstab.stability.boundary_locus import Bounds
from bezstab.stability.closed_loop import decays_faster
from bezstab.stability.line_crossings import arc_crossings, crossed_levels
from bezstab.stability.line_slices import (
    RIM,
    Slices,
    all_inside,
    island_radii,
    mu_bound,
    real_events,
    slices,
    turning_radii,
)
from bezstab.stability.pencils import Pencil, deadbeat_mu

PANELS = 8  # with as many nodes, 64 lines over what the region covers: each costs 5 to 20 us, a region 20 to 500 ms
NODES = 8  # of Gauss and Legendre on a panel
THIN = 1e-6  # relative range of sqrt|q| of a curve, below which lines cross it within rounding
BEYOND = 24  # lines further out, where there must be nothing
RESOLVED = 1e-12  # of |p|: a shorter interval is rounding of its two ends
LINE_ERROR = 1e-7  # of the longest line: an edge's crossing and a slice's end agree to 1e-10 but next to a tangency
CURVE_ERROR = 2e-3  # of the longest line: 400 chords per arc stay within 1e-5, crossings near tangencies less so
AREA_ERROR = 5e-3  # of the area: what 64 nodes leave across square roots and corners
TANGENT = 1  # lines that may disagree: one within rounding of a tangency
BESIDE = 1e-6  # relative distance of sqrt|q| from the region from which a line counts as beyond it
REAL_ZERO = 1e-9  # of |mu|: an imaginary part below it is rounding of a simple real zero
BESIDE_AN_END = 1e-3  # of an interval: where its end is tried, on either side
END_ROUNDING = 1e-13  # of |mu|: a hundredfold above that of an interval's end
WELL_WIDE = 1e-11  # of |mu|: an interval of that width is a hundredfold above rounding of its ends

IntArray = NDArray[np.int_]


def check_region(pencil: Pencil, level: float, bounds: Bounds, area: float, curves: list[FloatArray]) -> None:
    """Raise NumericalError unless area and closed curves (of shape (points, 2), user's plane) agree with slices.

    Lines beyond the region must be unstable throughout, and each real zero of R of a one-step method inside.
    """
    in_feedback = [curve @ pencil.to_feedback.T for curve in curves]
    bound, events = mu_bound(pencil, level), real_events(pencil, level)
    _check_islands(pencil, level, bounds)
    _check_intervals(pencil, level, bounds)
    t, weight = _lines_through(in_feedback, bounds.radius / RIM)
    beyond = _lines_beyond(pencil, level, in_feedback, bound, events)
    everything = np.concatenate([t, beyond])
    q = everything * np.abs(everything)
    sliced = slices(pencil, level, q, events, bound)
    _check_beyond(pencil, level, q, sliced, first=len(t))
    if not t.size:
        return
    q = q[: len(t)]
    lengths = sliced.lengths()[: len(t)]
    _check_lengths(pencil, level, q, lengths, _lengths_by_edges(bounds, q), "edges", LINE_ERROR)
    _check_lengths(pencil, level, q, lengths, _lengths_by_curves(in_feedback, q), "curves", CURVE_ERROR)
    terms = weight * lengths * 2 * np.abs(t) * abs(float(np.linalg.det(pencil.to_user)))
    sum_of_slices = float(terms.sum())
    # a feature met by one node alone may be off by as much as that node's term
    if abs(sum_of_slices - area) > AREA_ERROR * area + float(terms.max()):
        raise NumericalError(
            f"{pencil.method.name}: the area {area:.6g} of |z_p| < {level:g} is about {sum_of_slices:.6g} by slices"
        )


def _lines_through(curves: list[FloatArray], shapely: float) -> tuple[FloatArray, FloatArray]:
    """Return nodes t = sign(q) sqrt|q|, ascending, and their weights: panels over each curve's own range.

    Each curve by itself, because a part of the region may be 1e-6 of the size of its distance to another; and panels
    over what has a shape, up to `shapely` (of |mu|), where curves go on beyond it.
    """
    ends = [np.linspace(-shapely, shapely, 2 * PANELS + 1)] if curves and shapely < np.inf else []
    for curve in curves:
        signed = np.sign(curve[:, 1]) * np.sqrt(np.abs(curve[:, 1]))
        if np.ptp(signed) > THIN * np.abs(signed).max():
            ends.append(np.linspace(signed.min(), signed.max(), PANELS + 1))
    if not ends:
        return np.zeros(0), np.zeros(0)
    edges = np.unique(np.concatenate(ends))
    nodes, weights = leggauss(NODES if len(edges) <= 2 * PANELS else NODES // 2)
    half = np.diff(edges)[:, np.newaxis] / 2
    t = (edges[:-1, np.newaxis] + half * (1 + nodes)).ravel()
    weight = (half * weights).ravel()
    kept = (weight > 0) & (np.diff(t, prepend=-np.inf) > 0) & (np.abs(t) > BESIDE * np.abs(t).max())
    return t[kept], weight[kept]


def _lines_beyond(
    pencil: Pencil, level: float, curves: list[FloatArray], bound: float, events: FloatArray
) -> FloatArray:
    """Return sign(q) sqrt|q| of lines that the region does not reach, as far out as any mu could be stable."""
    heights = np.concatenate([np.zeros(1), *(curve[:, 1] for curve in curves)])
    top, bottom = np.sqrt(heights.max()), -np.sqrt(-heights.min())
    both_signs = bool((events < 0).any() and (events > 0).any())  # of two real mu with q < 0
    lowest = min(bottom, -bound if both_signs else 0.0)
    lines = np.linspace(lowest, bound, BEYOND + 2)[1:-1]
    if pencil.steps == 1:
        lines = np.append(lines, island_radii(pencil, level)[1::3])
    else:
        lines = np.append(lines, turning_radii(pencil, level) * (1 - 1e-3))
    lines = lines[np.isfinite(lines) & (lines != 0) & (np.abs(lines) < bound)]
    outside = (lines > top * (1 + BESIDE)) | (lines < bottom * (1 + BESIDE))
    return np.asarray(lines[outside])


def _check_islands(pencil: Pencil, level: float, bounds: Bounds) -> None:
    """Raise NumericalError unless each simple real zero of R lies in a real interval: there every pole is zero."""
    if pencil.steps > 1:
        return
    zeros = deadbeat_mu(pencil)
    for zero in zeros[np.abs(zeros.imag) <= REAL_ZERO * np.abs(zeros)].real.tolist():
        slope = abs(float(polyval(zero, polyder(pencil.table[0]))))
        if slope * WELL_WIDE * abs(zero) > level * abs(float(polyval(zero, pencil.table[1]))):
            continue  # too narrow for float64
        if not any(start < zero < end for start, end in bounds.intervals):
            raise NumericalError(f"{pencil.method.name}: |z_p| < {level:g} around mu = {zero:.6g} was not found")


def _check_intervals(pencil: Pencil, level: float, bounds: Bounds) -> None:
    """Raise NumericalError unless each real interval is stable just within its ends and not just beyond them.

    An interval far out may be too narrow for any line to meet what belongs to it. What Schur's recursion in float64
    contradicts is decided in rationals, with both mu at that place.
    """
    ends = np.array(bounds.intervals).reshape(-1, 2)
    if not ends.size:
        return
    width = np.diff(ends)[:, 0]
    gap_below = np.append(np.inf, ends[1:, 0] - ends[:-1, 1])
    gap_above = np.append(gap_below[1:], np.inf)
    within = BESIDE_AN_END * width
    places = [ends[:, 0] + within, ends[:, 1] - within]
    places += [ends[:, 0] - within, ends[:, 1] + within]
    expected = np.repeat([True, True, False, False], len(ends))
    mu = np.concatenate(places)
    clear = np.tile(within > END_ROUNDING * np.abs(ends).max(axis=1), 4)
    always = np.full(len(ends), True)
    clear &= np.concatenate([always, always, gap_below > within, gap_above > within])  # some touch each other
    clear &= np.abs(mu) < bounds.radius  # an end on the rim is none of the method's
    contradicted = clear & (all_inside(pencil, mu.astype(complex), level) != expected)
    for place in np.flatnonzero(contradicted):
        exact_mu = Fraction(float(mu[place]))
        if proven_inside(pencil, level, -2 * exact_mu, exact_mu**2) != expected[place]:
            raise NumericalError(
                f"{pencil.method.name}: a real interval of |z_p| < {level:g} does not end near mu = {mu[place]:.9g}"
            )


def _check_beyond(pencil: Pencil, level: float, q: FloatArray, sliced: Slices, first: int) -> None:
    """Raise NumericalError if a line from number `first` on has a stable piece, proven so in rationals."""
    for line, piece in zip(*np.nonzero(sliced.stable[first:]), strict=True):
        low, high = sliced.ends[first + line, piece : piece + 2].tolist()
        if high - low <= RESOLVED * max(abs(low), abs(high)):
            continue
        if proven_inside(pencil, level, Fraction((low + high) / 2), Fraction(float(q[first + line]))):
            raise NumericalError(
                f"{pencil.method.name}: a part of |z_p| < {level:g} was not found, at mu_1 mu_2 = {q[first + line]:.6g}"
            )


def proven_inside(pencil: Pencil, level: float, p: Fraction, q: Fraction) -> bool:
    """Return whether all poles have |z| < level for the feedback mu^2 + p mu + q: Schur-Cohn in rationals, a proof.

    Rounding of a double root, which passes for a short stable interval, does not pass here.
    """
    (a, b), (c, d) = pencil.feedback
    determinant = a * d - b * c
    alpha_hat, beta_hat = (d * p - b * q) / determinant, (a * q - c * p) / determinant
    return decays_faster(pencil.method, Fraction(level), alpha_hat, beta_hat)


def _check_lengths(
    pencil: Pencil, level: float, q: FloatArray, expected: FloatArray, found: FloatArray, what: str, error: float
) -> None:
    """Raise NumericalError if lengths on more than one line are off by more than a share of the longest."""
    wrong = ~(np.abs(found - expected) <= error * expected.max())
    if wrong.sum() <= TANGENT:
        return
    worst = int(np.argmax(np.where(np.isnan(found), np.inf, np.abs(found - expected))))
    raise NumericalError(
        f"{pencil.method.name}: the {what} of |z_p| < {level:g} contradict the poles where mu_1 mu_2 = {q[worst]:.6g}: "
        f"length {found[worst]:.6g}, not {expected[worst]:.6g}"
    )


def _lengths_by_edges(bounds: Bounds, q: FloatArray) -> FloatArray:
    """Return the length inside on each ascending line of constant q, between crossings of arcs and straight edges."""
    rows = [np.zeros(0, int)]
    places = [np.zeros(0)]
    for arc in bounds.arcs:
        row, place = arc_crossings(arc, q, np.eye(2))
        rows.append(row)
        places.append(place)
    held = [end for interval in bounds.intervals for end in interval]
    for fixed, (start, end) in product(held, bounds.intervals):
        row, _ = crossed_levels(q, np.array([fixed * start, fixed * end]))  # p = -(fixed + mu), q = fixed mu
        rows.append(row)
        places.append(-(fixed + q[row] / fixed) if fixed else np.zeros(0))
    return _lengths_between(np.concatenate(rows), np.concatenate(places), len(q))


def _lengths_by_curves(curves: list[FloatArray], q: FloatArray) -> FloatArray:
    """Return the length inside closed polygons on each ascending line of constant q."""
    rows = [np.zeros(0, int)]
    places = [np.zeros(0)]
    for curve in curves:
        row, step = crossed_levels(q, curve[:, 1])
        start, end = curve[step], curve[step + 1]
        rows.append(row)
        places.append(start[:, 0] + (end[:, 0] - start[:, 0]) * (q[row] - start[:, 1]) / (end[:, 1] - start[:, 1]))
    return _lengths_between(np.concatenate(rows), np.concatenate(places), len(q))


def _lengths_between(line: IntArray, place: FloatArray, lines: int) -> FloatArray:
    """Return the length inside on each line, given all crossings (line number, place).

    nan for a line with an odd number of crossings: no closed boundary has one.
    """
    order = np.lexsort((place, line))
    line = line[order]
    place = place[order]
    rank = np.arange(len(line)) - np.searchsorted(line, line)
    lengths = np.zeros(lines)
    np.add.at(lengths, line, np.where(rank % 2, place, -place))
    odd = np.bincount(line, minlength=lines) % 2 == 1
    return np.where(odd, np.nan, lengths)
