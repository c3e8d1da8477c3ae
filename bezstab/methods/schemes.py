"""Integration methods as exact, frozen data that checks itself at birth.

A scheme is a formula, a method a scheme with its name, source, family and step:

    LinearMultistep      rho(E) y = h sigma(E) f                          B4, AB4, BDF2, trapezoidal rule
    PredictorCorrector   two of them: predict, evaluate, correct          ABM4
    RungeKutta           stages by a Butcher tableau A, weights b         RK4, SIE, SDIRK2
    SecondOrder          equations for x, v, a and helpers                SYM, Verlet, Newmark (second_order.py)

Whatever a scheme is, it says how many past points it uses (`steps`), and what its step is as equations for x, v and a
(`second_order`), in which the state is y = (x, v) and its slope f = (v, a). From these follow whether a step solves
equations, how often it evaluates, P(z; alpha_hat, beta_hat) and the order of accuracy.

On y' = lambda y all but a SecondOrder are a polynomial pi(z, mu), mu = h lambda: `mu_table`, C with
pi = sum_kj C[k][j] z^k mu^j. It has `steps` + 1 rows, one column for each power of mu, and is monic in z for mu = 0;
for every mu unless implicit. P is its product over both mu of the feedback.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property

from bezstab.errors import InputError
from bezstab.methods.polynomials import MuTable, polynomial_gcd
from bezstab.methods.schur import recursion_verdict
from bezstab.methods.second_order import SecondOrder
from bezstab.methods.step_equations import (
    ACCELERATION,
    POSITION,
    STATE,
    VELOCITY,
    Assignment,
    Combination,
    Equation,
    Evaluation,
    Quantity,
)
from bezstab.rationals import ONE, ZERO

Coefficients = tuple[Fraction, ...]

LEAST_STEP_MULTIPLE = Fraction("1e-6")
LARGEST_STEP_MULTIPLE = Fraction("1e6")  # six orders either way: beyond any use, and powers of it stay within float64


Weighted = Sequence[tuple[Fraction, str, int]]
"""Weights of states or of slopes, by what stands in front of their name, and their step."""


def _moved(part: str, states: Weighted, slopes: Weighted) -> Combination:
    """Return a sum of states and slopes, of x or of v: the slope of x is v, that of v is a."""
    slope = VELOCITY if part == POSITION else ACCELERATION
    named = [
        (c, Quantity(prefix + name, step))
        for name, terms in ((part, states), (slope, slopes))
        for c, prefix, step in terms
    ]
    return tuple((c, quantity) for c, quantity in named if c)


def _state(new: str, states: Weighted, slopes: Weighted) -> list[Equation]:
    """Return the assignments to a new x and v."""
    return [Assignment(Quantity(new + part, 1), _moved(part, states, slopes)) for part in (POSITION, VELOCITY)]


def _evaluated(state: str, step: int) -> Evaluation:
    """Return the evaluation at an x and v."""
    position, velocity = (((ONE, Quantity(state + part, step)),) for part in (POSITION, VELOCITY))
    return Evaluation(Quantity(state + ACCELERATION, step), position, velocity)


@dataclass(frozen=True)
class LinearMultistep:
    """rho(E) y = h sigma(E) f: coefficients from the newest value back, as files have them; rho begins with 1.

    InputError unless the method is consistent (rho(1) = 0, sigma(1) = rho'(1)) and zero-stable (the roots of rho in
    the closed unit disc, those on the circle simple): Hairer, Norsett & Wanner I, section III.2-3.
    """

    rho: Coefficients
    sigma: Coefficients

    def __post_init__(self) -> None:
        if len(self.rho) != len(self.sigma) or len(self.rho) < 2:
            raise InputError("rho and sigma must have the same number of coefficients, at least two")
        if self.rho[0] == 0:
            raise InputError("the leading coefficient of rho is 0")
        if sum(self.rho) != 0:
            raise InputError(f"inconsistent: rho(1) = {sum(self.rho)}, not 0")
        slope = sum(((self.steps - i) * a for i, a in enumerate(self.rho)), ZERO)
        if sum(self.sigma) != slope:
            raise InputError(f"inconsistent: sigma(1) = {sum(self.sigma)}, but rho'(1) = {slope}")
        if recursion_verdict(self.rho[::-1]) == "diverges":
            raise InputError("zero-unstable: rho has a root outside the unit circle, or a repeated one on it")
        shared = polynomial_gcd(self.rho[::-1], self.sigma[::-1])
        if any(shared[:-1]):  # a pole other than 0 that no feedback moves
            from bezstab.methods.determinants import in_words  # loads sympy

            raise InputError(f"ρ and σ share the factor {in_words(shared)}: cancel it")
        leading = self.rho[0]
        object.__setattr__(self, "rho", tuple(a / leading for a in self.rho))
        object.__setattr__(self, "sigma", tuple(b / leading for b in self.sigma))

    @property
    def steps(self) -> int:
        """The number of past values one step uses."""
        return len(self.rho) - 1

    @property
    def implicit(self) -> bool:
        """Whether f at the new point enters the step."""
        return self.sigma[0] != 0

    @cached_property
    def mu_table(self) -> MuTable:
        """rho(z) - mu sigma(z)."""
        return tuple((a, -b) for a, b in zip(self.rho[::-1], self.sigma[::-1], strict=True))

    @cached_property
    def second_order(self) -> SecondOrder:
        """The equations of a step, which evaluates the acceleration at the newest point that it needs."""
        new = self.end("")
        return SecondOrder((*new, _evaluated("", 1)) if self.implicit else (_evaluated("", 0), *new))

    def end(self, new: str, newest_slope: str = "") -> list[Equation]:
        """Return the assignments to x and v at the end of the step, called so with `new` in front.

        `newest_slope` stands in front of what their slopes there are called.
        """
        states = [(-a, "", -j) for j, a in enumerate(self.rho[1:])]
        slopes = [(b, "" if j else newest_slope, 1 - j) for j, b in enumerate(self.sigma)]
        return _state(new, states, slopes)


@dataclass(frozen=True)
class PredictorCorrector:
    """PECE: the explicit predictor's value is evaluated once for the implicit corrector, whose value is evaluated.

    Both use the same number of past values.
    """

    predictor: LinearMultistep
    corrector: LinearMultistep

    @property
    def steps(self) -> int:
        """The number of past values one step uses."""
        return self.corrector.steps

    @cached_property
    def mu_table(self) -> MuTable:
        """The corrector's pi with the predictor's value in place of the new one."""
        b = self.corrector.sigma[0]
        pairs = zip(self.corrector.mu_table, self.predictor.mu_table, strict=True)
        return tuple((rho, slope + b * predicted, b * by_mu) for (rho, slope), (predicted, by_mu) in pairs)

    @cached_property
    def second_order(self) -> SecondOrder:
        """The equations of a step: evaluate, predict, evaluate, correct."""
        predicted, corrected = self.predictor.end("predicted_"), self.corrector.end("", newest_slope="predicted_")
        return SecondOrder((_evaluated("", 0), *predicted, _evaluated("predicted_", 1), *corrected))


@dataclass(frozen=True)
class RungeKutta:
    """A Runge-Kutta method by its Butcher tableau; explicit where A is strictly lower triangular.

        0    |
        a_21 | 0             K_i = f(y_k + h sum_j a_ij K_j)
        a_31 | a_32  0       y_{k+1} = y_k + h sum_i b_i K_i
        -----+-----------
             | b_1 b_2 b_3

    InputError unless it is consistent (the weights sum to one).
    """

    tableau: tuple[Coefficients, ...]
    weights: Coefficients

    steps = 1

    def __post_init__(self) -> None:
        stages = len(self.weights)
        if stages == 0 or len(self.tableau) != stages or any(len(row) != stages for row in self.tableau):
            raise InputError(f"A must be square with a row for each of the {stages} weights b")
        if sum(self.weights) != 1:
            raise InputError(f"inconsistent: the weights b sum to {sum(self.weights)}, not 1")

    @cached_property
    def mu_table(self) -> MuTable:
        """z - R(mu) times det(I - mu A), which is one for an explicit method, from P(z; -mu, 0) = (z - 1) pi(z, mu)."""
        constant, _, leading = self.second_order.table[:, :, 0].tolist()
        return tuple(-c * (-1) ** j for j, c in enumerate(constant)), tuple(
            c * (-1) ** j for j, c in enumerate(leading)
        )

    @cached_property
    def second_order(self) -> SecondOrder:
        """The equations of the stages, V_i = v + sum_j a_ij A_j and X_i = x + sum_j a_ij V_j, and of the step."""
        start = [(ONE, "", 0)]
        *stages, end = (
            [(weight, f"stage_{j}_", 1) for j, weight in enumerate(row)] for row in (*self.tableau, self.weights)
        )
        equations: list[Equation] = []
        for i, slopes in enumerate(stages):
            velocity = Quantity(f"stage_{i}_{VELOCITY}", 1)
            equations.append(Assignment(velocity, _moved(VELOCITY, start, slopes)))
            evaluated = Quantity(f"stage_{i}_{ACCELERATION}", 1)
            equations.append(Evaluation(evaluated, _moved(POSITION, start, slopes), ((ONE, velocity),)))
        return SecondOrder((*equations, *_state("", start, end)))


Scheme = LinearMultistep | PredictorCorrector | RungeKutta | SecondOrder


@dataclass(frozen=True)
class Method:
    """A scheme with its name and source; each of its steps spans `step_multiple` of the user's h (RK4@5: five).

    `digits`: irrational coefficients have been replaced by rationals good to so many digits, which is what is proven
    about; None where the coefficients are the method's. InputError for a step multiple outside 1e-6 to 1e6.
    """

    name: str
    scheme: Scheme
    source: str
    step_multiple: Fraction = ONE
    digits: int | None = None

    def __post_init__(self) -> None:
        if not LEAST_STEP_MULTIPLE <= self.step_multiple <= LARGEST_STEP_MULTIPLE:
            raise InputError(f"step multiple {float(self.step_multiple):g}: expected 1e-6 to 1e6")

    @property
    def rounding(self) -> Fraction:
        """How far off a sum of coefficients may be that is zero without rounding: as far as all but two digits go."""
        return ZERO if self.digits is None else Fraction(100, 10**self.digits)


@dataclass(frozen=True)
class MethodGroup:
    """Methods that are listed together: what makes each of them, by its name; a line about their names if needed."""

    heading: str
    methods: Mapping[str, Callable[[], Method]]
    note: str = ""


def steps(method: Method) -> int:
    """Return the number of past points the method uses: n for an n-step method, 1 for a one-step method."""
    return method.scheme.steps


def implicit(method: Method) -> bool:
    """Return whether a step has to solve equations for what it evaluates at."""
    return method.scheme.second_order.implicit


def evaluations(method: Method) -> int:
    """Return the number of right-hand-side evaluations in one step of the method, whatever its step multiple.

    Of an implicit method: for one iteration.
    """
    return len(method.scheme.second_order.evaluated)


def check_one_step(method: Method) -> None:
    """Raise InputError unless the state at the end of a step follows from x, v and a at its start alone."""
    equations = method.scheme.second_order.equations
    results = {equation.result for equation in equations}
    carried = {quantity for equation in equations for quantity in equation.used} - results
    if any(quantity.name not in STATE or quantity.step != 0 for quantity in carried):
        raise InputError(
            f"{method.name} uses values of several steps, and its coefficients assume that these are of equal length: "
            "steps that vary cannot be judged"
        )
