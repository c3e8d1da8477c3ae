"""What rows say, in words: for each kind of row the sentence above its block of lines."""

import math

from bezstab.show.cells import order_text, safe_step_text
from bezstab.show.fields import Row, formatted
from bezstab.words import counted, seconds_words


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


def run_sentence(row: Row) -> str:
    """Return how long a run of a mechanism went well, and how far it stayed from its constraints."""
    how = "broke down after" if row["failure"] else "went through to"
    run = f"{row['method']} {how} {seconds_words(row['time'])}; the largest |c| is {formatted(row['c_max'], '.1e')}."
    return f"{run} {_drift_words(row['energy_drift'], row['multiplier_work'])}".rstrip()


def _drift_words(drift: float, by_multipliers: float) -> str:
    """Return what most of a run's energy drift is: the feedback's, or the method's own; nothing where none is told."""
    if not (math.isfinite(drift) and math.isfinite(by_multipliers) and drift):
        return ""
    own = drift - by_multipliers
    if abs(by_multipliers) >= abs(own):
        return "Most of the energy drift is the multipliers' work on the constraint error: it depends on the feedback."
    return "Most of the energy drift is the method's own: its truncation, and the torque of its stages if it has any."


def measurement_sentence(row: Row) -> str:
    """Return the predicted and the measured modulus, and whether the verdicts agree."""
    ends = {True: "the verdicts agree", False: "the verdicts DISAGREE", None: "too close to call"}
    agree = row["verdicts_agree"]
    if not row["measurable"]:
        verdict = "" if agree is None else f" The run {row['measured_verdict']}: {ends[agree]}."
        return f"Not measurable: {row['reason']}.{verdict}"
    predicted, measured = formatted(row["predicted_z_abs"], ".6f"), formatted(row["measured_z_abs"], ".6f")
    return f"Predicted |z| {predicted}, measured {measured}: {ends[agree]}."


def verdict_map_sentence(row: Row) -> str:
    """Return how many runs gave a verdict, how many of these are as predicted, and how many others must not differ."""
    if not row["judged_runs"]:
        return f"{row['method']}: none of {row['runs']} runs gave a verdict."
    given = f"{row['judged_runs']} of {row['runs']} runs gave a verdict, {row['agreeing']} as predicted"
    return f"{row['method']}: {given}; {row['disagreeing']} that are not too close to call differ."
