"""Generated code: accelerations, multipliers and corrections as assignments, and the functions that are made of them.

Only this file writes source, and only here it is executed; others hand it equations and take functions. What a method
does with them is no text: `programs` and `stepper` have it.

    assignments          all that solves paper Eq. 9, and brings a state back to its constraints, one after the other
    Code                 those of them that some results need
    state_function       a code as text that becomes a function, of one state or of many
    lane_function        the same for runs side by side

All of it is plain arithmetic, one assignment a line, with `sin`, `cos` and `sqrt` as the only functions. What they are
is decided when the text is compiled, so one source serves four kinds of numbers:

- floats with `math`: a single run, without the overhead of arrays of four or five entries; so does machine code;
- numpy arrays: a batch of runs, each variable one array over the batch, each line one operation on all of it;
- arrays of complex numbers: a state that is moved by a tiny imaginary step gives the slope in that direction;
- mpmath numbers: references of as many digits as asked for.

The names: q0, q1, ... coordinates, v0, ... their rates, a0, ... their accelerations, l0, ... multipliers; C1_2, the
entry of C_q in row 1 and column 2; two_alpha and beta_squared, the gains. The text holds nothing of a scene but numbers
and these names; least of all the names that a user gave to bodies.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import ArrayLike, NDArray
from sympy.printing.pycode import PythonCodePrinter

from bezstab.mechanism.equations import Mechanism, T

IMAGINARY_STEP = 1e-200
"""By which a state is moved to find a slope: nothing is subtracted, so that the derivative is exact to rounding.

