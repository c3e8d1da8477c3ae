"""Steps as machine code: the generated stepper, compiled by numba, in blocks of steps.

A generator gives its steps one by one, which would cost more than the step itself. So what is compiled is the same
stepper as a block, a function that takes many steps and stores their states (see `generated_code`).

Every operation is the one that Python would do, in its order, rounded as there: no sum is regrouped, no product fused
with a sum; sin, cos and sqrt are those of the C library that `math` has too, and what `math` refuses is refused. So
each bit of a run is the same. A block ends early where a state looks like a breakdown; where something is refused, the
step is taken again in Python. Thus it is Python that decides, and says, why a run ends.

The Newton iterations of an implicit method are one text for Python and for machine code, in plain loops over lists
(`newton_iterations`). What each step keeps, the inverse Jacobians, lies in arrays. A step whose equations are not
solved is taken again in Python, too.
"""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, partial
from types import SimpleNamespace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bezstab.compiling import (
    INNER,
    check_numba,
    compiled_choice,
    compiler,
    numba_is_installed,
    shared_with_machine_code,
)
from bezstab.errors import InputError
from bezstab.mechanism.compiled import (
    BLOWN_UP,
    SINGULAR,
    Mechanism,
    compiled_residuals,
    machine_code_of,
    machine_residuals,
    machine_stepper_of,
    stepper_of,
)
from bezstab.mechanism.generated_code import Stepper, block_source, compiled_source, lesser, varying_block_source
from bezstab.mechanism.newton_iterations import (
    LOOPS,
    TOLERANCE,
    Residual,
    Work,
    iterated,
    newton_solution,
    no_inverse,
    rounding_of,
)
from bezstab.methods import Method, implicit

FloatArray = NDArray[np.float64]

BLOCK = 4096
"""Steps between two looks at what the user wants (Ctrl-C): milliseconds for a mechanism of some bodies."""

NEARLY_BLOWN_UP = BLOWN_UP * (1 - 1e-9)
"""Below what blows up by more than any rounding of the sum: what is beyond, Python judges."""

WORTH_COMPILING = 10**6
"""Evaluations of a run: Python takes twice as long for so many as numba takes to be loaded and to compile the method.

Both grow with the mechanism and with the evaluations of a step alike."""

ITERATIONS_OF_A_SOLUTION = 4
"""Evaluations that Newton's method usually takes for each of an implicit method's, or more."""

CHEAPER_TOGETHER = 20
"""Times: what an evaluation costs in a batch of numpy, against one of a run alone in Python."""

MOST_LINES = 3000
"""Of a turn of a stepper that is compiled without being asked for: what numba takes grows faster than the text."""

MOST_LINES_ASKED_FOR = 8000
"""Of one that is asked for: numba takes a minute for 2,000 lines, and between two and three for 6,000."""

CONSTANT = "float64, float64, float64, float64"
VARYING = "float64[::1], float64[::1], float64[::1], float64[::1], int64[::1]"
BLOCK_ARGUMENTS = "int64, int64, float64[::1], float64[::1], float64[::1], int64[::1]"
"""What a block is given of its steps, constant or varying ones, and after that; an implicit method has two more."""

Powers = tuple[int, ...] | None
"""Of steps that vary: the power of the length in each number that a step remembers. None if they are constant."""

_compiled: set[tuple[Mechanism, Method, bool]] = set()
"""What this process has compiled, and whether for steps that vary."""


@dataclass(frozen=True, eq=False)
class Block:
    """States after each of some steps, shape (steps, 2n), SI units, and the least relative pivots on the way."""

    states: FloatArray
    pivots: FloatArray


@dataclass(frozen=True, eq=False)
class VaryingSteps:
    """Steps of different lengths (s), one after the other, shape (steps,).

    `gains` has 2 alpha (1/s) and beta^2 (1/s^2) of each, shape (steps, 2).
    """

    lengths: FloatArray
    gains: FloatArray

    @property
    def times(self) -> FloatArray:
        """The times (s) at which they begin, and that at which the last one ends; shape (steps + 1,)."""
        return np.concatenate([[0.0], np.cumsum(self.lengths)])

    @property
    def ratios(self) -> FloatArray:
        """The ratio of each length to the one before, the first to itself."""
        before = np.concatenate([self.lengths[:1], self.lengths[:-1]])
        ratios: FloatArray = self.lengths / before
        return ratios


