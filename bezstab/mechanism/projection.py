"""Projection: after each step the new state is brought back to the constraints, in the metric of the masses.

Positions go to c(q, t) = 0 by Newton's method, then velocities to cdot = C_q v + c_t = 0 by one solution:

    dq = -M^-1 C_q^T S^-1 c        again and again, S = C_q M^-1 C_q^T
    dv = -M^-1 C_q^T S^-1 cdot     once, at the projected position

Each is the least change that does it, in the norm of the kinetic energy: M dq is orthogonal to all that the constraints
let move. There is no feedback: between projections, 2 alpha = beta^2 = 0. S is what accelerations factor, too, and is
factored the same way.

Sources: E. Eich, Convergence results for a coordinate projection method applied to mechanical systems with algebraic
constraints, SIAM J. Numer. Anal. 30 (1993) 1467; U. Ascher, H. Chin, L. Petzold and S. Reich, Stabilization of
constrained mechanical systems with DAEs and invariant manifolds, Mech. Struct. Mach. 23 (1995) 135. Left out is the
stabilised index-2 formulation of C. W. Gear, G. K. Gupta and B. Leimkuhler, Automatic integration of Euler-Lagrange
equations with constraints, J. Comput. Appl. Math. 12 (1985) 77: it adds multipliers to q' = v and solves for them
within the step of an implicit method.
"""

from dataclasses import dataclass
from typing import Literal

from bezstab.errors import InputError
from bezstab.mechanism.second_order_memory import memory
from bezstab.methods import Method, second_order_form

Stabilise = Literal["baumgarte", "projection", "none"]
"""What holds the constraints: feedback on their errors, projection after each step, or nothing but c'' = 0."""


@dataclass(frozen=True)
class Projection:
    """How positions are projected: by so many iterations at most, or by as many as it takes to get within 1e-12.

    What is projected of a multistep method is its newest state. The history stays as it was, each state of it as it was
    projected when it was the newest; accelerations stay those of the states before they were projected. That changes
    a step by no more than its own error does, so that the order of accuracy stays. InputError unless `iterations` is
    None or at least 1.
    """

    iterations: int | None = None

    def __post_init__(self) -> None:
        if self.iterations is not None and self.iterations < 1:
            raise InputError(f"iterations {self.iterations}: expected at least 1")


def check_projected(method: Method) -> None:
    """Raise InputError for a method whose position is a step ahead of its velocity: no turn ends with a state."""
    if memory(second_order_form(method.scheme)).newest:
        raise InputError(
            f"projection: {method.name} has its position a step ahead of its velocity: "
            "expected a method that has both at once"
        )
