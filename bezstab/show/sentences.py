"""What rows say, in words: for each kind of row the sentence above its block of lines."""

import math

from bezstab.show.cells import order_text, safe_step_text, step_limit
from bezstab.show.fields import Row, formatted
from bezstab.show.words import change_words, counted, growth_words, safety_words, seconds_words


def answer_sentence(row: Row) -> str:
    """Return what there is to say of a point, and which motion was assumed if it was chosen for one."""
    sentence = point_sentence(row)
    if row["safe_with"]:
        sentence += f" With {row['safe_with']} it is safe."
    if row["goal"] != "accurate" or not row["omega_assumed"]:
        return sentence
    turn = f"ωh = {row['omega_h']:g}"
    motion = f"with {turn}" if row["h"] is None else f"of {row['omega_h'] / row['h']:.3g} rad/s ({turn})"
    return f"{sentence} Without --omega a motion {motion} is assumed."


def point_sentence(row: Row) -> str:
    """Return whether a point is safe, what a step does to the error, and how far step, α and β may grow, at rest."""
    if "kp" in row and not {"moving_verdict", "varying"} & row.keys():
        return drive_sentence(row)
    if not row["safe"] or "swept_z_abs" in row:
        return safety_words(row)
    if row["margins_reason"]:
        return f"{safety_words(row)} How far the step, α and β may grow is not known: {row['margins_reason']}."
    limit = step_limit(row)
    factor = row["h_factor"] if row["h"] is None else None
    step = growth_words(factor) if limit is None else f"to {seconds_words(limit)}"
    alpha, beta = growth_words(row["alpha_factor_max"]), growth_words(row["beta_factor_max"])
    begin = "At rest the" if "moving_verdict" in row else "The"
    if {step, alpha, beta} == {growth_words(None)}:
        return f"{safety_words(row)} {begin} step, α and β may grow {step}."
    return f"{safety_words(row)} {begin} step may grow {step}, α {alpha}, β {beta}."


def drive_sentence(row: Row) -> str:
    """Return whether a drive is safe, what a step does to the error, and how far the step and each gain may go.

    Without kp it is the velocity that is judged. Not safe. Each step multiplies the velocity by 3. Lower kd to 0.5.
    """
    change = change_words(row["z_abs"], row["verdict"], "error" if row["kp"] else "velocity")
    begin = f"{'Safe' if row['safe'] else 'Not safe'}. {change[0].upper()}{change[1:]}."
    if not row["safe"]:
        remedies = " or ".join(_gain_remedies(row))
        return f"{begin} {remedies[0].upper()}{remedies[1:]}." if remedies else begin
    if row["margins_reason"]:
        return f"{begin} How far the step, kp and kd may grow is not known: {row['margins_reason']}."
    limits = {"the step": row["h_limit"] and seconds_words(row["h_limit"])}
    limits |= {gain: row[f"{gain}_max"] and _plain(row[f"{gain}_max"]) for gain in ("kp", "kd")}
    ends = ", ".join(f"{name} {f'to {limit}' if limit else 'without limit'}" for name, limit in limits.items())
    return f"{begin} Each alone may grow: {ends}."


def _gain_remedies(row: Row) -> list[str]:
    """Return which change of one gain alone makes a drive stable."""
    kp, kp_max, kd, kd_min, kd_max = (row[key] for key in ("kp", "kp_max", "kd", "kd_min", "kd_max"))
    remedies = []
    if kd_min is not None and kd <= kd_min:
        remedies.append(f"raise kd above {_plain(kd_min)}{'' if kd_max is None else f', up to {_plain(kd_max)}'}")
    if kd_max is not None and kd >= kd_max:
        remedies.append(f"lower kd to {_plain(kd_max)}")
    if kp_max is not None and kp >= kp_max:
        remedies.append(f"lower kp to {_plain(kp_max)}")
    return remedies


def _plain(gain: float) -> str:
    """Return a gain to four digits, 11000 without a power of ten."""
    return f"{float(f'{gain:.4g}'):g}"


def step_sentence(row: Row) -> str:
    """Return up to which step alpha and beta are safe."""
    limit = safe_step_text(row)
    if limit == "none":
        return "Not safe at small steps."
    return "Safe at any h." if limit == "unlimited" else f"Safe up to h = {limit} s."


def chosen_step_sentence(row: Row) -> str:
    """Return alpha and beta of a choice that does not depend on the step, and up to which step they are safe."""
    return f"α = {row['alpha']:.3g} 1/s, β = {row['beta']:.3g} 1/s at any step. {step_sentence(row)}"


