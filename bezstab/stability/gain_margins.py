r"""Which of two gains is used up: how far alpha_hat alone, and beta_hat alone, is from where a point turns unstable.

beta_hat                      x a stable point: each gain may grow up to the edge
   |  \    edge               o an unstable one: each gain alone is lowered until it is stable again, if ever
   |---x--->\   o
   |        |\ <--
   +------------ alpha_hat
"""

from fractions import Fraction

from bezstab.stability.choices import Choice
from bezstab.stability.path_crossings import Path, first_stable_below


def gain_factors(choice: Choice) -> tuple[float | None, float | None]:
    """Return by which factors alpha_hat alone and beta_hat alone are at the edge of what is stable.

    Upwards from a stable point, else downwards, to where the proven verdict turns. A factor is infinite where there is
    no edge, None where lowering that gain alone does not help.
    """
    if choice.margins:
        return choice.margins.alpha[1], choice.margins.beta[1] ** 2
    point = Fraction(choice.alpha_hat), Fraction(choice.beta_hat)
    by_alpha, by_beta = (first_stable_below(Path(choice.method, *point, powers)) for powers in ((1, 0), (0, 2)))
    return None if by_alpha is None else float(by_alpha), None if by_beta is None else float(by_beta**2)
