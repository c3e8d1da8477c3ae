"""What is said of runs in words."""

import math
from collections.abc import Sequence

from bezstab.mechanism.simulation import Simulation
from bezstab.runs.measured_poles import Measurement
from bezstab.runs.verdict_maps import VerdictMap
from bezstab.show.cells import formatted
from bezstab.words import point_words, seconds_words

MOST_LISTED = 20  # times in a message


def run_sentence(run: Simulation) -> str:
    """Return how long a run of a mechanism went well, how far it stayed from its constraints, and what its energy did.

    SYM at α̂ = 1, β̂ = 1 (α = 50 1/s, β = 100 1/s at h = 0.01 s) went through to 2 s; the largest |c| is 8.3e-09.
    """
    feedback = point_words(run.alpha_hat, run.beta_hat, run.h)
    with_what = {"baumgarte": f"at {feedback}", "projection": "with projection", "none": "without feedback"}
    how = "broke down after" if run.failure else "went through to"
    ended = f"{how} {seconds_words(float(run.t[-1]))}; the largest |c| is {formatted(run.c_max, '.1e')}."
    drift = _drift_words(float(run.energy_drift[-1]), float(run.multiplier_work[-1]))
    return f"{run.method.name} {with_what[run.stabilise]} {ended} {drift}".rstrip()


def _drift_words(drift: float, by_multipliers: float) -> str:
    """Return what most of a run's energy drift is: the feedback's, or the method's own; nothing where none is told."""
    if not (math.isfinite(drift) and math.isfinite(by_multipliers) and drift):
        return ""
    if abs(by_multipliers) >= abs(drift - by_multipliers):
        return "Most of the energy drift is the multipliers' work on the constraint error: it depends on the feedback."
    return "Most of the energy drift is the method's own: its truncation, and the torque of its stages if it has any."


def passages_words(times: Sequence[float]) -> str:
    """Return where a run has gone through singular configurations, and what that means; times in s."""
    listed = ", ".join(f"{time:.6g}" for time in times[:MOST_LISTED])
    more = ", ..." if len(times) > MOST_LISTED else ""
    what = "a singular configuration" if len(times) == 1 else f"{len(times)} singular configurations"
    where = f"the run goes through {what}, at t = {listed}{more} s"
    return f"{where}: there the motion can branch, and which way it goes is left to rounding"


def measurement_sentence(found: Measurement) -> str:
    """Return where a pole was measured, the predicted and the measured modulus, and whether the verdicts agree.

    RK4 at α̂ = 1, β̂ = 1 (α = 50 1/s, β = 100 1/s at h = 0.01 s): predicted |z| 0.5, measured 0.5: the verdicts agree.
    """
    ends = {True: "the verdicts agree", False: "the verdicts DISAGREE", None: "too close to call"}
    judged = f"{found.method.name} at {point_words(found.alpha_hat, found.beta_hat, found.h)}"
    agree = found.verdicts_agree
    if found.measured is None:
        verdict = "" if agree is None else f" The run {found.measured_verdict}: {ends[agree]}."
        return f"{judged}: not measurable: {found.reason}.{verdict}"
    predicted, measured = formatted(abs(found.predicted), ".6f"), formatted(abs(found.measured), ".6f")
    return f"{judged}: predicted |z| {predicted}, measured {measured}: {ends[agree]}."


def exact_rate_words(measurement: Measurement) -> str:
    """Return along which motion the exact rates of a method are; why there are none, where the motion ends."""
    name = measurement.method.name
    if measurement.periodic:
        return f"Exact rates of {name}: along the motion of the mechanism."
    shown = "What is shown is how errors grow over the run."
    return f"No rate of {name} is exact: the motion does not begin anew. {shown}"


def verdict_map_sentence(found: VerdictMap) -> str:
    """Return how many runs gave a verdict, how many of these are as predicted, and how many others must not differ."""
    runs = found.undecided.size
    if not found.judged:
        return f"{found.method.name}: none of {runs} runs gave a verdict."
    given = f"{found.judged} of {runs} runs gave a verdict, {found.agreeing} as predicted"
    beyond = found.disagreements_beyond_band
    return f"{found.method.name}: {given}; {beyond} that are not too close to call differ."
