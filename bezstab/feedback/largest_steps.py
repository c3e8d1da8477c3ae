"""Up to which step is every step stable with alpha and beta in 1/s? What `check` and `choose` answer without --h."""

import math
from dataclasses import dataclass
from fractions import Fraction

from bezstab.arguments import Number, exact_number, in_keywords
from bezstab.methods.registry import method as method_named
from bezstab.methods.schemes import Method
from bezstab.rationals import rounded_down
from bezstab.stability.path_ends import stable_up_to


@dataclass(frozen=True, repr=False)
class StepAnswer:
    """The step (s) up to which every step is stable with a method, alpha and beta (1/s): infinite if all are.

    safe: whether small steps are stable at all; else h_limit is zero.
    """

    method: Method
    alpha: float
    beta: float
    h_limit: float
    safe: bool
    sentence: str

    def __repr__(self) -> str:
        return self.sentence

    def __bool__(self) -> bool:
        return self.safe


def step_answer(method: Method, alpha: Fraction, beta: Fraction) -> StepAnswer:
    """Return up to which step every one is stable with alpha and beta (1/s). In its sentence it is rounded down."""
    h_limit = stable_up_to(method, alpha, beta)
    safe = "not safe at small steps"
    if h_limit:
        safe = "safe at any h" if math.isinf(h_limit) else f"safe up to h = {limit_words(h_limit)} s"
    sentence = f"α = {float(alpha):.6g} 1/s, β = {float(beta):.6g} 1/s: {safe}."
    return StepAnswer(method, float(alpha), float(beta), h_limit, h_limit > 0, sentence)


def limit_words(h_limit: float) -> str:
    """Return such a step (s) to four digits, rounded down; it is known to a part in 1e9, so 0.04 is not 0.03999."""
    return rounded_down(float(f"{h_limit:.9g}"), 4)


@in_keywords()
def largest_step(method: str | Method, *, alpha: Number, beta: Number) -> float:
    """Return the step (s) up to which every step is stable with alpha and beta.

    Parameters
    ----------
    method : str or Method
        The integration method.
    alpha, beta : number or str
        The feedback in 1/s.

    Returns
    -------
    float
        Infinite if every step is stable, 0 if small ones are not. The verdict is proven on both sides.

    Raises
    ------
    InputError
        A number is not finite.

    References
    ----------
    The path of all steps through the plane of the paper's Eq. 17.
    """
    return stable_up_to(method_named(method), exact_number(alpha, "alpha"), exact_number(beta, "beta"))
