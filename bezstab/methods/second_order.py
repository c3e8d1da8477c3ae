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
from bezstab.methods.polynomials import MuTable, PlaneTable, Polynomial, quotient_and_remainder
from bezstab.methods.schur import recursion_verdict
from bezstab.methods.step_equations import POSITION, VELOCITY, Equation, Evaluation, Quantity, in_order
from bezstab.rationals import ONE, ZERO

FURTHEST_BACK = -20  # steps
LATEST = 2  # step of a result: beyond the end of the step by as much as a multistep formula may be written


@dataclass(frozen=True)
class SecondOrder:
    """Equations for x1, v1, the accelerations and any helpers, each for one quantity.

    InputError unless every quantity is defined once, and not used later than it is there, and x1 and v1 are among them.
    """

    equations: tuple[Equation, ...]

    def __post_init__(self) -> None:
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
        if not self.evaluated:
            raise InputError("no equation evaluates the acceleration")
        for equation in self.equations:
            for quantity in equation.used:
                if quantity.name not in latest:
                    raise InputError(f"{equation.result}: no equation gives {quantity}")
                if quantity.step > latest[quantity.name].step:
                    raise InputError(
                        f"{equation.result}: uses {quantity}, but {latest[quantity.name]} is the latest there is"
                    )

    def check_motion(self) -> None:
        """Raise InputError unless the equations determine x1 and v1 from 20 steps, and are consistent and zero-stable.

        Consistent: a free motion x0 + v0 t is followed exactly and an acceleration acts in full. Zero-stable: without
        feedback z = 1 is a double root, all others lie inside the unit circle or are simple on it.
        """
        for equation in self.equations:
            for quantity in equation.used:
                if quantity.step < FURTHEST_BACK:
                    raise InputError(
                        f"{equation.result}: uses {quantity}: expected at most {-FURTHEST_BACK} steps back"
                    )
        free = [in_plane[0][0] for in_plane in self.table]
        if not free or not free[-1]:  # else without feedback, or with little, a step has no solution or many
            raise InputError("the equations do not determine x1 and v1")
        reduced, rest = quotient_and_remainder(free, (ONE, Fraction(-2), ONE))
        if any(rest) or not reduced:
            raise InputError("inconsistent: a free motion x0 + v0 t is not followed exactly")
        if any(any(defect(self.table, degree)) for degree in (1, 2)):
            raise InputError("inconsistent: an acceleration does not act in full, or feedback not as feedback")
        if sum(reduced) == 0 or recursion_verdict(reduced) == "diverges":
            raise InputError("zero-unstable: without feedback a root lies outside the unit circle, or repeats on it")
        if any(any(of_velocity) for _, of_velocity in map(self.left_over, (0, 1))):
            raise InputError("inconsistent: v1 is not the velocity of x1")

    @property
    def second_order(self) -> "SecondOrder":
        """The scheme itself."""
        return self

    @property
    def mu_table(self) -> MuTable:
        """Position and velocity may be stepped differently: no such polynomial, ()."""
        return ()

    @property
    def evaluated(self) -> tuple[Evaluation, ...]:
        """The equations that evaluate the acceleration."""
        return tuple(equation for equation in self.equations if isinstance(equation, Evaluation))

    @property
    def implicit(self) -> bool:
        """Whether some equations must be solved together."""
        return any(len(group) > 1 or group[0].result in group[0].used for group in self.groups)

    @property
    def oldest(self) -> int:
        """The earliest step that is looked back to, at most 0: 0 for a one-step method."""
        return min(0, *(quantity.step for equation in self.equations for quantity in equation.used))

    @property
    def steps(self) -> int:
        """The number of past points that a step uses."""
        return 1 - self.oldest

    @cached_property
    def groups(self) -> tuple[tuple[Equation, ...], ...]:
        """The equations in an order in which each can be taken; those that wait for each other form one group."""
        return tuple(in_order(self.equations))

    @cached_property
    def table(self) -> PlaneTable:
        """P(z; alpha_hat, beta_hat), the determinant, without roots z = 0 that no parameters move; a step of h.

        Leading coefficient one at alpha_hat = beta_hat = 0.
        """
        from bezstab.methods.determinants import determinant_table  # loads sympy

        return determinant_table(self.equations)

    @cached_property
    def responses(self) -> tuple[PlaneTable, PlaneTable]:
        """Polynomials in the ratio of x and v on every motion z^k, from the equations without one evaluation.

        InputError if no acceleration acts on x.
        """
        from bezstab.methods.determinants import responses  # loads sympy

        return responses(self.equations)

    def left_over(self, power: int) -> Iterator[Polynomial]:
        """Yield what an exact motion leaves over in P, of degree power + 1, and in v - mu x, of degree `power`.

        The one is relative to the roots that stay, the other to x. Entry i of each belongs to mu^(n - i) alpha_hat^i,
        beta_hat = -mu (alpha_hat + mu).
        """
        roots_that_stay = sum((comb(k, 2) * in_plane[0][0] for k, in_plane in enumerate(self.table)), ZERO)  # P''(1)/2
        yield [c / roots_that_stay for c in defect(self.table, power + 1)]
        position, velocity = self.responses
        size_of_x = sum((in_plane[0][0] for in_plane in position), ZERO)
        times_mu = [*defect(position, power - 1), ZERO]
        yield [(v - x) / size_of_x for v, x in zip(defect(velocity, power), times_mu, strict=True)]


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
