"""Generated source: accelerations, multipliers and observations as Python text, and its compilation.

Only this file writes source, and only here it is executed; others hand it equations and take functions. What a method
does with them is no text: `programs` and `stepping` have it. From its top to its end, each part under a comment:

    compiled_source                        text becomes functions
    accelerations and multipliers          the assignments that solve paper Eq. 9
    corrections                            what brings a state back to its constraints, by the same factors
    slopes of the acceleration             its derivatives along a direction of positions and velocities
    functions of a state                   all of these by name, each as a function of one state or of many
    machine code                           the same for lanes side by side, and by shapes where they are long

All of it is plain arithmetic on numbered variables, one assignment a line, with `sin`, `cos`, `sqrt` and `least` as the
only functions. What they are is decided when the text is compiled, so one source
serves three kinds of numbers:

- floats with `math`: a single run, without the overhead of arrays of four or five entries;
- numpy arrays: a batch of runs, each variable one array over the batch, each line one operation on all of it;
- mpmath numbers: references of as many digits as asked for.

The names: q0, q1, ... coordinates, v0, ... their rates, a0, ... their accelerations, l0, ... multipliers; C1_2, the
entry of C_q in row 1 and column 2; two_alpha and beta_squared, the gains. The text holds nothing of a scene but numbers
and these names; least of all the names that a user gave to bodies.
"""

import math
import re
from collections.abc import Callable, Container, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from itertools import groupby
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import NDArray
from sympy.printing.precedence import PRECEDENCE
from sympy.printing.pycode import PythonCodePrinter

from bezstab.mechanism.equations import Equations, variable_names

