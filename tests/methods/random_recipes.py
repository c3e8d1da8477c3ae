"""Random second-order recipes: consistent and zero-stable by construction, explicit and implicit."""

import random
from collections.abc import Sequence
from fractions import Fraction
from typing import Protocol

from hypothesis import strategies as st

from tests.reference.rationals import rationals

SMALL = rationals(-1, 1, max_denominator=6)
INSIDE = rationals(Fraction(-4, 5), Fraction(4, 5), max_denominator=5)


class Choices(Protocol):
    """Who decides what a random recipe is like."""

    def small(self) -> Fraction:
        """Return a number of size one at most."""

    def inside(self) -> Fraction:
        """Return a root inside the unit circle."""

    def coin(self) -> bool:
        """Return either truth value."""

    def order(self, names: Sequence[str]) -> list[str]:
        """Return the names in any order."""


class Drawn:
    """Choices by hypothesis."""

    def __init__(self, draw: st.DrawFn) -> None:
        self.draw = draw

    def small(self) -> Fraction:
        return self.draw(SMALL)

    def inside(self) -> Fraction:
        return self.draw(INSIDE)

    def coin(self) -> bool:
        return self.draw(st.booleans())

    def order(self, names: Sequence[str]) -> list[str]:
        return self.draw(st.permutations(names))


class Seeded:
    """Choices by a generator of random numbers, the same on every machine."""

    def __init__(self, rng: random.Random) -> None:
        self.rng = rng

    def small(self) -> Fraction:
        denominator = self.rng.randint(1, 6)
        return Fraction(self.rng.randint(-denominator, denominator), denominator)

    def inside(self) -> Fraction:
        denominator = self.rng.randint(2, 5)
        return Fraction(self.rng.randint(1 - denominator, denominator - 1), denominator)

    def coin(self) -> bool:
        return self.rng.random() < 0.5

    def order(self, names: Sequence[str]) -> list[str]:
        return self.rng.sample(names, len(names))


def term(coefficient: Fraction, quantity: str) -> str:
    return f" + ({coefficient} {quantity})" if coefficient >= 0 else f" - {-coefficient} {quantity}"


def random_recipe(choices: Choices) -> dict[str, str]:
    """Return a recipe.

    Updates with any weights of old and new acceleration, evaluated between the ends of the step, perhaps twice; an
    acceleration that is smoothed from step to step; a position that relaxes to what the velocity says.
    """
    at_the_end = choices.coin()  # of the step
    smoothed = choices.coin()
    acceleration = "mean" if smoothed else "a"
    old, older, new = f"{acceleration}[0]", f"{acceleration}[-1]", f"{acceleration}[1]"
    to_x = [choices.small() for _ in range(3)]
    new_weight, oldest_weight = choices.small(), choices.small()
    relaxed = choices.inside()
    back = choices.small()
    equations = {
        "x1": f"x0 + v0{term(relaxed, '(x0 - x[-1] - v[-1])')}"
        + "".join(term(c, quantity) for c, quantity in zip(to_x, (old, older, new), strict=True)),
        "v1": "v0" + term(1 - new_weight - oldest_weight, old) + term(oldest_weight, older) + term(new_weight, new),
    }
    if at_the_end:
        place = f"{1 - back} x1{term(back, 'x0')}"
        speed = f"{1 - back} v1{term(back, 'v0')}{term(choices.small(), '(v1 - v0)')}"
    else:
        place = f"x0 + v0{term(back, old)}"
        speed = f"v0{term(choices.small(), old)}{term(choices.small(), older)}"
    evaluated = "force" if choices.coin() else "a1"
    equations[evaluated] = f"acceleration({place}, {speed})"
    if evaluated == "force":  # and once more at the start of the step
        share = choices.small()
        equations["again"] = f"acceleration(x0{term(choices.small(), 'v0')}, v0)"
        equations["a1"] = f"0 v0{term(1 - share, 'force')}{term(share, 'again')}"
    if smoothed:
        memory = choices.inside()
        equations["mean"] = f"0 v0{term(memory, 'mean[0]')}{term(1 - memory, 'a1')}"
    order = choices.order(list(equations))
    return {name: equations[name] for name in order}


@st.composite
def recipes(draw: st.DrawFn) -> dict[str, str]:
    """Return a recipe whose choices are hypothesis'."""
    return random_recipe(Drawn(draw))
