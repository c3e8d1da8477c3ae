"""The words of JSON and CSV: what every key of every command's rows means, once for all of them.

A key is added by a line here and its name among the keys of its command in `schemas`; tests hold what commands print
against both.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

Kind = Literal["number", "integer", "text", "truth", "numbers", "text rows"]
"""Of a value; numbers are a list, text rows a list of lists of texts."""


@dataclass(frozen=True)
class Key:
    """What a key's value is: its kind, its meaning, its unit ("" where it has none), and when it is null ("": never).

    `values` are all that a text can be, where there are only a few.
    """

    kind: Kind
    meaning: str
    unit: str = ""
    null: str = ""
    values: tuple[str, ...] = ()

    @property
    def description(self) -> str:
        """The meaning with the unit, and when there is no value, as one text."""
        unit = f", in {self.unit}" if self.unit else ""
        return f"{self.meaning}{unit}{f'; null {self.null}' if self.null else ''}."


VERDICTS = ("converges", "marginal", "diverges")
MOVING_VERDICTS = ("converges", "diverges", "not settled for this mechanism")
OUTCOMES = ("converges", "diverges", "neither", "too close to call")
UNKNOWN_STEP = "where no step is given"
UNSTABLE = "where the point is not stable"
NOT_MEASURED = "where nothing could be measured; `reason` says why"
LEVEL_ROW = "in the row of a level below 1, which is of the mechanism at rest"
NO_ERROR = "where errors do not decay, or it is not known"
NO_CHOICE = "where no feedback decays so fast"
NO_BEST = "where there is no best point; `best_reason` says why"
UNBOUNDED = "where the region has no end there, or is empty"


def _pole(prefix: str, whose: str, null: str = "") -> dict[str, Key]:
    """Return the four keys of a pole: its parts, its modulus, its angle."""
    return {
        f"{prefix}z_real": Key("number", f"Real part of {whose}", null=null),
        f"{prefix}z_imag": Key("number", f"Imaginary part of {whose}, that of the upper one of a pair", null=null),
        f"{prefix}z_abs": Key("number", f"Modulus of {whose}: by so much errors shrink or grow at a step", null=null),
        f"{prefix}z_angle_deg": Key("number", f"Angle of {whose}: so far errors turn at a step", "degrees", null),
    }


VOCABULARY: Mapping[str, Key] = {
    # a method, a point, a step
    "method": Key("text", "Name of the integration method, with @m where its step is m times h"),
    "alpha_hat": Key("number", "Dimensionless damping of the feedback, 2 alpha h"),
    "beta_hat": Key("number", "Dimensionless stiffness of the feedback, beta^2 h^2"),
    "alpha": Key("number", "Damping of the feedback c'' + 2 alpha c' + beta^2 c = 0", "1/s", UNKNOWN_STEP),
    "beta": Key(
        "number", "Stiffness of the same feedback as a rate", "1/s", f"{UNKNOWN_STEP}, and for a negative beta_hat"
    ),
    "h": Key("number", "Step size", "s", UNKNOWN_STEP),
    # poles and verdicts
    **_pole("", "the pole"),
    "verdict": Key("text", "What errors do, proven on the numbers as typed", values=VERDICTS),
    "safe": Key("truth", "Whether every error is proven to shrink; with --scene, on the moving mechanism as well"),
    # a mechanism that moves
    "kappa": Key("number", "How fast the directions of the constraints turn, at most", "1/s", LEVEL_ROW),
    "chi_abs": Key("number", "How strongly that turning moves the pole, relative to its modulus and a step's turn"),
    "z_abs_moving": Key("number", "Growth of errors per step over the motion, to first order in kappa h"),
    "z_abs_worst": Key("number", "The largest growth for a moment of the motion, to first order in kappa h"),
    "double_pole": Key("truth", "Whether another pole is so near that the first-order law fails and a bound is shown"),
    "settled": Key("truth", "Whether the terms left out cannot change the verdict on the moving mechanism"),
    "moving_verdict": Key("text", "What errors do on the moving mechanism", values=MOVING_VERDICTS),
    "safe_speed": Key(
        "number",
        "Times the given speed up to which errors shrink, at most as far as the law holds, kappa h = 0.1",
        null="where it diverges at rest, or where nothing turns",
    ),
    "speed": Key("number", "Times its own speed at which the scene moves", null=LEVEL_ROW),
    "area_moving": Key(
        "number", "Area of the region of the moving mechanism in alpha_hat and beta_hat", null=LEVEL_ROW
    ),
    # a region
    "z_abs_below": Key("number", "What |z_p| is below, or on a front at most; 1 where the method is stable"),
    "area": Key("number", "Area of the region in alpha_hat and beta_hat", null="where it is infinite or empty"),
    "alpha_hat_min": Key("number", "Smallest alpha_hat of the region", null=UNBOUNDED),
    "alpha_hat_max": Key("number", "Largest alpha_hat of the region", null=UNBOUNDED),
    "beta_hat_min": Key("number", "Smallest beta_hat of the region", null=UNBOUNDED),
    "beta_hat_max": Key("number", "Largest beta_hat of the region", null=UNBOUNDED),
    "approached": Key(
        "text",
        "Those of the four limits that no edge attains: the region comes near them far out",
        null="where edges attain all that there are",
    ),
    "best_z_abs": Key("number", "Smallest modulus of the dominant pole over the region", null=NO_BEST),
    "best_alpha_hat": Key("number", "Where that modulus is smallest, in alpha_hat", null=NO_BEST),
    "best_beta_hat": Key("number", "Where that modulus is smallest, in beta_hat", null=NO_BEST),
    "best_where": Key("text", "Which poles meet where the modulus is smallest, in words", null="where nothing is"),
    "best_reason": Key("text", "Why there is no best point", null="where there is one"),
    "bounded": Key("truth", "Whether the region is bounded"),
    "stable_for_all": Key(
        "text", "Whether all alpha_hat, beta_hat > 0 are stable", values=("proven", "no unstable point found", "no")
    ),
    "unconditional_damping_ratio": Key(
        "number", "Damping ratio alpha / beta above which every step is stable", null="if none is"
    ),
    "critical_damping_limit": Key("number", "Largest beta h on alpha = beta up to which all are stable", null="if all"),
    "critical_damping_limit_exact": Key(
        "text", "The same as a rational number", null="if all are stable, or where it is not known to be rational"
    ),
    # a method by itself
    "steps": Key("integer", "Number of steps of the method", null="for the limit of a family"),
    "evaluations": Key(
        "integer", "Evaluations of the right-hand side in a step, of an implicit method in an iteration"
    ),
    "order": Key("integer", "Order of accuracy, computed from the coefficients"),
    "order_position_forces": Key("integer", "Order of accuracy where forces depend on positions alone"),
    "order_velocity_forces": Key("integer", "Order of accuracy where forces depend on velocities alone"),
    "error_constant": Key("number", "Error constant of the method"),
    "error_constant_exact": Key(
        "text", "The error constant as a rational", null="where the coefficients are irrational"
    ),
    "source": Key("text", "Where a method or a conversion is from"),
    "implicit": Key("truth", "Whether a step solves equations"),
    "digits": Key("integer", "Digits to which rationals stand for irrational coefficients", null="where none do"),
    "group": Key("text", "Heading under which the row is listed"),
    "recursion": Key("text", "The method's recursion"),
    "mapping": Key("text", "The method's mapping from s to z"),
    "characteristic_polynomial": Key("text", "Polynomial in z whose roots are the poles"),
    "steady_error": Key(
        "text",
        "What the method forces on a constraint that moves as e^(i omega t), as a share of that motion: the first term "
        "in theta = i omega h where alpha_hat and beta_hat are held",
    ),
    "steady_velocity_error": Key("text", "The same of the velocity, as a share of that of the motion"),
    # what accuracy a feedback costs
    "omega_h": Key("number", "How far the motion that errors are told of turns in a step, omega h", "rad"),
    "forced_error": Key(
        "number",
        "Constraint error that the method forces on that motion in the steady state, as a share of its amplitude",
        null=NO_ERROR,
    ),
    "total_error": Key(
        "number",
        "Constraint error that is left in a run, as such a share: the largest that is forced at any rate up to omega",
        null=NO_ERROR,
    ),
    "velocity_error": Key(
        "number", "Error forced on the velocity of that motion, as a share of the velocity's amplitude", null=NO_ERROR
    ),
    "order_left": Key(
        "integer",
        "Order in h of the forced error where alpha_hat and beta_hat are held, at most the method's own",
        null="where it is not known",
    ),
    "times_least": Key(
        "number",
        "Total error over that at the point of the goal accurate, which weighs velocities as well",
        null=f"{NO_ERROR}, or that point is not",
    ),
    "times_least_velocity": Key(
        "number", "Velocity error over that at the same point", null=f"{NO_ERROR}, or that point is not"
    ),
    "combined_error": Key(
        "number", "The largest constraint error that is forced at any rate and velocity_error, such shares, added up"
    ),
    "accurate_alpha_hat": Key("number", "Where the goal accurate chooses to be, in alpha_hat", null=NO_CHOICE),
    "accurate_beta_hat": Key("number", "Where the goal accurate chooses to be, in beta_hat", null=NO_CHOICE),
    "accurate_z_abs": Key(
        "number", "Modulus of the dominant pole where the goal accurate chooses to be", null=NO_CHOICE
    ),
    "accurate_error": Key("number", "What combined_error is where the goal accurate chooses to be", null=NO_CHOICE),
    "best_error": Key("number", "What combined_error is at best_alpha_hat, best_beta_hat", null=NO_BEST),
    # choices and checks
    "role": Key("text", "Whether the point was given, or is what to take instead", values=("given", "instead")),
    "goal": Key("text", "What the point was chosen for, or that it is as given"),
    "worst": Key("number", "Largest modulus of the dominant pole with alpha and beta off by the spread"),
    "margins_reason": Key(
        "text", "Why h_factor and the factors on alpha and beta are not known", null="where they are, or it is unstable"
    ),
    "searched": Key(
        "number", "Largest alpha h and beta h that were searched", null="where all of the region was, or none of it"
    ),
    "settle_steps": Key("integer", "Steps in which the error falls a thousandfold", null=UNSTABLE),
    "settle_seconds": Key("number", "Time in which the error falls a thousandfold", "s", f"{UNSTABLE} or known"),
    "h_factor": Key("number", "Times h up to which alpha and beta stay stable", null=f"{UNSTABLE}, or any step is"),
    "h_limit": Key(
        "number", "Largest step that is stable at this alpha and beta", "s", f"{UNSTABLE}, any step is, or h is unknown"
    ),
    "engine_h_limit": Key(
        "number",
        "Largest step up to which the engine's values are stable as it reads them at each step",
        "s",
        f"{UNSTABLE}, or any step is",
    ),
    "alpha_factor_min": Key("number", "Least factor by which alpha alone may be scaled", null=UNSTABLE),
    "alpha_factor_max": Key("number", "Largest factor by which alpha alone may be scaled", null=f"{UNSTABLE}, or any"),
    "beta_factor_min": Key("number", "Least factor by which beta alone may be scaled", null=UNSTABLE),
    "beta_factor_max": Key("number", "Largest factor by which beta alone may be scaled", null=f"{UNSTABLE}, or any"),
    "varying": Key(
        "text", "Whether errors decay for every sequence of steps", values=("proven", "refuted", "not known")
    ),
    "varying_h_min": Key("number", "Smallest step of such a sequence", "s"),
    "varying_h_max": Key("number", "Largest step of such a sequence", "s"),
    "hold": Key("truth", "Whether alpha_hat and beta_hat are held while the step varies, not alpha and beta"),
    "certificate_kind": Key("text", "What the certificate is", null="without a proof"),
    "certificate": Key("text rows", "Rational numbers that prove it, as rows", null="where it takes none"),
    "sequence": Key("numbers", "Steps that do not let errors decay when they are repeated", "s", "unless refuted"),
    "growth": Key(
        "number",
        "Times as large as before that errors are after each such repetition",
        null="unless refuted, and where a step has no solution",
    ),
    "shown_by": Key("text", "The line with which simulate shows errors grow", null="where no run shows it"),
    # engines
    "engine": Key("text", "Name of an engine"),
    "level": Key("text", "Where the engine's feedback acts", values=("acceleration", "velocity", "position")),
    "parameters": Key("text", "What the engine calls the feedback's parameters"),
    "setting": Key(
        "text", "What to write in the engine's words", null="where no point is given, or the engine's values are"
    ),
    "sweeps": Key(
        "truth",
        "Whether the engine solves each constraint by itself, in sweeps, so that what is said of one alone says little "
        "about a chain of them",
    ),
    "excludes": Key("text", "What the conversion leaves out"),
    "optional": Key("text", "Which of the parameters may be left away"),
    "units": Key("text", "Units of the parameters, in their order"),
    "witness": Key(
        "text", "With which engine a run has confirmed the conversion", null="where its source alone says it"
    ),
    "applied": Key(
        "text", "What the engine does to its values before it uses them", null="where nothing is known of it"
    ),
    # drives
    "drive": Key("text", "How the drive is applied", null="where the method is no drive's"),
    "kp": Key("number", "Stiffness of the drive", "N m/rad or N/m"),
    "kd": Key("number", "Damping of the drive", "N m s/rad or N s/m"),
    "inertia": Key("number", "Inertia that the drive feels", "kg m^2 or kg"),
    "kp_max": Key("number", "Largest stable stiffness with this damping", "N m/rad or N/m", "without a limit"),
    "kd_max": Key("number", "Largest stable damping with this stiffness", "N m s/rad or N s/m", "without a limit"),
    "used_up": Key(
        "text", "Which gain is at its limit or nearest to it", null="where none has one", values=("kp", "kd")
    ),
    # models and logs
    "element": Key("text", "Name of the element of a model"),
    "kind": Key("text", "What the element is"),
    "judged": Key("text", "Which of its points is judged, and why"),
    "map": Key("text", "Method whose region judges the element"),
    "advice": Key("text", "What to write instead", null="where nothing is to be changed"),
    "uncertainty": Key("number", "How far the fitted pole may be off", null=NOT_MEASURED),
    "samples": Key("integer", "Samples that the fit has used"),
    "distance": Key(
        "number",
        "Distance of the fitted pole from that of the method; or by which share of themselves its poles must shift for "
        "its recursion to explain the log; or, by exclusion, which share of a term its recursion leaves over at least",
        null=NOT_MEASURED,
    ),
    "judged_by": Key(
        "text",
        "How a method is judged: by its pole, by its recursion, or, where the log can test neither, by whether it can "
        "exclude the method; `reason` says so",
        values=("pole", "recursion", "exclusion"),
    ),
    "fits": Key(
        "truth", "Whether the log may be the method's: agrees with it within its uncertainty, or cannot exclude it"
    ),
    "column": Key("text", "Name of the column of the log"),
    "allowed": Key("number", "Largest distance that still fits"),
    "dominant": Key("truth", "Whether the method's nearest pole is its dominant one"),
    "same_as": Key("text", "Methods that no log can tell from this one"),
    "alpha_hat_error": Key("number", "How far alpha_hat may be off by the error of the fit"),
    "beta_hat_error": Key("number", "How far beta_hat may be off by the error of the fit"),
    # runs
    "scene": Key("text", "Name of the scene"),
    "time": Key("number", "When the run ended", "s"),
    "run_steps": Key("integer", "Steps of the whole run"),
    "run_evaluations": Key("integer", "Evaluations of the right-hand side in the whole run"),
    "c_max": Key("number", "Largest constraint error", "m or rad"),
    "c_rms": Key("number", "Root mean square of the constraint error", "m or rad"),
    "cdot_max": Key("number", "Largest rate of the constraint error", "m/s or rad/s"),
    "cdot_rms": Key("number", "Root mean square of the rate of the constraint error", "m/s or rad/s"),
    "energy_drift": Key("number", "Change of energy that is not the work of drivers and forces", "J"),
    "driver_work": Key("number", "Work of the drivers", "J"),
    "force_work": Key("number", "Work of the applied forces", "J"),
    "iterations": Key("integer", "Newton's iterations of the whole run", null="for an explicit method"),
    "least_pivot": Key("number", "Least relative pivot of C_q M^-1 C_q^T; small near a singular configuration"),
    "pivot_time": Key("number", "When that pivot was least", "s"),
    "singular_passages": Key("integer", "Number of singular configurations that the run went through"),
    "failure": Key("text", "Why the run ended early", null="if it did not"),
    "trajectory_error": Key("number", "Largest error of the coordinates", "m or rad", "if the run failed"),
    "observed_order": Key(
        "number", "Order of accuracy seen between this and the next larger step", null="where none can be told"
    ),
    "seconds": Key("number", "Processor time of the run, the median of the repeats", "s"),
    "seconds_min": Key("number", "Least processor time of the repeats", "s"),
    "seconds_max": Key("number", "Largest processor time of the repeats", "s"),
    "front": Key("text", "T if no run is both cheaper and nearer to the trajectory, c if none is to the constraints"),
    # predicted against measured
    **_pole("predicted_", "the pole predicted for the mechanism at rest"),
    "predicted_verdict": Key("text", "Verdict predicted for the mechanism at rest", values=VERDICTS),
    "law_z_abs": Key("number", "Modulus predicted by the first-order law of the motion"),
    "law_verdict": Key("text", "Verdict predicted by the first-order law of the motion", values=MOVING_VERDICTS),
    "floquet_z_abs": Key(
        "number",
        "Modulus per step of the linearised steps over the motion the method makes: exact where that begins anew, else "
        "a growth over the run",
        null="without --floquet",
    ),
    **_pole("measured_", "the pole measured in the simulation", NOT_MEASURED),
    "measured_rate": Key(
        "number",
        "Growth per step measured over a whole revolution beside the motion the method makes, the first left out",
        null="without --floquet, and where it cannot be followed for so long",
    ),
    "measured_verdict": Key("text", "Verdict of the simulation", values=OUTCOMES),
    "difference_z_real": Key("number", "Real part measured less that predicted", null=NOT_MEASURED),
    "difference_z_imag": Key("number", "Imaginary part measured less that predicted", null=NOT_MEASURED),
    "difference_z_abs": Key("number", "Modulus measured less that predicted", null=NOT_MEASURED),
    "difference_z_angle_deg": Key("number", "Angle measured less that predicted", "degrees", NOT_MEASURED),
    "reason": Key("text", "Why nothing could be measured, or what disturbs it; empty where nothing does"),
    "measurable": Key("truth", "Whether the pole could be measured"),
    "verdicts_agree": Key("truth", "Whether predicted and measured verdict agree", null="where either is not settled"),
    "right": Key("text", "Which predictions have the measured verdict: at rest, law, exact (or over the run)"),
    # predicted against measured errors
    "gain_share": Key("number", "Times alpha and beta of the point that was chosen or given"),
    "predicted_error": Key(
        "number",
        "Largest constraint error predicted for the later half of the run, with nothing fitted",
        "m or rad",
        "where errors do not decay, or the motion cannot be followed for longer than the run",
    ),
    "measured_error": Key(
        "number", "Largest constraint error in the later half of the run", "m or rad", "if the run failed"
    ),
    "quotient": Key("number", "Measured over predicted error, 1 if they agree", null="where `reason` says why"),
    "predicted_order": Key(
        "number", "Order in h of the predicted error between this and the next larger step", null="of the largest step"
    ),
    # maps of simulated verdicts
    "runs": Key("integer", "Number of runs"),
    "undecided": Key("integer", "Runs that gave no verdict"),
    "judged_runs": Key("integer", "Runs that gave a verdict"),
    "agreeing": Key("integer", "Runs whose verdict is the predicted one"),
    "agreeing_share": Key(
        "number", "Share of the runs with a verdict whose verdict is the predicted one", null="if no run has a verdict"
    ),
    "band": Key("number", "Distance of the modulus from one below which a verdict is too close to call"),
    "too_close": Key("integer", "Runs so close to one, or closer than the motion moves the predicted pole"),
    "farthest": Key(
        "number", "Largest distance of the modulus from one of a run that disagrees", null="if none disagrees"
    ),
    "disagreeing": Key("integer", "Runs not too close to call that disagree"),
    # witnesses
    "integrator": Key("text", "What the other engine calls its integrator"),
    "times_boundary": Key("number", "Distance of the point from the origin, in those of the boundary on its ray"),
    "remaining": Key("number", "Largest constraint error in the last tenth of the run", "m"),
    # extremes
    "case": Key("text", "What was looked at"),
    "expected": Key("text", "What must come out, stated beforehand"),
    "seen": Key("text", "What came out"),
    "held": Key("truth", "Whether what came out is what was expected"),
    # the paper
    "where": Key("text", "Where in the paper the claim stands"),
    "claim": Key("text", "What the paper claims"),
    "paper": Key("text", "What the paper says of it, in numbers"),
    "here": Key("text", "What came out here"),
    "agreement": Key(
        "text",
        "Whether the claim is confirmed",
        values=("confirmed", "confirmed with a correction", "not confirmed", "cannot be tested"),
    ),
}
"""Every key that any command prints, by name."""
