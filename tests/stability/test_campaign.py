"""Regions of 500 random methods against other routes; with `make campaign` of 10,000.

Of each: the ends of the stretches of a few lines against verdicts in rationals, and the area against a plain midpoint
rule over many lines, where what hangs together with weak feedback is all there is.
"""

import os

import numpy as np
import pytest

from bezstab.errors import NumericalError
from bezstab.methods.schemes import Method
from bezstab.rationals import exact
from bezstab.stability.closed_loop import converges
from bezstab.stability.lines import Lines
from bezstab.stability.regions import Region, _lines, _region, region
from tests.reference.random_methods import other_random_method, random_method

METHODS = int(os.environ.get("METHODS", "250"))  # of either half
BESIDE = 1e-5  # of an end: on either side of it the verdict is asked; double poles are known to less
NARROW = 1e-3  # of an end: stretches and gaps so short are not asked about: beyond a gap lies the next stretch
ASKED = 5  # lines of each method
ZERO = 1e-9  # of the upper end: a lower one so small is rounding of zero
RULES = (1_000, 4_000, 64_000)  # lines of the midpoint rule: the last difference, times two for corners, is its error
ADMITTED = 1e-7  # of the area, besides


@pytest.mark.slow
@pytest.mark.parametrize("first", range(0, METHODS, 25))
def test_no_region_of_a_random_method_is_wrong_beyond_its_own_estimate(first: int) -> None:
    methods = [draw(first + k) for k in range(25) for draw in (random_method, other_random_method)]
    refused = 0
    for method in methods:
        try:
            shape = region(method)
        except NumericalError:
            refused += 1
        else:
            assert contradicted_ends(method) == []
            if shape.area and not shape.islands:
                assert_area(shape)
    _region.cache_clear()
    _lines.cache_clear()
    assert refused <= 0.1 * len(methods)  # 3 % of all, by chance more of one in ten


def contradicted_ends(method: Method) -> list[tuple[float, float]]:
    """Return the ends of stretches, (alpha_hat, beta_hat), that contradict verdicts in rationals."""
    lines, wrong = _lines(method, 1.0)[0], []
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
                    wrong.append((place, end))
    return wrong


def assert_area(shape: Region) -> None:
    """Hold an area to a midpoint rule, with more lines before that counts."""
    assert shape.extent
    assert shape.area
    (low, high), _ = shape.extent
    lines, plain = Lines(shape.method, shape.level, 0), [np.inf]
    for count in RULES:
        stretches = lines._stretches(low + (high - low) * (np.arange(count) + 0.5) / count)
        plain.append(float(sum(np.diff(ends).sum() for ends in stretches) * (high - low) / count))
        known = shape.area_error + 2 * abs(plain[-1] - plain[-2]) + ADMITTED * shape.area
        if len(plain) > 2 and abs(shape.area - plain[-1]) <= known:
            return
    raise AssertionError(f"{shape.method.name}: area {shape.area:.9g}, {plain[-1]:.9g} by a plain rule")
