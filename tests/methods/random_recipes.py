"""Random second-order recipes: consistent and zero-stable by construction, explicit and implicit."""

import random
from fractions import Fraction

from hypothesis import strategies as st

VERLET = {
    "x1": "x0 + v0 + 1/2 a0",
    "vh": "v0 + 1/2 a0",
    "a1": "acceleration(x1, vh)",
    "v1": "vh + 1/2 a1",
}  # fmt: skip
"""Velocity Verlet as a user may write it, the feedback with the velocity of the half step."""


def term(coefficient: Fraction, quantity: str) -> str:
    return f" + ({coefficient} {quantity})" if coefficient >= 0 else f" - {-coefficient} {quantity}"


def random_recipe(rng: random.Random) -> dict[str, str]:
    """Return a recipe.

    Updates with any weights of old and new acceleration, evaluated between the ends of the step, perhaps twice; an
    acceleration that is smoothed from step to step; a position that relaxes to what the velocity says.
    """

    def coin() -> bool:
        return rng.random() < 0.5

    def small() -> Fraction:
        """Return a number of size one at most."""
        denominator = rng.randint(1, 6)
        return Fraction(rng.randint(-denominator, denominator), denominator)

    def inside() -> Fraction:
        """Return a root inside the unit circle."""
        denominator = rng.randint(2, 5)
        return Fraction(rng.randint(1 - denominator, denominator - 1), denominator)

    at_the_end = coin()  # of the step
    smoothed = coin()
    acceleration = "mean" if smoothed else "a"
    old, older, new = f"{acceleration}[0]", f"{acceleration}[-1]", f"{acceleration}[1]"
    to_x = [small() for _ in range(3)]
    new_weight, oldest_weight = small(), small()
    relaxed = inside()
    back = small()
    equations = {
        "x1": f"x0 + v0{term(relaxed, '(x0 - x[-1] - v[-1])')}"
        + "".join(term(c, quantity) for c, quantity in zip(to_x, (old, older, new), strict=True)),
        "v1": "v0" + term(1 - new_weight - oldest_weight, old) + term(oldest_weight, older) + term(new_weight, new),
    }
    if at_the_end:
        place = f"{1 - back} x1{term(back, 'x0')}"
        speed = f"{1 - back} v1{term(back, 'v0')}{term(small(), '(v1 - v0)')}"
    else:
        place = f"x0 + v0{term(back, old)}"
        speed = f"v0{term(small(), old)}{term(small(), older)}"
    evaluated = "force" if coin() else "a1"
    equations[evaluated] = f"acceleration({place}, {speed})"
    if evaluated == "force":  # and once more at the start of the step
        share = small()
        equations["again"] = f"acceleration(x0{term(small(), 'v0')}, v0)"
        equations["a1"] = f"0 v0{term(1 - share, 'force')}{term(share, 'again')}"
    if smoothed:
        memory = inside()
        equations["mean"] = f"0 v0{term(memory, 'mean[0]')}{term(1 - memory, 'a1')}"
    order = rng.sample(list(equations), len(equations))
    return {name: equations[name] for name in order}


RECIPES = st.randoms().map(random_recipe)
"""Recipes whose choices are hypothesis'."""
