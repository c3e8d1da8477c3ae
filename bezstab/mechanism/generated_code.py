"""Generated source: accelerations, multipliers and observations as Python text, and its compilation.

Only this file writes source, and only here it is executed; others hand it equations and take functions. What a method
does with them is no text: `programs` and `stepping` have it. From its top to its end, each part under a comment:

    compiled_source                        text becomes functions
    accelerations and multipliers          the assignments that solve paper Eq. 9
    corrections                            what brings a state back to its constraints, by the same factors
    functions of a state                   all of these by name, each as a function of one state or of many
    machine code                           the same for a lane, and as single operations where they are long

All of it is plain arithmetic on numbered variables, one assignment a line, with `sin`, `cos`, `sqrt` and `least` as the
only functions. What they are is decided when the text is compiled, so one source
serves four kinds of numbers:

- floats with `math`: a single run, without the overhead of arrays of four or five entries;
- numpy arrays: a batch of runs, each variable one array over the batch, each line one operation on all of it;
- complex numbers, or arrays of them: a state that is moved by a tiny imaginary step gives the slope in that direction;
- mpmath numbers: references of as many digits as asked for.

The names: q0, q1, ... coordinates, v0, ... their rates, a0, ... their accelerations, l0, ... multipliers; C1_2, the
entry of C_q in row 1 and column 2; two_alpha and beta_squared, the gains. The text holds nothing of a scene but numbers
and these names; least of all the names that a user gave to bodies.
"""

import ast
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import NDArray
from sympy.printing.precedence import PRECEDENCE
from sympy.printing.pycode import PythonCodePrinter

from bezstab.mechanism.equations import Equations, variable_names

TAKE = """
def take(rows, steps, room, states, told):
 take_steps(rows, steps, room, states, told)
"""
"""A function of the scene's own name in front of the loop that takes steps: what numba keeps on disk goes by it."""


def compiled_source(
    source: str, library: Any, others: Mapping[str, Any] | None = None, file: str = "<generated>"
) -> dict[str, Any]:
    """Return what generated source defines, its elementary functions those of `library`: math, numpy or mpmath.

    `others` are functions that it calls, by their names; `file` is where it is said to come from.
    """
    least = min if library is math else _least_of_arrays
    namespace = {"sin": library.sin, "cos": library.cos, "sqrt": library.sqrt, "least": least}
    namespace |= {"__name__": __name__} | dict(others or {})
    exec(compile(source, file, "exec"), namespace)
    return namespace


def _least_of_arrays(*values: Any) -> Any:
    """Return the least value entry by entry, of arrays and numbers of any broadcastable shapes."""
    return np.minimum.reduce(np.broadcast_arrays(*values))


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
class StateCode:
    """Assignments that compute the variables `results` from t, two_alpha, beta_squared, q_i and v_i."""

    coordinates: int
    constraints: int
    lines: tuple[str, ...]
    results: tuple[str, ...]

    @property
    def pivots(self) -> list[str]:
        """The texts of the pivots D_j relative to S_jj; where the least of these is small, S is nearly singular."""
        return [f"D{j} / S{j}" for j in range(self.constraints)]

    @property
    def least_pivot(self) -> str:
        """The text of the least relative pivot, or 1 without any."""
        return f"least(1.0, {', '.join(self.pivots)})" if self.constraints else "1.0"


@cache
def acceleration_code(equations: Equations) -> StateCode:
    """Return what solves paper Eq. 9 for a_i = qddot_i, by an unrolled L D L^T without its structural zeros.

    On the way l_j = lambda_j, c_j and cdot_j get their values.
    """
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
    results = tuple(variable_names("a", coordinates))
    return StateCode(coordinates, constraints, tuple(lines), results)


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
        right_side = [f"C{i}_{k} * {inverse_masses[k]} * g{k}" for k in columns if f"g{k}" in entries]
        if f"gamma{i}" in entries:
            right_side.append(f"(-gamma{i})")
        right_side += [f"two_alpha * cdot{i}", f"beta_squared * c{i}"]
        lines.append(_rate_line(i, columns, entries))
        lines.append(f"r{i} = {' + '.join(right_side)}")
    return lines


def _rate_line(i: int, columns: Sequence[int], entries: Iterable[str]) -> str:
    """Return the assignment to cdot_i = (C_q v + c_t)_i."""
    parts = [f"C{i}_{k} * v{k}" for k in columns]
    if f"ct{i}" in entries:
        parts.append(f"ct{i}")
    return f"cdot{i} = {' + '.join(parts)}"


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