Its square is zero in float64, and so is that of what a step makes of it with feedback beyond all use.
"""

SINGULAR = 1e-12  # of a row's own size: a pivot of S = C_q M^-1 C_q^T this small has lost all digits to cancellation

Row = dict[int, sp.Expr]
"""Entries of a matrix that are not zero, by their columns."""


class Assignments(list[tuple[sp.Symbol, sp.Expr]]):
    """Assignments to variables, one after the other."""

    def variable(self, name: str, value: sp.Expr) -> sp.Symbol:
        """Return the variable of that name, which gets this value."""
        self.append((sp.Symbol(name), sp.Float(value) if value.is_Integer else value))
        return self[-1][0]


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
# Then L y = r forwards, y / D, and L^T lambda = y / D backwards, all in the variables y_i and l_i. The loops over i, j
# and p run here, once: what is generated is the list of assignments they would execute ("unrolled").
#
# A constraint involves few coordinates and a body few constraints, so most entries of C_q are zero whatever q is, and
# with them many of S and L. Such structural zeros are known here, and no term that has one as a factor is written.
# A chain of N bodies costs N times as much as one, where a full elimination would cost N^3.


TWO_ALPHA, BETA_SQUARED = sp.symbols("two_alpha beta_squared")


@cache
def assignments(mechanism: Mechanism) -> tuple[Assignments, dict[str, list[sp.Symbol]]]:
    """Return what computes accelerations a, observations c, cdot and l, and corrections dq and dv; and these by name.

    Multipliers l are in N along a constraint whose c is in m.
    """
    found = Assignments()
    n, m = mechanism.size, len(mechanism.constraints)
    matrices = (mechanism.jacobian, mechanism.constraints, mechanism.constraints_t, mechanism.gamma, mechanism.forces)
    common, (jacobian, c, c_t, gamma, forces) = sp.cse(matrices, symbols=sp.numbered_symbols("x"))
    found += common

    def entry(name: str, value: sp.Expr) -> sp.Expr:
        """Return an entry: a number as it is, all else by its variable."""
        return value if value.is_number else found.variable(name, value)

    rows = [{k: entry(f"C{i}_{k}", jacobian[i, k]) for k in range(n) if jacobian[i, k] != 0} for i in range(m)]
    applied = [entry(f"g{k}", force) for k, force in enumerate(forces)]
    inverse_masses = [sp.Float(1 / mass) for mass in mechanism.mass.tolist()]
    pivots, solve = _factored(found, rows, inverse_masses)

    def accelerated(name: str, pulls: Sequence[sp.Expr], multipliers: Sequence[sp.Expr]) -> list[sp.Symbol]:
        """Assign M^-1 (pulls - C_q^T multipliers)."""
        reactions = [sp.Add(*(rows[i][k] * multipliers[i] for i in range(m) if k in rows[i])) for k in range(n)]
        # not evaluated: else the product of a number and a sum becomes a sum of products, which takes longer
        scaled = [
            sp.Mul(w, pull - r, evaluate=False) for w, pull, r in zip(inverse_masses, pulls, reactions, strict=True)
        ]
        return [found.variable(f"{name}{k}", value) for k, value in enumerate(scaled)]

    errors, rates, right_sides = [], [], []
    for i, row in enumerate(rows):
        errors.append(found.variable(f"c{i}", c[i]))
        speeds = (each * mechanism.v[k] for k, each in row.items())
        rates.append(found.variable(f"cdot{i}", sp.Add(*speeds, entry(f"ct{i}", c_t[i]))))
        by_forces = (each * inverse_masses[k] * applied[k] for k, each in row.items())
        feedback = TWO_ALPHA * rates[i] + BETA_SQUARED * errors[i]
        right_sides.append(sp.Add(*by_forces, -entry(f"gamma{i}", gamma[i]), feedback))
    multipliers, nothing = solve("l", right_sides), [sp.Integer(0)] * n
    accelerations = accelerated("a", applied, multipliers)
    corrections = accelerated("dq", nothing, solve("lq", errors)) + accelerated("dv", nothing, solve("lv", rates))
    return found, {
        "accelerations": accelerations,
        "observations": errors + rates + multipliers,
        "corrections": corrections,
        "pivots": pivots,
    }


def _factored(
    found: Assignments, rows: Sequence[Row], inverse_masses: Sequence[sp.Expr]
) -> tuple[list[sp.Symbol], Callable[[str, Sequence[sp.Expr]], list[sp.Symbol]]]:
    """Assign what factors S; return its relative pivots, and the function that assigns what solves for a right side."""

    def entry_of_s(i: int, j: int) -> sp.Expr:
        shared = rows[i].keys() & rows[j].keys()
        return sp.Add(*(rows[i][k] * rows[j][k] * inverse_masses[k] for k in shared))

    m = len(rows)
    pivots: list[sp.Symbol] = []
    diagonal: list[sp.Symbol] = []
    factors: list[Row] = [{} for _ in rows]  # L, and W = L D
    left: list[Row] = [{} for _ in rows]
    for j in range(m):
        size = found.variable(f"S{j}", entry_of_s(j, j))
        taken_off = sp.Add(*(factors[j][p] * left[j][p] for p in factors[j]))
        diagonal.append(found.variable(f"D{j}", size - taken_off))
        pivots.append(found.variable(f"pivot{j}", diagonal[j] / size))
        for i in range(j + 1, m):
            earlier = factors[i].keys() & factors[j].keys()
            value = entry_of_s(i, j) - sp.Add(*(factors[i][p] * left[j][p] for p in earlier))
            if value != 0:
                left[i][j] = found.variable(f"W{i}_{j}", value)
                factors[i][j] = found.variable(f"L{i}_{j}", left[i][j] / diagonal[j])

    def solve(name: str, right_sides: Sequence[sp.Expr]) -> list[sp.Symbol]:
        forwards: list[sp.Symbol] = []
        for i, right_side in enumerate(right_sides):
            known = sp.Add(*(factor * forwards[p] for p, factor in factors[i].items()))
            forwards.append(found.variable(f"y_{name}{i}", right_side - known))
        backwards: Row = {}
        for i in reversed(range(m)):
            known = sp.Add(*(factors[p][i] * backwards[p] for p in range(i + 1, m) if i in factors[p]))
            backwards[i] = found.variable(f"{name}{i}", forwards[i] / diagonal[i] - known)
        return [backwards[i] for i in range(m)]

    return pivots, solve


# Functions


@dataclass(frozen=True, eq=False)
class Code:
    """The assignments that results need, from what is given on: t, two_alpha, beta_squared, all q_i and all v_i.

    `pivots` are the D_j relative to S_jj: where the least of these is small, S is nearly singular.
    """

    given: Sequence[sp.Symbol]
    assignments: Sequence[tuple[sp.Symbol, sp.Expr]]
    results: Sequence[sp.Symbol]
    pivots: Sequence[sp.Symbol]


@cache
def code_of(mechanism: Mechanism, name: str) -> Code:
    """Return the code of accelerations, observations or corrections."""
    known, by_name = assignments(mechanism)
    results, pivots = by_name[name], by_name["pivots"]
    needed, kept = {*results, *pivots}, []
    for symbol, value in reversed(known):
        if symbol in needed:
            kept.append((symbol, value))
            needed |= value.free_symbols
    return Code((T, TWO_ALPHA, BETA_SQUARED, *mechanism.q, *mechanism.v), kept[::-1], results, pivots)


class _EveryDigit(PythonCodePrinter):  # type: ignore[misc]  # sympy has no types
    """Prints a number as Python does, where sympy leaves its last digits out; and of sums what is added first."""

    def _print_Float(self, expr: sp.Float) -> str:  # noqa: N802  # the name by which sympy calls it
        return repr(float(expr))

    def _as_ordered_terms(self, expr: sp.Add, order: str | None = None) -> list[sp.Expr]:
        return sorted(expr.args, key=lambda term: bool(term.could_extract_minus_sign()))


def source(code: Code, head: str, given: Sequence[str], end: Sequence[str]) -> str:
    """Return the source of the function with this head, from the texts of what is given to its last lines."""
    printer = _EveryDigit({"fully_qualified_modules": False})
    used = set().union(*(value.free_symbols for _, value in code.assignments))
    lines = [f"{symbol} = {text}" for symbol, text in zip(code.given, given, strict=True) if symbol in used]
    lines += [f"{symbol} = {printer.doprint(value)}" for symbol, value in code.assignments]
    return "\n".join([f"def {head}:", *(f" {line}" for line in (*lines, *end))])


def compiled_source(text: str, library: Any, others: Mapping[str, Any] | None = None, file: str = "<generated>") -> Any:
    """Return the function that generated source defines, its elementary functions those of math, numpy or mpmath.

    `others` are functions that it calls, by their names; `file` is where it is said to come from.
    """
    namespace = {"sin": library.sin, "cos": library.cos, "sqrt": library.sqrt, "__name__": __name__} | dict(
        others or {}
    )
    exec(compile(text, file, "exec"), namespace)
    return namespace[text.partition("(")[0].removeprefix("def ")]


StateFunction = Callable[[Sequence[Any]], tuple[Any, ...]]
"""A function of t (s), the gains 2 alpha (1/s) and beta^2 (1/s^2), and all q and all v, in one row; in SI units.

