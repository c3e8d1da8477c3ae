r"""Second-order schemes: an integrator of x'' = a(x, x') as a list of linear equations, in any order.

With h = 1, x, v and a stand for c, h cdot and h^2 cddot. An equation gives one quantity at one step, either as a sum of
multiples of others or as the acceleration at such sums. Velocity Verlet with the feedback at the half-step velocity:

    x1 = x0 + v0 + 1/2 a0
    vh = v0 + 1/2 a0                       vh: a helper, any other name than x, v and a
    a1 = acceleration(x1, vh)
    v1 = vh + 1/2 a1                       1 is the end of the step, 0 its start, -1 the start of the step before

With acceleration(x, v) = -alpha_hat v - beta_hat x the equations are linear and homogeneous. A shift by one step is a
factor z, so the determinant of their coefficients is the characteristic polynomial P(z; alpha_hat, beta_hat):

              x           v          vh               a
    x1:    [  z - 1      -1           0             -1/2          ]
    vh:    [  0          -1           z             -1/2          ]        det = 0
    a1:    [  beta_hat z  0           alpha_hat z    z            ]
    v1:    [  0           z          -z             -z/2          ]

An equation can be taken as soon as what it needs is known. Where some wait for each other in a circle they are solved
together, and the scheme is implicit: that is found here, not declared.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from math import comb, factorial

from bezstab.errors import InputError
from bezstab.methods.plane_polynomials import ONE, ZERO, Matrix, Terms, determinant
from bezstab.methods.schur import quotient_and_remainder, recursion_verdict

POSITION, VELOCITY, ACCELERATION = "x", "v", "a"
MOST_EQUATIONS = 60  # some 20 stages
FURTHEST_BACK = -20  # steps
LATEST = 2  # step of a result: beyond the end of the step by as much as a multistep formula may be written

PlaneTable = tuple[tuple[tuple[Fraction, ...], ...], ...]
"""A polynomial in z, alpha_hat and beta_hat: table[k][i][j] belongs to z^k alpha_hat^i beta_hat^j."""


@dataclass(frozen=True, order=True)
class Quantity:
    """A value at a numbered step: 1 is the end of the step being taken, 0 its start, -1 the start of the one before."""

    name: str
    step: int

    def __str__(self) -> str:
        if self.name not in (POSITION, VELOCITY, ACCELERATION):
            return self.name if self.step == 1 else f"{self.name}[{self.step}]"
        return f"{self.name}{self.step}" if self.step >= 0 else f"{self.name}[{self.step}]"


Combination = tuple[tuple[Fraction, Quantity], ...]
"""A sum of coefficients times quantities."""


@dataclass(frozen=True)
class Assignment:
    """result = value, a sum of numbers times quantities, in units in which h = 1."""

    result: Quantity
    value: Combination

    @property
    def used(self) -> tuple[Quantity, ...]:
        """What the right-hand side needs."""
        return tuple(quantity for _, quantity in self.value)


@dataclass(frozen=True)
class Evaluation:
    """result = acceleration(position, velocity), in units in which h = 1."""

    result: Quantity
    position: Combination
    velocity: Combination

    @property
    def used(self) -> tuple[Quantity, ...]:
        """What the right-hand side needs."""
        return tuple(quantity for _, quantity in (*self.position, *self.velocity))


Equation = Assignment | Evaluation


@dataclass(frozen=True)
class SecondOrder:
    """Equations for x1, v1, the accelerations and any helpers, each for one quantity.

    InputError unless every quantity is defined once, and not used later than it is there; x1 and v1 are among them; the
    equations determine them; and the scheme is consistent (a free motion x0 + v0 t is followed exactly and an
    acceleration acts in full) and zero-stable (without feedback z = 1 is a double root, all others lie inside the unit
    circle or are simple on it; or what velocities do by themselves stays bounded, and so does what positions do without
    them: a weakly stable multistep method has the root z = -1 once in each, and what the one makes of the other grows
    like n h = t, as x0 + v0 t does).
    """

    equations: tuple[Equation, ...]

    def __post_init__(self) -> None:
        self._check_names()
        self._check_motion()

    def _check_names(self) -> None:
        if len(self.equations) > MOST_EQUATIONS:
            raise InputError(f"{len(self.equations)} equations: expected at most {MOST_EQUATIONS}")
        latest: dict[str, Quantity] = {}
        for equation in self.equations:
            result = equation.result
            if result.name in latest:
                raise InputError(f"{result}: a second equation for {result.name}")
            if not 0 <= result.step <= LATEST:
                raise InputError(f"{result}: expected an equation for step 0, 1 or 2")
            latest[result.name] = result
        for name in (POSITION, VELOCITY):
            if name not in latest or latest[name].step < 1:
                raise InputError(f"no equation gives {name}1")
        if not self.evaluations:
            raise InputError("no equation evaluates the acceleration")
        for equation in self.equations:
            for quantity in equation.used:
                if quantity.name not in latest:
                    raise InputError(f"{equation.result}: no equation gives {quantity}")
                if quantity.step > latest[quantity.name].step:
                    raise InputError(
                        f"{equation.result}: uses {quantity}, but {latest[quantity.name]} is the latest there is"
                    )
                if quantity.step < FURTHEST_BACK:
                    raise InputError(
                        f"{equation.result}: uses {quantity}: expected at most {-FURTHEST_BACK} steps back"
                    )

    def _check_motion(self) -> None:
        free = [in_plane[0][0] for in_plane in reversed(self.table)]
        if not free or not free[0]:  # else without feedback, or with little, a step has no solution or many
            raise InputError("the equations do not determine x1 and v1")
        reduced, rest = quotient_and_remainder(free, (ONE, Fraction(-2), ONE))
        if any(rest) or not reduced:
            raise InputError("inconsistent: a free motion x0 + v0 t is not followed exactly")
        if any(any(defect(self.table, degree)) for degree in range(3)):
            raise InputError("inconsistent: an acceleration does not act in full, or feedback not as feedback")
        if sum(reduced) == 0 or (recursion_verdict(reduced) == "diverges" and not self._parts_stay_bounded()):
            raise InputError("zero-unstable: without feedback a root lies outside the unit circle, or repeats on it")
        position, velocity = self.responses
        mu_times_x = [*defect(position, 0), ZERO]
        if any(defect(velocity, 0)) or defect(velocity, 1) != mu_times_x:
            raise InputError("inconsistent: v1 is not the velocity of x1")

    def _parts_stay_bounded(self) -> bool:
        """Return whether without feedback velocities do not depend on positions, and neither part grows by itself."""
        value_of = {
            equation.result.name: equation.value if isinstance(equation, Assignment) else ()  # no feedback: a = 0
            for equation in self.equations
        }
        velocities: set[str] = set()
        found = {VELOCITY}
        while found:
            velocities |= found
            found = {quantity.name for name in found for _, quantity in value_of[name]} - velocities
        if POSITION in velocities:
            return False
        for part in (velocities, value_of.keys() - velocities):
            alone: list[Equation] = []
            for equation in self.equations:
                name = equation.result.name
                if name in part:
                    alone.append(Assignment(equation.result, tuple(x for x in value_of[name] if x[1].name in part)))
            free = [in_plane[0][0] for in_plane in reversed(_determinant_table(tuple(alone)))]
            if recursion_verdict(free) == "diverges":
                return False
        return True

    @property
    def evaluations(self) -> int:
        """How often a step evaluates the acceleration: an implicit one so often for each of Newton's iterations."""
        return sum(isinstance(equation, Evaluation) for equation in self.equations)

    @property
    def implicit(self) -> bool:
        """Whether some equations must be solved together."""
        return any(len(group) > 1 or group[0].result in group[0].used for group in self.groups)

    @property
    def oldest(self) -> int:
        """The earliest step that is looked back to, at most 0: 0 for a one-step method."""
        return min(0, *(quantity.step for equation in self.equations for quantity in equation.used))

    @cached_property
    def groups(self) -> tuple[tuple[Equation, ...], ...]:
        """The equations in an order in which each can be taken; those that wait for each other form one group."""
        return tuple(_in_order(self.equations))

    @cached_property
    def table(self) -> PlaneTable:
        """P(z; alpha_hat, beta_hat), the determinant, without roots z = 0 that no parameters move; a step of h.

        Leading coefficient one at alpha_hat = beta_hat = 0.
        """
        return _determinant_table(self.equations)

    @cached_property
    def responses(self) -> tuple[PlaneTable, PlaneTable]:
        """Polynomials in the ratio of x and v on every motion z^k, from the equations without one evaluation."""
        position, velocity = _responses(self.equations)
        lowest = min(k for k, _, _ in (*position, *velocity))
        return _table_from(position, lowest), _table_from(velocity, lowest)


