"""A method's program in thirty digits: what a formula does before rounding ends its descent.

Not another route but the same rows, exact as they are, without Newton's method: a group of evaluations is repeated
until nothing changes.
"""

from collections.abc import Iterable, Sequence
from fractions import Fraction
from typing import Any

import mpmath as mp

from bezstab.mechanism import Mechanism, acceleration_function, memory
from bezstab.mechanism.programs import program_of
from bezstab.methods import Method, second_order_form
from tests.reference.one_coordinate_motion import DIGITS

Vector = list[Any]
MOST_SWEEPS = 100  # each takes off a factor of about alpha_hat and beta_hat, which are far below one here


def precise_run(
    mechanism: Mechanism, method: Method, h: Any, gains: tuple[int, int], states: Sequence[Any], count: int
) -> list[Any]:
    """Return `count` states (q then v) after the given ones, which are as many as the method needs, h (s) apart."""
    with mp.workdps(DIGITS):
        return _run(mechanism, method, h, gains, states, count)


def _run(
    mechanism: Mechanism, method: Method, h: Any, gains: tuple[int, int], states: Sequence[Any], count: int
) -> list[Any]:
    scheme = second_order_form(method.scheme)
    program, remembered, n = program_of(scheme), memory(scheme), mechanism.size
    acceleration = acceleration_function(mechanism, mp)
    first = len(states) - 1

    def found(t: Any, position: Vector, velocity: Vector) -> Vector:
        """Return h^2 a for a position and h times a velocity."""
        return [h * h * a for a in acceleration(t, *gains, position, [x / h for x in velocity])]

    registers: list[Vector] = []
    for shares, step in zip(remembered.shares, remembered.state_steps, strict=True):
        q, v = list(states[first + step][:n]), [h * x for x in states[first + step][n:]]
        registers.append(combined(shares, [q, v, found((first + step) * h, q, v)]))
    carried = len(registers)
    registers += [[mp.mpf(0)] * n for _ in program.evaluations]
    later = []
    for k in range(first, first + count):
        for start, end, waiting in program.groups:
            numbers = range(start, end)
            if waiting:
                for number in numbers:
                    registers[carried + number] = registers[program.evaluations[number].guess]
            for _ in range(MOST_SWEEPS if waiting else 1):
                before = [registers[carried + number] for number in numbers]
                for number in numbers:
                    each = program.evaluations[number]
                    registers[carried + number] = found(
                        (k + as_number(each.moment)) * h,
                        combined(each.position, registers),
                        combined(each.velocity, registers),
                    )
                if [registers[carried + number] for number in numbers] == before:
                    break
        all_registers = [*registers, *(combined(row, registers) for row in program.combined)]
        position, velocity = (all_registers[register] for register in program.state)
        later.append([*position, *(x / h for x in velocity)])
        for source, target in program.moves:
            all_registers[target] = all_registers[source]
        registers = all_registers[: len(registers)]
    return later


def as_number(ratio: Fraction) -> Any:
    return mp.mpf(ratio.numerator) / ratio.denominator


def combined(row: Iterable[Fraction], registers: Sequence[Vector]) -> Vector:
    """Return the sum of registers that a row says."""
    terms = [(as_number(c), register) for c, register in zip(row, registers, strict=False) if c]
    return [mp.fsum(c * register[i] for c, register in terms) for i in range(len(registers[0]))]
