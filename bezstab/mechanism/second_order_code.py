"""Generated source of steps for second-order schemes, and for every implicit one written as such.

Inside, h = 1: X, V and A stand for q, h v and h^2 a, H1, H2, ... for the scheme's helpers, with the step and the
coordinate: V_1_0 is the velocity of coordinate 0 at the end of the turn, A_m1_3 an acceleration one step before its
start. For velocity Verlet with the feedback at the half-step velocity and one coordinate the source reads

    def run(start, h, two_alpha, beta_squared, carried, solve):
     (X_0_0,), (V_0_0,), (A_0_0,), = carried
     k = 0
     h_squared = h * h
     while True:
      worst_pivot = 1.0
      X_1_0 = X_0_0 + V_0_0 + 0.5 * A_0_0                  the equations, in the order in which they can be taken
      H1_1_0 = V_0_0 + 0.5 * A_0_0
      q0 = X_1_0
      v0 = (H1_1_0) / h
      t = start + (k + 1.0) * h
      ...                                                  the acceleration code: a0 from t, q0 and v0
      worst = least(1.0, D0 / S0)
      A_1_0 = h_squared * a0
      worst_pivot = least(worst_pivot, worst)
      V_1_0 = H1_1_0 + 0.5 * A_1_0
      k = k + 1
      yield (X_1_0, V_1_0 / h,), (V_0_0 / h, A_0_0 / h_squared,), worst_pivot
      X_0_0 = X_1_0                                        what the next turn needs, one step back
      V_0_0 = V_1_0
      A_0_0 = A_1_0

Equations that wait for each other are solved together. Their assignments are linear and eliminated here, exactly, so
that position and velocity of each evaluation are known up to multiples of the unknown accelerations:

    K0 = X_0_0 + V_0_0                                     the known part of a position, then of a velocity
    K1 = V_0_0
    (A_1_0,), worst = solve(0, start, k, h, two_alpha, beta_squared, (K0, K1,), (A_0_0,))

where solve seeks the zero of residual_0 from the last acceleration on,

    def residual_0(start, k, h, two_alpha, beta_squared, known, unknown):
     K0, K1, = known
     U0, = unknown
     h_squared = h * h
     q0 = K0 + 0.25 * U0
     v0 = (K1 + 0.5 * U0) / h
     ...                                                   the acceleration code
     return (U0 - h_squared * a0,), worst
"""

from collections.abc import Iterable, Sequence
from fractions import Fraction

from bezstab.mechanism.equations import variable_names
from bezstab.mechanism.generated_code import AccelerationCode, indented, tuple_text
from bezstab.mechanism.linear_equations import solution
from bezstab.mechanism.second_order_memory import (
    ACCELERATION,
    POSITION,
    VELOCITY,
    Memory,
    is_solved_together,
    memory,
)
from bezstab.methods import Assignment, Combination, Evaluation, Quantity, SecondOrder

ONE, ZERO = Fraction(1), Fraction(0)

Sum = dict[Quantity, Fraction]
"""A combination by what it multiplies."""


def second_order_stepper_source(acceleration: AccelerationCode, scheme: SecondOrder) -> str:
    """Return the source of run(start, h, two_alpha, beta_squared, carried, solve), a generator of turns.

    Each turn yields q and v at its end, then v and a at its start (where the scheme has no a there: zeros), and the
    least relative pivot of S met on the way. `start` (s) is the time of step 0 of the first turn, h (s) the whole step,
    and `carried` has what `memory` says, n entries each, in units in which h = 1. An implicit scheme calls
    solve(number of the group, start, k, h, two_alpha, beta_squared, known, guess), which returns what makes all of
    residual_<number> zero, and the least pivot there.
    """
    names = _Names(scheme, acceleration.coordinates)
    carried = memory(scheme).carried
    lines = ["worst_pivot = 1.0"]
    for number, group in enumerate(scheme.groups):
        if is_solved_together(group):
            lines += _implicit_lines(names, number, group)
        elif isinstance(group[0], Evaluation):
            lines += _evaluation_lines(names, acceleration, group[0], memory(scheme))
        else:
            lines += names.assignments(group[0].result, _sum(group[0].value))
    reported = [*names.of(Quantity(POSITION, 1)), *_over(names.of(Quantity(VELOCITY, 1)), "h")]
    lines += ["k = k + 1", f"yield {tuple_text(reported)}, {tuple_text(_slope(names, carried))}, worst_pivot"]
    for quantity in carried:  # each name's oldest first: none is overwritten before it has been moved on
        newer = names.of(Quantity(quantity.name, quantity.step + 1))
        lines += [f"{old} = {new}" for old, new in zip(names.of(quantity), newer, strict=True)]
    unpacked = tuple_text(tuple_text(names.of(quantity)) for quantity in carried)
    return "\n".join([
        "def run(start, h, two_alpha, beta_squared, carried, solve):",
        *indented([f"{unpacked} = carried", "k = 0", "h_squared = h * h", "while True:"], 1),
        *indented(lines, 2),
    ])  # fmt: skip