def _in_order(equations: tuple[Equation, ...]) -> Iterator[tuple[Equation, ...]]:
    """Yield the equations in groups that can be taken one after the other, as far as possible as they are listed."""
    waiting = {equation.result: equation for equation in equations}
    while waiting:
        needed = {result: _needed(result, waiting) for result in waiting}
        # whatever the first of the smallest sets waits for waits for it too: else its own set were smaller
        smallest = min(needed.values(), key=len)
        yield tuple(equation for result, equation in waiting.items() if result in smallest)
        waiting = {result: equation for result, equation in waiting.items() if result not in smallest}


def _needed(result: Quantity, waiting: dict[Quantity, Equation]) -> set[Quantity]:
    """Return the quantities, itself included, whose equations must be taken before this one is there."""
    needed: set[Quantity] = set()
    found = {result}
    while found:
        needed |= found
        found = {quantity for each in found for quantity in waiting[each].used if quantity in waiting} - needed
    return needed


def _determinant_table(equations: tuple[Equation, ...]) -> PlaneTable:
    """Return the determinant of the equations' coefficients as a table."""
    return _table_of(determinant(coefficient_rows(equations)))


def coefficient_rows(equations: tuple[Equation, ...]) -> Matrix:
    """Return the coefficients of each equation, one column for each quantity's name, in the order of the equations.

    A coefficient is a polynomial as a dict, by powers of z, alpha_hat and beta_hat.
    """
    column = {equation.result.name: number for number, equation in enumerate(equations)}
    earliest = first_step(equations)
    rows: Matrix = []
    for equation in equations:
        row: list[Terms] = [{} for _ in equations]
        for coefficient, quantity, (by_velocity, by_position) in _terms_of(equation):
            terms = row[column[quantity.name]]
            powers = (quantity.step - earliest, by_velocity, by_position)
            terms[powers] = terms.get(powers, ZERO) + coefficient
        rows.append([{powers: c for powers, c in terms.items() if c} for terms in row])
    return rows


