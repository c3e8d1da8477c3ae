"""What holds the constraints of a run: feedback, projection, or nothing; and what is done to each new state for that.

Projection brings a state back to the constraints, in the metric of the masses. Positions go to c(q, t) = 0 by Newton's
method, then velocities to cdot = C_q v + c_t = 0 by one solution:

    dq = -M^-1 C_q^T S^-1 c        again and again, S = C_q M^-1 C_q^T
    dv = -M^-1 C_q^T S^-1 cdot     once, at the projected position

Each is the least change that does it, in the norm of the kinetic energy: M dq is orthogonal to all that the constraints
let move. There is no feedback: between projections, 2 alpha = beta^2 = 0. S is what accelerations factor, too, and is
factored the same way.

What is projected of a multistep method is its newest state. The history stays as it was, each state of it as it was
projected when it was the newest; accelerations stay those of the states before they were projected. That changes a step
by no more than its own error does, so that the order of accuracy stays.

Sources: E. Eich, Convergence results for a coordinate projection method applied to mechanical systems with algebraic
constraints, SIAM J. Numer. Anal. 30 (1993) 1467; U. Ascher, H. Chin, L. Petzold and S. Reich, Stabilization of
constrained mechanical systems with DAEs and invariant manifolds, Mech. Struct. Mach. 23 (1995) 135. Left out is the
stabilised index-2 formulation of C. W. Gear, G. K. Gupta and B. Leimkuhler, Automatic integration of Euler-Lagrange
equations with constraints, J. Comput. Appl. Math. 12 (1985) 77: it adds multipliers to q' = v and solves for them
within the step of an implicit method.
"""

from typing import Literal, NamedTuple

from bezstab.errors import InputError

Stabilise = Literal["baumgarte", "projection", "none"]

STABILISE: dict[Stabilise, str] = {
    "baumgarte": "by feedback with α and β",
    "projection": "each new state is moved onto the constraints, by the least change in the metric of the masses",
    "none": "not at all (α = β = 0)",
}
"""What may hold the constraints, each with how it does."""


class AfterStep(NamedTuple):
    """What is done to each new state, as the numbers that the loop of steps reads.

    `projecting`: it is projected, its position by at most so many `iterations` of Newton's method or, where that is 0,
    by as many as it takes to get within 1e-12.
    """

    projecting: bool = False
    iterations: int = 0


NOTHING = AfterStep()


def after_step(stabilise: str, iterations: int | None = None) -> AfterStep:
    """Return what is done to each new state, with at most so many iterations; by default as many as it takes.

    InputError for another word than those of `Stabilise`, for iterations below 1, and where there are none.
    """
    if stabilise not in STABILISE:
        raise InputError(f"--stabilise {stabilise!r}: expected {', '.join(STABILISE)}")
    if stabilise != "projection":
        if iterations is not None:
            raise InputError("--iterations needs --stabilise projection: they are its iterations")
        return NOTHING
    if iterations is not None and iterations < 1:
        raise InputError(f"iterations {iterations}: expected at least 1")
    return AfterStep(projecting=True, iterations=iterations or 0)


def held_by(after: AfterStep, feedback: bool) -> Stabilise:
    """Return what holds the constraints of a run with this after each step, with feedback or without."""
    if after.projecting:
        return "projection"
    return "baumgarte" if feedback else "none"
