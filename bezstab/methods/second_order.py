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

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from bezstab.errors import InputError
from bezstab.methods.polynomials import MuTable
from bezstab.methods.step_equations import POSITION, VELOCITY, Equation, Evaluation, Quantity, in_order

if TYPE_CHECKING:  # loads numpy
    from bezstab.methods.determinants import ExactArray

MOST_TOGETHER = 16  # equations, as of eight implicit stages: P takes two seconds
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
    def table(self) -> "ExactArray":
        """P(z; alpha_hat, beta_hat), the determinant, without roots z = 0 that no parameters move; a step of h.

        Leading coefficient one at alpha_hat = beta_hat = 0. InputError if more than 16 equations wait for each other:
        it would take too long.
        """
        if (together := max(map(len, self.groups))) > MOST_TOGETHER:
            raise InputError(f"{together} equations wait for each other: expected at most {MOST_TOGETHER}")
        from bezstab.methods.determinants import determinant_table  # loads sympy

        return determinant_table(self.equations)
