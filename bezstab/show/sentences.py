"""What rows say, in words: for each kind of row the sentence above its block of lines."""

from bezstab.show.cells import safe_step_text
from bezstab.show.fields import Row


def step_sentence(row: Row) -> str:
    """Return up to which step alpha and beta are safe."""
    limit, judged = safe_step_text(row), f"α = {row['alpha']:.6g} 1/s, β = {row['beta']:.6g} 1/s"
    if limit == "none":
        return f"{judged}: not safe at small steps."
    return f"{judged}: safe {'at any h' if limit == 'unlimited' else f'up to h = {limit} s'}."


def one_pole_sentence(row: Row) -> str:
    """Return what the part of the error does that belongs to one pole of several."""
    return f"{row['method']} {row['verdict']}. The part of the error with this pole is |z| times as large each step."