TAKE = """
def take(rows, steps, room, judged, states, pivots):
 return take_steps(rows, steps, room, judged, states, pivots)
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
    """Assignments that compute the variables `results` from t, two_alpha, beta_squared and what is `given` of a state.

    That is q_i and v_i, and for slopes dq_i and dv_i, the direction in which the state changes.
    """

    coordinates: int
    constraints: int
    lines: tuple[str, ...]
    results: tuple[str, ...]
    given: tuple[str, ...] = ("q", "v")

    @property
    def pivots(self) -> list[str]:
        """The texts of the pivots D_j relative to S_jj; where the least of these is small, S is nearly singular."""
        return [f"D{j} / S{j}" for j in range(self.constraints)]

    @property
    def least_pivot(self) -> str:
        """The text of the least relative pivot, or 1 without any."""
        return f"least(1.0, {', '.join(self.pivots)})" if self.constraints else "1.0"

    @property
    def of_some_lanes(self) -> bool:
        """Whether it is told, of many runs, for which to compute it: slopes, which cost most, are seldom needed."""
        return len(self.given) > 2


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


# Slopes of the acceleration
#
# Along a direction (dq, dv) of positions and velocities the differentials of Eq. 9 are
#
#     M dqddot + C_q^T dlambda = G,      G = dg - dC_q^T lambda
#           C_q dqddot         = F,      F = dgamma - 2 alpha d(cdot) - beta^2 C_q dq - dC_q qddot
#
# hence S dlambda = C_q M^-1 G - F, dqddot = M^-1 (G - C_q^T dlambda): what takes r to l above takes this right side to
# dlambda. A Jacobian is taken so, along one unknown after the other, or along all at once where directions are arrays.


@cache
def slope_code(equations: Equations) -> StateCode:
    """Return the assignments to da, the change of a along dq and dv, after those to a."""
    acceleration = acceleration_code(equations)
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
    return replace(
        acceleration,
        lines=(*acceleration.lines, *lines),
        results=tuple(variable_names("da", len(equations.q))),
        given=("q", "v", "dq", "dv"),
    )


def _difference_text(name: str, there: Container[str], taken: Iterable[str]) -> str:
    """Return the text of a variable, or zero where it is not there, less some terms."""
    return (name if name in there else "0.0") + "".join(f" - {term}" for term in taken)


def _nonzero_differentials(equations: Equations) -> dict[str, sp.Expr]:
    """Return how the entries of C_q, gamma, c_t and g change along dq and dv, where they do, by their names."""
    changes = {symbol: sp.Symbol(f"d{symbol}") for symbol in (*equations.q, *equations.v)}
    return {
        f"d{name}": sum(entry.diff(symbol) * changes[symbol] for symbol in sorted(moving, key=str))
        for name, entry in _nonzero_entries(equations).items()
        if name.startswith(("C", "gamma", "ct", "g")) and (moving := entry.free_symbols & changes.keys())
    }


# Functions of a state

CODES: Mapping[str, Callable[[Equations], StateCode]] = {
    "accelerations": acceleration_code,
    "observations": observation_code,
    "corrections": correction_code,
    "slope": slope_code,
}
"""All that is generated of a scene, by name. Whoever asks for a name gets it in Python or as machine code."""


def state_source(code: StateCode, results: Iterable[str]) -> str:
    """Return the source of found(t, two_alpha, beta_squared, q, v, ...): some of the variables that a code assigns."""
    lines = [f"{_tuple_text(variable_names(name, code.coordinates))} = {name}" for name in code.given]
    lines += [*code.lines, f"return {_tuple_text(results)}"]
    return "\n".join([f"def found(t, two_alpha, beta_squared, {', '.join(code.given)}):", *_indented(lines, 1)])


def _tuple_text(entries: Iterable[str]) -> str:
    """Return the text of a tuple."""
    return f"({', '.join(entries)},)"


def _indented(lines: Iterable[str], depth: int) -> list[str]:
    """Return lines of source so many blocks deep."""
    return [" " * depth + line for line in lines]


# Machine code
#
# Machine code takes runs side by side, each in a lane: arrays have room for `stride` lanes of each coordinate, of which
# as many are taken as there are runs. A run alone has a stride of one, and code without loops over lanes.
#
# What turning text into machine code costs grows faster than the text. But the thousands of lines of a long mechanism
# have a few dozen shapes, as its bodies are alike. So only the shapes become machine code, each once; what a line is
# about stands in a table, as places in an array of all variables and numbers, the room:
#
#     W6_5 = C6_46 * C5_46 * 12.0 - L6_4 * W5_4        room[a] = room[b] * room[c] * room[d] - room[e] * room[f]
#     W9_7 = C9_47 * C7_47 * 3.0 - L9_5 * W7_5         the same, with other places

LONG = 1000
"""Lines of an acceleration above which it is taken by shapes; a shorter one runs faster as it is."""

OPERAND = re.compile(r"\b(?!(?:sin|cos|sqrt)\b)[A-Za-z_]\w*|\b\d+(?:\.\d*)?(?:e[-+]?\d+)?")
"""A variable or a number in a line."""


@dataclass(frozen=True)
class MachineCode:
    """The source of the functions of a mechanism that machine code calls, their names, and the tables that they name.

    Each is NAME(t, gains, state, found, room) and writes the results of the code of that name for all lanes. For a
    stride of one it returns the least relative pivot of S. gains (2, lanes); state (2 or 4, n stride): q, v, and for
    slopes dq, dv; found (n stride,) or as much for each of the results, lane after lane of each coordinate; the room
    (size,). A slope is told, last, for which lanes.
    """

    source: str
    names: tuple[str, ...]
    tables: dict[str, NDArray[Any]] = field(default_factory=dict)
    size: int = 0


def machine_code(codes: Mapping[str, StateCode], stride: int) -> MachineCode:
    """Return the source for so many lanes of a function of each of the codes, by its name; accelerations among them."""
    if len(codes["accelerations"].lines) > LONG:
        return _code_by_shapes(codes, stride)
    source = []
    for name, code in codes.items():
        lines = ["two_alpha = gains[0, lane]", "beta_squared = gains[1, lane]"]
        for row, given in enumerate(code.given):
            lines += [f"{given}{i} = state[{row}, {i * stride} + lane]" for i in range(code.coordinates)]
        lines += [*code.lines]
        lines += [f"found[{place * stride} + lane] = {result}" for place, result in enumerate(code.results)]
        if stride == 1:
            lines = ["lane = 0", *lines, "pivot = 1.0", *(f"pivot = min(pivot, {each})" for each in code.pivots)]
            lines.append("return pivot")
        else:
            wanted = ["if lanes[lane]:", *_indented(lines, 1)] if code.of_some_lanes else lines
            lines = ["for lane in range(gains.shape[1]):", *_indented(wanted, 1), "return 1.0"]
        source += [_head(name, code), *_indented(lines, 1)]
    return MachineCode("\n".join(source), tuple(codes))


def _head(name: str, code: StateCode) -> str:
    """Return the first line of a function's source."""
    return f"def {name}(t, gains, state, found, room{', lanes' if code.of_some_lanes else ''}):"


