"""Regions and best points of many random methods against independent ones: `make campaign`, or a sample by slow tests.

Areas are held against integrals over lines of constant alpha_hat (tests/reference/sliced_areas), in a box three times
as wide as what was found; extents, of regions without end too, against proven verdicts on lines near and far out
(extents); the least |z_p| against what descent finds in the quadrant up to 1e9 (least_by_descent). Prints every
difference above 1e-6 of the area, every other contradiction and every refusal; the exit status is 1 if one was silent.
"""

import sys
import time
from collections import Counter
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parent.parent.parent))  # run as a script, the tests are no package yet

from bezstab.errors import NumericalError
from bezstab.methods import Method
from bezstab.stability import best_point, best_points, falls_towards, region
from bezstab.stability.boundary_locus import bounds_of
from tests.reference.companion_poles import closed_loop_tables
from tests.reference.extents import contradictions as extent_contradictions
from tests.reference.least_by_descent import contradictions as best_point_contradictions
from tests.reference.random_methods import other_random_method, random_method
from tests.reference.sliced_areas import Integral, proven_sliced_integral, sliced_integral, stable

METHODS = 5_000  # of either half
LEVELS = (1.0, 0.93, 0.75, 0.5)
DIFFERENT = 1e-6  # of the area
WIDENED, LESS_WIDENED = 3.0, 1.5  # times the window of what was found, in which the second integral looks
PANELS = 48  # of that integral, over that box: a third of them over what was found
OTHER_PANELS = 1000  # before a difference counts
ROUNDING = 1e-9  # of a level, and more: nearer to it float64 does not tell on which side a multiple pole lies
ALPHA_RANGE, BETA_RANGE, POINTS = (-2.0, 8.0), (-4.0, 16.0), 20_000  # where an empty region must have no stable point


@dataclass(frozen=True)
class Case:
    """One region: its area (None if refused, with the reason), the integral's, and the error the integral admits.

    `contradictions` say what else is wrong, of its extent and, with level 1, of the method's best point.
    """

    name: str
    level: float
    area: float | None
    reason: str
    integral: float
    admitted: float
    contradictions: tuple[str, ...] = ()

    @property
    def verdict(self) -> str:
        """'agrees', 'refused', 'unbounded', 'silent', or 'undecided' where the integral itself is not that exact."""
        if self.contradictions:
            return "silent"
        if self.area is None:
            return "refused" if self.reason else "unbounded"
        if _agree(self.area, Integral(self.integral, self.admitted)):
            return "agrees"
        return "undecided" if abs(self.area - self.integral) <= 10 * self.admitted else "silent"


def compared(method: Method, level: float) -> Case:
    """Return one case; nothing is integrated where there is no area."""
    try:
        area = region(method, level).area
    except NumericalError as error:
        return Case(method.name, level, None, str(error), integral=0.0, admitted=0.0)
    contradictions = _contradictions(method, level)
    if area is None:
        return Case(method.name, level, None, "", integral=0.0, admitted=0.0, contradictions=contradictions)
    integral = _integral(method, level, area)
    return Case(method.name, level, area, "", integral.value, integral.error, contradictions)


def _contradictions(method: Method, level: float) -> tuple[str, ...]:
    """Return what is wrong with the extent at a level and, with level 1, with the best point; a refusal is not."""
    extent = region(method, level).extent
    found = extent_contradictions(method, level, extent) if extent else []
    if level == 1:
        with suppress(NumericalError):
            best, limit = best_point(method), falls_towards(method)
            found += best_point_contradictions(method, best, limit.z_abs if limit else None)
    return tuple(found)


def _agree(area: float, integral: Integral) -> bool:
    return abs(area - integral.value) <= DIFFERENT * max(abs(area), abs(integral.value))


def _integral(method: Method, level: float, area: float) -> Integral:
    """Return the integral over lines of constant alpha_hat, as exact as it takes to tell a difference."""
    if not area:
        rng = np.random.default_rng(0)
        below = level * (1 - ROUNDING)  # a pole that no feedback moves may lie on the level itself
        found = stable(method, below, rng.uniform(*ALPHA_RANGE, POINTS), rng.uniform(*BETA_RANGE, POINTS))
        box = (ALPHA_RANGE[1] - ALPHA_RANGE[0]) * (BETA_RANGE[1] - BETA_RANGE[0])
        return Integral(float(found.mean()) * box, error=0.0)
    integral = sliced_integral(method, level, PANELS, WIDENED)
    if _agree(area, integral):
        return integral
    # a part may have lain between its lines; and where poles nearly meet float64 does not tell where a slice ends
    proven = proven_sliced_integral(method, level, OTHER_PANELS, WIDENED)
    # in a large box an interval may be missed: what the box's size changes is the integral's own error, too
    other = proven_sliced_integral(method, level, OTHER_PANELS, LESS_WIDENED)
    return Integral(proven.value, proven.error + abs(proven.value - other.value))


def all_cases_of(number: int) -> list[Case]:
    """Return the cases of both random methods of a number."""
    return [*cases_of(random_method(number)), *cases_of(other_random_method(number))]


def cases_of(method: Method) -> list[Case]:
    """Return the cases of a method, and forget what was remembered of it."""
    cases = [compared(method, level) for level in LEVELS]
    for remembering in (region, bounds_of, closed_loop_tables, best_points._best_or_limit):
        remembering.cache_clear()
    return cases


def all_cases(methods: int, seconds: float, first_method: int) -> Iterator[Case]:
    """Yield the cases of so many numbers from the first on, from two processes, until the time is over."""
    start = time.monotonic()
    with ProcessPoolExecutor(2) as pool:
        for done, cases in enumerate(pool.map(all_cases_of, range(first_method, first_method + methods)), start=1):
            yield from cases
            if done % 500 == 0:
                print(f"{done} of {methods}", file=sys.stderr, flush=True)
            if time.monotonic() - start > seconds:
                pool.shutdown(wait=False, cancel_futures=True)
                return


def main() -> None:
    """Run the campaign: numbers of methods of either half, of seconds at most, and of the first method may be given."""
    methods = int(sys.argv[1]) if len(sys.argv) > 1 else METHODS
    seconds = float(sys.argv[2]) if len(sys.argv) > 2 else float("inf")
    first_method = int(sys.argv[3]) if len(sys.argv) > 3 else 0
    counts: Counter[str] = Counter()
    for case in all_cases(methods, seconds, first_method):
        counts[case.verdict] += 1
        if case.verdict not in ("agrees", "unbounded"):
            print(case.verdict, case, flush=True)
    print(dict(counts))
    sys.exit(1 if counts["silent"] else 0)


if __name__ == "__main__":
    main()
