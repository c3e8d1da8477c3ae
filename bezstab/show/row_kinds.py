"""Every field of every row, and which fields the rows of each command have: the one place that says so.

A new column is a line here: a `Field` among those of its kind of row. Rows, tables, CSV, JSON and the table of keys
(keys.csv) take it from there.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from operator import itemgetter

from bezstab.show.cells import (
    SPINNING,
    any_or_missing,
    any_speed,
    area_text,
    constant_text,
    modulus_words,
    order_text,
    pole_text,
    safe_step_text,
    step_text,
    unbounded,
)
from bezstab.show.fields import MISSING, Field, RowKind, integer, number, text, truth
from bezstab.show.sentences import (
    step_sentence,
)
from bezstab.words import times_words

UNKNOWN_STEP = "where no step is given"
UNSTABLE = "where the point is not stable"
NOT_MEASURED = "where nothing could be measured; `reason` says why"
LEVEL_ROW = "in the row of a level below 1, which is of the mechanism at rest"
NO_ERROR = "where errors do not decay, or it is not known"
NOT_COMPARED = "where errors do not decay, or it is not known, or that point is not; in `check` without a rate, too"
NO_CHOICE = "where no feedback decays so fast"
NO_BEST = "where there is no best point; `best_reason` says why"
NO_SWEEPS = "where the engine does not sweep, or it is not known how"

METHOD = text(
    "method",
    "Name of the integration method, with @m where its step is m times h",
    "method",
    otherwise=lambda _: "yours",
)
ALPHA_HAT = number("alpha_hat", "Dimensionless damping of the feedback, 2 alpha h", "α̂")
BETA_HAT = number("beta_hat", "Dimensionless stiffness of the feedback, beta^2 h^2", "β̂")
ALPHA = number(
    "alpha",
    "Damping of the feedback c'' + 2 alpha c' + beta^2 c = 0",
    "α (1/s)",
    unit="1/s",
    null=UNKNOWN_STEP,
)
BETA = number(
    "beta",
    "Stiffness of the same feedback as a rate",
    "β (1/s)",
    unit="1/s",
    null="where no step is given, and for a negative beta_hat",
)
H = number("h", "Step size", "h (s)", unit="s", null=UNKNOWN_STEP)
SENTENCE = text("sentence", "What was judged, and the answer in words")
IN_WORDS = itemgetter("sentence")  # above a block, the sentence of the answer itself
Z_REAL = number("z_real", "Real part of the pole", path="pole.real")
Z_IMAG = number("z_imag", "Imaginary part of the pole, that of the upper one of a pair", path="pole.imag")
Z_ABS = number(
    "z_abs", "Modulus of the pole: each step multiplies errors by it", "|z_p|", modulus_words, path="pole.abs"
)
Z_ANGLE_DEG = number(
    "z_angle_deg",
    "Angle of the pole: errors turn by it in each step",
    "∠z (deg)",
    ".3f",
    unit="degrees",
    path="pole.angle_deg",
)
# the pole of an answer; `pole_fields` makes those of others from it
POLE = (Z_REAL, Z_IMAG, Z_ABS, Z_ANGLE_DEG)


def pole_fields(name: str, which: str, null: str = "") -> Sequence[Field]:
    """Return the fields of one pole of several, by its name: those of POLE, which tell the pole by what it is."""
    return [
        replace(
            field,
            key=f"{name}_{field.key}",
            meaning=field.meaning.replace("the pole", f"the pole {which}"),
            heading=field.heading and f"{name} {field.heading}",
            path=field.path.replace("pole", name),
            null=null,
        )
        for field in POLE
    ]


PREDICTED_Z_REAL, PREDICTED_Z_IMAG, PREDICTED_Z_ABS, PREDICTED_Z_ANGLE_DEG = pole_fields(
    "predicted", "predicted for the mechanism at rest"
)
MEASURED_Z_REAL, MEASURED_Z_IMAG, MEASURED_Z_ABS, MEASURED_Z_ANGLE_DEG = pole_fields(
    "measured", "measured in the simulation", null=NOT_MEASURED
)
VERDICT = text("verdict", "What errors do, proven on the numbers as typed: converges, marginal or diverges", "verdict")
SAFE = truth("safe", "Whether every error is proven to shrink; with --scene, on the moving mechanism as well")
KAPPA = number(
    "kappa",
    "How fast the directions of the constraints turn, at most",
    "κ (1/s)",
    ".4g",
    unit="1/s",
    null=LEVEL_ROW,
)
Z_ABS_BELOW = number(
    "z_abs_below",
    "What |z_p| is below, or on a front at most; 1 where the method is stable",
    "|z_p| up to",
    path="region.level",
)
AREA = number(
    "area",
    "Area of the region in alpha_hat and beta_hat",
    "area",
    text=area_text,
    otherwise=unbounded,
    null="where it is infinite or empty",
    path="region.area",
)
AREA_ERROR = number(
    "area_error",
    "How far the area may be off",
    null="where it is infinite or empty",
    path="region.area_error",
)
end = partial(number, form=".8g", otherwise=unbounded, null="where the region has no end there, or is empty")
ALPHA_HAT_MAX = end("alpha_hat_max", "Largest alpha_hat of the region", "α̂ to", path="region.extent.0.1")
BETA_HAT_MAX = end("beta_hat_max", "Largest beta_hat of the region", "β̂ to", path="region.extent.1.1")
BEST_Z_ABS = number(
    "best_z_abs",
    "Smallest modulus of the dominant pole over the region",
    "least |z_p|",
    ".8f",
    null=NO_BEST,
    path="inside.z_abs",
)
STEPS = integer("steps", "Number of steps of the method", "steps")
ORDER = integer("order", "Order of accuracy, computed from the coefficients", "order", text=order_text)
ERROR_CONSTANT = number("error_constant", "Error constant of the method", "error constant", text=constant_text)
SOURCE = text("source", "Where a method or a conversion is from", "source")
GROUP = text("group", "Heading under which the row is listed", "group")
OMEGA_H = number(
    "omega_h",
    "Angle by which the motion that errors are told on turns in a step, omega h",
    unit="rad",
    path="question.motion.omega_h",
)
OMEGA_ASSUMED = truth(
    "omega_assumed",
    "Whether that angle is assumed, as neither a rate nor a scene was given",
    path="question.motion.assumed",
)
FORCED_ERROR = number(
    "forced_error",
    "Constraint error that the method forces on that motion in the steady state, as a share of its amplitude",
    null=NO_ERROR,
    path="cost.forced_error",
)
TOTAL_ERROR = number(
    "total_error",
    "Constraint error that is left in a run, as such a share: the largest that is forced at any rate up to omega",
    "error",
    ".2e",
    null=NO_ERROR,
    path="cost.total_error",
)
VELOCITY_ERROR = number(
    "velocity_error",
    "Error forced on the velocity of that motion, as a share of the velocity's amplitude",
    "error of velocity",
    ".2e",
    null=NO_ERROR,
    path="cost.velocity_error",
)
ORDER_LEFT = integer(
    "order_left",
    "Order in h of the forced error where alpha_hat and beta_hat are held, at most the method's own",
    "order left",
    null="where it is not known",
    path="cost.order_left",
)
TIMES_LEAST = number(
    "times_least",
    "Total error over that at the point of the goal accurate, which weighs velocities as well",
    "error / least",
    times_words,
    null=NOT_COMPARED,
    path="cost.times_least",
)
TIMES_LEAST_VELOCITY = number(
    "times_least_velocity",
    "Velocity error over that at the same point",
    "velocity error / least",
    times_words,
    null=NOT_COMPARED,
    path="cost.times_least_velocity",
)
ROLE = text("role", "Whether the point was given, or is what to take instead")
H_FACTOR = number(
    "h_factor",
    "Factor on h up to which this alpha and beta are stable",
    "stable for h times",
    ".4g",
    otherwise=any_or_missing,
    null="where the point is not stable, or any step is",
    path="margins.h",
)
H_LIMIT = number(
    "h_limit",
    "Largest step that is stable at this alpha and beta",
    "largest stable h (s)",
    text=step_text,
    unit="s",
    null="where the point is not stable, any step is, or h is unknown",
)
SETTING = text(
    "setting",
    "What to write in the engine's words",
    "to paste",
    null="where no point is given, or the engine's values are",
)
SWEEPS = truth(
    "sweeps",
    "Whether the engine solves each constraint by itself, in sweeps, so that what is said of one alone says "
    "little about a chain of them",
    path="question.engine.sweeps",
)
EXCLUDES = text("excludes", "What the conversion leaves out", "left out", path="question.engine.excludes")
SCENE = text("scene", "Name of the scene", "scene")
RUN_STEPS = integer("run_steps", "Steps of the whole run", "steps of the run")
RUN_EVALUATIONS = integer("run_evaluations", "Evaluations of the right-hand side in the whole run", "evaluations")
FACTORIZATIONS = integer(
    "factorizations",
    "Factorizations of C_q M^-1 C_q^T in the whole run: one for each evaluation, and those of projections",
    "factorizations",
)
STABILISE = text("stabilise", "What holds the constraints", "held by")
C_MAX = number("c_max", "Largest constraint error", "largest |c| (m, rad)", ".2e", unit="m or rad")
CDOT_MAX = number(
    "cdot_max", "Largest rate of the constraint error", "largest |ċ| (m/s, rad/s)", ".2e", unit="m/s or rad/s"
)
ENERGY_DRIFT = number(
    "energy_drift",
    "Change of energy that is not the work of drivers and forces",
    "energy drift (J)",
    ".2e",
    unit="J",
)
FAILURE = text("failure", "Why the run ended early", "failure", null="if it did not")
OBSERVED_ORDER = number(
    "observed_order",
    "Order of accuracy seen between this and the next larger step",
    "order seen",
    ".2f",
    null="where none can be told",
)
PREDICTED_VERDICT = text(
    "predicted_verdict",
    "Verdict predicted for the mechanism at rest",
    "predicted verdict",
)
MEASURED_VERDICT = text(
    "measured_verdict",
    "Verdict of the simulation",
    "measured verdict",
)
REASON = text(
    "reason",
    "Why nothing could be measured, or what disturbs it; empty where nothing does",
    "remark",
)
PREDICTED_ERROR = number(
    "predicted_error",
    "Largest constraint error predicted for the later half of the run, with nothing fitted",
    "predicted |c|",
    ".2e",
    unit="m or rad",
    null="where errors do not decay, or the motion cannot be followed for longer than the run",
)
MEASURED_ERROR = number(
    "measured_error",
    "Largest constraint error in the later half of the run",
    "measured |c|",
    ".2e",
    unit="m or rad",
    null="if the run failed",
)

# what --scene adds: bounds on the poles of the moving mechanism
Z_ABS_AT_MOST = number(
    "z_abs_at_most",
    "What a step multiplies an error by over the motion, at most, to first order in kappa h",
    "|z| at most",
    ".6f",
    null="without a bound, where two poles nearly meet",
    path="at_most",
)
MOVING_VERDICT = text(
    "moving_verdict",
    "What errors do on the moving mechanism",
    "moving verdict",
    path="verdict",
)
MOVING = (
    KAPPA,
    Z_ABS_AT_MOST,
    number(
        "z_abs_at_least",
        "The same at least, of the dominant pole",
        null="without a bound, where two poles nearly meet",
        path="at_least",
    ),
    MOVING_VERDICT,
    number(
        "safe_speed",
        "Factor on the given speed up to which errors shrink, at most as far as first order holds, kappa h = 0.1",
        "safe to speed",
        ".3g",
        otherwise=any_speed,
        null="where it diverges at rest, or where nothing turns",
    ),
)
# what --omega adds without a scene
ENERGY_RATE = number(
    "energy_rate",
    "What a second adds to the energy of a motion of that rate, which varies by 30 %, or in an engine of a body that "
    "spins about a pin, as a share of it",
    "energy gained a second",
    ".2e",
    null="without --omega, or where an error grows",
    path="energy_rate.0",
)
# what --scene adds: a run of it
SCENE_RUN = (
    number("run_seconds", "How long the scene was run", "run (s)", unit="s", path="duration"),
    number("run_c_max", "Largest |c| of that run", "|c| in the run", ".1e", unit="m or rad", path="c_max"),
    number(
        "run_gained",
        "What its energy gained beside the work of drivers and forces, as a share of the largest kinetic energy",
        "energy gained",
        ".2e",
        path="gained",
    ),
    number(
        "run_breakdown",
        "When it breaks down if the energy goes on growing",
        "breaks down (s)",
        ".3g",
        unit="s",
        null="where that is not foretold",
        path="breakdown",
    ),
    text("run_failure", "Why the run of the scene ended early", null="if it did not", path="failure").hidden,
)
APPLIED = text(
    "applied",
    "What the engine does to its values before it uses them",
    null="where nothing is known of it",
    path="question.given.words",
)
# constraints that an engine sweeps over, also of `chains` and `engines`
SWEPT_ITERATIONS = integer(
    "swept_iterations", "Sweeps that the engine makes in a step", "sweeps", null=NO_SWEEPS, path="swept.iterations"
)
SWEPT_Z_ABS = number(
    "swept_z_abs",
    "Factor by which a step multiplies the errors of the constraints that are swept over, in the long run",
    "|z| swept",
    ".4f",
    path="swept.growth.factor",
)
STABLE_ITERATIONS = integer(
    "stable_iterations",
    "From how many sweeps the constraints are stable",
    "stable from sweeps",
    null="where none tried is",
    path="swept.stable_iterations",
)
SWEPT_OVER = (
    text(
        "swept",
        "For which constraints `safe` holds of an engine that sweeps: one alone, a chain of bodies, those of a scene; "
        "poles, margins and times are those of one alone",
        "holds for",
        null="where the engine solves all constraints together",
        path="swept_over",
    ),
    integer("swept_constraints", "How many constraints the engine sweeps over", path="swept.constraints.count"),
    SWEPT_ITERATIONS,
    SWEPT_Z_ABS,
    number(
        "swept_accuracy", "How far that factor may be off by rounding, to first order", path="swept.growth.accuracy"
    ),
    number("alone_z_abs", "The same factor for one constraint alone, with as many sweeps", path="swept.alone"),
    STABLE_ITERATIONS,
)
"""What an engine that sweeps adds: the first to all, the others to --chain and --scene."""
ENGINE_H_LIMIT = number(
    "engine_h_limit",
    "Largest step up to which the engine's values are stable as it reads them at each step",
    unit="s",
    null="where the point is not stable, or any step is",
)
# printed by `poles`
POLES = RowKind(
    "a pole of a method",
    fields=(
        METHOD,
        ALPHA_HAT.hidden,
        BETA_HAT.hidden,
        Z_REAL.shown("pole z", text=pole_text),
        Z_IMAG,
        Z_ABS,
        Z_ANGLE_DEG,
        VERDICT,
        SAFE,
        OMEGA_H,
        FORCED_ERROR,
        TOTAL_ERROR,
        VELOCITY_ERROR.hidden,
        ORDER_LEFT.hidden,
        TIMES_LEAST,
        TIMES_LEAST_VELOCITY.hidden,
        SENTENCE,
    ),
    added=(
        *MOVING,
        *SCENE_RUN,
        APPLIED,
        EXCLUDES.hidden,
        SWEEPS,
        *SWEPT_OVER,
    ),
    sentence=IN_WORDS,
)
# printed by `choose`
CHOICES = RowKind(
    "a choice",
    fields=(
        METHOD,
        text("goal", "What the point was chosen for, or that it is as given", "goal"),
        ALPHA_HAT,
        BETA_HAT,
        ALPHA,
        BETA,
        VERDICT,
        SAFE,
        *POLE,
        number(
            "worst",
            "Largest modulus of the dominant pole with alpha and beta off by the spread",
            "worst |z_p|",
            ".4f",
        ),
        number(
            "searched",
            "Largest alpha h and beta h that were searched",
            "searched",
            "αh, βh to {:g}".format,
            null="where all of the region was, or none of it",
        ),
        H.hidden,
        integer("settle_steps", "Steps in which the error falls a thousandfold", "steps to 1/1000", null=UNSTABLE),
        number(
            "settle_seconds",
            "Time in which the error falls a thousandfold",
            "seconds to 1/1000",
            ".3g",
            unit="s",
            null="where the point is not stable or known",
        ),
        text(
            "margins_reason",
            "Why h_factor and the factors on alpha and beta are not known",
            null="where they are, or it is unstable",
        ),
        H_FACTOR.hidden,
        H_LIMIT,
        number(
            "alpha_factor_min",
            "Least factor by which alpha alone may be scaled",
            "min α factor",
            ".3g",
            null=UNSTABLE,
            path="margins.alpha.0",
        ),
        number(
            "alpha_factor_max",
            "Largest factor by which alpha alone may be scaled",
            "max α factor",
            ".3g",
            otherwise=any_or_missing,
            null="where the point is not stable, or any",
            path="margins.alpha.1",
        ),
        number(
            "beta_factor_min",
            "Least factor by which beta alone may be scaled",
            "min β factor",
            ".3g",
            null=UNSTABLE,
            path="margins.beta.0",
        ),
        number(
            "beta_factor_max",
            "Largest factor by which beta alone may be scaled",
            "max β factor",
            ".3g",
            otherwise=any_or_missing,
            null="where the point is not stable, or any",
            path="margins.beta.1",
        ),
        text(
            "safe_with",
            "The option with which a choice is safe that is not",
            null="where it is safe, a point was given, or neither --goal robust nor a shorter step was found safe",
        ),
        OMEGA_H,
        OMEGA_ASSUMED,
        FORCED_ERROR,
        TOTAL_ERROR,
        VELOCITY_ERROR,
        ORDER_LEFT,
        TIMES_LEAST,
        TIMES_LEAST_VELOCITY,
        ENERGY_RATE.hidden,
        SENTENCE,
    ),
    added=(*MOVING, *SCENE_RUN, SWEEPS, *SWEPT_OVER, ENGINE_H_LIMIT, SETTING),
    sentence=IN_WORDS,
)
# printed by `check`: a choice with its role
CHECKED = RowKind(
    "a point, or what to take instead",
    fields=(ROLE, *CHOICES.fields),
    added=(*CHOICES.added, APPLIED, EXCLUDES.hidden),
    sentence=IN_WORDS,
)
# printed by `choose --omega` without --h
STEPS_OF_CHOICES = RowKind(
    "a choice whose alpha and beta do not depend on the step",
    fields=(
        METHOD,
        ALPHA,
        BETA,
        SAFE,
        H_LIMIT.shown("largest stable h (s)", text=safe_step_text),
    ),
    sentence=step_sentence,
)
# printed by `check --physical` without --h
LARGEST_STEPS = RowKind(
    "the largest step of alpha and beta, without a step",
    fields=(ROLE, *STEPS_OF_CHOICES.fields),
    sentence=step_sentence,
)
# printed by `engines`
ENGINES_LISTED = RowKind(
    "an engine",
    fields=(
        text("engine", "Name of an engine", "engine", path="name"),
        text(
            "level",
            "Where the engine's feedback acts",
            "level",
        ),
        METHOD,
        text("parameters", "What the engine calls the feedback's parameters", "parameters"),
        text("optional", "Which of the parameters may be left away", "optional"),
        text("units", "Units of the parameters, in their order", "units"),
        SETTING,
        text(
            "energy_class",
            "How the engine takes errors back, which decides what a step does to the energy of a body that spins about "
            "a pin: motion/README.md",
            "a spinning body",
            text=lambda row: SPINNING[row["energy_class"]],
            otherwise=lambda row: "by the integrator" if row["level"] == "acceleration" else MISSING,
            null="where the integrator decides, or nothing spins",
        ),
        ENERGY_RATE,
        text(
            "witness",
            "With which engine a run has confirmed the conversion",
            "verified by",
            text=lambda row: "a run" if row["witness"] else "its source",
            null="where its source alone says it",
        ),
        SOURCE,
        EXCLUDES,
        SWEEPS.shown("sweeps"),
        SWEPT_ITERATIONS.hidden.of("sweeping.iterations"),
        text("swept_word", "What the engine calls their number", null=NO_SWEEPS, path="sweeping.word"),
        text("swept_source", "Where it is from how the engine sweeps", null=NO_SWEEPS, path="sweeping.source"),
        text("swept_excludes", "What is left out of how it sweeps", null=NO_SWEEPS, path="sweeping.excludes"),
    ),
)
ROW_KINDS: Mapping[str, Sequence[RowKind]] = {
    "poles": (POLES,),
    "choose": (CHOICES, STEPS_OF_CHOICES),
    "check": (
        CHECKED,
        LARGEST_STEPS,
    ),
    "engines": (ENGINES_LISTED,),
}
"""The kinds of rows that each command prints."""

FIELDS: Mapping[str, Field] = {
    field.key: field for kinds in ROW_KINDS.values() for kind in kinds for field in (*kind.fields, *kind.added)
}
"""Every key that any command prints, by name."""
