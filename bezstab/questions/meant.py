"""Were alpha and beta meant in 1/s where alpha_hat and beta_hat were typed?"""

from collections.abc import Sequence
from fractions import Fraction

from bezstab.engines.conversions import Point
from bezstab.methods.schemes import Method
from bezstab.stability.choices import describe_point
from bezstab.stability.closed_loop import verdict
from bezstab.units import to_dimensionless
from bezstab.words import SLOWLY

LARGE = 10
"""Above this alpha_hat or beta_hat 1/s was probably meant: as alpha_hat it leaves e^-5 of an error after a step."""


def meant_in_seconds(methods: Sequence[Method], point: Point, h: Fraction | None) -> bool:
    """Return whether numbers that were given as alpha_hat and beta_hat may be alpha and beta in 1/s.

    They may if no method is stable there and one of the numbers is above LARGE; and with a step (s) if errors then fall
    with some method, and not SLOWLY.
    """
    if max(point) > LARGE and not any(verdict(method, *point) == "converges" for method in methods):
        return True
    if h is None:
        return False
    in_seconds = to_dimensionless(*point, h)
    for method in methods:
        steps = describe_point(method, "as given", *in_seconds).settle_steps
        if steps is not None and steps * h * method.step_multiple < SLOWLY:
            return True
    return False