def observation_code(equations: Equations) -> StateCode:
    """Return the same for all c, all cdot, then all l: multipliers in N along a constraint whose c is in m."""
    code = acceleration_code(equations)
    names = [name for prefix in ("c", "cdot", "l") for name in variable_names(prefix, code.constraints)]
    return replace(code, results=tuple(names))


# Corrections
#
# What brings a state back to its constraints, in the metric of the masses (`stabilising`), takes the same S:
#
#     dq = -M^-1 C_q^T S^-1 c,      dv = -M^-1 C_q^T S^-1 cdot


@cache
def correction_code(equations: Equations) -> StateCode:
    """Return the assignments that compute dq_i and dv_i from t, q_i and v_i; S is factored as for accelerations."""
    coordinates, constraints = len(equations.q), len(equations.constraints)
    entries = {name: entry for name, entry in _nonzero_entries(equations).items() if name.startswith(("C", "c"))}
    columns_of_row, inverse_masses = _columns_of_row(equations), _inverse_masses(equations)
    factors = _nonzero_factors(columns_of_row)
    lines = [
        *_entry_lines(entries),
        *(_rate_line(i, columns, entries) for i, columns in enumerate(columns_of_row)),
        *_factorization_lines(columns_of_row, inverse_masses, factors),
    ]
    for error, correction in (("c", "dq"), ("cdot", "dv")):
        lines += [f"r{i} = {error}{i}" for i in range(constraints)]
        lines += _substitution_lines(constraints, factors)
        lines += _acceleration_lines(columns_of_row, inverse_masses, ())  # without forces, what l alone accelerates
        lines += [f"{correction}{k} = a{k}" for k in range(coordinates)]
    results = (*variable_names("dq", coordinates), *variable_names("dv", coordinates))
    return StateCode(coordinates, constraints, tuple(lines), results)


# Functions of a state

CODES: Mapping[str, Callable[[Equations], StateCode]] = {
    "accelerations": acceleration_code,
    "observations": observation_code,
    "corrections": correction_code,
}
"""All that is generated of a scene, by name. Whoever asks for a name gets it in Python or as machine code."""


def state_source(code: StateCode, results: Iterable[str]) -> str:
    """Return the source of found(t, two_alpha, beta_squared, q, v): some of the variables that a code assigns."""
    lines = [f"{_tuple_text(variable_names(name, code.coordinates))} = {name}" for name in ("q", "v")]
    lines += [*code.lines, f"return {_tuple_text(results)}"]
    return "\n".join(["def found(t, two_alpha, beta_squared, q, v):", *(f" {line}" for line in lines)])


def _tuple_text(entries: Iterable[str]) -> str:
    """Return the text of a tuple."""
    return f"({', '.join(entries)},)"


# Machine code
#
# Machine code takes runs side by side, each in a lane: arrays have room for `stride` lanes of each coordinate. Each
# function is NAME_of(t, gains, state, found, variables, lane): it writes the results of the code of that name for a
# lane, and returns the least relative pivot of S. gains (2, lanes); state (2, n stride), q and v; found (n stride,), or
# as much for each of the results.
#
# What turning text into machine code costs grows faster than the text. So thousands of lines, as of a long mechanism,
# become a table of single operations on an array of all variables and numbers, which one short loop takes:
#
#     W6_5 = C6_46 * 12.0 - W5_4        variables[t] = variables[a] * variables[b]      (TIMES, t, a, b)
#                                       variables[w] = variables[t] - variables[c]      (MINUS, w, t, c)

LONG = 1000
"""Lines above which a code becomes a table of operations; a shorter one runs faster as it is."""

PLUS, MINUS, TIMES, OVER, SINE, COSINE, ROOT = range(7)
KINDS = {ast.Add: PLUS, ast.Sub: MINUS, ast.Mult: TIMES, ast.Div: OVER, "sin": SINE, "cos": COSINE, "sqrt": ROOT}
"""The kinds of operations, by what the text has for them."""


