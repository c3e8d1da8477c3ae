"""Every field of every row, and which fields the rows of each command have: the one place that says so.

A new column is a line here: a `Field` among those of its kind of row. Rows, tables, CSV, JSON, the JSON Schema and the
documentation of keys (`bezstab schema`) take it from there.
"""

from collections.abc import Mapping, Sequence
from typing import get_args

from bezstab.methods import Verdict
from bezstab.show.cells import (
    both_errors_text,
    both_times_text,
    constant_text,
    diverged_text,
    fitted_pole_text,
    found_text,
    gain_limit_text,
    milliseconds_text,
    modulus_text,
    order_text,
    pole_text,
    range_text,
    safe_step_text,
    searched_text,
    speed_text,
    stable_steps_text,
    step_text,
    times_least_text,
    times_text,
    unbounded_text,
    used_up_text,
    yes_no_text,
)
from bezstab.show.fields import Field, RowKind
from bezstab.show.sentences import (
    answer_sentence,
    chain_sentence,
    check_sentence,
    cost_sentence,
    engine_sentence,
    finding_sentence,
    forced_sentence,
    front_sentence,
    held_sentence,
    measurement_sentence,
    member_sentence,
    method_sentence,
    region_sentence,
    run_sentence,
    step_sentence,
    summary_sentence,
    verdict_map_sentence,
    whole_method_sentence,
    witness_sentence,
)
from bezstab.show.words import safety_words

VERDICTS = get_args(Verdict)
MOVING_VERDICTS = ("evidence.MovingVerdict",)
UNKNOWN_STEP = "where no step is given"
UNSTABLE = "where the point is not stable"
NOT_MEASURED = "where nothing could be measured; `reason` says why"
LEVEL_ROW = "in the row of a level below 1, which is of the mechanism at rest"
NO_ERROR = "where errors do not decay, or it is not known"
NO_CHOICE = "where no feedback decays so fast"
NO_BEST = "where there is no best point; `best_reason` says why"
NO_SWEEPS = "where the engine does not sweep, or it is not known how"
UNBOUNDED = "where the region has no end there, or is empty"

