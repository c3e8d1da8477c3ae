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
from bezstab.mechanism.compiled import run_as_second_order
from bezstab.mechanism.generated_code import residual_slopes_source, residuals_source, slope_lines
from bezstab.mechanism.newton_iterations import TOLERANCE, Residual, Work, newton_solution, no_inverse
from bezstab.mechanism.runner import carried_quantities
from bezstab.mechanism.second_order_turns import implicit_groups
from bezstab.methods import Method, RungeKutta, lookup
from tests.reference.one_coordinate_motion import DIGITS

FLOAT_LITERAL = r"\d+\.\d+(e-?\d+)?"


def precise_run(
    mechanism: Mechanism, method: Method, h: Any, gains: tuple[int, int], states: Sequence[Any], count: int
) -> list[Any]:
    """Return `count` states after the given ones, which are as many as the method needs, h (s) apart."""
    with mp.workdps(DIGITS):
        if run_as_second_order(method):
            run = _precise_second_order_run(mechanism, method, h, gains, states)
        else:
            euler = _precise_stepper(mechanism, lookup("RK1"))
            past = []
            for state in states[-2::-1]:
                # the slope before a step does not depend on the method
                _, slope, _ = next(euler(0, h, *gains, state, []))
                past.append((state, slope))
            run = _precise_stepper(mechanism, method)(0, h, *gains, states[-1], past)
        return [state for state, _, _ in islice(run, count)]


def _precise_stepper(mechanism: Mechanism, method: Method) -> Callable[..., Iterator[Any]]:
    run: Callable[..., Iterator[Any]] = _precisely(stepper_code(mechanism, method), method)["run"]
    return run


def _precise_second_order_run(
    mechanism: Mechanism, method: Method, h: Any, gains: tuple[int, int], states: Sequence[Any]
) -> Iterator[Any]:
    """Return the steps of an implicit or second-order method, solved to the digits in force."""
    scheme = run_as_second_order(method)
    assert scheme
    plain = _precisely(residuals_source(mechanism.acceleration_code, scheme), method)
    slopes_of_acceleration = slope_lines(mechanism.equations)
    slopes = _precisely(residual_slopes_source(mechanism.acceleration_code, slopes_of_acceleration, scheme), method)
    residuals = {
        number: Residual(plain[f"residual_{number}"], slopes[f"residual_slope_{number}"], evaluations)
        for number, evaluations in implicit_groups(scheme).items()
    }

    def solver(residual: Residual) -> Callable[..., Any]:
        """Return what solves a group anew in each step."""

        def solve(situation: Sequence[Any], known: Sequence[Any], sought: list[Any]) -> Any:
            inverse: list[Any] = no_inverse(len(sought))
            return newton_solution(residual, situation, known, sought, inverse, TOLERANCE * mp.eps, [0, 0])

        return solve

    solve = {number: solver(residual) for number, residual in residuals.items()}
    carried = carried_quantities(mechanism, scheme, h, gains, states, None, mp, Work())
    return _precise_stepper(mechanism, method)((len(states) - 1) * h, h, *gains, carried, solve)


def _precisely(source: str, method: Method) -> dict[str, Any]:
    """Return what source defines, with each literal as the number that it stands for."""
    exact = {float(abs(c)): abs(c) for c in _coefficients(method.scheme)}

    def as_ratio(literal: re.Match[str]) -> str:
        """Return the method's coefficient, or the simplest fraction that rounds to a literal, as 1/3 to 0.333."""
        simplest = Fraction(literal[0]).limit_denominator(10**7)
        fallback = simplest if float(simplest) == float(literal[0]) else Fraction(literal[0])
        value = exact.get(float(literal[0]), fallback)
        return f"ratio({value.numerator}, {value.denominator})"

    namespace = compiled_source(re.sub(FLOAT_LITERAL, as_ratio, source), mp)
    namespace["ratio"] = cache(lambda numerator, denominator: mp.mpf(numerator) / denominator)
    return namespace


def _coefficients(part: Any) -> Iterator[Fraction]:
    """Yield every fraction in a scheme, and the times of a Runge-Kutta method's stages."""
    if isinstance(part, Fraction):
        yield part
    elif isinstance(part, tuple):
        for inner in part:
            yield from _coefficients(inner)
    elif hasattr(part, "__dataclass_fields__"):
        for name in part.__dataclass_fields__:
            yield from _coefficients(getattr(part, name))
    if isinstance(part, RungeKutta):
        yield from (sum(row, Fraction(0)) for row in part.tableau)
