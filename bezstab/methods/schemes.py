"""Integration methods as exact, frozen data that checks itself at birth.

A scheme is a formula, a method a scheme with its name, source, family and step:

    LinearMultistep      rho(E) y = h sigma(E) f                          B4, AB4, BDF2, trapezoidal rule
    PredictorCorrector   two of them: predict, evaluate, correct          ABM4
    RungeKutta           stages by a Butcher tableau A, weights b         RK4, SIE, SDIRK2
    SecondOrder          equations for x, v, a and helpers                SYM, Verlet, Newmark (second_order.py)
"""

from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction

from bezstab.errors import InputError
from bezstab.methods.schur import recursion_verdict
from bezstab.methods.second_order import SecondOrder

Coefficients = tuple[Fraction, ...]

ONE, ZERO = Fraction(1), Fraction(0)

LARGEST_COEFFICIENT = Fraction(10**100)

LEAST_STEP_MULTIPLE = Fraction("1e-6")
LARGEST_STEP_MULTIPLE = Fraction("1e6")  # six orders either way: beyond any use, and powers of it stay within float64


def _refuse_what_is_out_of_size(what: str, *coefficients: Fraction) -> None:
    """Raise InputError for a coefficient whose square float64 cannot hold: no method that is used has one."""
    for c in coefficients:
        if abs(c) > LARGEST_COEFFICIENT:
            found = Decimal(c.numerator) / c.denominator  # which may be too large for a float
            raise InputError(f"{what}: found {found:.3g}, expected numbers up to 1e100 in size")


@dataclass(frozen=True)
class LinearMultistep:
    """rho(E) y = h sigma(E) f: coefficients in descending powers of z, rho monic after construction.

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
        if recursion_verdict(self.rho) == "diverges":
            raise InputError("zero-unstable: rho has a root outside the unit circle, or a repeated one on it")
        leading = self.rho[0]
        object.__setattr__(self, "rho", tuple(a / leading for a in self.rho))
        object.__setattr__(self, "sigma", tuple(b / leading for b in self.sigma))
        _refuse_what_is_out_of_size("rho and sigma, with 1 in front of rho", *self.rho, *self.sigma)

    @property
    def steps(self) -> int:
        """The number of past values one step uses."""
        return len(self.rho) - 1

    @property
    def implicit(self) -> bool:
        """Whether f at the new point enters the step."""
        return self.sigma[0] != 0


@dataclass(frozen=True)
class PredictorCorrector:
    """PECE: the explicit predictor's value is evaluated once for the implicit corrector, whose value is evaluated.

    InputError unless the predictor is explicit, the corrector implicit, and both use the same number of past values.
    """

    predictor: LinearMultistep
    corrector: LinearMultistep

    def __post_init__(self) -> None:
        if self.predictor.implicit or not self.corrector.implicit or self.predictor.steps != self.corrector.steps:
            raise InputError("a predictor-corrector needs an explicit predictor, an implicit corrector, equal steps")


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

    def __post_init__(self) -> None:
        stages = len(self.weights)
        if stages == 0 or len(self.tableau) != stages or any(len(row) != stages for row in self.tableau):
            raise InputError(f"A must be square with a row for each of the {stages} weights b")
        if sum(self.weights) != 1:
            raise InputError(f"inconsistent: the weights b sum to {sum(self.weights)}, not 1")
        _refuse_what_is_out_of_size("A and b", *self.weights, *(a for row in self.tableau for a in row))

    @property
    def implicit(self) -> bool:
        """Whether some stage needs itself or a later one: an entry of A on or above the diagonal."""
        return any(a != 0 for i, row in enumerate(self.tableau) for a in row[i:])


Scheme = LinearMultistep | PredictorCorrector | RungeKutta | SecondOrder


@dataclass(frozen=True)
class Family:
    """What a method is by its coefficients, whatever it is called: B4 is number 4 of the family "Bezier".

    name: "Bezier", "Adams-Bashforth", "Adams-Bashforth-Moulton", "Runge-Kutta", "SIE" or "symplectic Euler".
    number: which member; 0 where a method is alone in its family.
    """

    name: str
    number: int


@dataclass(frozen=True)
class Method:
    """A scheme with its name and source; each of its steps spans `step_multiple` of the user's h (RK4@5: five).

    `family` is None for a scheme that belongs to no family known here. It takes part in equality, as what is
    remembered for a method (a start, a colour) may depend on it. `digits`: irrational coefficients have been replaced
    by rationals good to so many digits, which is what is proven about; None where the coefficients are the method's.
    InputError for a step multiple outside 1e-6 to 1e6.
    """

    name: str
    scheme: Scheme
    source: str
    step_multiple: Fraction = ONE
    family: Family | None = None
    digits: int | None = None

    def __post_init__(self) -> None:
        if not LEAST_STEP_MULTIPLE <= self.step_multiple <= LARGEST_STEP_MULTIPLE:
            raise InputError(f"step multiple {float(self.step_multiple):g}: expected 1e-6 to 1e6")


def steps(method: Method) -> int:
    """Return the number of past points the method uses: n for an n-step method, 1 for a one-step method."""
    match method.scheme:
        case LinearMultistep() as scheme:
            return scheme.steps
        case PredictorCorrector(predictor=scheme):
            return scheme.steps
        case RungeKutta():
            return 1
        case SecondOrder() as scheme:
            return 1 - scheme.oldest


def implicit(method: Method) -> bool:
    """Return whether a step has to solve equations for what it evaluates at."""
    match method.scheme:
        case LinearMultistep() | RungeKutta() | SecondOrder() as scheme:
            return scheme.implicit
        case PredictorCorrector():
            return False


def evaluations(method: Method) -> int:
    """Return the number of right-hand-side evaluations in one step of the method, whatever its step multiple.

    Of an implicit method: for one iteration.
    """
    match method.scheme:
        case LinearMultistep():
            return 1
        case PredictorCorrector():
            return 2
        case RungeKutta(weights=weights):
            return len(weights)
        case SecondOrder() as scheme:
            return scheme.evaluations