The library of its sines says on what numbers it works: floats (math), arrays (numpy) or those of mpmath.
"""


@cache
def state_function(mechanism: Mechanism, name: str, library: Any) -> StateFunction:
    """Return the function of that name: accelerations, observations (c, cdot, multipliers) or corrections (dq, dv).

    Behind these it returns the m relative pivots of S.
    """
    code = code_of(mechanism, name)
    given = [f"given[{place}]" for place in range(len(code.given))]
    results = ", ".join(map(str, (*code.results, *code.pivots)))
    function: StateFunction = compiled_source(source(code, "found(given)", given, [f"return ({results},)"]), library)
    return function


LaneFunction = Callable[[float, NDArray[Any], NDArray[Any], NDArray[Any]], tuple[NDArray[Any], float]]
"""A function of t (s), gains (2, lanes), q and v (n, lanes), of runs side by side; SI units.

It returns its values, (values, lanes), and of a run alone the least relative pivot of S, else 1.
"""


def lane_function(mechanism: Mechanism, name: str) -> LaneFunction:
    """Return the function of that name for runs side by side, of floats or complex numbers.

    What Python refuses to compute of a run alone is infinite, or no number, as with arrays.
    """
    of_numbers, of_arrays = (state_function(mechanism, name, library) for library in (math, np))
    count = len(mechanism.constraints)

    def function(t: float, gains: NDArray[Any], q: NDArray[Any], v: NDArray[Any]) -> tuple[NDArray[Any], float]:
        lanes, kind = q.shape[1], np.result_type(gains, q, v)
        if lanes == 1 and kind == np.float64:  # of few numbers arrays are slower
            given = [t, *gains[:, 0].tolist(), *q[:, 0].tolist(), *v[:, 0].tolist()]
            try:
                found = of_numbers(given)
            except (ArithmeticError, ValueError):
                found = of_arrays(list(np.array(given)))
            return np.array(found[:-count])[:, np.newaxis], float(min(1.0, *found[-count:]))
        found = of_arrays([t, *gains, *q, *v])
        values = np.empty((len(found) - count, lanes), kind)
        for into, value in zip(values, found, strict=False):
            into[:] = value
        return values, 1.0

    return function


def accelerations(
    mechanism: Mechanism, t: ArrayLike, two_alpha: ArrayLike, beta_squared: ArrayLike, q: ArrayLike, v: ArrayLike
) -> NDArray[Any]:
    """Return all of qddot, paper Eq. 9, shape (n, *batch) as of q and v, floats or complex numbers; SI units."""
    function = state_function(mechanism, "accelerations", np)
    values = function([t, two_alpha, beta_squared, *np.asarray(q), *np.asarray(v)])
    return np.stack(np.broadcast_arrays(*values[: mechanism.size]))


# Machine code
#
# Machine code takes runs side by side, each in a lane: arrays have room for `stride` lanes of each coordinate. Each
# function is NAME_of(t, gains, state, found, lane): it writes the results of the code of that name for a lane, and
# returns the least relative pivot of S. gains (2, lanes); state (2, n stride), q and v; found (n stride,), or as much
# for each of the results.


def machine_source(code: Code, name: str, stride: int) -> str:
    """Return the source of the function of that name for a lane."""
    n = (len(code.given) - 3) // 2
    given = ["t", "gains[0, lane]", "gains[1, lane]"]
    given += [f"state[{half}, {i * stride} + lane]" for half in range(2) for i in range(n)]
    end = [f"found[{place * stride} + lane] = {result}" for place, result in enumerate(code.results)]
    end += ["least = 1.0", *(f"least = min(least, {pivot})" for pivot in code.pivots), "return least"]
    return source(code, f"{name}_of(t, gains, state, found, lane)", given, end)