def residuals_source(acceleration: AccelerationCode, scheme: SecondOrder, with_pivots: bool) -> str:
    """Return the source of residual_<number>(start, k, h, two_alpha, beta_squared, known, unknown) for implicit groups.

    Each returns A - h^2 acceleration for all that the group evaluates; with pivots also the least relative pivot of S.
    Without them the functions also work on complex numbers, which have no least.
    """
    functions = [
        _residual_function(acceleration, scheme, number, scheme.groups[number], with_pivots)
        for number in implicit_groups(scheme)
    ]
    return "\n".join(functions)


def implicit_groups(scheme: SecondOrder) -> dict[int, int]:
    """Return the number of evaluations in each group that has to be solved, by the group's number."""
    return {
        number: len(_evaluations(group))
        for number, group in enumerate(scheme.groups)
        if is_solved_together(group) and _evaluations(group)
    }


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
            " + ".join(_product_text(c, self.of(quantity)[i]) for quantity, c in terms.items() if c) or "0.0"
            for i in range(self.coordinates)
        ]

    def assignments(self, result: Quantity, terms: Sum) -> list[str]:
        """Return the lines that give a quantity the value of a sum."""
        return [f"{name} = {value}" for name, value in zip(self.of(result), self.sums(terms), strict=True)]


def _sum(combination: Combination) -> Sum:
    terms: Sum = {}
    for coefficient, quantity in combination:
        terms[quantity] = terms.get(quantity, ZERO) + coefficient
    return terms


def _product_text(coefficient: Fraction, variable: str) -> str:
    return variable if coefficient == 1 else f"{float(coefficient)!r} * {variable}"


def _over(variables: Iterable[str], divisor: str) -> list[str]:
    return [f"{variable} / {divisor}" for variable in variables]


def _slope(names: _Names, carried: Sequence[Quantity]) -> list[str]:
    """Return v and a at the start of the turn, where the scheme carries them."""
    slope = []
    for name, divisor in ((VELOCITY, "h"), (ACCELERATION, "h_squared")):
        quantity = Quantity(name, 0)
        slope += _over(names.of(quantity), divisor) if quantity in carried else ["0.0"] * names.coordinates
    return slope


def _evaluation_lines(
    names: _Names, acceleration: AccelerationCode, evaluation: Evaluation, remembered: Memory
) -> list[str]:
    """Return the lines of an evaluation at a position, velocity and time that are known."""
    positions, velocities = (names.sums(_sum(part)) for part in (evaluation.position, evaluation.velocity))
    moment = remembered.moments[evaluation.result]
    return [
        *_acceleration_lines(acceleration, positions, velocities, moment),
        acceleration.least_pivot_line,
        *(f"{name} = h_squared * a{i}" for i, name in enumerate(names.of(evaluation.result))),
        "worst_pivot = least(worst_pivot, worst)",
    ]


def _acceleration_lines(
    acceleration: AccelerationCode, positions: Sequence[str], velocities: Sequence[str], moment: Fraction
) -> list[str]:
    """Return the lines that compute a from positions and velocities, given as texts, so many steps into the turn."""
    return [
        *(f"q{i} = {position}" for i, position in enumerate(positions)),
        *(f"v{i} = ({velocity}) / h" for i, velocity in enumerate(velocities)),
        f"t = start + (k + {float(moment)!r}) * h",
        *acceleration.lines,
    ]


# Groups of equations that are solved together


def _evaluations(group: Sequence[Assignment | Evaluation]) -> list[Evaluation]:
    return [equation for equation in group if isinstance(equation, Evaluation)]