def runs_compiled(mechanism: Mechanism, method: Method, evaluations: int, varying: bool = False) -> bool:
    """Return whether a run of so many evaluations is to be compiled. InputError if it must be and cannot be.

    That is without numba, or where a step is too long a text. By default where numba is there and it pays: the run is
    long, or has been compiled before. `evaluations` do not include what iterations take; `varying` says whether steps
    do. InputError, too, where BEZSTAB_COMPILED says neither auto nor yes nor no.
    """
    choice = compiled_choice()
    if choice == "no":
        return False
    if choice == "yes":
        check_numba()
        _check_length(mechanism, method)
        return True
    if not numba_is_installed():
        return False
    if implicit(method):
        evaluations *= ITERATIONS_OF_A_SOLUTION
    pays = evaluations >= WORTH_COMPILING and machine_stepper_of(mechanism, method).length <= MOST_LINES
    return pays or (mechanism, method, varying) in _compiled


def _check_length(mechanism: Mechanism, method: Method) -> None:
    """Raise InputError if a step of the method is too long to be compiled in minutes."""
    length = machine_stepper_of(mechanism, method).length
    if length > MOST_LINES_ASKED_FOR:
        raise InputError(
            f"--compiled yes: a step of {method.name} on {mechanism.scene.name} is {length} lines of code, of which "
            f"at most {MOST_LINES_ASKED_FOR} are compiled in minutes: expected auto or no"
        )


@cache
def _machine_block(mechanism: Mechanism, method: Method, powers: Powers = None) -> Callable[..., int]:
    """Return the block function as machine code."""
    numba = compiler()

    # what `math` refuses: Python's own words come from the step that is taken again
    def checked_sin(x: float) -> float:
        if math.isinf(x):
            raise ValueError
        return math.sin(x)

    def checked_cos(x: float) -> float:
        if math.isinf(x):
            raise ValueError
        return math.cos(x)

    def checked_sqrt(x: float) -> float:
        if x < 0:
            raise ValueError
        return math.sqrt(x)

    library = SimpleNamespace(
        sin=numba.njit(**INNER)(checked_sin),
        cos=numba.njit(**INNER)(checked_cos),
        sqrt=numba.njit(**INNER)(checked_sqrt),
    )
    parts = machine_parts(mechanism, library, INNER)
    solvers = _machine_solvers(numba, mechanism, method, library, parts)
    block = _block(machine_stepper_of(mechanism, method), powers, library, parts | solvers)
    arguments = f"{CONSTANT if powers is None else VARYING}, {BLOCK_ARGUMENTS}"
    if solvers:
        inverse = "float64[::1]" if powers is None else "float64[:, ::1]"
        arguments += f", UniTuple({inverse}, {len(solvers)}), int64[::1]"
    machine_block: Callable[..., int] = numba.njit(f"int64({arguments})", no_cfunc_wrapper=True)(block)
    _compiled.add((mechanism, method, powers is not None))
    return machine_block


def machine_parts(mechanism: Mechanism, library: Any, options: Mapping[str, Any]) -> dict[str, Any]:
    """Return the functions that compiled steps call, and their accelerations where they are long, by their names."""
    numba = compiler()
    parts: dict[str, Any] = {"empty": np.empty, "lesser": numba.njit(**options)(lesser)}
    for number, source in enumerate(machine_code_of(mechanism).parts):
        name = f"part_{number}"
        parts[name] = numba.njit(**options)(compiled_source(source, library)[name])
    return parts


def _machine_solvers(
    numba: Any, mechanism: Mechanism, method: Method, library: Any, parts: Mapping[str, Any]
) -> dict[str, Any]:
    """Return the functions by which the block of an implicit method has its equations solved, by their names."""
    shared_with_machine_code(LOOPS)
    residuals = machine_residuals(mechanism, method, library, parts)
    tolerance = TOLERANCE * rounding_of(math)

    def solver(residual: Residual) -> Any:
        machine_residual, slope = numba.njit(**INNER)(residual.residual), numba.njit(**INNER)(residual.slope)
        evaluations = residual.evaluations

        def solve(situation: Any, known: Any, sought: Any, inverse: Any, counts: Any) -> Any:
            converged, pivot, _ = iterated(
                machine_residual, slope, evaluations, situation, known, sought, inverse, tolerance, counts
            )
            if not converged:
                raise ArithmeticError
            return pivot

        return numba.njit(**INNER)(solve)

    return {f"solve_{number}": solver(residual) for number, residual in residuals.items()}


@cache
def _python_block(mechanism: Mechanism, method: Method, powers: Powers = None) -> Callable[..., int]:
    """Return the same function as Python takes it."""
    tolerance = TOLERANCE * rounding_of(math)

    def solver(residual: Residual) -> Any:
        def solve(situation: Any, known: Any, sought: Any, inverse: Any, counts: Any) -> Any:
            return newton_solution(residual, situation, known, sought, inverse, tolerance, counts)

        return solve

    residuals = compiled_residuals(mechanism, method, math)
    solvers = {f"solve_{number}": solver(residual) for number, residual in residuals.items()}
    return _block(stepper_of(mechanism, method), powers, math, solvers)


