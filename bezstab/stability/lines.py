r"""A region by lines of constant alpha_hat or beta_hat: what of it hangs together, how far it reaches, how large it is.

On a line all stable stretches are known (stretches.py). Where two neighbours have different numbers of them another
line is laid between, until they are neighbours in rounding. So lines fall into sections of one number, and within a
section the k-th stretches make a strip. Strips that overlap from one section to the next are of one part of the plane:

      beta_hat |        .-.                     a: a strip, alone in its section
               |   .---' b '.   ..              b, c: two of the next section, both overlap a
               |  ( a  |  .-'| ( d)             then a section without any
               |   '---|-c'--|  ''              d: an island, it does not hang together with a
               +-------+-----+-+------ alpha_hat

The region is the part that hangs together with weak feedback. Its area is the integral of its stretches' lengths:
Lobatto's rule on panels that are halved until both halves agree with the whole, in a variable that takes away the
roots with which a length may begin at a strip's ends. A corner is found by halving, and lines crowd there: so the
stretches' ends, as curves, have it sharp. Lines of either direction measure the area on their own.
"""

from collections.abc import Iterable
from contextlib import suppress
from dataclasses import dataclass, field
from itertools import groupby, pairwise

import numpy as np
from numpy.polynomial import Legendre

from bezstab.errors import NumericalError
from bezstab.methods.schemes import Method
from bezstab.stability.arrays import FloatArray
from bezstab.stability.stretches import ALONG_ALPHA, ALONG_BETA, middle_of, paths

FIRST_LINES: FloatArray = np.concatenate([[1e-12], np.geomspace(1e-5, 1e6, 177)])
"""alpha h and beta h of the method's own step, 15 % apart: a region from the first on begins at zero, one that is there
on the last goes on for ever. Further out float64 loses what decides."""

CLOSE = 1e-10
"""Of a place: neighbours in rounding. An end of the extent is known to it."""

LAST = Legendre.basis(8)
NODES: FloatArray = np.array([-1.0, *LAST.deriv().roots().real, 1.0])
WEIGHTS: FloatArray = 2 / (72 * LAST(NODES) ** 2)
"""Lobatto's rule of nine points. It has the ends of its panel, which other rules leave out: a corner next to one is
seen."""

CUTS: FloatArray = np.array([0, 1e-9, 1e-6, 1e-3, 0.15, 0.5, 0.85, 1])
"""Shares of a section at which the first panels end: where feedback is weak there may be something thin."""
AGREE = 1e-9
"""Of the area: so near both halves of a panel come to the whole."""
HALVINGS = 40
TOUCHING = 100 * CLOSE
"""Of a place along a line: parts that overlap by less only touch, in a corner, as do points no further off."""
THIN = 1e-6
"""Of its place: an island narrower than that is not mentioned, and a region that narrow far out goes on for ever."""
FAR = 1e4
"""alpha_hat or beta_hat that nobody uses."""
MOST_LINES = 6_000


@dataclass(eq=False)
class Strip:
    """One stretch of so `many`, the k-th, on each of neighbouring lines: their places, and its ends, shape (lines, 2).

    `part` is the number of the part of the plane that it is of, `kept` whether that is of the region.
    """

    places: list[float]
    ends: FloatArray
    k: int
    many: int
    part: int
    kept: bool = False

    def middle(self) -> tuple[float, float]:
        """Return the place of the middle line, and the middle of the stretch there."""
        line = len(self.places) // 2
        return self.places[line], float(middle_of(*self.ends[line]))


class MoreStripsError(Exception):
    """A line within a strip has another number of stretches: there are more strips."""


