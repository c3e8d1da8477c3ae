"""What rows say, in words: for each kind of row the sentence above its block of lines."""

from bezstab.show.cells import order_text, safe_step_text
from bezstab.show.fields import Row
from bezstab.words import counted


def step_sentence(row: Row) -> str:
    """Return up to which step alpha and beta are safe."""
    limit, judged = safe_step_text(row), f"α = {row['alpha']:.6g} 1/s, β = {row['beta']:.6g} 1/s"
    if limit == "none":
        return f"{judged}: not safe at small steps."
    return f"{judged}: safe {'at any h' if limit == 'unlimited' else f'up to h = {limit} s'}."


def one_pole_sentence(row: Row) -> str:
    """Return what the part of the error does that belongs to one pole of several."""
    return f"{row['method']} {row['verdict']}. The part of the error with this pole is |z| times as large each step."


def region_sentence(row: Row) -> str:
    """Return how large the region of a method is, and where in it errors shrink fastest."""
    what = "is stable" if row["z_abs_below"] == 1 else f"has |z_p| < {row['z_abs_below']:g}"
    if row["alpha_hat_max"] is None and row["bounded"]:
        return f"{row['method']} {what} nowhere."
    size = "in a region without end" if row["area"] is None else f"in a region of area {row['area']:.3g}"
    if row["islands"]:
        size += f" (and on islands, near α̂, β̂ = {row['islands']})"
    if row["best_z_abs"] is None:
        return f"{row['method']} {what} {size}."
    best = f"({row['best_alpha_hat']:.4g}, {row['best_beta_hat']:.4g})"
    return f"{row['method']} {what} {size}; the least |z_p| is {row['best_z_abs']:.3g}, at α̂, β̂ = {best}."


def method_sentence(row: Row) -> str:
    """Return what a method is: explicit or not, its order, what a step of it costs."""
    kind = "implicit" if row["implicit"] else "explicit"
    each = "iteration" if row["implicit"] else "step"
    cost = counted(row["evaluations"], "evaluation")
    return f"{row['method']} is {kind}, of order {order_text(row)}, with {cost} in each {each}."


def whole_method_sentence(row: Row) -> str:
    """Return that, and the order that strong feedback leaves it, for a method that is shown whole."""
    left = "keep that order" if row["order_left"] == row["order"] else f"are of order {row['order_left']}"
    return f"{method_sentence(row)} With α̂ and β̂ held as h shrinks, constraint errors {left}."
