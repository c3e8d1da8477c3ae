"""Generated source: accelerations, multipliers, observations and time steps as Python text, and its compilation.

Only this file writes source, and only here it is executed; others hand it data (equations, methods, turns) and take
functions. From its top to its end, each part under a comment of its own:

    compiled_source                        text becomes functions
    accelerations and multipliers          the assignments that solve paper Eq. 9
    functions of a state                   acceleration, multipliers, observation
    slopes of the acceleration             its derivatives by position and velocity, or along one direction
    accelerations in parts                 the same for machine code, where they are long
    steppers: their pieces                 what a step consists of, as data
    a stepper as a generator               one run, step by step
    a stepper as a single step             one step, and what the next begins with
    a stepper as a block                   one run, many steps at a time
    a stepper as a batch                   many runs, of which constraint errors are kept
    steppers of first-order schemes        the pieces of multistep and Runge-Kutta methods
    steppers of second-order schemes       those of all others; residuals and their slopes

All of it is plain arithmetic on numbered variables, one assignment a line, with `sin`, `cos`, `sqrt` and `least` as the
only functions, and `row` where there are slopes. What they are is decided when the text is compiled, so one source
serves three kinds of numbers:

- floats with `math`: a single run, without the overhead of arrays of four or five entries;
- numpy arrays: a batch of runs, each variable one array over the batch, each line one operation on all of it;
- mpmath numbers: references of as many digits as asked for.

The names: q0, q1, ... coordinates, v0, ... their rates, a0, ... their accelerations, l0, ... multipliers; C1_2, the
entry of C_q in row 1 and column 2; two_alpha and beta_squared, the gains. The text holds nothing of a scene or a method
but numbers and these names; least of all the names that a user gave to bodies.
"""

import math
import re
from collections.abc import Callable, Collection, Container, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

import numpy as np
import sympy as sp
from sympy.printing.precedence import PRECEDENCE
from sympy.printing.pycode import PythonCodePrinter

from bezstab.mechanism.equations import Equations, variable_names
from bezstab.mechanism.second_order_memory import ACCELERATION, POSITION, VELOCITY, memory
from bezstab.mechanism.second_order_turns import (
    Assigned,
    Evaluated,
    Solved,
    Sum,
    solved_groups,
    turn,
)
from bezstab.methods import (
    LinearMultistep,
    Method,
    PredictorCorrector,
    Quantity,
    RungeKutta,
    SecondOrder,
    steps,
)

AT_THE_START = Fraction(0)  # of a step
AT_THE_END = Fraction(1)


def compiled_source(source: str, library: Any, others: Mapping[str, Any] | None = None) -> dict[str, Any]:
    """Return what generated source defines, its elementary functions those of `library`: math, numpy or mpmath.

    `others` are functions that it calls, by their names.
    """
    least = min if library is math else _least_of_arrays
    namespace = {"sin": library.sin, "cos": library.cos, "sqrt": library.sqrt, "least": least, "row": _row_of_arrays}
    namespace |= {"lesser": lesser} | dict(others or {})
    exec(source, namespace)
    return namespace


def lesser(first: float, second: float) -> float:
    """Return what Python's min returns, the first unless the second is less; as text that machine code takes."""
    return second if second < first else first


def _least_of_arrays(*values: Any) -> Any:
    """Return the least value entry by entry, of arrays and numbers of any broadcastable shapes."""
    return np.minimum.reduce(np.broadcast_arrays(*values))


def _row_of_arrays(like: Any, *entries: Any) -> Any:
    """Return an array of entries, some of them numbers, along a first axis; each has the shape of an array like it."""
    row = np.empty((len(entries), *np.shape(like)))
    for place, entry in enumerate(entries):
        row[place] = entry
    return row


# Accelerations and multipliers
#
# M is diagonal, so paper Eq. 9, [M C_q^T; C_q 0] [qddot; lambda] = [g; gamma - 2 alpha cdot - beta^2 c], reduces to
#
#     S lambda = r,   S = C_q M^-1 C_q^T,   r = C_q M^-1 g - gamma + 2 alpha cdot + beta^2 c
#     qddot = M^-1 (g - C_q^T lambda)
#
# S is symmetric and positive definite. It is factored as L D L^T, L lower triangular with ones on its diagonal, D
# diagonal, column by column; with W_ij = L_ij D_j, which is what is left of S_ij after the earlier columns:
#
#     D_j  = S_jj - sum_{p<j} L_jp W_jp                      | 1           | D0             | 1 L10 L20 |
#     W_ij = S_ij - sum_{p<j} L_ip W_jp    (i > j)      S =  | L10 1       |    D1          |   1   L21 |
#     L_ij = W_ij / D_j                                      | L20 L21 1   |       D2       |       1   |
#
# Then L y = r forwards, y / D, and L^T lambda = y / D backwards, all in the variables r_i and l_i. The loops over i, j
# and p run here, once: what is generated is the list of assignments they would execute ("unrolled").
#
# A constraint involves few coordinates and a body few constraints, so most entries of C_q are zero whatever q is, and
# with them many of S and L. Such structural zeros are known here, and no term that has one as a factor is written.
# A chain of N bodies costs N times as much as one, where a full elimination would cost N^3.


@dataclass(frozen=True)
class AccelerationCode:
    """Assignments that compute a_i = qddot_i and l_j = lambda_j from t, q_i, v_i, two_alpha and beta_squared.

    On the way c_j and cdot_j get their values. `pivots` are the texts of 1 and of the pivots D_j relative to S_jj;
    where the least of these is small, S is nearly singular.
    """

    coordinates: int
    constraints: int
    lines: tuple[str, ...]
    pivots: tuple[str, ...]


def acceleration_code(equations: Equations) -> AccelerationCode:
    """Return the assignments that solve paper Eq. 9 by an unrolled L D L^T without its structural zeros."""
    coordinates = len(equations.q)
    constraints = len(equations.constraints)
    entries = _nonzero_entries(equations)
    columns_of_row = _columns_of_row(equations)
    inverse_masses = _inverse_masses(equations)
    factors = _nonzero_factors(columns_of_row)
    lines = [
        *_entry_lines(entries),
        *_right_side_lines(columns_of_row, inverse_masses, entries),
        *_factorization_lines(columns_of_row, inverse_masses, factors),
        *_substitution_lines(constraints, factors),
        *_acceleration_lines(columns_of_row, inverse_masses, entries),
    ]
    pivots = "1.0", *(f"D{j} / S{j}" for j in range(constraints))
    return AccelerationCode(coordinates, constraints, tuple(lines), pivots)


def _columns_of_row(equations: Equations) -> list[list[int]]:
    """Return for each constraint the coordinates on which it depends: the columns of C_q where its row is not zero."""
    jacobian = equations.jacobian
    return [[k for k in range(jacobian.cols) if jacobian[i, k] != 0] for i in range(jacobian.rows)]


def _inverse_masses(equations: Equations) -> list[str]:
    """Return the texts of the numbers 1 / M_k."""
    return [repr(1 / float(mass)) for mass in equations.mass]


def _nonzero_entries(equations: Equations) -> dict[str, sp.Expr]:
    """Return the entries of C_q, gamma, c, c_t and g that are not identically zero, by the names of their variables."""
    coordinates = range(len(equations.q))
    constraints = range(len(equations.constraints))
    entries = {f"C{i}_{k}": equations.jacobian[i, k] for i in constraints for k in coordinates}
    entries |= {f"gamma{i}": equations.gamma[i] for i in constraints}
    entries |= {f"c{i}": equations.constraints[i] for i in constraints}
    entries |= {f"ct{i}": equations.constraints_t[i] for i in constraints}
    entries |= {f"g{k}": equations.forces[k] for k in coordinates}
    return {name: expression for name, expression in entries.items() if expression != 0}


def _entry_lines(entries: dict[str, sp.Expr]) -> list[str]:
    """Return the assignments to the entries, after those to x0, x1, ...: what several of them have in common."""
    common, remaining = sp.cse(list(entries.values()), symbols=sp.numbered_symbols("x"))
    assigned = [(str(symbol), expression) for symbol, expression in common]
    assigned += zip(entries, remaining, strict=True)
    printer = _Arithmetic({"fully_qualified_modules": False})
    return [f"{name} = {printer.doprint(expression)}" for name, expression in assigned]


def constraint_texts(equations: Equations) -> list[str]:
    """Return the entries of c as expressions in q0, q1, ... and t."""
    printer = _Arithmetic({"fully_qualified_modules": False})
    return [str(printer.doprint(expression)) for expression in equations.constraints]