METHOD = Field("method", "text", "Name of the integration method, with @m where its step is m times h", "method")
ALPHA_HAT = Field("alpha_hat", "number", "Dimensionless damping of the feedback, 2 alpha h", "α̂", ".6f")
BETA_HAT = Field("beta_hat", "number", "Dimensionless stiffness of the feedback, beta^2 h^2", "β̂", ".6f")
ALPHA = Field(
    "alpha",
    "number",
    "Damping of the feedback c'' + 2 alpha c' + beta^2 c = 0",
    "α (1/s)",
    ".6g",
    unit="1/s",
    null=UNKNOWN_STEP,
)
BETA = Field(
    "beta",
    "number",
    "Stiffness of the same feedback as a rate",
    "β (1/s)",
    ".6g",
    unit="1/s",
    null="where no step is given, and for a negative beta_hat",
)
H = Field("h", "number", "Step size", unit="s", null=UNKNOWN_STEP)
Z_REAL = Field("z_real", "number", "Real part of the pole")
Z_IMAG = Field("z_imag", "number", "Imaginary part of the pole, that of the upper one of a pair")
Z_ABS = Field("z_abs", "number", "Modulus of the pole: each step multiplies errors by it", "|z_p|", ".4f")
Z_ANGLE_DEG = Field(
    "z_angle_deg", "number", "Angle of the pole: errors turn by it in each step", "∠z (deg)", ".3f", unit="degrees"
)
VERDICT = Field("verdict", "text", "What errors do, proven on the numbers as typed", "verdict", values=VERDICTS)
SAFE = Field("safe", "truth", "Whether every error is proven to shrink; with --scene, on the moving mechanism as well")
KAPPA = Field(
    "kappa",
    "number",
    "How fast the directions of the constraints turn, at most",
    "κ (1/s)",
    ".4g",
    unit="1/s",
    null=LEVEL_ROW,
)
Z_ABS_BELOW = Field(
    "z_abs_below",
    "number",
    "What |z_p| is below, or on a front at most; 1 where the method is stable",
    "|z_p| at most",
    ".4g",
)
AREA = Field(
    "area",
    "number",
    "Area of the region in alpha_hat and beta_hat",
    "area",
    text=unbounded_text("area", ".10g"),
    null="where it is infinite or empty",
)
ALPHA_HAT_MIN = Field(
    "alpha_hat_min",
    "number",
    "Smallest alpha_hat of the region",
    "α̂ from",
    text=unbounded_text("alpha_hat_min", ".6g"),
    null=UNBOUNDED,
)
ALPHA_HAT_MAX = Field(
    "alpha_hat_max",
    "number",
    "Largest alpha_hat of the region",
    "α̂ to",
    text=unbounded_text("alpha_hat_max", ".8g"),
    null=UNBOUNDED,
)
BETA_HAT_MIN = Field(
    "beta_hat_min",
    "number",
    "Smallest beta_hat of the region",
    "β̂ from",
    text=unbounded_text("beta_hat_min", ".6g"),
    null=UNBOUNDED,
)
BETA_HAT_MAX = Field(
    "beta_hat_max",
    "number",
    "Largest beta_hat of the region",
    "β̂ to",
    text=unbounded_text("beta_hat_max", ".8g"),
    null=UNBOUNDED,
)
APPROACHED = Field(
    "approached",
    "text",
    "Those of the four limits that no edge attains: the region comes near them far out",
    null="where edges attain all that there are",
)
BEST_Z_ABS = Field(
    "best_z_abs", "number", "Smallest modulus of the dominant pole over the region", "least |z_p|", ".8f", null=NO_BEST
)
BEST_ALPHA_HAT = Field(
    "best_alpha_hat", "number", "Where that modulus is smallest, in alpha_hat", "best α̂", ".8f", null=NO_BEST
)
BEST_BETA_HAT = Field(
    "best_beta_hat", "number", "Where that modulus is smallest, in beta_hat", "best β̂", ".8f", null=NO_BEST
)
BEST_WHERE = Field(
    "best_where",
    "text",
    "Which poles meet where the modulus is smallest, in words",
    "poles there",
    null="where nothing is",
)
BEST_REASON = Field("best_reason", "text", "Why there is no best point", null="where there is one")
BOUNDED = Field("bounded", "truth", "Whether the region is bounded")
STABLE_FOR_ALL = Field(
    "stable_for_all",
    "text",
    "Whether all alpha_hat, beta_hat > 0 are stable",
    values_of=("stability.StableForAll",),
)
UNCONDITIONAL_DAMPING_RATIO = Field(
    "unconditional_damping_ratio",
    "number",
    "Damping ratio alpha / beta above which every step is stable",
    null="if none is",
)
CRITICAL_DAMPING_LIMIT = Field(
    "critical_damping_limit",
    "number",
    "Largest beta h on alpha = beta up to which all are stable",
    "βh to (α = β)",
    text=stable_steps_text,
    null="if all",
)
CRITICAL_DAMPING_LIMIT_EXACT = Field(
    "critical_damping_limit_exact",
    "text",
    "The same as a rational number",
    null="if all are stable, or where it is not known to be rational",
)
STEPS = Field("steps", "integer", "Number of steps of the method", "steps", "d", null="for the limit of a family")
EVALUATIONS = Field(
    "evaluations",
    "integer",
    "Evaluations of the right-hand side in a step, of an implicit method in an iteration",
    "evaluations",
    "d",
)
ORDER = Field("order", "integer", "Order of accuracy, computed from the coefficients", "order", text=order_text)
ORDER_POSITION_FORCES = Field(
    "order_position_forces", "integer", "Order of accuracy where forces depend on positions alone"
)
ORDER_VELOCITY_FORCES = Field(
    "order_velocity_forces", "integer", "Order of accuracy where forces depend on velocities alone"
)
ERROR_CONSTANT = Field("error_constant", "number", "Error constant of the method", "error constant", text=constant_text)
ERROR_CONSTANT_EXACT = Field(
    "error_constant_exact", "text", "The error constant as a rational", null="where the coefficients are irrational"
)
SOURCE = Field("source", "text", "Where a method or a conversion is from", "source")
IMPLICIT = Field(
    "implicit",
    "truth",
    "Whether a step solves equations",
    "implicit",
    text=lambda row: "yes" if row["implicit"] else "",
)
DIGITS = Field("digits", "integer", "Digits to which rationals stand for irrational coefficients", null="where none do")
GROUP = Field("group", "text", "Heading under which the row is listed", "group")
OMEGA_H = Field(
    "omega_h", "number", "Angle by which the motion that errors are told on turns in a step, omega h", unit="rad"
)
FORCED_ERROR = Field(
    "forced_error",
    "number",
    "Constraint error that the method forces on that motion in the steady state, as a share of its amplitude",
    null=NO_ERROR,
)
TOTAL_ERROR = Field(
    "total_error",
    "number",
    "Constraint error that is left in a run, as such a share: the largest that is forced at any rate up to omega",
    null=NO_ERROR,
)
VELOCITY_ERROR = Field(
    "velocity_error",
    "number",
    "Error forced on the velocity of that motion, as a share of the velocity's amplitude",
    null=NO_ERROR,
)
ORDER_LEFT = Field(
    "order_left",
    "integer",
    "Order in h of the forced error where alpha_hat and beta_hat are held, at most the method's own",
    null="where it is not known",
)
TIMES_LEAST = Field(
    "times_least",
    "number",
    "Total error over that at the point of the goal accurate, which weighs velocities as well",
    null="where errors do not decay, or it is not known, or that point is not",
)
TIMES_LEAST_VELOCITY = Field(
    "times_least_velocity",
    "number",
    "Velocity error over that at the same point",
    null="where errors do not decay, or it is not known, or that point is not",
)
ROLE = Field("role", "text", "Whether the point was given, or is what to take instead", values=("given", "instead"))
GOAL = Field("goal", "text", "What the point was chosen for, or that it is as given", "goal")
WORST = Field(
    "worst",
    "number",
    "Largest modulus of the dominant pole with alpha and beta off by the spread",
    "|z_p| within the spread",
    ".4f",
)
MARGINS_REASON = Field(
    "margins_reason",
    "text",
    "Why h_factor and the factors on alpha and beta are not known",
    null="where they are, or it is unstable",
)
SEARCHED = Field(
    "searched",
    "number",
    "Largest alpha h and beta h that were searched",
    "searched",
    text=searched_text,
    null="where all of the region was, or none of it",
)
SETTLE_STEPS = Field(
    "settle_steps", "integer", "Steps in which the error falls a thousandfold", "steps to 1/1000", "d", null=UNSTABLE
)
SETTLE_SECONDS = Field(
    "settle_seconds",
    "number",
    "Time in which the error falls a thousandfold",
    "seconds to 1/1000",
    ".3g",
    unit="s",
    null="where the point is not stable or known",
)
H_FACTOR = Field(
    "h_factor",
    "number",
    "Factor on h up to which this alpha and beta are stable",
    "stable for h times",
    text=times_text,
    null="where the point is not stable, or any step is",
)
H_LIMIT = Field(
    "h_limit",
    "number",
    "Largest step that is stable at this alpha and beta",
    "stable for constant h (s) to",
    text=step_text,
    unit="s",
    null="where the point is not stable, any step is, or h is unknown",
)
ALPHA_FACTOR_MIN = Field(
    "alpha_factor_min",
    "number",
    "Least factor by which alpha alone may be scaled",
    "α times",
    text=range_text("alpha"),
    null=UNSTABLE,
)
ALPHA_FACTOR_MAX = Field(
    "alpha_factor_max",
    "number",
    "Largest factor by which alpha alone may be scaled",
    null="where the point is not stable, or any",
)
BETA_FACTOR_MIN = Field(
    "beta_factor_min",
    "number",
    "Least factor by which beta alone may be scaled",
    "β times",
    text=range_text("beta"),
    null=UNSTABLE,
)
BETA_FACTOR_MAX = Field(
    "beta_factor_max",
    "number",
    "Largest factor by which beta alone may be scaled",
    null="where the point is not stable, or any",
)
SETTING = Field(
    "setting", "text", "What to write in the engine's words", null="where no point is given, or the engine's values are"
)
SWEEPS = Field(
    "sweeps",
    "truth",
    "Whether the engine solves each constraint by itself, in sweeps, so that what is said of one alone says "
    "little about a chain of them",
)
EXCLUDES = Field("excludes", "text", "What the conversion leaves out", "left out")
SCENE = Field("scene", "text", "Name of the scene", "scene")
RUN_STEPS = Field("run_steps", "integer", "Steps of the whole run", "steps of each", "d")
RUN_EVALUATIONS = Field(
    "run_evaluations", "integer", "Evaluations of the right-hand side in the whole run", "evaluations", "d"
)
FACTORIZATIONS = Field(
    "factorizations",
    "integer",
    "Factorizations of C_q M^-1 C_q^T in the whole run: one for each evaluation, and those of projections",
    "factorizations",
    "d",
)
STABILISE = Field(
    "stabilise", "text", "What holds the constraints", "held by", values=("baumgarte", "projection", "none")
)
C_MAX = Field("c_max", "number", "Largest constraint error", "largest |c| (m, rad)", ".3e", unit="m or rad")
CDOT_MAX = Field(
    "cdot_max", "number", "Largest rate of the constraint error", "largest |ċ| (m/s, rad/s)", ".3e", unit="m/s or rad/s"
)
ENERGY_DRIFT = Field(
    "energy_drift",
    "number",
    "Change of energy that is not the work of drivers and forces",
    "energy drift (J)",
    ".3e",
    unit="J",
)
FAILURE = Field("failure", "text", "Why the run ended early", "failure", null="if it did not")
OBSERVED_ORDER = Field(
    "observed_order",
    "number",
    "Order of accuracy seen between this and the next larger step",
    "order seen",
    ".2f",
    null="where none can be told",
)
PREDICTED_Z_ABS = Field(
    "predicted_z_abs",
    "number",
    "Modulus of the pole predicted for the mechanism at rest: each step multiplies errors by it",
    "|z| there",
    ".7f",
)
PREDICTED_Z_ANGLE_DEG = Field(
    "predicted_z_angle_deg",
    "number",
    "Angle of the pole predicted for the mechanism at rest: errors turn by it in each step",
    "∠z (deg)",
    ".4f",
    unit="degrees",
)
PREDICTED_VERDICT = Field(
    "predicted_verdict", "text", "Verdict predicted for the mechanism at rest", "predicted verdict", values=VERDICTS
)
MEASURED_VERDICT = Field(
    "measured_verdict",
    "text",
    "Verdict of the simulation",
    "measured verdict",
    values_of=("evidence.MeasuredVerdict", "evidence.Outcome"),
)
REASON = Field(
    "reason",
    "text",
    "Why nothing could be measured, or what disturbs it; empty where nothing does",
    "not measurable because",
)
PREDICTED_ERROR = Field(
    "predicted_error",
    "number",
    "Largest constraint error predicted for the later half of the run, with nothing fitted",
    "predicted |c|",
    ".2e",
    unit="m or rad",
    null="where errors do not decay, or the motion cannot be followed for longer than the run",
)
MEASURED_ERROR = Field(
    "measured_error",
    "number",
    "Largest constraint error in the later half of the run",
    "measured |c|",
    ".2e",
    unit="m or rad",
    null="if the run failed",
)