def first_step(equations: tuple[Equation, ...]) -> int:
    """Return the earliest step of any quantity in the equations: it has the power 0 of z in their coefficients."""
    return min(quantity.step for equation in equations for quantity in (equation.result, *equation.used))


def _terms_of(equation: Equation) -> Iterator[tuple[Fraction, Quantity, tuple[int, int]]]:
    """Yield what stands in `result - right-hand side = 0`: coefficient, quantity, powers of alpha_hat and beta_hat."""
    yield ONE, equation.result, (0, 0)
    match equation:
        case Assignment(value=value):
            yield from ((-coefficient, quantity, (0, 0)) for coefficient, quantity in value)
        case Evaluation(position=position, velocity=velocity):
            yield from ((coefficient, quantity, (0, 1)) for coefficient, quantity in position)
            yield from ((coefficient, quantity, (1, 0)) for coefficient, quantity in velocity)


def _responses(equations: tuple[Equation, ...]) -> tuple[Terms, Terms]:
    """Return x and v where the acceleration of one evaluation is free, up to one factor, as polynomials.

    They are the minors of the coefficients without the row of that evaluation, the first that acts on x at all: on a
    motion z^k that satisfies all equations x and v are in their ratio (Cramer's rule).
    """
    rows = coefficient_rows(equations)
    names = [equation.result.name for equation in equations]
    for number, equation in enumerate(equations):
        if isinstance(equation, Evaluation):
            position, velocity = (
                determinant(_with_unit_row(rows, number, names.index(name))) for name in (POSITION, VELOCITY)
            )
            if sum(c for (_, i, j), c in position.items() if (i, j) == (0, 0)):
                return position, velocity
    raise InputError("inconsistent: no acceleration acts on x1")


def _with_unit_row(rows: Matrix, number: int, column: int) -> Matrix:
    """Return the matrix with 1 in one column of one row, and 0 in its others."""
    unit: list[Terms] = [{(0, 0, 0): ONE} if place == column else {} for place in range(len(rows))]
    return [unit if place == number else row for place, row in enumerate(rows)]


def _table_of(terms: Terms) -> PlaneTable:
    """Return the table of a polynomial without roots z = 0 that no parameters move; () for zero.

    Leading coefficient one at alpha_hat = beta_hat = 0, if there is one.
    """
    if not terms:
        return ()
    at_origin = [k for k, i, j in terms if (i, j) == (0, 0)]
    scale = terms[max(at_origin), 0, 0] if at_origin else ONE
    return _table_from({powers: c / scale for powers, c in terms.items()}, lowest=min(k for k, _, _ in terms))


def _table_from(terms: Terms, lowest: int) -> PlaneTable:
    """Return the table of a polynomial other than zero, divided by z^lowest."""
    highest = [max(powers[axis] for powers in terms) for axis in range(3)]
    return tuple(
        tuple(tuple(terms.get((k, i, j), ZERO) for j in range(highest[2] + 1)) for i in range(highest[1] + 1))
        for k in range(lowest, highest[0] + 1)
    )


def defect(table: PlaneTable, degree: int) -> list[Fraction]:
    """Return what an exact motion leaves over in P: the terms of one degree in mu_1, mu_2, as a list of coefficients.

    Feedback with roots mu_1 and mu_2 has alpha_hat = -(mu_1 + mu_2) and beta_hat = mu_1 mu_2, and exact motions
    e^(mu_1 t): P(e^mu_1; alpha_hat, beta_hat) would be zero. With beta_hat = -mu_1 (alpha_hat + mu_1) it is a
    power series in mu_1 and alpha_hat; entry i of the list belongs to mu_1^(degree - i) alpha_hat^i. An order of
    accuracy p makes all terms up to degree p + 1 vanish.
    """
    left_over = [ZERO] * (degree + 1)
    for k, in_plane in enumerate(table):
        for i, in_beta in enumerate(in_plane):
            for j, coefficient in enumerate(in_beta):
                n = degree - i - 2 * j  # the power of mu_1 that e^(k mu_1) must give
                if n < 0 or not coefficient:
                    continue
                growth = coefficient * Fraction(k**n, factorial(n)) * (-1) ** j
                for shared in range(j + 1):  # mu_1^j (alpha_hat + mu_1)^j
                    left_over[i + shared] += growth * comb(j, shared)
    return left_over