class _Arithmetic(PythonCodePrinter):  # type: ignore[misc]  # sympy has no types
    """Prints whole powers as products: x**2 is rounded otherwise for floats than for arrays, x*x alike for all."""

    def _print_Pow(self, expr: sp.Pow, rational: bool = False) -> str:  # noqa: N802  # the name by which sympy calls it
        if not expr.exp.is_Integer or expr.exp == -1:
            return str(super()._print_Pow(expr, rational=rational))
        base = self.parenthesize(expr.base, PRECEDENCE["Pow"])
        product = f"({'*'.join([base] * abs(int(expr.exp)))})"
        return product if expr.exp > 0 else f"(1/{product})"


def _right_side_lines(
    columns_of_row: Sequence[Sequence[int]], inverse_masses: Sequence[str], entries: Iterable[str]
) -> list[str]:
    """Return the assignments to cdot = C_q v + c_t and r = C_q M^-1 g - gamma + 2 alpha cdot + beta^2 c."""
    lines = []
    for i, columns in enumerate(columns_of_row):
        cdot = [f"C{i}_{k} * v{k}" for k in columns]
        if f"ct{i}" in entries:
            cdot.append(f"ct{i}")
        right_side = [f"C{i}_{k} * {inverse_masses[k]} * g{k}" for k in columns if f"g{k}" in entries]
        if f"gamma{i}" in entries:
            right_side.append(f"(-gamma{i})")
        right_side += [f"two_alpha * cdot{i}", f"beta_squared * c{i}"]
        lines.append(f"cdot{i} = {' + '.join(cdot)}")
        lines.append(f"r{i} = {' + '.join(right_side)}")
    return lines


def _nonzero_factors(columns_of_row: Sequence[Sequence[int]]) -> set[tuple[int, int]]:
    """Return the places (i, j), i > j, of L that are not structurally zero.

    L_ij is there where constraints i and j share a coordinate, and where an earlier column p fills the place in:
    L_ip and L_jp both there.
    """
    factors: set[tuple[int, int]] = set()
    constraints = len(columns_of_row)
    for j in range(constraints):
        for i in range(j + 1, constraints):
            shared = set(columns_of_row[i]) & set(columns_of_row[j])
            filled_in = any((i, p) in factors and (j, p) in factors for p in range(j))
            if shared or filled_in:
                factors.add((i, j))
    return factors


def _factorization_lines(
    columns_of_row: Sequence[Sequence[int]], inverse_masses: Sequence[str], factors: set[tuple[int, int]]
) -> list[str]:
    """Return the assignments to S_j (the diagonal of S), D_j, W_ij and L_ij, column by column."""

    def entry_of_s(i: int, j: int) -> str:
        shared = [k for k in columns_of_row[i] if k in columns_of_row[j]]
        return " + ".join(f"C{i}_{k} * C{j}_{k} * {inverse_masses[k]}" for k in shared) or "0.0"

    def eliminated(i: int, j: int) -> str:
        """Return what the columns before j take off from the entry (i, j)."""
        earlier = [p for p in range(j) if (i, p) in factors and (j, p) in factors]
        return "".join(f" - L{i}_{p} * W{j}_{p}" for p in earlier)

    lines = []
    constraints = len(columns_of_row)
    for j in range(constraints):
        lines.append(f"S{j} = {entry_of_s(j, j)}")
        lines.append(f"D{j} = S{j}{eliminated(j, j)}")
        for i in range(j + 1, constraints):
            if (i, j) in factors:
                lines.append(f"W{i}_{j} = {entry_of_s(i, j)}{eliminated(i, j)}")
                lines.append(f"L{i}_{j} = W{i}_{j} / D{j}")
    return lines


def _substitution_lines(constraints: int, factors: set[tuple[int, int]]) -> list[str]:
    """Return the assignments that solve L D L^T l = r: forwards, by the diagonal, backwards."""
    lines = []
    for i in range(constraints):
        lines += [f"r{i} = r{i} - L{i}_{p} * r{p}" for p in range(i) if (i, p) in factors]
    lines += [f"l{i} = r{i} / D{i}" for i in range(constraints)]
    for i in reversed(range(constraints)):
        lines += [f"l{i} = l{i} - L{p}_{i} * l{p}" for p in range(i + 1, constraints) if (p, i) in factors]
    return lines


def _acceleration_lines(
    columns_of_row: Sequence[Sequence[int]], inverse_masses: Sequence[str], entries: Iterable[str]
) -> list[str]:
    """Return the assignments to a = M^-1 (g - C_q^T l)."""
    lines = []
    for k, inverse_mass in enumerate(inverse_masses):
        force = f"g{k}" if f"g{k}" in entries else "0.0"
        reactions = "".join(f" - C{i}_{k} * l{i}" for i, columns in enumerate(columns_of_row) if k in columns)
        lines.append(f"a{k} = ({force}{reactions}) * {inverse_mass}")
    return lines


# Functions of a state


def observation_source(acceleration: AccelerationCode) -> str:
    """Return the source of observation(t, two_alpha, beta_squared, q, v): all c, all cdot, all l, the least pivot."""
    constraints = acceleration.constraints
    results = [name for prefix in ("c", "cdot", "l") for name in variable_names(prefix, constraints)]
    return _function_source("observation", acceleration, [*results, _least_text(acceleration.pivots)])


def multipliers_source(acceleration: AccelerationCode) -> str:
    """Return the source of multipliers(t, two_alpha, beta_squared, q, v): all l."""
    return _function_source("multipliers", acceleration, variable_names("l", acceleration.constraints))


def acceleration_source(acceleration: AccelerationCode) -> str:
    """Return the source of acceleration(t, two_alpha, beta_squared, q, v): all a."""
    return _function_source("acceleration", acceleration, variable_names("a", acceleration.coordinates))


def _function_source(name: str, acceleration: AccelerationCode, results: Sequence[str]) -> str:
    """Return the source of a function that returns some of the variables that the acceleration code assigns."""
    coordinates = acceleration.coordinates
    lines = [
        f"{_tuple_text(variable_names('q', coordinates))} = q",
        f"{_tuple_text(variable_names('v', coordinates))} = v",
        *acceleration.lines,
        f"return {_tuple_text(results)}",
    ]
    return "\n".join([f"def {name}(t, two_alpha, beta_squared, q, v):", *_indented(lines, 1)])


def _tuple_text(entries: Iterable[str]) -> str:
    """Return the text of a tuple."""
    return f"({', '.join(entries)},)"


def _least_text(values: Sequence[str]) -> str:
    """Return the text of the least of some values; of one value, itself."""
    return values[0] if len(values) == 1 else f"least({', '.join(values)})"


def _indented(lines: Iterable[str], depth: int) -> list[str]:
    """Return lines of source so many blocks deep."""
    return [" " * depth + line for line in lines]


# Slopes of the acceleration
#
# The derivatives of M qddot + C_q^T lambda = g and C_q qddot = gamma - 2 alpha cdot - beta^2 c by any one of the 2n
# numbers q, v are
#
#     M qddot' + C_q^T lambda' = G,      G = g' - C_q'^T lambda
#           C_q qddot'         = F,      F = gamma' - 2 alpha (C_q v + c_t)' - beta^2 c' - C_q' qddot
#
# which is Eq. 9 once more, solved by
#
#     qddot' = M^-1 G + X^T (F - C_q M^-1 G),      S X = C_q M^-1
#
# S is factored already, and what is unrolled above solves for X: its n columns are entries of a first axis that r and l
# then have. Of the entries of C_q, gamma, c_t and g most derivatives are structural zeros again; that of C0_1 by number
# 3 is called C0_1_3, and so are G0_3 and F0_3.


def slopes_source(acceleration: AccelerationCode, equations: Equations) -> str:
    """Return the source of slopes(t, two_alpha, beta_squared, q, v): all a, then their derivatives by each of q and v.

    For arrays of one shape only. Each of the 2n derivatives has a first axis of n entries.
    """
    coordinates, directions = range(acceleration.coordinates), range(2 * acceleration.coordinates)
    columns_of_row, inverse_masses = _columns_of_row(equations), _inverse_masses(equations)
    entries = _nonzero_slopes(equations)
    sides = _right_sides_of_slopes(columns_of_row, entries, acceleration.coordinates)
    lines = [
        f"accelerations = {_tuple_text(variable_names('a', acceleration.coordinates))}",
        *_entry_lines(entries),
        *(f"{name} = {text}" for name, text in sides.items()),
    ]
    for i, columns in enumerate(columns_of_row):
        column_of_x = (f"C{i}_{k} * {inverse_masses[k]}" if k in columns else "0.0" for k in coordinates)
        lines.append(f"r{i} = row(q0, {', '.join(column_of_x)})")
    lines += _substitution_lines(acceleration.constraints, _nonzero_factors(columns_of_row))
    for d in directions:
        by_forces = [f"G{k}_{d} * {inverse_masses[k]}" if f"G{k}_{d}" in sides else "0.0" for k in coordinates]
        without_reactions = f"row(q0, {', '.join(by_forces)})"
        parts = [without_reactions] if set(by_forces) != {"0.0"} else []
        for i, columns in enumerate(columns_of_row):
            taken = [f"C{i}_{k} * {by_forces[k]}" for k in columns if f"G{k}_{d}" in sides]
            if taken or f"F{i}_{d}" in sides:
                parts.append(f"l{i} * ({_difference_text(f'F{i}_{d}', sides, taken)})")
        lines.append(f"slope{d} = {' + '.join(parts) or without_reactions}")
    results = ["accelerations", _tuple_text(variable_names("slope", len(directions)))]
    return _function_source("slopes", replace(acceleration, lines=(*acceleration.lines, *lines)), results)