def eliminated(group: Sequence[Assignment | Evaluation]) -> dict[Quantity, Sum]:
    """Return what the group assigns as sums of what is known before and of the accelerations it evaluates.

    With y the assigned, u all else: y = M y + N u, hence y = (I - M)^-1 N u. Without feedback the accelerations are
    given, so that a scheme whose equations determine its step has an inverse here.
    """
    assignments = [equation for equation in group if isinstance(equation, Assignment)]
    assigned = [equation.result for equation in assignments]
    values = [_sum(equation.value) for equation in assignments]
    others = list(dict.fromkeys(quantity for value in values for quantity in value if quantity not in assigned))
    rows = [
        [(ONE if i == j else ZERO) - value.get(quantity, ZERO) for j, quantity in enumerate(assigned)]
        for i, value in enumerate(values)
    ]
    right_sides = [[value.get(quantity, ZERO) for quantity in others] for value in values]
    solved = solution(rows, right_sides)
    return {
        result: dict(zip(others, coefficients, strict=True))
        for result, coefficients in zip(assigned, solved, strict=True)
    }


def _reduced(combination: Combination, known_as: dict[Quantity, Sum]) -> Sum:
    """Return a combination with what a group assigns replaced by what it stands for."""
    terms: Sum = {}
    for coefficient, quantity in combination:
        for inner, share in known_as.get(quantity, {quantity: ONE}).items():
            terms[inner] = terms.get(inner, ZERO) + coefficient * share
    return terms


def _implicit_lines(names: _Names, number: int, group: Sequence[Assignment | Evaluation]) -> list[str]:
    """Return the lines that solve a group for its accelerations, and take its assignments after that."""
    known_as = eliminated(group)
    evaluations = _evaluations(group)
    unknowns = [evaluation.result for evaluation in evaluations]
    lines: list[str] = []
    if evaluations:
        parts: list[str] = []
        for evaluation in evaluations:
            for part in (evaluation.position, evaluation.velocity):
                reduced = _reduced(part, known_as)
                parts += names.sums({quantity: c for quantity, c in reduced.items() if quantity not in unknowns})
        known = variable_names("K", len(parts))
        lines += [f"{name} = {part}" for name, part in zip(known, parts, strict=True)]
        found = tuple_text(name for unknown in unknowns for name in names.of(unknown))
        guesses = [Quantity(unknown.name, unknown.step - 1) for unknown in unknowns]
        guess = tuple_text(name for quantity in guesses for name in names.of(quantity))
        situation = "start, k, h, two_alpha, beta_squared"
        lines += [
            f"{found}, worst = solve({number}, {situation}, {tuple_text(known)}, {guess})",
            "worst_pivot = least(worst_pivot, worst)",
        ]
    for result, terms in known_as.items():
        lines += names.assignments(result, terms)
    return lines


def _residual_function(
    acceleration: AccelerationCode,
    scheme: SecondOrder,
    number: int,
    group: Sequence[Assignment | Evaluation],
    with_pivots: bool,
) -> str:
    """Return the source of the residual of one group."""
    coordinates = acceleration.coordinates
    known_as = eliminated(group)
    evaluations = _evaluations(group)
    unknowns = [evaluation.result for evaluation in evaluations]
    lines = [
        f"{tuple_text(variable_names('K', 2 * coordinates * len(evaluations)))} = known",
        f"{tuple_text(variable_names('U', coordinates * len(evaluations)))} = unknown",
        "h_squared = h * h",
    ]
    if with_pivots:
        lines.append("worst_pivot = 1.0")
    residuals: list[str] = []
    for own, evaluation in enumerate(evaluations):
        positions, velocities = (
            [
                " + ".join(
                    [
                        f"K{(2 * own + part) * coordinates + i}",
                        *(
                            _product_text(terms[unknown], f"U{other * coordinates + i}")
                            for other, unknown in enumerate(unknowns)
                            if terms.get(unknown)
                        ),
                    ]
                )
                for i in range(coordinates)
            ]
            for part, terms in enumerate(
                (_reduced(evaluation.position, known_as), _reduced(evaluation.velocity, known_as))
            )
        )
        moment = memory(scheme).moments[evaluation.result]
        lines += _acceleration_lines(acceleration, positions, velocities, moment)
        if with_pivots:
            lines += [acceleration.least_pivot_line, "worst_pivot = least(worst_pivot, worst)"]
        for i in range(coordinates):
            residual = f"R{own * coordinates + i}"
            lines.append(f"{residual} = U{own * coordinates + i} - h_squared * a{i}")
            residuals.append(residual)
    results = f"{tuple_text(residuals)}, worst_pivot" if with_pivots else tuple_text(residuals)
    head = f"def residual_{number}(start, k, h, two_alpha, beta_squared, known, unknown):"
    return "\n".join([head, *indented([*lines, f"return {results}"], 1)])
