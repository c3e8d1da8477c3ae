"""Second-order schemes as text, and registered methods written as such."""

from bezstab.methods.recipes import recipe
from bezstab.methods.registry import lookup
from bezstab.methods.schemes import Method

RECIPES = {
    "implicit euler": {"a1": "acceleration(x1, v1)", "v1": "v0 + a1", "x1": "x0 + v1"},
    "beeman": {
        "x1": "x0 + v0 + 2/3 a0 - 1/6 a[-1]",
        "predicted": "v0 + 3/2 a0 - 1/2 a[-1]",
        "a1": "acceleration(x1, predicted)",
        "v1": "v0 + 1/3 a1 + 5/6 a0 - 1/6 a[-1]",
    },
    "B2 and B3": {
        "a0": "acceleration(x0, v0)",
        "x1": "x0 + 3/2 v0 - 1/2 v[-1]",
        "v1": "v0 + 19/12 a0 - 2/3 a[-1] + 1/12 a[-2]",
    },
    "AB3 and B3": {
        "a0": "acceleration(x0, v0)",
        "x1": "x0 + 23/12 v0 - 16/12 v[-1] + 5/12 v[-2]",
        "v1": "v0 + 19/12 a0 - 2/3 a[-1] + 1/12 a[-2]",
    },
}


def second_order(name: str) -> Method:
    """Return one of the recipes as a method."""
    return Method(name, recipe(RECIPES[name]), "")


def as_second_order(name: str) -> Method:
    """Return a registered method written as a second-order scheme."""
    method = lookup(name)
    return Method(f"{name} as x, v, a", method.scheme.second_order, "", method.step_multiple)