def _nonzero_slopes(equations: Equations) -> dict[str, sp.Expr]:
    """Return the derivatives of the entries of C_q, gamma, c_t and g that are not identically zero, by their names."""
    number_of = {symbol: number for number, symbol in enumerate((*equations.q, *equations.v))}
    found = {
        f"{name}_{number_of[symbol]}": entry.diff(symbol)
        for name, entry in _nonzero_entries(equations).items()
        if name.startswith(("C", "gamma", "ct", "g"))
        for symbol in sorted(entry.free_symbols & number_of.keys(), key=number_of.__getitem__)
    }
    return {name: slope for name, slope in found.items() if slope != 0}


def _right_sides_of_slopes(
    columns_of_row: Sequence[Sequence[int]], slopes: Container[str], coordinates: int
) -> dict[str, str]:
    """Return the texts of the entries of G and F that are not zero, by their names."""
    texts: dict[str, str] = {}
    for d in range(2 * coordinates):
        by_multipliers: dict[int, list[str]] = {k: [] for k in range(coordinates)}
        for i, columns in enumerate(columns_of_row):
            turning = [k for k in columns if f"C{i}_{k}_{d}" in slopes]
            rates = [f"C{i}_{k}_{d} * v{k}" for k in turning]
            rates += [f"ct{i}_{d}"] if f"ct{i}_{d}" in slopes else []
            rates += [f"C{i}_{d - coordinates}"] if d - coordinates in columns else []
            taken = [f"two_alpha * ({' + '.join(rates)})"] if rates else []
            taken += [f"beta_squared * C{i}_{d}"] if d in columns else []
            taken += [f"C{i}_{k}_{d} * a{k}" for k in turning]
            if taken or f"gamma{i}_{d}" in slopes:
                texts[f"F{i}_{d}"] = _difference_text(f"gamma{i}_{d}", slopes, taken)
            for k in turning:
                by_multipliers[k].append(f"C{i}_{k}_{d} * l{i}")
        for k, taken in by_multipliers.items():
            if taken or f"g{k}_{d}" in slopes:
                texts[f"G{k}_{d}"] = _difference_text(f"g{k}_{d}", slopes, taken)
    return texts


def _difference_text(name: str, there: Container[str], taken: Iterable[str]) -> str:
    """Return the text of a variable, or zero where it is not there, less some terms."""
    return (name if name in there else "0.0") + "".join(f" - {term}" for term in taken)


# Along one direction (dq, dv) of positions and velocities they are
#
#     M dqddot + C_q^T dlambda = G,      G = dg - dC_q^T lambda
#           C_q dqddot         = F,      F = dgamma - 2 alpha d(cdot) - beta^2 C_q dq - dC_q qddot
#
# hence S dlambda = C_q M^-1 G - F, dqddot = M^-1 (G - C_q^T dlambda): what takes r to l above takes this right side to
# dlambda. Newton's method takes its Jacobians so, one unknown after the other.


def slope_lines(equations: Equations) -> list[str]:
    """Return the assignments to da, the change of a along dq and dv, after those of the acceleration code."""
    columns_of_row, inverse_masses = _columns_of_row(equations), _inverse_masses(equations)
    coordinates, constraints = range(len(equations.q)), range(len(equations.constraints))
    entries = _nonzero_differentials(equations)
    lines = _entry_lines(entries)
    for k in coordinates:
        taken = [f"dC{i}_{k} * l{i}" for i in constraints if f"dC{i}_{k}" in entries]
        lines.append(f"G{k} = {_difference_text(f'dg{k}', entries, taken)}")
    for i, columns in enumerate(columns_of_row):
        turning = [k for k in columns if f"dC{i}_{k}" in entries]
        dcdot = [*(f"C{i}_{k} * dv{k}" for k in columns), *(f"dC{i}_{k} * v{k}" for k in turning)]
        dcdot += [f"dct{i}"] if f"dct{i}" in entries else []
        dc = [f"C{i}_{k} * dq{k}" for k in columns]
        taken = [f"two_alpha * ({' + '.join(dcdot)})", f"beta_squared * ({' + '.join(dc)})"]
        taken += [f"dC{i}_{k} * a{k}" for k in turning]
        lines.append(f"F{i} = {_difference_text(f'dgamma{i}', entries, taken)}")
        by_forces = [f"C{i}_{k} * {inverse_masses[k]} * G{k}" for k in columns]
        lines.append(f"r{i} = {' + '.join(by_forces)} - F{i}")
    lines += _substitution_lines(len(constraints), _nonzero_factors(columns_of_row))
    for k in coordinates:
        reactions = "".join(f" - C{i}_{k} * l{i}" for i, columns in enumerate(columns_of_row) if k in columns)
        lines.append(f"da{k} = (G{k}{reactions}) * {inverse_masses[k]}")
    return lines


def _nonzero_differentials(equations: Equations) -> dict[str, sp.Expr]:
    """Return how the entries of C_q, gamma, c_t and g change along dq and dv, where they do, by their names."""
    changes = {symbol: sp.Symbol(f"d{symbol}") for symbol in (*equations.q, *equations.v)}
    return {
        f"d{name}": sum(entry.diff(symbol) * changes[symbol] for symbol in sorted(moving, key=str))
        for name, entry in _nonzero_entries(equations).items()
        if name.startswith(("C", "gamma", "ct", "g")) and (moving := entry.free_symbols & changes.keys())
    }


# Accelerations in parts
#
# What turning text into machine code costs grows faster than the text. So the thousands of assignments of a long
# mechanism become functions of PART lines each, which leave their results to one another in an array, the room:
#
#     room = empty(2770)
#     room[0] = q0                            what they are given
#     ...
#     part_0(room)                            def part_0(room):
#     part_1(room)                             q0 = room[0]
#     ...                                      x0 = sin(q0)
#     a0 = room[1510]                          ...
#     D0 = room[640]                           room[17] = x0
#
# Those of the slopes follow in the same room. No operation changes, and no bit of any result.

PART = 150
"""Lines of a part; with twice as many compiling takes a third longer, with eight times as many two and a half times."""

LONG = 1000
"""Lines from which on an acceleration is cut: where machine code gains nothing any more from seeing it as one."""

NAME = re.compile(r"\b[A-Za-z_]\w*")


@dataclass(frozen=True)
class MachineCode:
    """The acceleration code and the lines of `slope_lines` as machine code takes them, and the sources of their parts.

    Each part is a function part_0(room), part_1(room), ...; `room` is allocated by empty(size).
    """

    acceleration: AccelerationCode
    slopes: tuple[str, ...]
    parts: tuple[str, ...] = ()


@dataclass(frozen=True)
class _Part:
    """Lines of a part, the variables whose values it needs from before, and those that it assigns."""

    lines: tuple[str, ...]
    needed: tuple[str, ...]
    assigned: tuple[str, ...]


