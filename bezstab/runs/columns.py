"""What is printed of runs: the columns of simulate, verify and tradeoff."""

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from typing import NamedTuple

from bezstab.mechanism.simulation import Simulation
from bezstab.runs.accuracy_costs import Run, SweptRuns
from bezstab.runs.measured_poles import Measurement, MeasurementSummary
from bezstab.runs.sentences import measurement_sentence, run_sentence, verdict_map_sentence
from bezstab.runs.verdict_maps import VerdictMap
from bezstab.show.cells import formatted, modulus_words
from bezstab.show.columns import METHOD, POINT, POLE, Column, of_part
from bezstab.stability.error_fronts import FrontPoint
from bezstab.units import alpha_and_beta

RUN: Sequence[Column[Simulation]] = (
    METHOD,
    Column("held by", "stabilise", lambda run: run.stabilise, "what holds the constraints"),
    *POINT,
    Column("h (s)", "h", lambda run: run.h, "step", "s"),
    Column("until (s)", "time", lambda run: float(run.t[-1]), "when the run ended", "s"),
    Column("largest |c| (m, rad)", "c_max", lambda run: run.c_max, "largest constraint error", "m or rad", ".2e"),
    Column(
        "largest |ċ| (m/s, rad/s)",
        "cdot_max",
        lambda run: run.cdot_max,
        "largest rate of the constraint error",
        "m/s or rad/s",
        ".2e",
        True,
    ),
    Column(
        "energy drift (J)",
        "energy_drift",
        lambda run: float(run.energy_drift[-1]),
        "change of energy that is not the work of drivers and forces",
        "J",
        ".2e",
        True,
    ),
    Column(
        "of it work of multipliers (J)",
        "multiplier_work",
        lambda run: float(run.multiplier_work[-1]),
        "part of the drift: work of the multipliers on the constraint error, which the feedback decides",
        "J",
        ".2e",
        True,
    ),
    Column("evaluations", "evaluations", lambda run: run.evaluations, "evaluations of the right-hand side"),
    Column(
        "least pivot",
        "least_pivot",
        lambda run: run.least_pivot,
        "least relative pivot of C_q M⁻¹ C_qᵀ; small near a singular configuration",
        form=".1e",
    ),
    Column(
        "Newton's iterations", "iterations", lambda run: run.iterations, "in the whole run; null for an explicit method"
    ),
    Column("failure", "remark", lambda run: run.failure, "why the run ended early; null if it did not", brief=True),
    Column("", "sentence", run_sentence, "the answer in words"),
)


MEASURED_POLE = [
    replace(each, heading=each.heading and f"measured {each.heading}", brief=each.key == "z_abs") for each in POLE
]

MEASURED: Sequence[Column[Measurement]] = (
    METHOD,
    *(replace(each, apart=True) for each in POINT),
    Column(
        "predicted |z_p|",
        "predicted_z_abs",
        lambda found: abs(found.predicted),
        "modulus of the pole predicted for the mechanism at rest",
        form=modulus_words,
        brief=True,
    ),
    Column(
        "|z| at most",
        "z_abs_at_most",
        lambda found: found.moving.at_most,
        "what a step multiplies an error by over the motion, at most; null where two poles nearly meet",
        form=".6f",
    ),
    Column("", "moving_verdict", lambda found: found.moving.verdict, "what errors do on the moving mechanism"),
    Column(
        "|z| over the motion",
        "floquet_z_abs",
        lambda found: found.floquet_abs,
        "modulus per step of the linearised steps over the motion that the method makes: exact where that begins anew, "
        "else a growth over the run; null without --floquet",
        form=".6f",
        brief=True,
    ),
    *of_part(Measurement, lambda found: found.measured, MEASURED_POLE),
    Column("predicted verdict", "", lambda found: found.predicted_verdict, ""),
    Column("measured verdict", "verdict", lambda found: found.measured_verdict, "of the run", apart=True),
    Column(
        "verdicts agree",
        "agreeing",
        lambda found: found.verdicts_agree,
        "whether predicted and measured verdict agree, null where either is not settled; of a map, how many of its "
        "runs have the predicted one",
        form="NO",
        apart=True,
    ),
    Column("whose verdict was right", "", lambda found: found.right, ""),
    Column(
        "remark",
        "remark",
        lambda found: found.reason,
        "why nothing could be measured, or what disturbs it; empty where nothing does",
        apart=True,
    ),
    Column("", "sentence", measurement_sentence, "the answer in words"),
)

