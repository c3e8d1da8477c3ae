"""Random second-order recipes for hypothesis: consistent and zero-stable by construction, explicit and implicit."""

from fractions import Fraction

from hypothesis import strategies as st

SMALL = st.fractions(min_value=-1, max_value=1, max_denominator=6)
INSIDE = st.fractions(min_value=Fraction(-4, 5), max_value=Fraction(4, 5), max_denominator=5)


def term(coefficient: Fraction, quantity: str) -> str:
    return f" + ({coefficient} {quantity})" if coefficient >= 0 else f" - {-coefficient} {quantity}"


@st.composite
def recipes(draw: st.DrawFn) -> dict[str, str]:
    """Return a recipe.

    Updates with any weights of old and new acceleration, evaluated between the ends of the step, perhaps twice; an
    acceleration that is smoothed from step to step; a position that relaxes to what the velocity says.
    """
    at_the_end = draw(st.booleans())  # of the step
    smoothed = draw(st.booleans())
    acceleration = "mean" if smoothed else "a"
    old, older, new = f"{acceleration}[0]", f"{acceleration}[-1]", f"{acceleration}[1]"
    to_x = [draw(SMALL) for _ in range(3)]
    new_weight, oldest_weight = draw(SMALL), draw(SMALL)
    relaxed = draw(INSIDE)
    back = draw(SMALL)
    equations = {
        "x1": f"x0 + v0{term(relaxed, '(x0 - x[-1] - v[-1])')}"
        + "".join(term(c, quantity) for c, quantity in zip(to_x, (old, older, new), strict=True)),
        "v1": "v0" + term(1 - new_weight - oldest_weight, old) + term(oldest_weight, older) + term(new_weight, new),
    }
    if at_the_end:
        place = f"{1 - back} x1{term(back, 'x0')}"
        speed = f"{1 - back} v1{term(back, 'v0')}{term(draw(SMALL), '(v1 - v0)')}"
    else:
        place = f"x0 + v0{term(back, old)}"
        speed = f"v0{term(draw(SMALL), old)}{term(draw(SMALL), older)}"
    evaluated = "force" if draw(st.booleans()) else "a1"
    equations[evaluated] = f"acceleration({place}, {speed})"
    if evaluated == "force":  # and once more at the start of the step
        share = draw(SMALL)
        equations["again"] = f"acceleration(x0{term(draw(SMALL), 'v0')}, v0)"
        equations["a1"] = f"0 v0{term(1 - share, 'force')}{term(share, 'again')}"
    if smoothed:
        memory = draw(INSIDE)
        equations["mean"] = f"0 v0{term(memory, 'mean[0]')}{term(1 - memory, 'a1')}"
    order = draw(st.permutations(list(equations)))
    return {name: equations[name] for name in order}