def machine_code(acceleration: AccelerationCode, slopes: Sequence[str]) -> MachineCode:
    """Return the code in parts, or as it is where it is not long."""
    if len(acceleration.lines) <= LONG:
        return MachineCode(acceleration, tuple(slopes))
    of_acceleration, of_slopes = _parts(acceleration.lines), _parts(slopes)
    parts = [*of_acceleration, *of_slopes]
    results = [*variable_names("a", acceleration.coordinates), *NAME.findall(" ".join(acceleration.pivots))]
    changes = variable_names("da", acceleration.coordinates)
    kept = {*results, *changes, *(name for part in parts for name in part.needed)}
    places = {name: place for place, name in enumerate(sorted(kept))}

    def stored(name: str) -> str:
        return f"room[{places[name]}] = {name}"

    def loaded(name: str) -> str:
        return f"{name} = room[{places[name]}]"

    def given(some: Sequence[_Part], before: Collection[str]) -> list[str]:
        """Return what stores the variables that some parts need and none has assigned by then."""
        known, names = set(before), []
        for part in some:
            names += [name for name in part.needed if name not in known]
            known |= {*part.needed, *part.assigned}
        return [stored(name) for name in names]

    def calls(first: int, some: Sequence[_Part]) -> list[str]:
        return [f"part_{first + number}(room)" for number in range(len(some))]

    known_by_then = {name for part in of_acceleration for name in (*part.needed, *part.assigned)}
    lines = [f"room = empty({len(places)})", *given(of_acceleration, ()), *calls(0, of_acceleration)]
    lines += [loaded(name) for name in results]
    slope_calls = [*given(of_slopes, known_by_then), *calls(len(of_acceleration), of_slopes)]
    slope_calls += [loaded(name) for name in changes]
    functions = []
    for number, part in enumerate(parts):
        inside = [loaded(name) for name in part.needed]
        inside += [*part.lines, *(stored(name) for name in part.assigned if name in kept)]
        functions.append("\n".join([f"def part_{number}(room):", *_indented(inside, 1)]))
    return MachineCode(replace(acceleration, lines=tuple(lines)), tuple(slope_calls), tuple(functions))


def _parts(lines: Sequence[str]) -> list[_Part]:
    """Return some lines cut into parts."""
    parts = []
    for first in range(0, len(lines), PART):
        some = tuple(lines[first : first + PART])
        needed: dict[str, None] = {}  # in the order in which they are met
        assigned: dict[str, None] = {}
        for line in some:
            result, *used = NAME.findall(line)
            needed |= {name: None for name in used if name not in assigned and name not in FUNCTIONS}
            assigned[result] = None
        parts.append(_Part(some, tuple(needed), tuple(assigned)))
    return parts


FUNCTIONS = ("sin", "cos", "sqrt")
"""That the acceleration calls."""


# Steppers: their pieces
#
# A stepper takes one step a turn of its loop. It is put together as data first, because four texts are made of it:
# a generator, a single step, a block of steps, a batch of runs. Most pieces are lines that all of them share; the
# others say what they are for, since that is where the texts differ.


@dataclass(frozen=True)
class Unpacked:
    """Variables that get their first values from an argument of the generator, by a line such as (q0, v0,) = state."""

    names: tuple[str, ...]
    line: str


@dataclass(frozen=True)
class Pivot:
    """A variable that gets the least of some values. They are pivots, relative: what tells that S becomes singular."""

    result: str
    values: tuple[str, ...]

    @property
    def line(self) -> str:
        """The assignment."""
        return f"{self.result} = {_least_text(self.values)}"


@dataclass(frozen=True)
class Moved:
    """A variable of an earlier step that takes the value of the step after it: `older` = `newer`."""

    older: str
    newer: str


@dataclass(frozen=True)
class Yielded:
    """The end of a step: the texts of its new state, q then v, and of the slope before it."""

    state: tuple[str, ...]
    slope: tuple[str, ...]


SITUATION = "(start, k, h, two_alpha, beta_squared)"
"""Of a step: what the residuals of its equations depend on beside what is known and sought."""


@dataclass(frozen=True)
class Sought:
    """Variables that get what solves a group of equations, by its number; texts of what is known, and of guesses."""

    number: int
    known: tuple[str, ...]
    guesses: tuple[str, ...]
    found: tuple[str, ...]

    def lines(self, solve: str, others: str = "") -> list[str]:
        """Return the lines that call a function, which turns guesses into solutions and returns the least pivot."""
        return [
            f"known = [{', '.join(self.known)}]",
            f"sought = [{', '.join(self.guesses)}]",
            f"worst = {solve}({SITUATION}, known, sought{others})",
            *(f"{name} = sought[{place}]" for place, name in enumerate(self.found)),
        ]


Piece = str | Pivot | Moved | Yielded | Sought

COUNT_FROM = "k = 0"
COUNT = "k = k + 1"
FORGET_PIVOTS = Pivot("worst_pivot", ("1.0",))
REMEMBER_PIVOT = Pivot("worst_pivot", ("worst_pivot", "worst"))


@dataclass(frozen=True)
class Stepper:
    """The pieces of a stepper.

    `arguments` are those of the generator beyond start, h and the gains; `opening` is what it does before its first
    turn; `functions` are the sources of those that an implicit stepper has solved for their zeros.
    """

    arguments: str
    opening: tuple[str | Unpacked, ...]
    turn: tuple[Piece, ...]
    functions: tuple[str, ...] = ()

    @property
    def remembered(self) -> list[str]:
        """The variables with which a step begins, in the order in which they are unpacked."""
        return [name for piece in self.opening if isinstance(piece, Unpacked) for name in piece.names]

    @property
    def groups(self) -> dict[int, int]:
        """The numbers of the groups of equations that a turn solves, in their order, and how many unknowns each has."""
        return {piece.number: len(piece.found) for piece in self.turn if isinstance(piece, Sought)}

    @property
    def length(self) -> int:
        """About how many lines there are to compile."""
        return len(self.turn) + sum(function.count("\n") for function in self.functions)

    @property
    def preparations(self) -> list[str]:
        """The lines of the opening that neither unpack nor count."""
        return [piece for piece in self.opening if isinstance(piece, str) and piece != COUNT_FROM]


def _acceleration_lines_at(acceleration: AccelerationCode, moment: Fraction) -> list[str]:
    """Return the assignments to a, at the current q and v and so many steps after the turn has begun."""
    return [f"t = start + (k + {float(moment)!r}) * h", *acceleration.lines]


def _worst(acceleration: AccelerationCode) -> Pivot:
    """Return the least relative pivot of the last acceleration."""
    return Pivot("worst", acceleration.pivots)


def _product_text(coefficient: Fraction, variable: str) -> str:
    """Return the text of a product."""
    return f"{float(coefficient)!r} * {variable}"


# A stepper as a generator: it runs for ever, and yields after each step


def generator_source(stepper: Stepper) -> str:
    """Return the source of run(start, h, two_alpha, beta_squared, <the stepper's arguments>), a generator of steps.

    Each turn yields the new state, the slope before it and the least relative pivot of S met on the way.
    """
    opening = [piece.line if isinstance(piece, Unpacked) else piece for piece in stepper.opening]
    turn = [line for piece in stepper.turn for line in _generator_lines(piece)]
    return "\n".join([
        f"def run(start, h, two_alpha, beta_squared, {stepper.arguments}):",
        *_indented([*opening, "while True:"], 1),
        *_indented(turn, 2),
        *stepper.functions,
    ])  # fmt: skip


def _generator_lines(piece: Piece) -> list[str]:
    """Return the lines of the generator that stand for a piece."""
    match piece:
        case str():
            return [piece]
        case Pivot():
            return [piece.line]
        case Moved(older, newer):
            return [f"{older} = {newer}"]
        case Sought(number):
            return piece.lines(f"solve[{number}]")
        case Yielded(state, slope):
            return [COUNT, f"yield {_tuple_text(state)}, {_tuple_text(slope)}, worst_pivot"]


# A stepper as a single step: a function that takes one and returns what the next begins with, so that it can be changed
#
#     def single_step(start, h, two_alpha, beta_squared, remembered, solve):
#      k = 0
#      (q0, v0,) = remembered
#      ...                                                the lines of a turn
#      taken = (q0, v0,), (f0, f1,), worst_pivot
#      return taken, (q0, v0,)


def single_step_source(stepper: Stepper) -> str:
    """Return the source of single_step(start, h, two_alpha, beta_squared, remembered, solve).

    `remembered` holds what the stepper remembers, in its order. Of a step at time `start` (s) it returns what the
    generator yields, and what is remembered after it.
    """
    remembered = _tuple_text(stepper.remembered)
    lines = [COUNT_FROM, f"{remembered} = remembered", *stepper.preparations]
    for piece in stepper.turn:
        if isinstance(piece, Yielded):
            lines.append(f"taken = {_tuple_text(piece.state)}, {_tuple_text(piece.slope)}, worst_pivot")
        else:
            lines += _generator_lines(piece)
    lines.append(f"return taken, {remembered}")
    head = "def single_step(start, h, two_alpha, beta_squared, remembered, solve):"
    return "\n".join([head, *_indented(lines, 1)])