def _block(stepper: Stepper, powers: Powers, library: Any, others: Mapping[str, Any]) -> Callable[..., int]:
    if powers is None:
        source, name = block_source(stepper, SINGULAR, NEARLY_BLOWN_UP), "block"
    else:
        source, name = varying_block_source(stepper, powers, SINGULAR, NEARLY_BLOWN_UP), "varying_block"
    block: Callable[..., int] = compiled_source(source, library, others)[name]
    return block


def blocks_of_steps(
    mechanism: Mechanism,
    method: Method,
    start: float,
    h: float,
    gains: tuple[float, float],
    remembered: Sequence[Any],
    count: int,
    work: Work,
) -> Iterator[Block]:
    """Yield `count` steps of a method in blocks, as machine code takes them; a block ends where it may break.

    `start` (s), h (s, the whole step), the gains 2 alpha (1/s) and beta^2 (1/s^2) are those of the generated stepper;
    `remembered` is what it is called with beyond them: state and past, or what a second-order scheme carries. What
    implicit steps take is added to `work`. Where Python would refuse an operation, or not solve a step's equations, it
    does: ArithmeticError or ValueError, after the steps before.
    """
    by_machine = partial(_machine_block(mechanism, method), start, h, *gains)

    def by_python(*arguments: Any) -> int:
        return _python_block(mechanism, method)(start, h, *gains, *arguments)

    inverses = tuple(np.array(no_inverse(unknowns)) for unknowns in stepper_of(mechanism, method).groups.values())
    return _blocks(by_machine, by_python, 2 * mechanism.size, remembered, inverses, count, work)


def blocks_of_varying_steps(
    mechanism: Mechanism,
    method: Method,
    steps: VaryingSteps,
    powers: tuple[int, ...],
    remembered: Sequence[Any],
    work: Work,
) -> Iterator[Block]:
    """Yield the same of a one-step method's steps, which may vary; of what it remembers each has a power of the length.

    The inverse Jacobians of its equations are kept from step to step of the same length.
    """
    lengths, kinds = np.unique(steps.lengths, return_inverse=True)
    given = (steps.times[:-1], steps.lengths, steps.ratios, steps.gains.ravel(), kinds.astype(np.int64))
    by_machine = partial(_machine_block(mechanism, method, powers), *given)

    def by_python(*arguments: Any) -> int:
        return _python_block(mechanism, method, powers)(*(array.tolist() for array in given), *arguments)

    inverses = tuple(
        np.array([no_inverse(unknowns)] * len(lengths)) for unknowns in stepper_of(mechanism, method).groups.values()
    )
    return _blocks(by_machine, by_python, 2 * mechanism.size, remembered, inverses, len(steps.lengths), work)


def _blocks(
    by_machine: Callable[..., int],
    by_python: Callable[..., int],
    size: int,
    remembered: Sequence[Any],
    inverses: tuple[FloatArray, ...],
    count: int,
    work: Work,
) -> Iterator[Block]:
    """Yield steps in blocks, states of that size; what is refused is taken again by Python, which says why."""
    memory = np.array(list(flat(remembered)), dtype=np.float64)
    reached = np.zeros(1, dtype=np.int64)
    k = 0
    while k < count:
        last = min(k + BLOCK, count)
        states, pivots = np.empty((last - k) * size), np.empty(last - k)
        kept = tuple(inverse.copy() for inverse in inverses)
        counts = np.zeros(2, dtype=np.int64)
        solving = (inverses, counts) if inverses else ()
        refused = False
        try:
            by_machine(k, last, memory, states, pivots, reached, *solving)
        except (ArithmeticError, ValueError):  # memory is as it was before the block
            refused = True
            for inverse, before in zip(inverses, kept, strict=True):
                inverse[:] = before
            counts[:] = 0
            by_machine(k, int(reached[0]), memory, states, pivots, reached, *solving)
        work.add(counts.tolist())
        taken = int(reached[0]) - k
        k += taken
        if taken:
            yield Block(states[: taken * size].reshape(taken, size), pivots[:taken])
        if refused:
            in_lists = ([inverse.tolist() for inverse in inverses], work.counts) if inverses else ()
            by_python(k, k + 1, memory.tolist(), [0.0] * size, [0.0], [k], *in_lists)
            raise AssertionError("a step that machine code refuses was taken by Python")


def flat(remembered: Any) -> Iterator[Any]:
    """Yield the numbers or arrays of nested tuples and lists, in their order."""
    if isinstance(remembered, (tuple, list)):
        for part in remembered:
            yield from flat(part)
    else:
        yield remembered
