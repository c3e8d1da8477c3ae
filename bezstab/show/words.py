"""Numbers as sentences have them: times, factors, and what becomes of an error from step to step."""

from bezstab.show.fields import Row, Value

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


def growth_words(factor: float | None) -> str:
    """Return how far something may grow: 1.32-fold, or without limit where there is no factor."""
    return "without limit" if factor is None else f"{factor:.3g}-fold"


def times_words(factor: float) -> str:
    """Return a factor to two digits, as a sentence has it: 0.25, 1.1, 3,400; powers of ten from ten millions on."""
    digits = f"{factor:.2g}"
    return f"{float(digits):,.0f}" if 100 <= float(digits) < PLAIN else digits


def change_words(z_abs: float, verdict: Value, what: str = "error", bound: str = "") -> str:
    """Return what a step does to an error by its proven verdict: each step multiplies the error by 0.65.

    The error, or `what` else: of a damper alone it is the velocity.

    Two digits of the modulus, and as many more as it takes to tell it from one. Where rounding has left it on the wrong
    side of one, the verdict alone. `bound` says that it is at most, or at least, so much.
    """
    if verdict == "marginal":
        return f"the {what} neither shrinks nor grows"
    converges = verdict == "converges"
    if converges and z_abs < GONE:
        return f"the {what} is gone within a few steps"
    if not (z_abs < 1 if converges else z_abs > 1):
        return f"the {what} {'shrinks' if converges else 'grows'}, by less at a step than rounding shows"
    digits = next(digits for digits in range(2, MOST_DIGITS + 1) if float(f"{z_abs:.{digits}g}") != 1)
    return f"each step multiplies the {what} by {bound}{z_abs:.{digits}g}"


def safety_words(row: Row) -> str:
    """Return in a sentence or two whether a point is safe and what a step does to errors.

    From a row with `safe`, `verdict` and `z_abs`. With --scene also what happens over the motion, with --h-min what
    steps that vary do; of an engine that solves its constraints one after another, for how many that is.
    """
    if "swept_z_abs" in row:
        return swept_words(row)
    safe = "Safe" if row["safe"] else "Not safe"
    if row.get("sweeps"):
        safe = f"One constraint alone: {safe.lower()}"
    at_rest = change_words(row["z_abs"], row["verdict"])
    varying = f" when steps vary ({row['varying']})" if "varying" in row else ""
    if "moving_verdict" not in row:
        begin = f"With constant steps {at_rest}" if varying else at_rest[0].upper() + at_rest[1:]
        return f"{safe}{varying}. {begin}."
    return f"{safe}{varying}. At rest {at_rest}. {_in_motion(row)}."


def _in_motion(row: Row) -> str:
    """Return what a step at most or at least does to an error as the mechanism moves, or why that is not settled."""
    least, most = row["z_abs_at_least"], row["z_abs_at_most"]
    if row["moving_verdict"] == "converges":
        return f"In motion {change_words(most, 'converges', bound='at most ')}"
    if row["moving_verdict"] == "diverges":
        return f"In motion {change_words(least, 'diverges', bound='at least ')}"
    if most is not None and most < 1:
        return "In motion it is not settled: the constraints turn too far in a step, or faster than the feedback works"
    how = "two poles nearly meet there" if most is None else f"a step may multiply the error by {most:.3g}"
    return f"In motion this may diverge: {how}"


def swept_words(row: Row) -> str:
    """Return whether many constraints are safe in an engine that sweeps, what a step does to errors, how many sweeps.

    Not safe in a chain of 10: each step multiplies the error by 1.03 (one constraint alone: 0.80). What else was
    asked, of a scene that moves and of steps that vary, is said of constraints that are solved exactly.
    """
    z_abs, alone, stable = row["swept_z_abs"], row["alone_z_abs"], row["stable_iterations"]
    enough = (
        "No number of sweeps that was tried is stable" if stable is None else f"Stable from {counted(stable, 'sweep')}"
    )
    safe = "Safe" if row["safe"] else "Not safe"
    begin = f"{safe} in {row['swept']}:" if row["safe"] == (z_abs < 1) else f"{safe}. In {row['swept']}"
    change = change_words(z_abs, "converges" if z_abs < 1 else "diverges")
    sentences = [f"{begin} {change} (one constraint alone: {alone:.2f})", enough]
    if "moving_verdict" in row:
        sentences.append(f"That is at rest. Solved exactly: {_in_motion(row)[0].lower()}{_in_motion(row)[1:]}")
    if "varying" in row:
        sentences.append(f"That is with constant steps. Solved exactly, when steps vary: {row['varying']}")
    return f"{'. '.join(sentences)}."


def counted(number: int, one: str, many: str = "") -> str:
    """Return how many there are of something: 1 sweep, 10 sweeps."""
    return f"1 {one}" if number == 1 else f"{number} {many or one + 's'}"
