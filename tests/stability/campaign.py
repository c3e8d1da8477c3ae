"""Areas of many random methods against an independent integral: `make campaign`, or a sample by the slow tests.

Prints every difference above 1e-6 of the area and every refusal; the exit status is 1 if a difference was silent.
"""

import sys
import time
from collections import Counter
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent.parent.parent))  # run as a script, the tests are no package yet

from bezstab.errors import NumericalError
from bezstab.methods import Method
from bezstab.stability import region
from bezstab.stability.boundary_locus import bounds_of
from tests.reference.random_methods import random_method
from tests.reference.slice_integral import slice_area

METHODS = 10_000
LEVELS = (1.0, 0.93, 0.75, 0.5)
DIFFERENT = 1e-6  # of the area
FINER_PANELS = 1000  # of the integral, in place of 96, before a difference counts


@dataclass(frozen=True)
class Case:
    """One region: its area (None if refused, with the reason), the integral's, and the error the integral admits."""

    name: str
    level: float
    area: float | None
    reason: str
    integral: float
    admitted: float

    @property
    def verdict(self) -> str:
        """'agrees', 'refused', 'silent', or 'undecided' where the integral itself is not that exact."""
        if self.area is None:
            return "refused"
        allowed = DIFFERENT * max(abs(self.area), abs(self.integral))
        if abs(self.area - self.integral) <= allowed:
            return "agrees"
        return "undecided" if abs(self.area - self.integral) <= 10 * self.admitted else "silent"


def compared(method: Method, level: float) -> Case:
    """Return one case."""
    area: float | None
    try:
        area, reason = region(method, level).area, ""
    except NumericalError as error:
        area, reason = None, str(error)
    integral = slice_area(method, level)
    if area is not None and abs(area - integral.area) > DIFFERENT * max(abs(area), abs(integral.area)):
        integral = slice_area(method, level, panels_at_first=FINER_PANELS)  # a part may have lain between its lines
    return Case(method.name, level, area, reason, integral.area, integral.error)


def cases_of(number: int) -> list[Case]:
    """Return the cases of one random method, and forget what was remembered of it."""
    cases = [compared(random_method(number), level) for level in LEVELS]
    region.cache_clear()
    bounds_of.cache_clear()
    return cases


def all_cases(methods: int, seconds: float, first_method: int) -> Iterator[Case]:
    """Yield the cases of so many methods from the first on, from two processes, until the time is over."""
    start = time.monotonic()
    with ProcessPoolExecutor(2) as pool:
        last_method = first_method + methods
        for first in range(first_method, last_method, 20):
            for cases in pool.map(cases_of, range(first, min(first + 20, last_method))):
                yield from cases
            if time.monotonic() - start > seconds:
                return


def main() -> None:
    """Run the campaign: numbers of methods, of seconds at most, and of the first method may be given."""
    methods = int(sys.argv[1]) if len(sys.argv) > 1 else METHODS
    seconds = float(sys.argv[2]) if len(sys.argv) > 2 else float("inf")
    first_method = int(sys.argv[3]) if len(sys.argv) > 3 else 0
    counts: Counter[str] = Counter()
    for case in all_cases(methods, seconds, first_method):
        counts[case.verdict] += 1
        if case.verdict != "agrees":
            print(case.verdict, case, flush=True)
    print(dict(counts))
    sys.exit(1 if counts["silent"] else 0)


if __name__ == "__main__":
    main()
