r"""A region by lines of constant alpha_hat or beta_hat: what of it hangs together, how far it reaches, how large it is.

On a line all stable stretches are known (stretches.py). Where two neighbours have different numbers of them another
line is laid between, until they are neighbours in rounding. So lines fall into sections of one number, and within a
section the k-th stretches belong together; from one section to the next those do that overlap:

      beta_hat |        .-.                     sections 1: one stretch
               |   .---'   '.   ..                       2: two, both overlap the one of section 1
               |  ( 1  |2 .-'|3(4)                       3: none
               |   '---|- '--|  ''                       4: one, an island: it does not hang together with 1
               +-------+-----+-+------ alpha_hat

The region is the part that hangs together with weak feedback. Its area is the integral of its stretches' lengths:
Lobatto's rule on panels that are halved until both halves agree with the whole, in a variable that takes away the
roots with which a length may begin at a section's ends. A corner is found by halving, and lines crowd there: so the
stretches' ends, as curves, have it sharp. Lines of either direction measure the area on their own.
"""

from collections.abc import Iterable
from dataclasses import dataclass, field
from itertools import groupby, pairwise

import numpy as np
from numpy.polynomial import Legendre

from bezstab.errors import NumericalError
from bezstab.methods.schemes import Method
from bezstab.stability.arrays import BoolArray, FloatArray
from bezstab.stability.stretches import ALONG_ALPHA, ALONG_BETA, paths

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
FAR = 1e5
"""alpha_hat or beta_hat that nobody uses."""
MOST_LINES = 6_000