# A stepper as a block: a function that takes many steps and stores their states, in plain loops over plain arrays
#
#     def run(start, h, ..., state, past):              def block(start, h, ..., k, last, memory, states, ...):
#      k = 0
#      (q0, v0,) = state                                 q0 = memory[0]
#      ...                                               ...
#      while True:                                       while k < last:
#       ...                                               ...                             the same lines
#       worst = least(1.0, D0 / S0)                       worst = 1.0
#                                                         worst = lesser(worst, D0 / S0)
#       k = k + 1                                         k = k + 1
#       yield (q0, v0,), (...), worst_pivot               states[place + 0] = q0 ...
#
# Where steps vary each begins anew, at step 0 of a run of its own, with what it remembers in units of its own length:
#
#     def varying_block(times, lengths, ratios, ..., step, last, memory, states, ...):
#      V_0_0 = memory[0]
#      ...
#      while step < last:
#       start = times[step]
#       h = lengths[step]
#       ...
#       ratio = ratios[step]                              to the length of the step before
#       V_0_0 = ratio * V_0_0                             h v; what is h^2 a takes it twice
#       k = 0
#       ...                                               the same lines
#       step = step + 1
#       ...


def block_source(stepper: Stepper, pivot_limit: float, size_limit: float) -> str:
    """Return the source of block(start, h, two_alpha, beta_squared, k, last, memory, states, pivots, reached).

    It takes the steps k to last - 1 of a stepper and returns the number of the next. `memory` holds what the
    stepper remembers, in its order, and is brought up to date at the end; `states` gets the new states one
    after the other, `pivots` the least pivots, reached[0] after each step the number of the next. After a step whose
    pivot is not above `pivot_limit`, or whose state is not below `size_limit` in the sum of its sizes, it returns.

    That of an implicit stepper has two arguments more, `inverses`, one for each of its groups, and `counts`, which it
    hands on, both changed at once: it calls solve_<number>(situation, known, sought, inverse, counts).
    """
    before = [f"inverse_{number} = inverses[{place}]" for place, number in enumerate(stepper.groups)]
    return _looped_source(
        head="block(start, h, two_alpha, beta_squared, k",
        before=[*before, *stepper.preparations],
        counter="k",
        stepper=stepper,
        at_a_turn=[],
        limits=(pivot_limit, size_limit),
    )


def varying_block_source(stepper: Stepper, powers: Sequence[int], pivot_limit: float, size_limit: float) -> str:
    """Return the source of varying_block(times, lengths, ratios, gains, kinds, step, last, ...), the rest as `block`.

    Of each step the first have its time and length, the ratio of its length to that of the step before, and its gains,
    one after the other. `powers` are those of the length that are factors of what the stepper remembers: 0, 1 or 2. An
    implicit stepper has inverses for each kind of step, which `kinds` number.
    """
    own = ["start = times[step]", "h = lengths[step]", "two_alpha = gains[2 * step]"]
    own += ["beta_squared = gains[2 * step + 1]", "ratio = ratios[step]", "ratio_squared = ratio * ratio"]
    own += [f"inverse_{number} = inverses[{place}][kinds[step]]" for place, number in enumerate(stepper.groups)]
    factors = {1: "ratio", 2: "ratio_squared"}
    scaled = [
        f"{name} = {factors[power]} * {name}" for name, power in zip(stepper.remembered, powers, strict=True) if power
    ]
    return _looped_source(
        head="varying_block(times, lengths, ratios, gains, kinds, step",
        before=[],
        counter="step",
        stepper=stepper,
        at_a_turn=[*own, *scaled, COUNT_FROM, *stepper.preparations],
        limits=(pivot_limit, size_limit),
    )


def _looped_source(
    head: str,
    before: Sequence[str],
    counter: str,
    stepper: Stepper,
    at_a_turn: Sequence[str],
    limits: tuple[float, float],
) -> str:
    """Return the source of a function that takes many steps; some lines come before the first, some begin each turn."""
    lines = [f"{name} = memory[{place}]" for place, name in enumerate(stepper.remembered)]
    lines += [*before, "row = 0", "place = 0", f"while {counter} < last:", *_indented(at_a_turn, 1)]
    for piece in stepper.turn:
        lines += _indented(_block_lines(piece, counter, limits), 1)
    lines.append(" if not calm: break")
    lines += [f"memory[{place}] = {name}" for place, name in enumerate(stepper.remembered)]
    lines.append(f"return {counter}")
    for_solving = ", inverses, counts" if stepper.groups else ""
    return "\n".join([
        f"def {head}, last, memory, states, pivots, reached{for_solving}):",
        *_indented(lines, 1),
    ])  # fmt: skip


def _block_lines(piece: Piece, counter: str, limits: tuple[float, float]) -> list[str]:
    """Return the lines of the block that stand for a piece."""
    match piece:
        case Pivot():
            return _compared_lines(piece)
        case Yielded():
            return [f"{counter} = {counter} + 1", *_storing_lines(piece, limits), f"reached[0] = {counter}"]
        case str() | Moved():
            return _generator_lines(piece)
        case Sought(number):
            return piece.lines(f"solve_{number}", f", inverse_{number}, counts")


def _compared_lines(pivot: Pivot) -> list[str]:
    """Return what stands for `least`, two by two: hundreds of branches in one function are hard on a compiler."""
    first, *others = pivot.values
    lines = [] if first == pivot.result else [f"{pivot.result} = {first}"]
    for other in others:
        lines.append(f"{pivot.result} = lesser({pivot.result}, {other})")
    return lines


def _storing_lines(step: Yielded, limits: tuple[float, float]) -> list[str]:
    """Return what stores a step, and says whether it is calm: far from a breakdown."""
    size = len(step.state)
    pivot_limit, size_limit = limits
    return [
        *(f"states[place + {i}] = {entry}" for i, entry in enumerate(step.state)),
        "pivots[row] = worst_pivot",
        "total = 0.0",
        *(f"total = total + abs(states[place + {i}])" for i in range(size)),
        f"calm = worst_pivot > {pivot_limit!r} and total < {size_limit!r}",
        "row = row + 1",
        f"place = place + {size}",
    ]


# A stepper as a batch: a function that takes many steps of many runs, which differ in their gains and states, and keeps
# the constraint errors alone. Of 64 runs and one constraint:
#
#     def batch(start, h, gains, index, k, last, memory, errors):
#      row = 0
#      while k < last:
#       for lane in range(64):
#        two_alpha = gains[0, lane]
#        beta_squared = gains[1, lane]
#        q0 = memory[lane]                              what a step needs of before, each entry of all runs side by side
#        ...                                            the stepper's lines, but those of pivots
#        memory[lane] = q0                              the new state; what else is new goes to places of its own,
#        memory[320 + lane] = f0                        so that no run reads what another writes
#        t = (index + k) * h                            the time of the new state
#        errors[row + lane] = ...                       c there
#       for i in range(64):
#        memory[192 + i] = memory[320 + i]              what was new is now one step back
#       ...
#
# Equations are solved for all runs side by side. So the loop over the runs is cut in two there, and what a step has
# computed before is computed once more after, which costs less than to keep it:
#
#       for lane in range(64):
#        X_0_0 = memory[lane]
#        ...
#        known_0[0, lane] = X_0_0 + V_0_0 + 0.25 * A_0_0
#        sought_0[0, lane] = A_0_0                      a guess
#       solve_0(start, k, h, gains, known_0, sought_0, inverses[0])
#       for lane in range(64):
#        X_0_0 = memory[lane]
#        ...
#        A_1_0 = sought_0[0, lane]
#        ...
#
# where solve_0 seeks the zeros of residual_0, in a loop over the runs of its own:
#
#     def residual_0(start, k, h, gains, known, unknown, values):
#      for lane in range(64):
#       ...
#       K0 = known[0, lane]


@dataclass(frozen=True)
class BatchCode:
    """The source of a batch function, and how many entries its memory has for each run."""

    source: str
    entries: int


