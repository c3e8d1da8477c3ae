"""The generated stepper in thirty digits: what a formula does before rounding ends its descent.

Not another route but the same source in another arithmetic, with each literal as the fraction that it stands for.
"""

import re
from collections.abc import Callable, Iterator, Sequence
from fractions import Fraction
from functools import cache
from itertools import islice
from typing import Any

import mpmath as mp

from bezstab.mechanism import Mechanism, compiled_source, stepper_code
from bezstab.methods import Method, lookup
from tests.reference.one_coordinate_motion import DIGITS

FLOAT_LITERAL = r"\d+\.\d+(e-?\d+)?"


def precise_run(
    mechanism: Mechanism, method: Method, h: Any, gains: tuple[int, int], states: Sequence[Any], count: int
) -> list[Any]:
    """Return `count` states after the given ones, which are as many as the method has steps, h (s) apart."""
    with mp.workdps(DIGITS):
        euler = _precise_stepper(mechanism, lookup("RK1"))
        past = []
        for state in states[-2::-1]:
            _, slope, _ = next(euler(0, h, *gains, state, []))  # the slope before a step does not depend on the method
            past.append((state, slope))
        run = _precise_stepper(mechanism, method)(0, h, *gains, states[-1], past)
        return [state for state, _, _ in islice(run, count)]


def _precise_stepper(mechanism: Mechanism, method: Method) -> Callable[..., Iterator[Any]]:
    source = re.sub(FLOAT_LITERAL, _as_ratio, stepper_code(mechanism, method))
    namespace = compiled_source(source, mp)
    namespace["ratio"] = cache(lambda numerator, denominator: mp.mpf(numerator) / denominator)
    run: Callable[..., Iterator[Any]] = namespace["run"]
    return run


def _as_ratio(literal: re.Match[str]) -> str:
    """Return the simplest fraction that rounds to a literal, as 1/3 does to 0.3333333333333333."""
    simplest = Fraction(literal[0]).limit_denominator(10**7)
    value = simplest if float(simplest) == float(literal[0]) else Fraction(literal[0])
    return f"ratio({value.numerator}, {value.denominator})"