def _code_by_shapes(codes: Mapping[str, StateCode], stride: int) -> MachineCode:
    """Return the same where the lines are taken by their shapes, lane after lane."""
    n, m = codes["accelerations"].coordinates, codes["accelerations"].constraints
    names = ["t", "two_alpha", "beta_squared"]
    for name, count in (("q", n), ("v", n), ("dq", n), ("dv", n), ("a", n), ("da", n), ("S", m), ("D", m)):
        names += variable_names(name, count)
    places = {name: place for place, name in enumerate(names)}
    shapes: dict[str, int] = {}
    tables: dict[str, NDArray[Any]] = {}
    for name, code in codes.items():
        of_lines = [shapes.setdefault(OPERAND.sub("#", line), len(shapes)) for line in code.lines]
        operands = [operand for line in code.lines for operand in OPERAND.findall(line)]
        tables[f"{name}_shapes"] = np.array([(shape, len(list(some))) for shape, some in groupby(of_lines)], np.int64)
        # without a sign: numba need not ask whether they count from the end
        tables[f"{name}_places"] = np.array([places.setdefault(each, len(places)) for each in operands], np.uint32)
    numbers = {place: float(name) for name, place in places.items() if name[0].isdigit()}
    tables |= {"number_places": np.array([*numbers], np.uint32), "numbers": np.array([*numbers.values()])}
    cases = []
    for shape, number in shapes.items():
        operands = [f"room[places[p + {operand}]]" for operand in range(shape.count("#"))]
        cases += [
            f"{'elif' if number else 'if'} shape == {number}:",
            " for _ in range(count):",
            f"  {shape.replace('#', '{}').format(*operands)}",
            f"  p += {len(operands)}",
        ]
    first_places = {f"{name}0": places[f"{name}0"] for name in ("q", "S", "D")}
    source = [SHAPES_TAKEN.format(cases="\n".join(_indented(cases, 2)), stride=stride, n=n, **first_places)]
    for name, code in codes.items():
        about: dict[str, Any] = {
            "name": name,
            "head": _head(name, code),
            "wanted": "lanes[lane]" if code.of_some_lanes else "True",
        }
        about |= {"first": places[code.results[0]], "count": len(code.results), "stride": stride, "m": m}
        source.append(FOUND_BY_SHAPES.format(**about, **first_places))
    return MachineCode("".join(source), ("take_lines", "given", *codes), tables, len(places))


SHAPES_TAKEN = """
def take_lines(shapes, places, room):
 p = 0
 for number in range(len(shapes)):
  shape, count = shapes[number]
{cases}
def given(t, gains, state, room, lane):
 room[0], room[1], room[2] = t, gains[0, lane], gains[1, lane]
 for k in range(len(numbers)):
  room[number_places[k]] = numbers[k]
 for half in range(len(state)):
  for i in range({n}):
   room[{q0} + half * {n} + i] = state[half, i * {stride} + lane]
"""

FOUND_BY_SHAPES = """
{head}
 for lane in range(gains.shape[1]):
  if {wanted}:
   given(t, gains, state, room, lane)
   take_lines({name}_shapes, {name}_places, room)
   for i in range({count}):
    found[i * {stride} + lane] = room[{first} + i]
 pivot = 1.0
 if {stride} == 1:
  for j in range({m}):
   pivot = min(pivot, room[{D0} + j] / room[{S0} + j])
 return pivot
"""