CAUSES = {
    "gains": "These gains are not stable even if each step computes and applies its torque.",
    "rate": "The torque is held too long: the same gains are stable if each step computes it.",
    "delay": "The torque comes too late: the same gains are stable without the delay.",
    "rate and delay": "The torque is held too long and comes too late.",
}
"""Why a drive is unstable, by what is used up."""


NEAREST = {
    "kp": "kp is nearest to its limit",
    "kd": "kd is nearest to its limit",
    "too little kd": "kd is nearest to its limit, the lower one",
    "rate": "the time between two torques is nearest to its limit",
    "delay": "the delay is nearest to its limit",
}
"""Which number of a stable drive may change least, by what is used up."""


def held_sentence(row: Row) -> str:
    """Return whether a held or late drive is safe, what a step of the physics does to the error, why, what may change.

    Safe (explicit). Each step multiplies the error by 0.95. It stays stable with one of these alone: kp up to 849, kd
    from 1.03 to 48.4, a torque every 19 steps, at most 6 steps late; kp is nearest to its limit.
    """
    change = change_words(row["z_abs"], row["verdict"], "error" if row["kp"] else "velocity")
    sentence = f"{'Safe' if row['safe'] else 'Not safe'} ({row['drive']}). {change[0].upper()}{change[1:]}."
    changes = ", ".join(_changes(row))
    if not row["safe"]:
        remedy = f"It is stable with one of these alone: {changes}." if changes else "No single change makes it stable."
        return f"{sentence} {CAUSES[row['held_by']]} {remedy}"
    nearest = f"; {NEAREST[row['held_by']]}" if row["held_by"] else ""
    return f"{sentence} It stays stable with one of these alone: {changes}{nearest}."


def _changes(row: Row) -> list[str]:
    """Return how far each number alone may go with which a drive is stable."""
    kp_max, kd_min, kd_max = row["kp_max"], row["kd_min"], row["kd_max"]
    changes = []
    if kp_max is not None:
        changes.append(f"kp {'lowered' if row['kp'] > kp_max else 'up'} to {kp_max:.3g}")
    if kd_max is not None and row["kd"] > kd_max:
        changes.append(f"kd lowered to {kd_max:.3g}")
    elif kd_min is not None:
        end = "on" if kd_max is None else f"to {kd_max:.3g}"
        changes.append(f"kd from {kd_min:.3g} {end}")
    if row["every_max"] is not None:
        changes.append("a torque every step" if row["every_max"] == 1 else f"a torque every {row['every_max']} steps")
    if row["late_max"] is not None:
        changes.append(f"at most {counted(row['late_max'], 'step')} late")
    return changes


def one_pole_sentence(row: Row) -> str:
    """Return what the part of the error does that belongs to one pole of several."""
    return f"{row['method']} {row['verdict']}. The part of the error with this pole is |z| times as large each step."


def region_sentence(row: Row) -> str:
    """Return how large the region of a method is, and where in it errors shrink fastest."""
    what = "is stable" if row["z_abs_below"] == 1 else f"has |z_p| < {row['z_abs_below']:g}"
    if row["alpha_hat_max"] is None and row["bounded"]:
        return f"{row['method']} {what} nowhere."
    size = "in a region without end" if row["area"] is None else f"in a region of area {row['area']:.3g}"
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


def witness_sentence(row: Row) -> str:
    """Return what the other engine did against what was predicted."""
    as_predicted = "as" if row["measured_verdict"] == row["predicted_verdict"] else "NOT as"
    return f"MuJoCo's {row['integrator']}: {row['measured_verdict']}, {as_predicted} predicted."


def chain_sentence(row: Row) -> str:
    """Return from how many sweeps a chain is stable, and what a step does with the engine's own number of them."""
    z_abs, stable = row["swept_z_abs"], row["stable_iterations"]
    enough = "with no number that was tried" if stable is None else f"from {counted(stable, 'sweep')}"
    heavier = "" if row["chain_mass_ratio"] == 1 else f", the last {row['chain_mass_ratio']:g} times as heavy"
    own = counted(row["swept_iterations"], "sweep")
    bodies = counted(row["chain_bodies"], "body", "bodies")
    change = change_words(z_abs, "converges" if z_abs < 1 else "diverges")
    return f"{bodies}{heavier}: stable {enough}. With {own} {change}."