SUMMARY: Sequence[Column[MeasurementSummary]] = (
    Column("method", "", lambda found: found.method.name, ""),
    Column("points", "", lambda found: found.points, ""),
    Column("measured points", "", lambda found: found.measured, ""),
    Column("median error of |z|", "", lambda found: found.median_error, "", form=".1e"),
    Column("largest error of |z|", "", lambda found: found.largest_error, "", form=".1e"),
    Column("verdicts called", "", lambda found: found.called, ""),
    Column("wrong verdicts", "", lambda found: found.wrong, ""),
)
"""How well the measured poles of a method agree with the predicted ones: for people, who read several points."""

VERDICT_MAP: Sequence[Column[VerdictMap]] = (
    METHOD,
    Column("h (s)", "h", lambda found: found.h, "step", "s"),
    Column("runs", "", lambda found: found.undecided.size, "", brief=True),
    Column("gave a verdict", "", lambda found: found.judged, "", brief=True),
    Column("as predicted", "agreeing", lambda found: found.agreeing, "runs with the predicted verdict", brief=True),
    Column(
        "disagreeing, not too close",
        "disagreeing",
        lambda found: found.disagreements_beyond_band,
        "runs not too close to call that disagree",
        brief=True,
    ),
    Column("", "sentence", verdict_map_sentence, "the answer in words"),
)


class Ranked(NamedTuple):
    """A run among all that are compared."""

    run: Run
    front: str


def ranked_rows(swept: SweptRuns) -> list[Ranked]:
    """Return each run with the fronts on which it is: T by trajectory error, c by constraint error, or cheapest."""
    cheapest = [place for place, run in enumerate(swept.runs) if run is swept.cheapest]
    best = {"T": swept.fronts["trajectory"], "c": swept.fronts["constraint"], "cheapest": cheapest}
    return [
        Ranked(run, " ".join(word for word, places in best.items() if place in places))
        for place, run in enumerate(swept.runs)
    ]