def function_of_a_lane(
    name: str, code: StateCode, stride: int, places: dict[str | float, int], made: Callable[[Any], Any]
) -> Callable[..., float]:
    """Return the function of that name for a lane of so many, to be made machine code as `made` does.

    `places` gets those of its variables and numbers, where it is long.
    """
    if len(code.lines) > LONG:
        return by_operations(operations(code, places), code.coordinates, stride, made(take_operations))
    lines = ["two_alpha, beta_squared = gains[0, lane], gains[1, lane]"]
    for half, given in enumerate(("q", "v")):
        lines += [f"{given}{i} = state[{half}, {i * stride} + lane]" for i in range(code.coordinates)]
    lines += code.lines
    lines += [f"found[{place * stride} + lane] = {result}" for place, result in enumerate(code.results)]
    lines += ["pivot = 1.0", *(f"pivot = min(pivot, ({each}).real)" for each in code.pivots), "return pivot"]
    source = "\n".join([f"def {name}_of(t, gains, state, found, variables, lane):", *(f" {line}" for line in lines)])
    function: Callable[..., float] = compiled_source(source, np)[f"{name}_of"]
    return function


@dataclass(frozen=True)
class Operations:
    """A code as single operations: rows of kind, place of the result, places of one or two operands (twice the one).

    `results` are the places of the code's own, `pivots` those of each D_j and S_j.
    """

    rows: NDArray[np.uint32]
    results: NDArray[np.uint32]
    pivots: NDArray[np.uint32]


def operations(code: StateCode, places: dict[str | float, int]) -> Operations:
    """Return a code as single operations, and enter the places of its variables and numbers.

    t, two_alpha, beta_squared, q_i and v_i are the first, in this order.
    """
    for name in ("t", "two_alpha", "beta_squared", *(f"{name}{i}" for name in "qv" for i in range(code.coordinates))):
        places.setdefault(name, len(places))
    rows: list[tuple[int, ...]] = []

    def place_of(key: str | float) -> int:
        return places.setdefault(key, len(places))

    def computed(node: ast.expr, name: str) -> int:
        """Return the place of what an expression comes to; if it is more than a variable or a number, that name's."""
        match node:
            case ast.Name(id=variable):
                return place_of(variable)
            case ast.Constant(value=int() | float() as number):
                return place_of(float(number))
            case ast.UnaryOp(operand=operand):
                kind, operands = MINUS, [place_of(0.0), computed(operand, f"{name}-")]
            case ast.BinOp(left=left, op=operator, right=right):
                kind, operands = KINDS[type(operator)], [computed(left, f"{name}<"), computed(right, f"{name}>")]
            case ast.Call(func=ast.Name(id=function), args=[argument]):
                kind, operands = KINDS[function], 2 * [computed(argument, f"{name}()")]
            case _:
                raise TypeError(ast.dump(node))
        rows.append((kind, place_of(name), *operands))
        return place_of(name)

    for line in code.lines:
        target, expression = line.split(" = ")
        found = computed(ast.parse(expression, mode="eval").body, target)
        if found != place_of(target):
            rows.append((PLUS, place_of(target), found, place_of(0.0)))
    pivots = [[places[f"D{j}"], places[f"S{j}"]] for j in range(code.constraints)]
    # without a sign: numba need not ask whether they count from the end
    return Operations(*(np.array(each, np.uint32) for each in (rows, [places[each] for each in code.results], pivots)))


def by_operations(code: Operations, n: int, stride: int, take: Callable[..., None]) -> Callable[..., float]:
    """Return the function of a lane that takes single operations, by `take_operations` or what is made of it."""
    rows, results, pivots = code.rows, code.results, code.pivots

    def of_a_lane(t: float, gains: Any, state: Any, found: Any, variables: Any, lane: int) -> float:
        variables[0], variables[1], variables[2] = t, gains[0, lane], gains[1, lane]
        for i in range(n):
            variables[3 + i] = state[0, i * stride + lane]
            variables[3 + n + i] = state[1, i * stride + lane]
        take(rows, variables)
        for i in range(len(results)):
            found[i * stride + lane] = variables[results[i]]
        pivot = 1.0
        for j in range(len(pivots)):
            pivot = min(pivot, (variables[pivots[j, 0]] / variables[pivots[j, 1]]).real)
        return pivot

    return of_a_lane


def take_operations(rows: Any, variables: Any) -> None:
    """Take single operations on variables, one after the other."""
    for k in range(len(rows)):
        kind, result = rows[k, 0], rows[k, 1]
        left, right = variables[rows[k, 2]], variables[rows[k, 3]]
        if kind == TIMES:
            variables[result] = left * right
        elif kind == MINUS:
            variables[result] = left - right
        elif kind == PLUS:
            variables[result] = left + right
        elif kind == OVER:
            variables[result] = left / right
        elif kind == SINE:
            variables[result] = np.sin(left)
        elif kind == COSINE:
            variables[result] = np.cos(left)
        elif kind == ROOT:
            variables[result] = np.sqrt(left)
