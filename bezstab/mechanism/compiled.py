"""A mechanism: a scene with its equations of motion, and the functions that are generated and compiled from them."""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from bezstab.mechanism.equations import Equations, equations_of_motion
from bezstab.mechanism.generated_code import (
    AccelerationCode,
    MachineCode,
    Stepper,
    acceleration_code,
    acceleration_source,
    compiled_source,
    first_order_stepper,
    generator_source,
    machine_code,
    multipliers_source,
    observation_source,
    residual_slopes_source,
    residuals_source,
    second_order_stepper,
    single_step_source,
    slope_lines,
    slopes_source,
)
from bezstab.mechanism.newton_iterations import (
    TOLERANCE,
    Residual,
    Work,
    newton_solution,
    newton_solutions,
    no_inverse,
    rounding_of,
)
from bezstab.mechanism.scenes import Scene
from bezstab.mechanism.second_order_turns import implicit_groups
from bezstab.methods import Method, SecondOrder, implicit, second_order_form

State = tuple[Any, ...]
"""q then v, 2n numbers of any kind: floats, arrays over a batch, numbers of mpmath."""
Step = tuple[State, State, Any]
"""A new state, the slope before it (the derivatives of its entries) and the least relative pivot of S on the way."""
StateFunction = Callable[[Any, Any, Any, Any, Any], tuple[Any, ...]]
"""A function of t, 2 alpha, beta^2, q and v."""

SINGULAR = 1e-12  # of a row's own size: a pivot of S = C_q M^-1 C_q^T this small has lost all digits to cancellation

BLOWN_UP = 1e9  # SI units, sum of all coordinates and velocities: far beyond any mechanism, far below overflow


@dataclass(frozen=True, eq=False, repr=False)  # one per scene: compared by identity
class Mechanism:
    """A scene, its equations of motion and the code generated from them: all that a run needs, made once."""

    scene: Scene
    equations: Equations
    acceleration_code: AccelerationCode

    @property
    def size(self) -> int:
        """The number n of coordinates."""
        return len(self.equations.q)

    @property
    def constraints(self) -> int:
        """The number m of constraints."""
        return len(self.equations.constraints)

    def __repr__(self) -> str:
        return f"Mechanism({self.scene.name}, {self.size} coordinates, {self.constraints} constraints)"


@cache
def compiled_mechanism(scene: Scene) -> Mechanism:
    """Return the scene's mechanism (paper Eqs 1 to 9), the same one each time it is asked for."""
    equations = equations_of_motion(scene)
    return Mechanism(scene, equations, acceleration_code(equations))


def stepper_code(mechanism: Mechanism, method: Method) -> str:
    """Return the source of a generator function run(start, h, two_alpha, beta_squared, state, past).

    It starts from `state` (q then v, SI units) at time `start` (s) and takes steps of h (s, the whole step of the
    method) with the gains 2 alpha (1/s) and beta^2 (1/s^2). `past` holds the earlier (state, slope) pairs, newest
    first, one less than the method has steps. After each step it yields the new state, the slope before it and the
    least relative pivot of S = C_q M^-1 C_q^T met on the way.

    A second-order scheme, and every implicit one, has instead run(start, h, two_alpha, beta_squared, carried, solve)
    with what `second_order_memory` says that it carries, followed by its residuals.
    """
    return generator_source(stepper_of(mechanism, method))


def stepper_of(mechanism: Mechanism, method: Method) -> Stepper:
    """Return the pieces of which the source of a method's steps is put together."""
    return _stepper(mechanism.acceleration_code, method)


def machine_stepper_of(mechanism: Mechanism, method: Method) -> Stepper:
    """Return the same as machine code takes it: where its accelerations are long, it calls their parts."""
    return _stepper(machine_code_of(mechanism).acceleration, method)


def _stepper(code: AccelerationCode, method: Method) -> Stepper:
    scheme = run_as_second_order(method)
    return first_order_stepper(code, method) if scheme is None else second_order_stepper(code, scheme)


@cache
def machine_code_of(mechanism: Mechanism) -> MachineCode:
    """Return the mechanism's accelerations and their slopes as machine code takes them."""
    return machine_code(mechanism.acceleration_code, slope_lines(mechanism.equations))


def run_as_second_order(method: Method) -> SecondOrder | None:
    """Return the second-order scheme by which a method runs, or None for an explicit one that has steps of its own."""
    if implicit(method) or isinstance(method.scheme, SecondOrder):
        return second_order_form(method.scheme)
    return None


@cache
def compiled_stepper(mechanism: Mechanism, method: Method, library: Any) -> Callable[..., Iterator[Step]]:
    """Return the function whose source `stepper_code` returns, in the arithmetic of math, numpy or mpmath."""
    run: Callable[..., Iterator[Step]] = compiled_source(stepper_code(mechanism, method), library)["run"]
    return run


@cache
def compiled_single_step(mechanism: Mechanism, method: Method) -> Callable[..., tuple[Step, tuple[float, ...]]]:
    """Return single_step(start, h, two_alpha, beta_squared, remembered, solve), on floats: a step of its own length.

    `remembered` is flat: state, then past, or what a second-order scheme carries (units in which h = 1). It returns a
    step as `compiled_stepper` yields it, and what is remembered after it.
    """
    source = single_step_source(stepper_of(mechanism, method))
    single_step: Callable[..., tuple[Step, tuple[float, ...]]] = compiled_source(source, math)["single_step"]
    return single_step


