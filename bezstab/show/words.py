"""Numbers as sentences have them: times, factors, and what becomes of an error from step to step."""

from bezstab.show.columns import Row, Value

MOST_DIGITS = 17  # of float64: with so many every number other than one is shown as another
THOUSAND = 1000.0
PLAIN = 1e7  # a factor from here on has so many zeros that nobody counts them
GONE = 1e-6  # of |z|: after three steps an error is below rounding; at a double root that is zero |z| comes out as 1e-8
UNITS = ((1.0, "s"), (1e-3, "ms"), (1e-6, "µs"))
"""Of times, the largest first: each with its seconds."""


def seconds_words(seconds: float) -> str:
    """Return a time (s) to three digits, in the unit that suits it: 1.56 ms; powers of ten where none does."""
    for size, unit in UNITS:
        if size <= seconds < THOUSAND * size:
            return f"{seconds / size:.3g} {unit}"
    return f"{seconds:.3g} s"


def growth_words(factor: Value) -> str:
    """Return how far something may be scaled up: to 1.32 times, or without limit where there is no factor."""
    return f"to {factor:.3g} times" if isinstance(factor, float) else "without limit"


def times_words(factor: float) -> str:
    """Return a factor to two digits, as a sentence has it: 0.25, 1.1, 3,400; powers of ten from ten millions on."""
    digits = f"{factor:.2g}"
    return f"{float(digits):,.0f}" if 100 <= float(digits) < PLAIN else digits


def change_words(z_abs: float, verdict: Value) -> str:
    """Return what an error does at every step by its proven verdict: shrinks 0.65-fold a step, grows, or neither.

    Two digits of the modulus, and as many more as it takes to tell it from one. Where rounding has left it on the wrong
    side of one, the verdict alone.
    """
    if verdict == "marginal":
        return "neither shrinks nor grows"
    converges = verdict == "converges"
    verb = "shrinks" if converges else "grows"
    if converges and z_abs < GONE:
        return "is gone within a few steps"
    if not (z_abs < 1 if converges else z_abs > 1):
        return f"{verb}, by less at a step than rounding shows"
    digits = next(digits for digits in range(2, MOST_DIGITS + 1) if float(f"{z_abs:.{digits}g}") != 1)
    return f"{verb} {z_abs:.{digits}g}-fold a step"


def safety_words(row: Row, error: str = "the error") -> str:
    """Return whether a point is safe and how fast errors shrink, from a row with `safe`, `verdict` and `z_abs`.

    With --scene also what they do over the motion, with --h-min that they do so with constant steps; of an engine that
    sweeps over its constraints, that one of them alone is meant. Without the last full stop.
    """
    safe = "Safe" if row["safe"] else "Not safe"
    if row["safe"] and row.get("sweeps"):
        safe = "One constraint alone: safe"
    z_abs, moving = row["z_abs"], row.get("z_abs_moving")
    assert isinstance(z_abs, float)
    constant = f" with steps that vary: {row['varying']}. With constant steps" if "varying" in row else ""
    at_rest = f"{error} {change_words(z_abs, row['verdict'])}"
    if constant and not isinstance(moving, float):
        return f"{safe}{constant} {at_rest}"
    if not isinstance(moving, float):
        return f"{safe}. {at_rest[0].upper()}{at_rest[1:]}"
    if row["moving_verdict"] in ("converges", "diverges"):
        return f"{safe}. At rest {at_rest}, over the motion it {change_words(moving, row['moving_verdict'])}"
    unsettled = f"{safe}. At rest {at_rest}; over the motion it is {row['moving_verdict']}"
    if row["double_pole"]:
        return (
            f"{unsettled}: nearly a double pole, which moves like (κh)^½, at worst {row['z_abs_worst']:.3g}-fold a step"
        )
    return unsettled