def batch_code(stepper: Stepper, observed: Sequence[str], lanes: int) -> BatchCode:
    """Return the source of batch(start, h, gains, index, k, last, memory, seen).

    It takes the steps k to last - 1 of so many runs as there are lanes and returns the number of the next. `gains`
    holds 2 alpha of all runs, then beta^2; `memory` each entry of what the stepper remembers, of all runs, then room
    for what is new; `seen` gets what is observed after each step, entry by entry, at the time (index + k) h: c and q,
    or whatever expressions in q0, q1, ... and t.

    That of an implicit stepper has one argument more, `inverses`, one for each of its groups, and calls functions
    solve_<number>(start, k, h, gains, known, sought, inverse).
    """
    remembered = stepper.remembered
    moves = [piece for piece in stepper.turn if isinstance(piece, Moved)]
    places = {name: place for place, name in enumerate(remembered)}
    for move in moves:
        places.setdefault(move.newer, len(places))
    moved_to = {move.older for move in moves}
    kept = [name for name in places if name not in moved_to]  # q and v; what a move takes back a step is new
    (step,) = (piece for piece in stepper.turn if isinstance(piece, Yielded))
    new_positions = step.state[: len(step.state) // 2]
    solving, computed = _solving_loops(stepper, places, lanes)
    body = [
        *computed,
        *(f"memory[{lanes * places[name]} + lane] = {name}" for name in kept),
        *(f"q{i} = {position}" for i, position in enumerate(new_positions) if position != f"q{i}"),
        "t = (index + k) * h",
        *(f"seen[row + {lanes * i} + lane] = {expression}" for i, expression in enumerate(observed)),
    ]
    groups = stepper.groups
    room = [f"known_{number} = empty(({2 * unknowns}, {lanes}))" for number, unknowns in groups.items()]
    room += [f"sought_{number} = empty(({unknowns}, {lanes}))" for number, unknowns in groups.items()]
    source = [
        f"def batch(start, h, gains, index, k, last, memory, seen{', inverses' if groups else ''}):",
        *_indented([*stepper.preparations, *room, "row = 0", "while k < last:"], 1),
        *_indented(solving, 2),
        *_indented(_lane_loop(body, lanes), 2),
        *_indented(_moving_lines([(places[move.older], places[move.newer]) for move in moves], lanes), 2),
        f"  row = row + {lanes * len(observed)}",
        f"  {COUNT}",
        " return k",
    ]
    return BatchCode("\n".join(source), len(places))


def _solving_loops(stepper: Stepper, places: Mapping[str, int], lanes: int) -> tuple[list[str], list[str]]:
    """Return the lines that have a step's groups solved for all runs, and then those that compute a run's step."""
    computed = [*GAINS_OF_A_LANE, *(f"{name} = memory[{lanes * places[name]} + lane]" for name in stepper.remembered)]
    loops = []
    for piece in stepper.turn:
        match piece:
            case str():
                computed.append(piece)
            case Sought(number, known, guesses, found):
                given = [f"known_{number}[{place}, lane] = {text}" for place, text in enumerate(known)]
                given += [f"sought_{number}[{place}, lane] = {guess}" for place, guess in enumerate(guesses)]
                loops += _lane_loop([*computed, *given], lanes)
                group = list(stepper.groups).index(number)
                loops.append(f"solve_{number}(start, k, h, gains, known_{number}, sought_{number}, inverses[{group}])")
                computed += [f"{name} = sought_{number}[{place}, lane]" for place, name in enumerate(found)]
            case Pivot() | Moved() | Yielded():
                pass  # no pivot is looked at, nothing is yielded, and all runs are moved on together
    return loops, computed


GAINS_OF_A_LANE = ("two_alpha = gains[0, lane]", "beta_squared = gains[1, lane]")


def _lane_loop(body: Iterable[str], lanes: int) -> list[str]:
    """Return a loop over all runs."""
    return [f"for lane in range({lanes}):", *_indented(body, 1)]


def _moving_lines(moves: Sequence[tuple[int, int]], lanes: int) -> list[str]:
    """Return loops that do these moves, each to a place from a place, in their order, neighbours together."""
    runs: list[tuple[int, int, int]] = []  # first place moved to, first place moved from, how many
    for target, source in moves:
        if runs:
            first_target, first_source, count = runs[-1]
            continued = (target, source) == (first_target + count, first_source + count)
            if continued and not first_source < first_target <= source:  # else it would take what has been moved
                runs[-1] = first_target, first_source, count + 1
                continue
        runs.append((target, source, 1))
    return [
        f"for i in range({lanes * count}): memory[{lanes * target} + i] = memory[{lanes * source} + i]"
        for target, source, count in runs
    ]


# Steppers of first-order schemes, y' = f: of multistep and Runge-Kutta methods, predictor-corrector pairs and SYM
#
# For AB2 and one coordinate the generator reads
#
#     def run(start, h, two_alpha, beta_squared, state, past):
#      k = 0
#      (q0, v0,) = state
#      (y_1_0, y_1_1,), (f_1_0, f_1_1,) = past[0]           the state and the slope one step back
#      while True:
#       worst_pivot = 1.0
#       y0 = q0                                             y: the state at the start of the step, q then v
#       y1 = v0
#       t = start + (k + 0.0) * h
#       ...                                                 the acceleration code: a0 from t, q0 and v0
#       worst = least(1.0, D0 / S0)
#       f0 = v0                                             f: the slope there, v then a
#       f1 = a0
#       worst_pivot = least(worst_pivot, worst)
#       q0 = 1.0 * y0 + h * (1.5 * f0 + -0.5 * f_1_0)       the formula of the method, coordinate by coordinate
#       v0 = 1.0 * y1 + h * (1.5 * f1 + -0.5 * f_1_1)
#       f_1_0 = f0                                          what was new is now one step back
#       f_1_1 = f1
#       k = k + 1
#       yield (q0, v0,), (f0, f1,), worst_pivot
#
# A Runge-Kutta method repeats the part from `t =` to `worst_pivot =` for each stage, with stage_1_0, stage_1_1, ... for
# f0, f1, ...; a predictor-corrector pair once, with p0, p1, ... Since q and v are assigned only after y and the slope
# have their values, and y keeps the old state, no line overwrites what a later one needs.


@dataclass(frozen=True)
class Term:
    """A coefficient of a method and the prefix of the variables, one for each entry of a state, that it multiplies."""

    coefficient: Fraction
    prefix: str


def first_order_stepper(acceleration: AccelerationCode, method: Method) -> Stepper:
    """Return the stepper whose generator is run(start, h, two_alpha, beta_squared, state, past).

    `state` is the one at time `start` (s), q then v, h (s) the whole step of the method, and `past` holds the
    earlier (state, slope) pairs that a method of several steps needs, newest first; the slope of a state has its
    derivatives. TypeError for a second-order scheme.
    """
    size = 2 * acceleration.coordinates
    state = _state_variables(acceleration)
    lines: list[Piece] = [FORGET_PIVOTS]
    lines += [f"y{i} = {name}" for i, name in enumerate(state)]
    lines += _evaluation_lines(acceleration, "f", AT_THE_START)
    match method.scheme:
        case LinearMultistep() as scheme:
            lines += _multistep_lines(state, scheme, slope_at_the_end=None)
        case PredictorCorrector(predictor, corrector):
            lines += _multistep_lines(state, predictor, slope_at_the_end=None)
            lines += _evaluation_lines(acceleration, "p", AT_THE_END)
            lines += _multistep_lines(state, corrector, slope_at_the_end="p")
        case RungeKutta() as scheme:
            lines += _runge_kutta_lines(acceleration, scheme)
        case SecondOrder():
            raise TypeError(f"{method.name}: a second-order scheme has steps of its own")
    lines += _moves(size, method)
    lines.append(Yielded(tuple(state), tuple(variable_names("f", size))))

    opening: list[str | Unpacked] = [COUNT_FROM, Unpacked(tuple(state), f"{_tuple_text(state)} = state")]
    for back in range(1, steps(method)):
        past_state, past_slope = variable_names(f"y_{back}_", size), variable_names(f"f_{back}_", size)
        line = f"{_tuple_text(past_state)}, {_tuple_text(past_slope)} = past[{back - 1}]"
        opening.append(Unpacked((*past_state, *past_slope), line))
    return Stepper("state, past", tuple(opening), tuple(lines))


def _state_variables(acceleration: AccelerationCode) -> list[str]:
    """Return the variables of a state: q, then v."""
    coordinates = acceleration.coordinates
    return [*variable_names("q", coordinates), *variable_names("v", coordinates)]


def _evaluation_lines(acceleration: AccelerationCode, slope: str, moment: Fraction) -> list[Piece]:
    """Return the assignments to the slope, so called, at the current q and v and at time t + moment h."""
    coordinates = acceleration.coordinates
    derivatives = [*variable_names("v", coordinates), *variable_names("a", coordinates)]
    return [
        *_acceleration_lines_at(acceleration, moment),
        _worst(acceleration),
        *(f"{slope}{i} = {derivative}" for i, derivative in enumerate(derivatives)),
        REMEMBER_PIVOT,
    ]


def _update_lines(state: Sequence[str], states: Sequence[Term], slopes: Sequence[Term]) -> list[str]:
    """Return the assignments that set q and v to a sum of states plus h times a sum of slopes."""
    lines = []
    for i, variable in enumerate(state):
        value = " + ".join(_product_text(term.coefficient, f"{term.prefix}{i}") for term in states if term.coefficient)
        rise = " + ".join(_product_text(term.coefficient, f"{term.prefix}{i}") for term in slopes if term.coefficient)
        lines.append(f"{variable} = {value} + h * ({rise or '0.0'})")
    return lines


def _multistep_lines(state: Sequence[str], scheme: LinearMultistep, slope_at_the_end: str | None) -> list[str]:
    """Return the step y_{k+1} = -sum_{j>0} rho_j y_{k+1-j} + h sum_j sigma_j f_{k+1-j} of a multistep scheme.

    f_{k+1}, which only a corrector uses, is the slope called `slope_at_the_end`.
    """
    states = [Term(-scheme.rho[1], "y")]
    slopes = [] if slope_at_the_end is None else [Term(scheme.sigma[0], slope_at_the_end)]
    slopes.append(Term(scheme.sigma[1], "f"))
    for back in range(1, scheme.steps):
        states.append(Term(-scheme.rho[back + 1], f"y_{back}_"))
        slopes.append(Term(scheme.sigma[back + 1], f"f_{back}_"))
    return _update_lines(state, states, slopes)


def _runge_kutta_lines(acceleration: AccelerationCode, scheme: RungeKutta) -> list[Piece]:
    """Return the later stages, each evaluated at y + h sum A_ij (slope of stage j), and the step with the weights."""
    state = _state_variables(acceleration)
    old_state = [Term(Fraction(1), "y")]
    stages = ["f", *(f"stage_{number}_" for number in range(1, len(scheme.weights)))]
    lines: list[Piece] = []
    for number, stage in enumerate(stages):
        if number == 0:
            continue  # it is f, the slope at the start of the step
        row = scheme.tableau[number]
        slopes = [Term(coefficient, name) for coefficient, name in zip(row, stages, strict=True)]
        lines += _update_lines(state, old_state, slopes)
        lines += _evaluation_lines(acceleration, stage, sum(row, Fraction(0)))
    weighted = [Term(weight, name) for weight, name in zip(scheme.weights, stages, strict=True)]
    return [*lines, *_update_lines(state, old_state, weighted)]


def _moves(size: int, method: Method) -> list[Moved]:
    """Return what moves the past on by one step, oldest first, as far as the method uses it.

    Adams and Bezier methods use past slopes but no past states.
    """
    match method.scheme:
        case LinearMultistep() as scheme:
            schemes = [scheme]
        case PredictorCorrector(predictor, corrector):
            schemes = [predictor, corrector]
        case RungeKutta() | SecondOrder():
            schemes = []
    kinds = []
    if any(coefficient for scheme in schemes for coefficient in scheme.rho[2:]):
        kinds.append("y")
    if any(coefficient for scheme in schemes for coefficient in scheme.sigma[2:]):
        kinds.append("f")
    moves = []
    for back in reversed(range(1, steps(method))):
        newer = "" if back == 1 else f"_{back - 1}_"
        moves += [Moved(f"{kind}_{back}_{i}", f"{kind}{newer}{i}") for kind in kinds for i in range(size)]
    return moves


# Steppers of second-order schemes, and of every implicit one, which runs as such: the actions of a turn as text
#
# Inside, h = 1: X, V and A stand for q, h v and h^2 a, H1, H2, ... for the scheme's helpers, with the step and the
# coordinate: V_1_0 is the velocity of coordinate 0 at the end of the turn, A_m1_3 an acceleration one step before its
# start. For velocity Verlet with the feedback at the half-step velocity and one coordinate the source reads
#
#     def run(start, h, two_alpha, beta_squared, carried, solve):
#      ((X_0_0,), (V_0_0,), (A_0_0,),) = carried
#      k = 0
#      h_squared = h * h
#      while True:
#       worst_pivot = 1.0
#       X_1_0 = X_0_0 + V_0_0 + 0.5 * A_0_0                 the actions, in order
#       H1_1_0 = V_0_0 + 0.5 * A_0_0
#       q0 = X_1_0
#       v0 = (H1_1_0) / h
#       t = start + (k + 1.0) * h
#       ...                                                 the acceleration code: a0 from t, q0 and v0
#       worst = least(1.0, D0 / S0)
#       A_1_0 = h_squared * a0
#       worst_pivot = least(worst_pivot, worst)
#       V_1_0 = H1_1_0 + 0.5 * A_1_0
#       k = k + 1
#       yield (X_1_0, V_1_0 / h,), (V_0_0 / h, A_0_0 / h_squared,), worst_pivot
#       X_0_0 = X_1_0                                       what the next turn needs, one step back
#       V_0_0 = V_1_0
#       A_0_0 = A_1_0
#
# A group that is solved collects what is known of its positions and velocities, two for each evaluation, and calls
#
#       known = [X_0_0 + V_0_0 + 0.25 * A_0_0, V_0_0 + 0.5 * A_0_0]
#       sought = [A_0_0]
#       worst = solve[0]((start, k, h, two_alpha, beta_squared), known, sought)
#       A_1_0 = sought[0]
#
# where solve[0] seeks the zero of residual_0 from the last acceleration on, U for the unknown,
#
#     def residual_0(situation, known, unknown, values):
#      (start, k, h, two_alpha, beta_squared) = situation
#      K0 = known[0]
#      K1 = known[1]
#      U0 = unknown[0]
#      h_squared = h * h
#      q0 = K0 + 0.25 * U0
#      v0 = (K1 + 0.5 * U0) / h
#      ...                                                  the acceleration code
#      values[0] = U0 - h_squared * a0
#
# by Newton's method, which takes its Jacobian from residual_slope_0: how this changes along a direction of the unknowns
#
#     def residual_slope_0(situation, known, unknown, direction, values):
#      ...
#      dU0 = direction[0]
#      ...                                                  q0, v0 and the acceleration code as before
#      dq0 = 0.25 * dU0
#      dv0 = (0.5 * dU0) / h
#      ...                                                  da0 from these
#      values[0] = dU0 - h_squared * da0


def second_order_stepper(acceleration: AccelerationCode, scheme: SecondOrder) -> Stepper:
    """Return the stepper whose generator is run(start, h, two_alpha, beta_squared, carried, solve), with residuals.

    Each turn yields q and v at its end, then v and a at its start (where the scheme has no a there: zeros), and the
    least relative pivot of S met on the way. `start` (s) is the time of step 0 of the first turn, h (s) the whole step,
    and `carried` has what `memory` says, n entries each, in units in which h = 1. An implicit scheme calls
    solve[number of the group](situation, known, sought), which turns guesses into what makes all of residual_<number>
    zero, and returns the least pivot there; these functions follow.
    """
    names = _Names(scheme, acceleration.coordinates)
    carried = memory(scheme).carried
    lines: list[Piece] = [FORGET_PIVOTS]
    for action in turn(scheme):
        match action:
            case Assigned(result, value):
                lines += names.assignments(result, value)
            case Evaluated():
                lines += _evaluated_lines(names, acceleration, action)
            case Solved():
                lines += _solving_lines(names, action)
    reported = [*names.of(Quantity(POSITION, 1)), *_over(names.of(Quantity(VELOCITY, 1)), "h")]
    lines.append(Yielded(tuple(reported), tuple(_slope(names, carried))))
    for quantity in carried:  # each name's oldest first: none is overwritten before it has been moved on
        newer = names.of(Quantity(quantity.name, quantity.step + 1))
        lines += [Moved(old, new) for old, new in zip(names.of(quantity), newer, strict=True)]
    remembered = tuple(name for quantity in carried for name in names.of(quantity))
    unpacking = f"{_tuple_text(_tuple_text(names.of(quantity)) for quantity in carried)} = carried"
    return Stepper(
        arguments="carried, solve",
        opening=(Unpacked(remembered, unpacking), COUNT_FROM, "h_squared = h * h"),
        turn=tuple(lines),
        functions=(residuals_source(acceleration, scheme),),
    )


def residuals_source(acceleration: AccelerationCode, scheme: SecondOrder, compared: bool = False) -> str:
    """Return the source of residual_<number>(situation, known, unknown, values) for implicit groups.

    Each writes A - h^2 acceleration for all that the group evaluates into `values`, and returns the least relative
    pivot of S. `compared` says whether pivots are compared one by one, as in a block, instead of by `least`.
    """
    pivot_lines = _compared_lines if compared else _generator_lines
    return "\n".join(_residual_function(acceleration, solved, pivot_lines) for solved in solved_groups(scheme))


def residuals_side_by_side_source(acceleration: AccelerationCode, scheme: SecondOrder, lanes: int) -> str:
    """Return the source of residual_<number>(start, k, h, gains, known, unknown, values), the same of many runs.

    Arrays have a row for each entry and a column for each run. Nothing is returned.
    """
    functions = []
    for solved in solved_groups(scheme):
        body = [*GAINS_OF_A_LANE, *_lines_of_arguments(solved, acceleration.coordinates, of_run=", lane")]
        for own in range(len(solved.evaluations)):
            body += _lines_of_evaluation(acceleration, solved, own)
            residuals = _residual_texts(acceleration.coordinates, own)
            body += [f"values[{place}, lane] = {residual}" for place, residual in residuals.items()]
        functions += [
            f"def residual_{solved.number}(start, k, h, gains, known, unknown, values):",
            *_indented(["h_squared = h * h", *_lane_loop(body, lanes)], 1),
        ]
    return "\n".join(functions)


def residual_slopes_source(acceleration: AccelerationCode, slopes: Sequence[str], scheme: SecondOrder) -> str:
    """Return the source of residual_slope_<number>(situation, known, unknown, direction, values) for implicit groups.

    Each writes the derivatives of the residual of that number, along a direction of its unknowns, into `values`; those
    of the acceleration are `slope_lines`.
    """
    return "\n".join(_residual_slope_function(acceleration, slopes, solved) for solved in solved_groups(scheme))


class _Names:
    """The variables of a scheme's quantities: those of helpers are numbered, for a user's names stay outside."""

    def __init__(self, scheme: SecondOrder, coordinates: int) -> None:
        self.coordinates = coordinates
        self.prefixes = {POSITION: "X", VELOCITY: "V", ACCELERATION: "A"}
        for equation in scheme.equations:
            self.prefixes.setdefault(equation.result.name, f"H{len(self.prefixes) - 2}")

    def of(self, quantity: Quantity) -> list[str]:
        """Return the variables of a quantity, one for each coordinate."""
        step = str(quantity.step).replace("-", "m")
        return variable_names(f"{self.prefixes[quantity.name]}_{step}_", self.coordinates)

    def sums(self, terms: Sum) -> list[str]:
        """Return the texts of a sum, one for each coordinate."""
        return [
            " + ".join(_term_text(c, self.of(quantity)[i]) for quantity, c in terms.items() if c) or "0.0"
            for i in range(self.coordinates)
        ]

    def assignments(self, result: Quantity, terms: Sum) -> list[str]:
        """Return the lines that give a quantity the value of a sum."""
        return [f"{name} = {value}" for name, value in zip(self.of(result), self.sums(terms), strict=True)]


def _term_text(coefficient: Fraction, variable: str) -> str:
    """Return a product, a factor of one left out."""
    return variable if coefficient == 1 else _product_text(coefficient, variable)


def _over(variables: Iterable[str], divisor: str) -> list[str]:
    """Return the texts of quotients."""
    return [f"{variable} / {divisor}" for variable in variables]


def _slope(names: _Names, carried: Sequence[Quantity]) -> list[str]:
    """Return v and a at the start of the turn, where the scheme carries them."""
    slope = []
    for name, divisor in ((VELOCITY, "h"), (ACCELERATION, "h_squared")):
        quantity = Quantity(name, 0)
        slope += _over(names.of(quantity), divisor) if quantity in carried else ["0.0"] * names.coordinates
    return slope


def _evaluated_lines(names: _Names, acceleration: AccelerationCode, evaluated: Evaluated) -> list[Piece]:
    """Return the lines of an evaluation at a position, velocity and time that are known."""
    return [
        *_state_lines(names.sums(evaluated.position), names.sums(evaluated.velocity)),
        *_acceleration_lines_at(acceleration, evaluated.moment),
        _worst(acceleration),
        *(f"{name} = h_squared * a{i}" for i, name in enumerate(names.of(evaluated.result))),
        REMEMBER_PIVOT,
    ]


def _state_lines(positions: Sequence[str], velocities: Sequence[str]) -> list[str]:
    """Return the assignments to q and v of positions and velocities given as texts, in units in which h = 1."""
    return [
        *(f"q{i} = {position}" for i, position in enumerate(positions)),
        *(f"v{i} = ({velocity}) / h" for i, velocity in enumerate(velocities)),
    ]


def _solving_lines(names: _Names, solved: Solved) -> list[Piece]:
    """Return the lines that have a group solved for its accelerations, from those one step back on."""
    parts: list[str] = []
    for evaluation in solved.evaluations:
        parts += [*names.sums(evaluation.known_position), *names.sums(evaluation.known_velocity)]
    unknowns = [evaluation.result for evaluation in solved.evaluations]
    guesses = [Quantity(unknown.name, unknown.step - 1) for unknown in unknowns]
    sought = Sought(
        number=solved.number,
        known=tuple(parts),
        guesses=tuple(name for guess in guesses for name in names.of(guess)),
        found=tuple(name for unknown in unknowns for name in names.of(unknown)),
    )
    return [sought, REMEMBER_PIVOT]


def _residual_function(
    acceleration: AccelerationCode, solved: Solved, pivot_lines: Callable[[Pivot], list[str]]
) -> str:
    """Return the source of the residual of one group, its pivots by these lines."""
    lines = [*OF_SITUATION, *_lines_of_arguments(solved, acceleration.coordinates), *pivot_lines(FORGET_PIVOTS)]
    for own in range(len(solved.evaluations)):
        lines += _lines_of_evaluation(acceleration, solved, own)
        lines += [*pivot_lines(_worst(acceleration)), *pivot_lines(REMEMBER_PIVOT)]
        residuals = _residual_texts(acceleration.coordinates, own)
        lines += [f"values[{place}] = {residual}" for place, residual in residuals.items()]
    lines.append("return worst_pivot")
    head = f"def residual_{solved.number}(situation, known, unknown, values):"
    return "\n".join([head, *_indented(lines, 1)])


def _residual_slope_function(acceleration: AccelerationCode, slopes: Sequence[str], solved: Solved) -> str:
    """Return the source of the derivative of the residual of one group."""
    coordinates = acceleration.coordinates
    count = coordinates * len(solved.evaluations)
    lines = [*OF_SITUATION, *_lines_of_arguments(solved, coordinates)]
    lines += [f"dU{i} = direction[{i}]" for i in range(count)]
    for own, evaluation in enumerate(solved.evaluations):
        by_position = _sought_texts(solved, evaluation.sought_position, coordinates, unknown="dU")
        by_velocity = _sought_texts(solved, evaluation.sought_velocity, coordinates, unknown="dU")
        lines += _lines_of_evaluation(acceleration, solved, own)
        lines += [f"dq{i} = {' + '.join(by_position[i]) or '0.0'}" for i in range(coordinates)]
        lines += [f"dv{i} = ({' + '.join(by_velocity[i]) or '0.0'}) / h" for i in range(coordinates)]
        lines += slopes
        places = {own * coordinates + i: i for i in range(coordinates)}
        lines += [f"values[{place}] = dU{place} - h_squared * da{i}" for place, i in places.items()]
    head = f"def residual_slope_{solved.number}(situation, known, unknown, direction, values):"
    return "\n".join([head, *_indented(lines, 1)])


OF_SITUATION = (f"{SITUATION} = situation", "h_squared = h * h")


def _lines_of_arguments(solved: Solved, coordinates: int, of_run: str = "") -> list[str]:
    """Return the lines that take what a residual is given: of what is known, K, twice as much as unknowns, U."""
    count = coordinates * len(solved.evaluations)
    known = [f"K{i} = known[{i}{of_run}]" for i in range(2 * count)]
    return [*known, *(f"U{i} = unknown[{i}{of_run}]" for i in range(count))]


def _lines_of_evaluation(acceleration: AccelerationCode, solved: Solved, own: int) -> list[str]:
    """Return the lines of one of a group's evaluations, by its place in the group."""
    coordinates, evaluation = acceleration.coordinates, solved.evaluations[own]
    first = 2 * own * coordinates
    return [
        *_state_lines(
            positions=_known_and_sought(solved, evaluation.sought_position, first, coordinates),
            velocities=_known_and_sought(solved, evaluation.sought_velocity, first + coordinates, coordinates),
        ),
        *_acceleration_lines_at(acceleration, evaluation.moment),
    ]


def _residual_texts(coordinates: int, own: int) -> dict[int, str]:
    """Return the texts of the residuals of one of a group's evaluations, by their places among those of the group."""
    return {own * coordinates + i: f"U{own * coordinates + i} - h_squared * a{i}" for i in range(coordinates)}


def _known_and_sought(solved: Solved, sought: Sum, first_known: int, coordinates: int) -> list[str]:
    """Return texts, one for each coordinate, of a known part K and multiples of the unknowns U."""
    sums = _sought_texts(solved, sought, coordinates, unknown="U")
    return [" + ".join([f"K{first_known + i}", *terms]) for i, terms in enumerate(sums)]


def _sought_texts(solved: Solved, sought: Sum, coordinates: int, unknown: str) -> list[list[str]]:
    """Return the texts, for each coordinate, of the terms of a sum of unknowns, which are called so."""
    places = {evaluation.result: place for place, evaluation in enumerate(solved.evaluations)}
    return [
        [_term_text(c, f"{unknown}{places[quantity] * coordinates + i}") for quantity, c in sought.items() if c]
        for i in range(coordinates)
    ]
