"""Regions of many random methods against other routes: `make campaign`, or a sample by slow tests.

Of each: the ends of the stretches of a few lines against verdicts in rationals, and the area against a plain midpoint
rule over many lines, where what hangs together with weak feedback is all there is. Prints every contradiction and
every refusal; the exit status is 1 if an area was wrong beyond its own estimate.
"""

import sys
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parent.parent.parent))  # run as a script, the tests are no package yet

from bezstab.errors import NumericalError
from bezstab.methods.schemes import Method
from bezstab.rationals import exact
from bezstab.stability.closed_loop import converges
from bezstab.stability.lines import Lines
from bezstab.stability.regions import Region, _lines, _region, region
from tests.reference.random_methods import other_random_method, random_method

METHODS = 5_000  # of either half
BESIDE = 1e-5  # of an end: on either side of it the verdict is asked; double poles are known to less
NARROW = 1e-3  # of an end: stretches and gaps so short are not asked about: beyond a gap lies the next stretch
ASKED = 5  # lines of each method
ZERO = 1e-9  # of the upper end: a lower one so small is rounding of zero
RULES = (1_000, 4_000, 64_000)  # lines of the midpoint rule: the last difference, times two for corners, is its error
ADMITTED = 1e-7  # of the area, besides


def verdict_on(method: Method) -> str:
    """Return 'agrees', 'refused: why', 'unbounded', 'empty', or 'wrong: what' of a method's stable region."""
    try:
        shape = region(method)
    except NumericalError as error:
        return f"refused: {error}"
    finally:
        _region.cache_clear()
    wrong = _wrong_end(method)
    if not wrong and shape.area and not shape.islands:
        wrong = _wrong_area(shape)
    _lines.cache_clear()
    if wrong:
        return f"wrong: {wrong}"
    return "empty" if shape.extent is None else "agrees" if shape.bounded else "unbounded"


def _wrong_end(method: Method) -> str:
    """Return which end of a stretch contradicts verdicts in rationals; nothing if none does."""
    lines = _lines(method, 1.0)[0]
    wide = [place for place, ends in lines.found.items() if len(ends) and 1e-3 < place < 1e3]
    for place in sorted(wide)[:: 1 + len(wide) // ASKED]:
        ends = lines.found[place]
        for low, high in ends.tolist():
            for end, inwards in ((low, 1), (high, -1)):
                if not ZERO * high < end < np.inf or high - low < NARROW * high:
                    continue
                if np.any((np.abs(ends - end) > 0) & (np.abs(ends - end) < NARROW * end)):
                    continue
                within, beyond = (exact(end * (1 + side * inwards * BESIDE)) for side in (1, -1))
                if not converges(method, exact(place), within) or converges(method, exact(place), beyond):
                    return f"end {end:.9g} at alpha_hat = {place:.9g}"
    return ""


def _wrong_area(shape: Region) -> str:
    """Return how an area contradicts a midpoint rule, with more lines before that counts; nothing if it does not."""
    assert shape.area is not None
    plain = [plain_area(shape, RULES[0])]
    for count in RULES[1:]:
        plain.append(plain_area(shape, count))
        if abs(shape.area - plain[-1]) <= shape.area_error + 2 * abs(plain[-1] - plain[-2]) + ADMITTED * shape.area:
            return ""
    return f"area {shape.area:.9g}, {plain[-1]:.9g} by a plain rule"


def plain_area(shape: Region, count: int) -> float:
    """Return the area by a midpoint rule over many lines, wherever a region is, islands and all."""
    assert shape.extent
    (low, high), _ = shape.extent
    stretches = Lines(shape.method, shape.level, 0)._stretches(low + (high - low) * (np.arange(count) + 0.5) / count)
    return float(sum(np.diff(ends).sum() for ends in stretches) * (high - low) / count)


def methods(first: int, count: int) -> Iterator[Method]:
    """Yield random methods of both halves in turn."""
    for number in range(first, first + count):
        yield random_method(number)
        yield other_random_method(number)


def main() -> None:
    """Run the campaign."""
    counts: Counter[str] = Counter()
    for method in methods(0, METHODS):
        found = verdict_on(method)
        counts[found.split(":")[0]] += 1
        if ":" in found:
            print(method.name, found, flush=True)
    print(dict(counts))
    sys.exit(1 if counts["wrong"] else 0)


if __name__ == "__main__":
    main()