COSTS: Sequence[Column[Ranked]] = (
    Column("method", "method", lambda it: it.run.method.name, "integration method", brief=True),
    Column("held by", "stabilise", lambda it: it.run.stabilise, "what holds the constraints"),
    Column(
        "goal",
        "goal",
        lambda it: "accurate" if it.run.advised else None,
        "that of `choose` that gave the point; null where it was given",
    ),
    Column("h (s)", "h", lambda it: it.run.h, "step", "s", brief=True),
    Column("α̂", "alpha_hat", lambda it: it.run.alpha_hat, "2αh", brief=True),
    Column("β̂", "beta_hat", lambda it: it.run.beta_hat, "β²h²", brief=True),
    Column("|z_p|", "z_abs", lambda it: it.run.z_abs, "modulus of the dominant pole", form=modulus_words),
    Column(
        "trajectory error (m, rad)",
        "trajectory_error",
        lambda it: it.run.trajectory_error,
        "largest error of the coordinates; null if the run failed",
        "m or rad",
        brief=True,
        words=lambda it: "diverged" if it.run.failure else formatted(it.run.trajectory_error, ".2e"),
    ),
    Column(
        "order seen",
        "order",
        lambda it: it.run.order,
        "order of accuracy between this and the next larger step; null where none can be told",
        form=".2f",
    ),
    Column("largest |c| (m, rad)", "c_max", lambda it: it.run.c_max, "of the run", "m or rad", ".2e", True),
    Column("measured |c|", "", lambda it: it.run.measured_error, "", form=".2e"),
    Column(
        "predicted |c|",
        "predicted_error",
        lambda it: it.run.predicted_error,
        "largest |c| in the later half of the run as predicted, with nothing fitted; null where errors do not decay "
        "or the motion cannot be followed",
        "m or rad",
        ".2e",
    ),
    Column("measured work (J)", "", lambda it: it.run.measured_work, "", form=".2e"),
    Column(
        "predicted work (J)",
        "predicted_work",
        lambda it: it.run.predicted_work,
        "work of the multipliers there, which the energy gains, to leading order; null where predicted_error is",
        "J",
        ".2e",
    ),
    Column("measured trajectory", "", lambda it: it.run.measured_trajectory, "", form=".2e"),
    Column(
        "predicted trajectory",
        "predicted_trajectory",
        lambda it: it.run.predicted_trajectory,
        "largest error of the coordinates there, of a mechanism that drivers move entirely; else null",
        "m or rad",
        ".2e",
    ),
    Column(
        "energy drift (J)",
        "energy_drift",
        lambda it: it.run.energy_drift,
        "change of energy that is not the work of drivers and forces",
        "J",
        ".2e",
        True,
    ),
    Column("evaluations", "evaluations", lambda it: it.run.evaluations, "of the right-hand side", brief=True),
    Column("factorizations", "factorizations", lambda it: it.run.factorizations, "of C_q M⁻¹ C_qᵀ"),
    Column("time (s)", "seconds", lambda it: it.run.seconds, "processor time, median of repeats", "s", ".3g", True),
    Column(
        "front",
        "front",
        lambda it: it.front,
        "T if no run is both cheaper and nearer to the trajectory, c if none is to the constraints; and cheapest of "
        "those with a trajectory error within --tolerance",
        brief=True,
    ),
    Column("failure", "remark", lambda it: it.run.failure, "why the run ended early; null if it did not"),
)


class Placed(NamedTuple):
    """A point of a front, and the step (s) at which it is told in 1/s, if there is one."""

    point: FrontPoint
    h: Fraction | None


def _rates(it: Placed) -> tuple[float | None, float | None]:
    return alpha_and_beta(it.point.alpha_hat, it.point.beta_hat, it.h)


FRONTS: Sequence[Column[Placed]] = (
    Column("method", "method", lambda it: it.point.method.name, "integration method", brief=True),
    Column("", "omega_h", lambda it: it.point.omega_h, "angle by which the motion turns in a step", "rad"),
    Column("|z_p| up to", "z_abs_below", lambda it: it.point.z_abs_below, "what |z_p| is at most", brief=True),
    Column("", "z_abs", lambda it: it.point.z_abs, "|z_p| itself"),
    Column("α̂", "alpha_hat", lambda it: it.point.alpha_hat, "2αh", brief=True),
    Column("β̂", "beta_hat", lambda it: it.point.beta_hat, "β²h²", brief=True),
    Column("α (1/s)", "alpha", lambda it: _rates(it)[0], "damping; null without --h", "1/s", brief=True),
    Column("β (1/s)", "beta", lambda it: _rates(it)[1], "stiffness as a rate; null without --h", "1/s", brief=True),
    Column(
        "error",
        "total_error",
        lambda it: it.point.total_error,
        "constraint error that is left in a run, as a share of the motion's amplitude",
        form=".2e",
        brief=True,
    ),
    Column(
        "error of velocity",
        "velocity_error",
        lambda it: it.point.velocity_error,
        "error forced on the velocity, as a share of its amplitude",
        form=".2e",
        brief=True,
    ),
    Column(
        "energy gained",
        "energy_growth",
        lambda it: it.point.energy_growth,
        "growth of energy in a revolution of a motion whose rate varies by 30 %, as a share of it; null if not known",
        form=".2e",
        brief=True,
    ),
)