MOVING = (
    KAPPA,
    Field(
        "chi_abs",
        "number",
        "How strongly that turning moves the pole, relative to its modulus and a step's turn",
        "|χ|",
        ".3f",
    ),
    Field(
        "z_abs_moving",
        "number",
        "Growth of errors per step over the motion, to first order in kappa h",
        "|z| moving",
        ".6f",
    ),
    Field(
        "z_abs_worst",
        "number",
        "The largest growth for a moment of the motion, to first order in kappa h",
        "|z| at worst",
        ".6f",
    ),
    Field(
        "double_pole", "truth", "Whether another pole is so near that the first-order law fails and a bound is shown"
    ),
    Field("settled", "truth", "Whether the terms left out cannot change the verdict on the moving mechanism"),
    Field(
        "moving_verdict", "text", "What errors do on the moving mechanism", "moving verdict", values_of=MOVING_VERDICTS
    ),
    Field(
        "safe_speed",
        "number",
        "Factor on the given speed up to which errors shrink, at most as far as the law holds, kappa h = 0.1",
        "safe to speed",
        text=speed_text,
        null="where it diverges at rest, or where nothing turns",
    ),
)
ACCURACY = (
    OMEGA_H,
    Field(
        "accurate_alpha_hat",
        "number",
        "Where the goal accurate chooses to be, in alpha_hat",
        "accurate α̂",
        ".6g",
        null=NO_CHOICE,
    ),
    Field(
        "accurate_beta_hat",
        "number",
        "Where the goal accurate chooses to be, in beta_hat",
        "accurate β̂",
        ".6g",
        null=NO_CHOICE,
    ),
    Field(
        "accurate_z_abs",
        "number",
        "Modulus of the dominant pole where the goal accurate chooses to be",
        "|z_p| there",
        ".6f",
        null=NO_CHOICE,
    ),
    Field(
        "accurate_error",
        "number",
        "What combined_error is where the goal accurate chooses to be",
        "error forced there",
        ".2e",
        null=NO_CHOICE,
    ),
    Field(
        "best_error",
        "number",
        "What combined_error is at best_alpha_hat, best_beta_hat",
        "error forced at the least |z_p|",
        ".2e",
        null=NO_BEST,
    ),
)
APPLIED = Field(
    "applied", "text", "What the engine does to its values before it uses them", null="where nothing is known of it"
)
CHAIN_BODIES = Field("chain_bodies", "integer", "Bodies of the chain, the first held by the world", "bodies", "d")
CHAIN_MASS_RATIO = Field(
    "chain_mass_ratio", "number", "Mass of the last body of the chain over that of each other", "last mass", "g"
)
SWEPT_ITERATIONS = Field(
    "swept_iterations", "integer", "Sweeps that the engine makes in a step", "sweeps", "d", null=NO_SWEEPS
)
SWEPT_Z_ABS = Field(
    "swept_z_abs",
    "number",
    "Factor by which a step multiplies the errors of the constraints that are swept over, in the long run",
    "|z| swept",
    ".4f",
)
STABLE_ITERATIONS = Field(
    "stable_iterations",
    "integer",
    "From how many sweeps the constraints are stable",
    "stable from sweeps",
    "d",
    null="where none tried is",
)
SWEPT_OVER = (
    Field(
        "swept",
        "text",
        "For which constraints `safe` holds of an engine that sweeps: one alone, a chain of bodies, those of a scene; "
        "poles, margins and times are those of one alone",
        "holds for",
        null="where the engine solves all constraints together",
    ),
    Field("swept_constraints", "integer", "How many constraints the engine sweeps over"),
    SWEPT_ITERATIONS,
    SWEPT_Z_ABS,
    Field("swept_accuracy", "number", "How far that factor may be off by rounding, to first order"),
    Field("alone_z_abs", "number", "The same factor for one constraint alone, with as many sweeps"),
    STABLE_ITERATIONS,
)
"""What an engine that sweeps adds: the first to all, the others to --chain and --scene."""
DRIVE = (
    Field("drive", "text", "How the drive is applied", "applied", null="where the method is no drive's"),
    Field("kp", "number", "Stiffness of the drive", "kp", ".4g", unit="N m/rad or N/m"),
    Field(
        "kp_max",
        "number",
        "Largest stable stiffness with this damping",
        "kp to",
        text=gain_limit_text("kp"),
        unit="N m/rad or N/m",
        null="without a limit",
    ),
    Field("kd", "number", "Damping of the drive", "kd", ".4g", unit="N m s/rad or N s/m"),
    Field("inertia", "number", "Inertia that the drive feels", unit="kg m^2 or kg"),
    Field(
        "kd_max",
        "number",
        "Largest stable damping with this stiffness",
        "kd to",
        text=gain_limit_text("kd"),
        unit="N m s/rad or N s/m",
        null="without a limit",
    ),
    Field(
        "used_up",
        "text",
        "Which gain is at its limit or nearest to it",
        "used up",
        text=used_up_text,
        null="where none has one",
        values=("kp", "kd"),
    ),
)
VARYING = (
    Field(
        "varying",
        "text",
        "Whether errors decay for every sequence of steps",
        "varying steps",
        values_of=("stability.Varying",),
    ),
    Field("varying_h_min", "number", "Smallest step of such a sequence", unit="s"),
    Field("varying_h_max", "number", "Largest step of such a sequence", unit="s"),
    Field("hold", "truth", "Whether alpha_hat and beta_hat are held while the step varies, not alpha and beta"),
    Field("certificate_kind", "text", "What the certificate is", null="without a proof"),
    Field("certificate", "text rows", "Rational numbers that prove it, as rows", null="where it takes none"),
    Field(
        "sequence",
        "numbers",
        "Steps of a sequence that lets errors not decay when it is repeated",
        unit="s",
        null="unless refuted",
    ),
    Field(
        "growth",
        "number",
        "Factor on errors after each repetition of that sequence",
        null="unless refuted, and where a step has no solution",
    ),
    Field("shown_by", "text", "The line with which simulate shows errors grow", null="where no run shows it"),
)
LIKENESS = (
    METHOD,
    PREDICTED_Z_ABS,
    PREDICTED_Z_ANGLE_DEG,
    Field("distance", "number", "Distance of the fitted pole from that of the method", "distance", ".1e"),
    Field("allowed", "number", "Largest distance that still fits", "allowed", ".1e"),
    Field("dominant", "truth", "Whether the method's nearest pole is its dominant one"),
    Field("same_as", "text", "Methods that no log can tell from this one"),
    Field(
        "fits",
        "truth",
        "Whether the log may be the method's: it agrees with it within its uncertainty",
        "fits",
        text=yes_no_text("fits"),
    ),
)
LIKE_POINT = (
    ALPHA_HAT.shown("α̂", text=found_text("alpha_hat")),
    BETA_HAT.shown("β̂", text=found_text("beta_hat")),
    Field("alpha_hat_error", "number", "How far alpha_hat may be off by the error of the fit"),
    Field("beta_hat_error", "number", "How far beta_hat may be off by the error of the fit"),
    H,
    ALPHA.shown("α (1/s)", ".7g"),
    BETA.shown("β (1/s)", ".7g"),
)
MOVING_REGION = (
    Field("speed", "number", "Factor on the scene's own speed at which it moves", "speed", "g", null=LEVEL_ROW),
    KAPPA,
    Field(
        "area_moving",
        "number",
        "Area of the region of the moving mechanism in alpha_hat and beta_hat",
        "area moving",
        ".6g",
        null=LEVEL_ROW,
    ),
)
ENGINE_H_LIMIT = Field(
    "engine_h_limit",
    "number",
    "Largest step up to which the engine's values are stable as it reads them at each step",
    unit="s",
    null="where the point is not stable, or any step is",
)
POLES = RowKind(
    "a pole of a method",
    fields=(
        METHOD,
        ALPHA_HAT.hidden,
        BETA_HAT.hidden,
        Z_REAL.shown("pole z", text=pole_text),
        Z_IMAG,
        Z_ABS.shown("|z|", text=modulus_text),
        Z_ANGLE_DEG,
        VERDICT,
        SAFE,
        OMEGA_H,
        FORCED_ERROR,
        TOTAL_ERROR.shown("error", ".1e"),
        VELOCITY_ERROR,
        ORDER_LEFT,
        TIMES_LEAST.shown("× least", text=times_least_text),
        TIMES_LEAST_VELOCITY,
    ),
    added=(
        *MOVING,
        APPLIED,
        EXCLUDES.hidden,
        SWEEPS,
        *SWEPT_OVER,
        *DRIVE,
    ),
    sentence=safety_words,
)
REGIONS = RowKind(
    "the region of a method",
    fields=(
        METHOD,
        Z_ABS_BELOW.shown("|z_p| below", "g"),
        AREA,
        ALPHA_HAT_MIN,
        ALPHA_HAT_MAX,
        BETA_HAT_MIN,
        BETA_HAT_MAX,
        APPROACHED,
        CRITICAL_DAMPING_LIMIT,
        CRITICAL_DAMPING_LIMIT_EXACT,
        BEST_Z_ABS,
        BEST_ALPHA_HAT,
        BEST_BETA_HAT,
        BEST_WHERE,
        BEST_REASON,
        BOUNDED,
        STABLE_FOR_ALL,
        UNCONDITIONAL_DAMPING_RATIO,
    ),
    added=(
        *ACCURACY,
        *MOVING_REGION,
    ),
    sentence=region_sentence,
)
LISTED_METHODS = RowKind(
    "a method in the list",
    fields=(
        METHOD,
        STEPS,
        EVALUATIONS,
        ORDER,
        ORDER_POSITION_FORCES,
        ORDER_VELOCITY_FORCES,
        ERROR_CONSTANT,
        ERROR_CONSTANT_EXACT,
        SOURCE.hidden,
        IMPLICIT,
        DIGITS,
        GROUP.hidden,
    ),
    sentence=method_sentence,
)
NAMED_METHODS = RowKind(
    "a method that was named",
    fields=(
        *LISTED_METHODS.fields[:-1],
        Field("recursion", "text", "The method's recursion"),
        Field("mapping", "text", "The method's mapping from s to z"),
        Field("characteristic_polynomial", "text", "Polynomial in z whose roots are the poles"),
        Field(
            "steady_error",
            "text",
            "What the method forces on a constraint that moves as e^(i omega t), as a share of that motion: "
            "the first term in theta = i omega h where alpha_hat and beta_hat are held",
        ),
        Field("steady_velocity_error", "text", "The same of the velocity, as a share of that of the motion"),
        ORDER_LEFT,
        *REGIONS.fields[1:],
    ),
    sentence=whole_method_sentence,
)
MEMBERS = RowKind(
    "a member of a family, or its limit",
    fields=(
        STEPS.shown("steps", text=lambda row: str(row["steps"] or "limit")),
        METHOD,
        AREA.shown("area", ".10g"),
        ALPHA_HAT_MAX.shown("α̂ to", ".8g"),
        BETA_HAT_MAX.shown("β̂ to", ".8g"),
        BEST_Z_ABS,
        ORDER.shown("order of accuracy", "d"),
        ERROR_CONSTANT.shown("error constant", ".6f"),
    ),
    sentence=member_sentence,
)
CHAINS = RowKind(
    "a chain of bodies in an engine that sweeps",
    fields=(CHAIN_MASS_RATIO, CHAIN_BODIES, SWEPT_ITERATIONS, SWEPT_Z_ABS, STABLE_ITERATIONS),
    sentence=chain_sentence,
)
CHOICES = RowKind(
    "a choice",
    fields=(
        METHOD,
        GOAL,
        ALPHA_HAT,
        BETA_HAT,
        ALPHA,
        BETA,
        VERDICT,
        SAFE,
        Z_REAL,
        Z_IMAG,
        Z_ABS,
        Z_ANGLE_DEG.shown("∠z_p (deg)", ".1f"),
        WORST,
        SEARCHED,
        H.hidden,
        SETTLE_STEPS,
        SETTLE_SECONDS,
        MARGINS_REASON,
        H_FACTOR.hidden,
        H_LIMIT,
        ALPHA_FACTOR_MIN,
        ALPHA_FACTOR_MAX,
        BETA_FACTOR_MIN,
        BETA_FACTOR_MAX,
        OMEGA_H,
        FORCED_ERROR,
        TOTAL_ERROR.shown("error forced", text=both_errors_text),
        VELOCITY_ERROR,
        ORDER_LEFT.shown("order left", "d"),
        TIMES_LEAST,
        TIMES_LEAST_VELOCITY.shown("times the least error", text=both_times_text),
    ),
    added=(*MOVING, *VARYING, SWEEPS, *SWEPT_OVER, *DRIVE, ENGINE_H_LIMIT, SETTING.shown("to paste")),
    sentence=answer_sentence,
)
CHECKED = RowKind(
    "a point, or what to take instead",
    fields=(ROLE, *CHOICES.fields),
    added=(*CHOICES.added, APPLIED, EXCLUDES.hidden),
    sometimes=("excludes",),
    sentence=answer_sentence,
)
LARGEST_STEPS = RowKind(
    "the largest step of alpha and beta, without a step",
    fields=(
        ROLE,
        METHOD,
        ALPHA,
        BETA,
        SAFE,
        H_LIMIT.shown("stable for constant h (s) to", text=safe_step_text),
    ),
    sentence=step_sentence,
)
LINTED = RowKind(
    "an element of a model",
    fields=(
        Field("element", "text", "Name of the element of a model", "element"),
        Field("kind", "text", "What the element is", "kind"),
        SETTING,
        Field("judged", "text", "Which of its points is judged, and why", "judged"),
        ALPHA_HAT.shown("α̂", ".4f"),
        BETA_HAT.shown("β̂", ".4f"),
        Field("map", "text", "Method whose region judges the element", "map"),
        VERDICT,
        SAFE,
        Z_ABS.shown("|z|", ".4f"),
        H_FACTOR,
        Field("advice", "text", "What to write instead", "advice", null="where nothing is to be changed"),
    ),
    sometimes=("alpha_hat", "beta_hat", "map", "verdict", "safe", "z_abs"),
)
ENGINES_LISTED = RowKind(
    "an engine",
    fields=(
        Field("engine", "text", "Name of an engine", "engine"),
        Field(
            "level",
            "text",
            "Where the engine's feedback acts",
            "level",
            values_of=("engines.Level",),
        ),
        METHOD.shown("method", text=lambda row: str(row["method"] or "yours")),
        Field("parameters", "text", "What the engine calls the feedback's parameters", "parameters"),
        Field("optional", "text", "Which of the parameters may be left away", "then"),
        Field("units", "text", "Units of the parameters, in their order", "units"),
        SETTING.shown("for this point"),
        Field(
            "witness",
            "text",
            "With which engine a run has confirmed the conversion",
            "rests on",
            text=lambda row: "a run" if row["witness"] else "its source",
            null="where its source alone says it",
        ),
        SOURCE,
        EXCLUDES,
        SWEEPS.shown("sweeps"),
        SWEPT_ITERATIONS.hidden,
        Field("swept_word", "text", "What the engine calls their number", null=NO_SWEEPS),
        Field("swept_source", "text", "Where it is from how the engine sweeps", null=NO_SWEEPS),
        Field("swept_excludes", "text", "What is left out of how it sweeps", null=NO_SWEEPS),
    ),
    sometimes=("method",),
    sentence=engine_sentence,
)
SIMULATIONS = RowKind(
    "a run",
    fields=(
        SCENE,
        METHOD,
        STABILISE,
        ALPHA_HAT.shown("α̂", ".6g"),
        BETA_HAT.shown("β̂", ".6g"),
        H.shown("h (s)", "g"),
        Field("time", "number", "When the run ended", "until (s)", ".6g", unit="s"),
        C_MAX,
        CDOT_MAX,
        ENERGY_DRIFT,
        Field("driver_work", "number", "Work of the drivers", "work of drivers (J)", ".3e", unit="J"),
        Field("force_work", "number", "Work of the applied forces", "work of forces (J)", ".3e", unit="J"),
        RUN_EVALUATIONS,
        FACTORIZATIONS,
        Field(
            "least_pivot",
            "number",
            "Least relative pivot of C_q M^-1 C_q^T; small near a singular configuration",
            "least pivot",
            ".1e",
        ),
        Field("pivot_time", "number", "When that pivot was least", "least pivot at (s)", ".6g", unit="s"),
        Field(
            "iterations",
            "integer",
            "Newton's iterations of the whole run",
            "Newton's iterations",
            "d",
            null="for an explicit method",
        ),
        Field(
            "singular_passages",
            "integer",
            "Number of singular configurations that the run went through",
            "singular passages",
            "d",
        ),
        FAILURE,
    ),
    sentence=run_sentence,
)
MEASUREMENTS = RowKind(
    "a measured pole",
    fields=(
        SCENE.hidden,
        METHOD,
        ALPHA_HAT,
        BETA_HAT,
        Field("predicted_z_real", "number", "Real part of the pole predicted for the mechanism at rest"),
        Field(
            "predicted_z_imag",
            "number",
            "Imaginary part of the pole predicted for the mechanism at rest, that of the upper one of a pair",
        ),
        PREDICTED_Z_ABS.shown("predicted |z|", ".6f"),
        Field("law_z_abs", "number", "Modulus predicted by the first-order law of the motion", "|z| by the law", ".6f"),
        Field(
            "law_verdict", "text", "Verdict predicted by the first-order law of the motion", values_of=MOVING_VERDICTS
        ),
        Field(
            "floquet_z_abs",
            "number",
            "Modulus per step of the linearised steps over the motion the method makes: exact where that "
            "begins anew, else a growth over the run",
            "|z| over the motion",
            ".6f",
            null="without --floquet",
        ),
        Field("measured_z_real", "number", "Real part of the pole measured in the simulation", null=NOT_MEASURED),
        Field(
            "measured_z_imag",
            "number",
            "Imaginary part of the pole measured in the simulation, that of the upper one of a pair",
            null=NOT_MEASURED,
        ),
        Field(
            "measured_z_abs",
            "number",
            "Modulus of the pole measured in the simulation: each step multiplies errors by it",
            "measured |z|",
            ".6f",
            null=NOT_MEASURED,
        ),
        Field(
            "measured_rate",
            "number",
            "Growth per step measured over a whole revolution beside the motion the method makes, the first left out",
            "measured over the motion",
            ".6f",
            null="without --floquet, and where it cannot be followed for so long",
        ),
        Field(
            "difference_z_abs",
            "number",
            "Modulus measured less that predicted",
            "difference of |z|",
            "+.1e",
            null=NOT_MEASURED,
        ),
        PREDICTED_Z_ANGLE_DEG.shown("predicted ∠z (deg)", ".3f"),
        Field(
            "measured_z_angle_deg",
            "number",
            "Angle of the pole measured in the simulation: errors turn by it in each step",
            "measured ∠z (deg)",
            ".3f",
            unit="degrees",
            null=NOT_MEASURED,
        ),
        Field(
            "difference_z_angle_deg",
            "number",
            "Angle measured less that predicted",
            "difference of ∠z (deg)",
            "+.0e",
            unit="degrees",
            null=NOT_MEASURED,
        ),
        PREDICTED_VERDICT,
        MEASURED_VERDICT,
        Field("difference_z_real", "number", "Real part measured less that predicted", null=NOT_MEASURED),
        Field("difference_z_imag", "number", "Imaginary part measured less that predicted", null=NOT_MEASURED),
        Field(
            "verdicts_agree",
            "truth",
            "Whether predicted and measured verdict agree",
            "verdicts agree",
            text=yes_no_text("verdicts_agree"),
            null="where either is not settled",
        ),
        Field(
            "right",
            "text",
            "Which predictions have the measured verdict: at rest, law, exact (or over the run)",
            "whose verdict was right",
        ),
        REASON,
        Field("measurable", "truth", "Whether the pole could be measured"),
    ),
    sentence=measurement_sentence,
)
SUMMARIES = RowKind(
    "how well the measured poles of a method agree with the predicted ones",
    fields=(
        METHOD,
        Field("points", "integer", "Points that were tried", "points", "d"),
        Field("measured", "integer", "Points at which a pole could be measured", "measured points", "d"),
        Field("median_error", "number", "Median difference of the moduli", "median error of |z|", ".1e"),
        Field("largest_error", "number", "Largest difference of the moduli", "largest error of |z|", ".1e"),
        Field("called", "integer", "Points at which both verdicts are settled", "verdicts called", "d"),
        Field("wrong", "integer", "Points of these whose verdicts disagree", "wrong verdicts", "d"),
        Field("followed", "integer", "Points followed over a revolution", "followed over a revolution", "d"),
        Field("map_error", "number", "Median error of the rate at rest", "median error at rest", ".1e"),
        Field("law_error", "number", "Median error of the law's rate", "median error of the law", ".1e"),
        Field("floquet_error", "number", "Median error of the exact rate", "median error of the exact rate", ".1e"),
        Field(
            "wrong_sides",
            "text",
            "Of how many points each rate is on the wrong side of one",
            "on the wrong side of one: at rest, law, exact",
        ),
    ),
    sentence=summary_sentence,
)
VERDICT_MAPS = RowKind(
    "a map of simulated verdicts",
    fields=(
        SCENE,
        METHOD,
        H,
        Field("runs", "integer", "Number of runs", "runs", "d"),
        Field("undecided", "integer", "Runs that gave no verdict"),
        RUN_STEPS,
        Field("judged_runs", "integer", "Runs that gave a verdict", "gave a verdict", "d"),
        Field("agreeing", "integer", "Runs whose verdict is the predicted one", "as predicted", "d"),
        Field(
            "agreeing_share",
            "number",
            "Share of the runs with a verdict whose verdict is the predicted one",
            "agreement",
            ".2%",
            null="if no run has a verdict",
        ),
        Field(
            "band",
            "number",
            "Distance of the modulus from one below which a verdict is too close to call",
            "too close to call: | |z_p| - 1 | below",
            "g",
        ),
        Field(
            "too_close",
            "integer",
            "Runs so close to one, or closer than the motion moves the predicted pole",
            "too close, or moved by so much",
            "d",
        ),
        Field(
            "farthest",
            "number",
            "Largest distance of the modulus from one of a run that disagrees",
            "largest | |z_p| - 1 | that disagrees",
            ".2e",
            null="if none disagrees",
        ),
        Field("disagreeing", "integer", "Runs not too close to call that disagree", "disagreeing, not too close", "d"),
    ),
    sentence=verdict_map_sentence,
)
FORCED = RowKind(
    "what a method forces on a mechanism",
    fields=(
        SCENE.hidden,
        METHOD,
        Field("gain_share", "number", "Factor on alpha and beta of the point that was chosen or given", "gains", "g"),
        ALPHA_HAT.shown("α̂", ".4g"),
        BETA_HAT.shown("β̂", ".4g"),
        H.shown("h (s)", "g"),
        PREDICTED_ERROR,
        MEASURED_ERROR,
        Field(
            "quotient",
            "number",
            "Measured over predicted error, 1 if they agree",
            "quotient",
            ".3f",
            null="where `reason` says why",
        ),
        Field(
            "predicted_order",
            "number",
            "Order in h of the predicted error between this and the next larger step",
            "order predicted",
            ".2f",
            null="of the largest step",
        ),
        OBSERVED_ORDER,
        REASON.shown("not compared"),
    ),
    sentence=forced_sentence,
)
WITNESSED = RowKind(
    "a run of an engine that is not ours",
    fields=(
        SCENE,
        Field("integrator", "text", "What the other engine calls its integrator", "MuJoCo's integrator"),
        METHOD,
        ALPHA_HAT.shown("α̂", ".4f"),
        BETA_HAT.shown("β̂", ".4f"),
        Field(
            "times_boundary",
            "number",
            "Distance of the point from the origin, in those of the boundary on its ray",
            "times the boundary",
            "g",
        ),
        PREDICTED_Z_ABS.shown("predicted |z|", ".4f"),
        PREDICTED_VERDICT,
        MEASURED_VERDICT.shown("verdict seen"),
        Field(
            "remaining",
            "number",
            "Largest constraint error in the last tenth of the run",
            "largest |c| at the end (m)",
            ".1e",
            unit="m",
        ),
        RUN_STEPS.shown("after steps", "d"),
    ),
    sentence=witness_sentence,
)
PROBED = RowKind(
    "the pole in a column of a log, or a method beside it, or a point at which a method has it",
    fields=(
        Field("column", "text", "Name of the column of the log", "column"),
        Z_REAL.shown("pole z, per row", text=fitted_pole_text),
        Z_IMAG,
        Z_ABS.shown("|z|", ".7f"),
        Z_ANGLE_DEG.shown("∠z (deg)", ".4f"),
        Field("uncertainty", "number", "How far the fitted pole may be off", "± of z", ".1e", null=NOT_MEASURED),
        Field("samples", "integer", "Samples that the fit has used", "rows"),
        REASON.shown("what is to be said of it"),
    ),
    added=(
        *LIKENESS,
        *LIKE_POINT,
    ),
    sometimes=(
        "samples",
        *(field.key for field in (Z_REAL, Z_IMAG, Z_ABS, Z_ANGLE_DEG, REASON, *LIKENESS, *LIKE_POINT)),
    ),
)
SWEPT = RowKind(
    "a run of a method with a step",
    fields=(
        METHOD,
        STABILISE,
        Field("advised", "truth", "Whether the point is the choice of the goal accurate for the scene's motion"),
        H.shown("h (s)", "g"),
        ALPHA_HAT.shown("α̂", ".4g"),
        BETA_HAT.shown("β̂", ".4g"),
        Z_ABS,
        Field(
            "trajectory_error",
            "number",
            "Largest error of the coordinates",
            "trajectory error (m, rad)",
            text=diverged_text,
            unit="m or rad",
            null="if the run failed",
        ),
        OBSERVED_ORDER,
        C_MAX.shown("largest |c| (m, rad)", ".1e"),
        MEASURED_ERROR.shown("in the later half", ".1e"),
        PREDICTED_ERROR.shown("predicted there", ".1e"),
        Field("c_rms", "number", "Root mean square of the constraint error", "rms c (m, rad)", ".1e", unit="m or rad"),
        CDOT_MAX.shown("largest |ċ| (m/s, rad/s)", ".1e"),
        Field(
            "cdot_rms",
            "number",
            "Root mean square of the rate of the constraint error",
            "rms ċ (m/s, rad/s)",
            ".1e",
            unit="m/s or rad/s",
        ),
        ENERGY_DRIFT.shown("energy drift (J)", ".1e"),
        RUN_EVALUATIONS,
        FACTORIZATIONS,
        Field(
            "seconds",
            "number",
            "Processor time of the run, the median of the repeats",
            "time (ms)",
            text=milliseconds_text,
            unit="s",
        ),
        Field("seconds_min", "number", "Least processor time of the repeats", unit="s"),
        Field("seconds_max", "number", "Largest processor time of the repeats", unit="s"),
        Field(
            "front",
            "text",
            "T if no run is both cheaper and nearer to the trajectory, c if none is to the constraints",
            "front",
        ),
        FAILURE,
    ),
    sometimes=("z_abs",),
    sentence=cost_sentence,
)
FRONTS = RowKind(
    "the least error that a method can force with |z_p| at most so large",
    fields=(
        METHOD,
        OMEGA_H,
        Z_ABS_BELOW,
        Z_ABS.hidden,
        ALPHA_HAT.shown("α̂", ".6g"),
        BETA_HAT.shown("β̂", ".6g"),
        H,
        ALPHA,
        BETA,
        TOTAL_ERROR.shown("error of position", ".2e"),
        VELOCITY_ERROR.shown("of velocity", ".2e"),
        Field(
            "combined_error",
            "number",
            "The largest constraint error that is forced at any rate and velocity_error, such shares, added up",
            "both",
            ".2e",
        ),
    ),
    sentence=front_sentence,
)
EXTREMES = RowKind(
    "a check",
    fields=(
        GROUP,
        Field("case", "text", "What was looked at", "case"),
        Field("expected", "text", "What must come out, stated beforehand", "expected"),
        Field("seen", "text", "What came out", "seen"),
        Field("held", "truth", "Whether what came out is what was expected", "held", text=yes_no_text("held")),
    ),
    sentence=check_sentence,
)
CLAIMS = RowKind(
    "a claim of the paper",
    fields=(
        Field("where", "text", "Where in the paper the claim stands", "where"),
        Field("claim", "text", "What the paper claims", "claim"),
        Field("paper", "text", "What the paper says of it, in numbers", "paper"),
        Field("here", "text", "What came out here", "here"),
        Field(
            "agreement",
            "text",
            "Whether the claim is confirmed",
            "agreement",
            values=("confirmed", "confirmed with a correction", "not confirmed", "cannot be tested"),
        ),
    ),
    sentence=finding_sentence,
)
_BY_KEY = {field.key: field for field in DRIVE}
HELD = RowKind(
    "a drive that is held or late",
    fields=(
        METHOD,
        _BY_KEY["drive"],
        VERDICT,
        SAFE,
        Z_ABS.shown("|z|", ".4f"),
        Field(
            "fresh_z_abs",
            "number",
            "Modulus of the same drive's pole if each step computes and applies its torque",
            "|z| if fresh",
            ".4f",
        ),
        H,
        Field("every", "integer", "Steps of the physics from one computation of the torque to the next"),
        Field("late", "number", "Steps of the physics until a torque is applied"),
        Field("filter", "number", "Time constant of the filter through which the velocity is seen", unit="s"),
        _BY_KEY["inertia"],
        _BY_KEY["kp"],
        _BY_KEY["kp_max"],
        _BY_KEY["kd"],
        Field(
            "kd_min",
            "number",
            "Least stable damping with this stiffness",
            "kd from",
            ".4g",
            unit="N m s/rad or N s/m",
            null="where none helps",
        ),
        _BY_KEY["kd_max"],
        Field(
            "every_max",
            "integer",
            "Steps up to which the torque may be held, the rest as it is",
            "every to",
            "d",
            null="where even one is unstable",
        ),
        Field(
            "late_max",
            "integer",
            "Whole steps up to which the torque may be late, the rest as it is",
            "late to",
            "d",
            null="where even none is unstable",
        ),
        Field(
            "held_by",
            "text",
            "What an unstable drive would be stable without, or which number of a stable one is nearest to its end",
            "used up",
            null="where none has an end",
            values_of=("questions.UsedUp",),
        ),
    ),
    sentence=held_sentence,
)

ROW_KINDS: Mapping[str, Sequence[RowKind]] = {
    "poles": (POLES,),
    "region": (REGIONS, HELD),
    "methods": (
        LISTED_METHODS,
        NAMED_METHODS,
    ),
    "family": (MEMBERS,),
    "choose": (CHOICES, HELD),
    "check": (
        CHECKED,
        LARGEST_STEPS,
        HELD,
    ),
    "lint": (LINTED,),
    "engines": (ENGINES_LISTED,),
    "chains": (CHAINS,),
    "simulate": (SIMULATIONS,),
    "verify": (
        MEASUREMENTS,
        VERDICT_MAPS,
        FORCED,
        WITNESSED,
    ),
    "probe": (PROBED,),
    "tradeoff": (
        SWEPT,
        FRONTS,
    ),
    "extremes": (EXTREMES,),
    "paper": (CLAIMS,),
}
"""The kinds of rows that each command prints."""

FIELDS: Mapping[str, Field] = {
    field.key: field for kinds in ROW_KINDS.values() for kind in kinds for field in (*kind.fields, *kind.added)
}
"""Every key that any command prints, by name."""