Solver = Mapping[int, Callable[[Sequence[Any], Sequence[Any], list[Any]], Any]]
"""For each group by its number solve(situation, known, sought): it turns guesses into solutions; the least pivot."""


def implicit_solver(mechanism: Mechanism, method: Method, library: Any, work: Work) -> Solver:
    """Return what an implicit stepper calls to solve its groups of equations; what that takes is added to `work`.

    With numpy nothing is counted: the points of a batch iterate together.
    """
    solver_of_group = _batch_solver if library is np else _single_solver
    tolerance = TOLERANCE * rounding_of(library)
    residuals = compiled_residuals(mechanism, method, library)
    return {number: solver_of_group(residual, tolerance, work) for number, residual in residuals.items()}


def _single_solver(residual: Residual, tolerance: Any, work: Work) -> Callable[..., Any]:
    """Return what solves a group for one run, and keeps the inverse of its Jacobian from step to step."""
    inverse: list[Any] = []

    def solve(situation: Sequence[Any], known: Sequence[Any], sought: list[Any]) -> Any:
        if not inverse:
            inverse.extend(no_inverse(len(sought)))
        return newton_solution(residual, situation, known, sought, inverse, tolerance, work.counts)

    return solve


def _batch_solver(residual: Residual, tolerance: float, _: Work) -> Callable[..., Any]:
    """Return the same for a batch."""
    inverse = None

    def solve(situation: Sequence[Any], known: Sequence[Any], sought: list[Any]) -> Any:
        nonlocal inverse
        sought[:], pivot, inverse = newton_solutions(residual, situation, known, sought, inverse, tolerance)
        return pivot

    return solve


@cache
def compiled_residuals(mechanism: Mechanism, method: Method, library: Any) -> dict[int, Residual]:
    """Return the residual of each implicit group by its number, and its slope."""
    scheme = run_as_second_order(method)
    if scheme is None:
        return {}
    code = mechanism.acceleration_code
    residuals = compiled_source(residuals_source(code, scheme), library)
    slopes = compiled_source(residual_slopes_source(code, slope_lines(mechanism.equations), scheme), library)
    return _residuals_by_number(scheme, residuals, slopes)


def machine_residuals(
    mechanism: Mechanism, method: Method, library: Any, others: Mapping[str, Any]
) -> dict[int, Residual]:
    """Return the same as functions that can be made machine code; `others` are what those call: parts."""
    scheme = run_as_second_order(method)
    if scheme is None:
        return {}
    code = machine_code_of(mechanism)
    residuals = compiled_source(residuals_source(code.acceleration, scheme, compared=True), library, others)
    slopes = compiled_source(residual_slopes_source(code.acceleration, code.slopes, scheme), library, others)
    return _residuals_by_number(scheme, residuals, slopes)


def _residuals_by_number(
    scheme: SecondOrder, residuals: Mapping[str, Any], slopes: Mapping[str, Any]
) -> dict[int, Residual]:
    return {
        number: Residual(residuals[f"residual_{number}"], slopes[f"residual_slope_{number}"], evaluations)
        for number, evaluations in implicit_groups(scheme).items()
    }


@cache
def acceleration_function(mechanism: Mechanism, library: Any) -> StateFunction:
    """Return the function of (t, two_alpha, beta_squared, q, v) that gives all of qddot: paper Eq. 9.

    Arguments as for multipliers_function; the n accelerations are in SI units.
    """
    source = acceleration_source(mechanism.acceleration_code)
    acceleration: StateFunction = compiled_source(source, library)["acceleration"]
    return acceleration


@cache
def slopes_function(mechanism: Mechanism) -> Callable[..., tuple[tuple[Any, ...], tuple[Any, ...]]]:
    """Return the function of (t, two_alpha, beta_squared, q, v), arrays of one shape, that gives qddot and its slopes.

    n accelerations, then 2n derivatives, each with a first axis of n entries; SI units.
    """
    source = slopes_source(mechanism.acceleration_code, mechanism.equations)
    slopes: Callable[..., tuple[tuple[Any, ...], tuple[Any, ...]]] = compiled_source(source, np)["slopes"]
    return slopes


@cache
def observation_function(mechanism: Mechanism, library: Any) -> StateFunction:
    """Return the function of (t, two_alpha, beta_squared, q, v) that gives all c, cdot, lambda, and the pivot."""
    source = observation_source(mechanism.acceleration_code)
    observation: StateFunction = compiled_source(source, library)["observation"]
    return observation


@cache
def multipliers_function(mechanism: Mechanism, library: Any) -> StateFunction:
    """Return the multipliers lambda as a function of (t, two_alpha, beta_squared, q, v): paper Eq. 9.

    `library` (math, numpy or mpmath) says on what numbers it works; q and v hold n of them, what is returned m (N along
    a constraint whose c is in m). t is in s, the gains 2 alpha and beta^2 in 1/s and 1/s^2, q and v in SI units.
    """
    source = multipliers_source(mechanism.acceleration_code)
    multipliers: StateFunction = compiled_source(source, library)["multipliers"]
    return multipliers