@dataclass(eq=False)
class Lines:
    """Lines of constant alpha_hat (axis 0) or beta_hat (axis 1), and on each the stretches where |z_p| < level.

    `stable`: of a level below one, the lines of constant alpha_hat where |z_p| < 1: in their region a part must lie.
    `found` has each line's stretches by its place, shape (stretches, 2); it grows as lines are looked at. All are
    dimensionless.
    """

    method: Method
    level: float
    axis: int
    stable: "Lines | None" = None
    found: dict[float, FloatArray] = field(default_factory=dict)

    def look(self, places: Iterable[float]) -> None:
        """Look at these lines, and between neighbours with different numbers of stretches.

        NumericalError where no end of that is in sight.
        """
        new = [place for place in places if place not in self.found]
        while new:
            self.found.update(zip(new, self._stretches(np.array(new)), strict=True))
            if len(self.found) > MOST_LINES:
                raise NumericalError(
                    f"{self.method.name}: the region |z_p| < {self.level:g} has details without end near {new[0]:.6g}"
                )
            new = [
                (low + high) / 2
                for low, high in pairwise(sorted(self.found))
                if len(self.found[low]) != len(self.found[high]) and high - low > CLOSE * high
            ]

    def _stretches(self, places: FloatArray) -> list[FloatArray]:
        one = np.ones_like(places)
        at = (places, one) if self.axis == 0 else (one, places)
        found = paths(self.method, *at, (ALONG_BETA, ALONG_ALPHA)[self.axis], self.level).stretches()
        ends = np.stack([found.low, found.high], axis=-1)
        return np.split(ends, np.searchsorted(found.path, np.arange(1, len(places))))

    def strips(self) -> list[Strip]:
        """Return all strips, from the weakest lines on: what belongs to the region is kept."""
        strips: list[Strip] = []
        before: list[Strip] = []
        for many, group in groupby(sorted(self.found), key=lambda place: len(self.found[place])):
            places = list(group)
            here: list[Strip] = []
            for k in range(many):
                ends = np.array([self.found[place][k] for place in places])
                parts = {strip.part for strip in before if _overlap(strip.ends[-1], ends[0])}
                part = min(parts, default=1 + max((strip.part for strip in [*strips, *here]), default=-1))
                here.append(Strip(places, ends, k, many, part))
                for strip in [*strips, *here]:
                    if strip.part in parts:  # two parts that meet are one
                        strip.part = part
            strips += here
            before = here
        region = {0} if self.stable is None else {p for p, point in _points(strips).items() if self._in_stable(*point)}
        for strip in strips:
            strip.kept = strip.part in region
        return strips

    def _in_stable(self, place: float, along: float) -> bool:
        """Return whether a point lies where what hangs together with weak feedback is stable."""
        assert self.stable
        alpha_hat, beta_hat = (place, along) if self.axis == 0 else (along, place)
        self.stable.look([alpha_hat])
        return self.stable.holds(alpha_hat, beta_hat)

    def holds(self, place: float, along: float) -> bool:
        """Return whether a point on a line that was looked at belongs to the region, or touches it."""
        kept = [strip.k for strip in self.strips() if strip.kept and strip.places[0] <= place <= strip.places[-1]]
        low, high = self.found[place][kept].T
        return bool(((low * (1 - TOUCHING) < along) & (along < high * (1 + TOUCHING))).any())

    def region(self) -> list[Strip]:
        """Return the strips of the region."""
        return [strip for strip in self.strips() if strip.kept]

    def extent(self) -> tuple[float, float] | None:
        """Return from which to which line the region reaches, 0 and infinity where it goes on; None if it is empty."""
        places = [strip.places for strip in self.region()]
        if not places:
            return None
        low, high = min(each[0] for each in places), max(each[-1] for each in places)
        before = max((place for place in self.found if place < high / 2), default=high)
        goes_on = high == max(self.found) or (high > FAR and self._width(before) < THIN)
        return 0.0 if low == min(self.found) else low, np.inf if goes_on else high

    def _width(self, place: float) -> float:
        """Return how wide the widest stretch of a line is, as a share of its upper end."""
        return float(max((1 - low / high for low, high in self.found[place]), default=1.0))

    def reach(self) -> tuple[float, float]:
        """Return from where to where along the lines that were looked at the region reaches."""
        ends = np.concatenate([strip.ends for strip in self.region()])
        return float(ends[:, 0].min()), float(ends[:, 1].max())

    def points(self) -> list[tuple[float, float]]:
        """Return a point (place, along) of each part of the plane where |z_p| < level, of the region or not."""
        return list(_points(self.strips()).values())

    def islands(self) -> list[tuple[float, float]]:
        """Return a point of each other part, those left out that are too thin to be more than rounding."""
        strips = [strip for strip in self.strips() if not strip.kept]
        wide = {
            strip.part
            for strip in strips
            if strip.places[0] < (1 - THIN) * strip.places[-1]
            and (strip.ends[:, 0] < (1 - THIN) * strip.ends[:, 1])[len(strip.places) // 2]
        }
        return [point for part, point in _points(strips).items() if part in wide]

    def area(self, low: float, high: float, top: float = np.inf) -> tuple[float, float]:
        """Return the region's area between two lines and below `top` along them, and by how much it may be off.

        NumericalError as `look`.
        """
        while True:
            with suppress(MoreStripsError):
                return self._measured(self.region(), low, high, top)

    def _measured(self, strips: list[Strip], low: float, high: float, top: float) -> tuple[float, float]:
        """Return `area` of these strips."""
        ends = np.array([(strip.places[0], strip.places[-1]) for strip in strips]).clip(low, high)

        def integrals(panels: FloatArray) -> FloatArray:
            """Return those over panels, each a strip's number and from and to which t, 0 <= t <= pi."""
            number, start, end = panels[:, 0].astype(int), panels[:, 1:2], panels[:, 2:]
            t = (start + end) / 2 + (end - start) / 2 * NODES
            low, high = ends[number, :1], ends[number, 1:]
            places = low + (high - low) * (1 - np.cos(t)) / 2
            places = np.where(places - low < CLOSE * high, low, np.where(high - places < CLOSE * high, high, places))
            of = np.repeat(number, len(NODES)).tolist()
            lengths = self._lengths(places.ravel().tolist(), [strips[k] for k in of], top).reshape(t.shape)
            return np.asarray((lengths * (high - low) / 2 * np.sin(t) * (end - start) / 2) @ WEIGHTS)

        cuts = np.arccos(1 - 2 * CUTS).tolist()
        panels = np.array([(k, *ts) for k, (a, b) in enumerate(ends) if a < b for ts in pairwise(cuts)]).reshape(-1, 3)
        total, known, whole = 0.0, 0.0, integrals(panels)
        for _ in range(HALVINGS):
            number, start, end = panels.T
            middle = (start + end) / 2
            halves = np.stack([number, start, middle, number, middle, end], axis=1).reshape(-1, 3)
            parts = integrals(halves).reshape(-1, 2)
            off = np.abs(parts.sum(axis=1) - whole)
            agree = off <= AGREE * (total + parts.sum())
            total += float(parts[agree].sum())
            known += float(off[agree].sum())
            panels, whole = halves[np.repeat(~agree, 2)], parts[~agree].ravel()
            if not whole.size:
                break
        return total + float(whole.sum()), known + float(np.abs(whole).sum())

    def _lengths(self, places: list[float], strips: list[Strip], top: float) -> FloatArray:
        """Return how long strips are below `top`, each on one line; MoreStripsError if that has more stretches."""
        self.look(places)
        stretches = [self.found[place] for place in places]
        if any(len(each) != strip.many for each, strip in zip(stretches, strips, strict=True)):
            raise MoreStripsError
        return np.array([np.ptp(each[strip.k].clip(0, top)) for each, strip in zip(stretches, strips, strict=True)])


def _overlap(one: FloatArray, other: FloatArray) -> bool:
    """Return whether two stretches of neighbouring lines overlap by more than rounding."""
    return bool(min(one[1], other[1]) > max(one[0], other[0]) * (1 + TOUCHING))


def _points(strips: list[Strip]) -> dict[int, tuple[float, float]]:
    """Return a point of each part of the plane: of its first strip."""
    return {strip.part: strip.middle() for strip in reversed(strips)}