@dataclass(frozen=True)
class Section:
    """Neighbouring lines of one number of stretches, and of each stretch the part of the plane that it belongs to."""

    places: list[float]
    parts: list[int]


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
        found = paths(self.method, *at, (ALONG_BETA, ALONG_ALPHA)[self.axis], self.level).stretches(exact=True)
        ends = np.stack([found.low, found.high], axis=-1)
        return np.split(ends, np.cumsum(found.counts(len(places)))[:-1])

    def sections(self) -> list[Section]:
        """Return the sections in ascending order, with the parts of the plane numbered from the weakest line on."""
        groups = [list(group) for _, group in groupby(sorted(self.found), key=lambda place: len(self.found[place]))]
        parts: list[list[int]] = []
        before: FloatArray = np.zeros((0, 2))
        for number, group in enumerate(groups):
            here = self.found[group[0]]
            parts.append([])
            for low, high in here:
                overlapping = [k for k, (a, b) in enumerate(before) if min(b, high) > max(a, low) * (1 + TOUCHING)]
                known = sorted({parts[number - 1][k] for k in overlapping})
                part = known[0] if known else 1 + max((p for each in parts for p in each), default=-1)
                parts[-1].append(part)
                for other in known[1:]:  # two parts that meet are one
                    parts = [[part if p == other else p for p in each] for each in parts]
            before = self.found[group[-1]]
        return [Section(places, part) for places, part in zip(groups, parts, strict=True)]

    def kept(self, sections: list[Section]) -> list[BoolArray]:
        """Return of each section which of its stretches belong to the region."""
        if self.stable is None:  # what hangs together with weak feedback
            parts = {0}
        else:
            samples = self._samples(sections)
            points = [sample if self.axis == 0 else sample[::-1] for sample in samples.values()]
            self.stable.look(alpha_hat for alpha_hat, _ in points)
            parts = {part for part, point in zip(samples, points, strict=True) if self.stable.holds(*point)}
        return [np.isin(section.parts, list(parts)) for section in sections]

    def holds(self, place: float, along: float) -> bool:
        """Return whether a point on a line that was looked at belongs to the region, or touches it."""
        sections = self.sections()
        number = int(np.searchsorted([section.places[0] for section in sections], place, side="right")) - 1
        low, high = self.found[place][self.kept(sections)[number]].T
        return bool(((low * (1 - TOUCHING) < along) & (along < high * (1 + TOUCHING))).any())

    def _samples(self, sections: list[Section]) -> dict[int, tuple[float, float]]:
        """Return a point of each part: on the middle line of its first section, in the middle of the stretch."""
        samples: dict[int, tuple[float, float]] = {}
        for section in sections:
            place = section.places[len(section.places) // 2]
            for part, (low, high) in zip(section.parts, self.found[place].tolist(), strict=True):
                samples.setdefault(part, (place, (low + high) / 2 if high < np.inf else 2 * low + 1))
        return samples

    def extent(self) -> tuple[float, float] | None:
        """Return from which to which line the region reaches, 0 and infinity where it goes on; None if it is empty."""
        sections = self.sections()
        kept = [section.places for section, some in zip(sections, self.kept(sections), strict=True) if some.any()]
        if not kept:
            return None
        low, high = kept[0][0], kept[-1][-1]
        before = max((place for place in self.found if place < high / 2), default=high)
        goes_on = high == max(self.found) or (high > FAR and self._width(before) < THIN)
        return 0.0 if low == min(self.found) else low, np.inf if goes_on else high

    def _width(self, place: float) -> float:
        """Return how wide the widest stretch of a line is, as a share of its upper end."""
        return float(max((1 - low / high for low, high in self.found[place]), default=1.0))

    def reach(self) -> tuple[float, float]:
        """Return from where to where along the lines that were looked at the region reaches."""
        sections = self.sections()
        kept = zip(sections, self.kept(sections), strict=True)
        ends = np.concatenate([self.found[place][some] for section, some in kept for place in section.places])
        return float(ends[:, 0].min()), float(ends[:, 1].max())

    def samples(self) -> list[tuple[float, float]]:
        """Return a point of each part of the plane where |z_p| < level, of the region or not."""
        return list(self._samples(self.sections()).values())

    def islands(self) -> list[tuple[float, float]]:
        """Return a point of each other part, those left out that are too thin to be more than rounding."""
        sections = self.sections()
        kept = {
            part
            for section, some in zip(sections, self.kept(sections), strict=True)
            for part in np.array(section.parts)[some]
        }
        middles = [section.places[len(section.places) // 2] for section in sections]
        wide = {
            part
            for section, place in zip(sections, middles, strict=True)
            for part, (low, high) in zip(section.parts, self.found[place], strict=True)
            if low < (1 - THIN) * high and section.places[-1] - section.places[0] > THIN * section.places[-1]
        }
        return [point for part, point in self._samples(sections).items() if part in wide - kept]

    def area(self, low: float, high: float, top: float = np.inf) -> tuple[float, float]:
        """Return the region's area between two lines and below `top` along them, and by how much it may be off.

        NumericalError as `look`.
        """
        while True:
            sections = self.sections()
            measured = self._measured(sections, self.kept(sections), low, high, top)
            if measured:
                return measured

    def _measured(
        self, sections: list[Section], kept: list[BoolArray], low: float, high: float, top: float
    ) -> tuple[float, float] | None:
        """Return `area` from these sections; None where a line between shows that there are more."""
        ends = np.array([(section.places[0], section.places[-1]) for section in sections]).clip(low, high)
        counts = np.array([len(section.parts) for section in sections])

        def integrals(panels: FloatArray) -> FloatArray | None:
            """Return those over panels, each a section's number and from and to which t, 0 <= t <= pi."""
            number, start, end = panels[:, 0].astype(int), panels[:, 1:2], panels[:, 2:]
            width = np.diff(ends[number], axis=1)
            t = (start + end) / 2 + (end - start) / 2 * NODES
            low, high = ends[number, :1], ends[number, 1:]
            places = low + width * (1 - np.cos(t)) / 2
            places = np.where(places - low < CLOSE * high, low, np.where(high - places < CLOSE * high, high, places))
            self.look(places.ravel().tolist())
            stretches = [self.found[place] for place in places.ravel().tolist()]
            of_section = np.repeat(number, len(NODES))
            if any(len(each) != counts[k] for each, k in zip(stretches, of_section, strict=True)):
                return None
            lengths = [np.diff(each[kept[k]].clip(0, top)).sum() for each, k in zip(stretches, of_section, strict=True)]
            return np.asarray((np.reshape(lengths, t.shape) * width / 2 * np.sin(t) * (end - start) / 2) @ WEIGHTS)

        cuts = np.arccos(1 - 2 * CUTS).tolist()
        panels = np.array(
            [(k, *ts) for k, some in enumerate(kept) if some.any() and ends[k, 0] < ends[k, 1] for ts in pairwise(cuts)]
        )
        total, known, whole = 0.0, 0.0, integrals(panels) if len(panels) else np.zeros(0)
        for _ in range(HALVINGS):
            if whole is None:
                return None
            if not len(panels):
                break
            number, start, end = panels.T
            middle = (start + end) / 2
            panels = np.stack([number, start, middle, number, middle, end], axis=1).reshape(-1, 3)
            parts = integrals(panels)
            if parts is None:
                return None
            off = np.abs(parts.reshape(-1, 2).sum(axis=1) - whole)
            agree = off <= AGREE * (total + parts.sum())
            total += float(parts.reshape(-1, 2)[agree].sum())
            known += float(off[agree].sum())
            panels, whole = panels[np.repeat(~agree, 2)], parts[np.repeat(~agree, 2)]
        assert whole is not None
        return total + float(whole.sum()), known + float(np.abs(whole).sum())
