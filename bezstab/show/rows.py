"""Results as rows: what a command prints in JSON and CSV, and what the columns of its table show."""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterable, Sequence
from fractions import Fraction
from typing import TYPE_CHECKING

from bezstab.engines import witness_of
from bezstab.errors import InputError
from bezstab.methods import Method, evaluations, implicit, steps
from bezstab.show.cells import LIMITS
from bezstab.show.columns import Row, Value
from bezstab.show.fields import cells
from bezstab.show.row_kinds import (
    ACCURACY,
    ENGINES_LISTED,
    FORCED,
    FRONTS,
    LIKE_POINT,
    LIKENESS,
    LINTED,
    LISTED_METHODS,
    MEASUREMENTS,
    MEMBERS,
    MOVING,
    POLES,
    PROBED,
    REGIONS,
    SIMULATIONS,
    SWEPT,
    VERDICT_MAPS,
)
from bezstab.units import alpha_and_beta

COST = (
    *("omega_h", "forced_error", "total_error", "velocity_error", "order_left"),
    *("times_least", "times_least_velocity"),
)
"""What accuracy a feedback costs, by key."""

NOT_KNOWN = "not known"
"""How the reason begins where the search for a best point failed."""

if TYPE_CHECKING:  # so that a small row does not load what makes the large ones
    from bezstab.engines import Engine
    from bezstab.evidence import (
        HalvedStep,
        Likeness,
        LikePoint,
        Linted,
        Measurement,
        MovingPole,
        ProbedPole,
        Run,
        VerdictMap,
    )
    from bezstab.mechanism import Mechanism, Simulation
    from bezstab.questions import Answer, ChainMap, ForcedErrors, RegionAnswer
    from bezstab.stability import Choice, FrontPoint, Limit, Member, Region


def complex_parts(prefix: str, z: complex) -> dict[str, float]:
    """Return real and imaginary part, modulus and angle (degrees), as `prefix` + real, imag, abs, angle_deg."""
    parts = {"real": z.real, "imag": z.imag, "abs": abs(z), "angle_deg": math.degrees(cmath.phase(z))}
    return {f"{prefix}{key}": value for key, value in parts.items()}


def pole_rows(answer: Answer, poles: Iterable[complex]) -> list[Row]:
    """Return a row for each pole of a method at the point of an answer (dimensionless), angles in degrees."""
    return [cells(POLES.fields, answer, {**complex_parts("z_", complex(z)), **cost_cells(answer)}) for z in poles]


def cost_cells(answer: Answer) -> dict[str, Value]:
    """Return what accuracy the feedback of an answer costs; None for what is not known."""
    if answer.cost is None:
        return {**dict.fromkeys(COST), "omega_h": float(answer.question.motion.omega_h)}
    return {key: getattr(answer.cost, key) for key in COST}


def moving_row(moving: MovingPole) -> Row:
    """Return what a mechanism's motion does to the poles at one point; kappa in 1/s, the rest dimensionless.

    `z_abs_moving` is the rate over the motion, `z_abs_worst` the largest for a moment; `safe_speed` the factor on the
    speed at which the rate is one or the law ends, None where no speed is safe, or every one.
    """
    speed = moving.safe_speed if math.isfinite(moving.safe_speed) else None
    return cells(
        MOVING,
        moving,
        {"double_pole": moving.double, "moving_verdict": moving.verdict, "safe_speed": speed},
    )


def method_row(method: Method, name: str = "", group: str | None = None) -> Row:
    """Return steps, evaluations per step, order of accuracy, error constant (as number, and exact as text) and source.

    The exact one is None where rationals stand for irrational coefficients; `digits` says to how many digits they do,
    None where they do not. `order_position_forces` and `order_velocity_forces` are the orders where forces
    depend on the position alone, and on the velocity alone; `implicit` is whether a step solves equations. `name` is
    what the method is listed as, under the heading of its `group`.
    """
    from bezstab.methods import accuracy, accuracy_by_force  # loads sympy

    order, constant = accuracy(method)
    by_force = accuracy_by_force(method)
    found = {
        "method": name or method.name,
        "group": group,
        "steps": steps(method),
        "evaluations": evaluations(method),
        "order": order,
        "error_constant": float(constant),
        "error_constant_exact": str(constant) if method.digits is None else None,
        "implicit": implicit(method),
        "order_position_forces": by_force.position[0],
        "order_velocity_forces": by_force.velocity[0],
    }
    return cells(LISTED_METHODS.fields if group else LISTED_METHODS.fields[:-1], method, found)


def formula_row(method: Method, latex: bool = False) -> Row:
    """Return one method's recursion, s->z mapping, characteristic polynomial (paper Tables 1 and 2), steady errors.

    As text. `steady_error` is that of constraints, `steady_velocity_error` that of their velocities, each as a share of
    the motion's; `order_left` the order of constraint errors where alpha_hat and beta_hat are held, at most the
    method's own.
    """
    from bezstab.methods import (  # loads sympy
        accuracy,
        characteristic_text,
        leading_error,
        mapping_text,
        recursion_text,
        steady_error_text,
    )

    order, _ = accuracy(method)

    return {
        "method": method.name,
        "recursion": recursion_text(method, latex),
        "mapping": mapping_text(method, latex),
        "characteristic_polynomial": characteristic_text(method, latex),
        "steady_error": steady_error_text(method, "x", latex),
        "steady_velocity_error": steady_error_text(method, "v", latex),
        "order_left": min(order, leading_error(method).order_left),
    }


def whole_row(answer: RegionAnswer, *, latex: bool) -> Row:
    """Return all that is known of one method: method_row, formula_row (as text or LaTeX) and region_row.

    NumericalError as `region_row`.
    """
    method = answer.region.method
    return {**method_row(method), **formula_row(method, latex), **region_row(answer)}


def region_row(answer: RegionAnswer) -> Row:
    """Return area, axis limits, best point of the method and which steps are stable; all dimensionless.

    Area and limits are of |z_p| < level, None where that region is empty, or has none; `approached` names those that
    no edge attains, only comes near far out. NumericalError where a pole leaves the range of float64.
    """
    from bezstab.show.best_point_text import best_point_words

    region, inside, exact_limit = answer.region, answer.inside, answer.critical_damping_limit_exact
    reason = None if inside else f"{NOT_KNOWN}: {answer.trouble}" if answer.trouble else _nowhere(answer)
    found = {
        "method": region.method.name,
        "z_abs_below": region.level,
        "area": region.area,
        "bounded": region.bounded,
        **_limits(region),
        "approached": _approached(region),
        "best_z_abs": inside.z_abs if inside else None,
        "best_alpha_hat": inside.alpha_hat if inside else None,
        "best_beta_hat": inside.beta_hat if inside else None,
        "best_where": best_point_words(inside) if inside else reason,
        "best_reason": reason,
        "critical_damping_limit_exact": None if exact_limit is None else str(exact_limit),
    }
    return cells(REGIONS.fields, answer, found)


def accuracy_cells(forced: ForcedErrors) -> dict[str, Value]:
    """Return what the best points of both maps force, the fastest and the most accurate."""
    chosen = forced.chosen
    found = {
        "omega_h": float(forced.motion.omega_h),
        "accurate_alpha_hat": chosen.alpha_hat if chosen else None,
        "accurate_beta_hat": chosen.beta_hat if chosen else None,
        "accurate_z_abs": abs(chosen.pole) if chosen else None,
    }
    return cells(ACCURACY, forced, found)


def _limits(region: Region) -> dict[str, float | None]:
    """Return the ends of a region's ranges by name; None where it is empty, or goes on without end."""
    (alpha_min, alpha_max), (beta_min, beta_max) = region.extent or ((math.inf, math.inf), (math.inf, math.inf))
    ends = (alpha_min, alpha_max, beta_min, beta_max)
    return {key: float(end) if math.isfinite(end) else None for key, end in zip(LIMITS, ends, strict=True)}


def _approached(region: Region) -> str | None:
    """Return the names of those limits that no edge attains, None if there is no such limit."""
    only_near = [near for ends in region.approached for near in ends]
    return ", ".join(key for key, near in zip(LIMITS, only_near, strict=True) if near) or None


def _nowhere(answer: RegionAnswer) -> str | None:
    """Return why there is no best point in a region: |z_p| is not that small, falls on, or a pole cannot be moved."""
    from bezstab.show.best_point_text import falling_words
    from bezstab.stability import pole_place

    if answer.best:
        return f"none: |z_p| is {answer.best.z_abs:.6g} at least"
    if answer.falls_towards is not None:
        return f"none: {falling_words(answer.falls_towards)}"
    if not answer.region.fixed_poles:
        return None
    return f"stable nowhere: a pole stays at {pole_place(answer.region.fixed_poles[0])} whatever α̂ and β̂"


def family_row(member: Member) -> Row:
    """Return what has become of a family at its number of steps; None where its region is empty."""
    alpha_max = beta_max = None
    if member.region.extent:
        (_, alpha_max), (_, beta_max) = member.region.extent
    found = {
        "steps": member.n,
        "area": member.region.area,
        "alpha_hat_max": alpha_max,
        "beta_hat_max": beta_max,
        "best_z_abs": member.z_abs,
    }
    return cells(MEMBERS.fields, member, found)


def limit_row(limit: Limit) -> Row:
    """Return the row of the Bezier family's limit, of order two, which has no number of steps."""
    return cells(MEMBERS.fields, limit, {"steps": None, "method": "B∞", "best_z_abs": limit.z_abs, "order": 2})


def simulation_row(simulation: Simulation) -> Row:
    """Return the summary of one run: largest |c| and |cdot| (SI), energy drift (J), cost, when and why it ended.

    `time` is where it ended (s); h in s. The drift is what of the change of energy is not the work (J) of drivers and
    of applied forces, which are there as well. `singular_passages` counts the singular configurations met.
    """
    trajectory = simulation.trajectory
    return cells(
        SIMULATIONS.fields,
        simulation,
        {
            "scene": trajectory.mechanism.scene.name,
            "method": trajectory.method.name,
            "run_evaluations": trajectory.evaluations,
            **{key: getattr(trajectory, key) for key in ("failure", "factorizations", "least_pivot", "pivot_time")},
            "iterations": trajectory.iterations,
            "time": float(simulation.t[-1]),
            "c_max": float(abs(simulation.c).max()),
            "cdot_max": float(abs(simulation.cdot).max()),
            "energy_drift": float(simulation.energy_drift[-1]),
            "driver_work": float(simulation.driver_work[-1]),
            "force_work": float(simulation.force_work[-1]),
            "singular_passages": len(simulation.singular_times),
        },
    )


def measurement_row(scene: str, measurement: Measurement) -> Row:
    """Return predicted and measured dominant pole at one point, their difference, angles in degrees.

    None where nothing was measured; verdicts agree if both or neither diverge.
    """
    predicted = complex_parts("z_", measurement.predicted)
    measured: dict[str, float | None] = dict.fromkeys(predicted)
    difference: dict[str, float | None] = dict.fromkeys(predicted)
    if measurement.measured is not None:
        parts = complex_parts("z_", measurement.measured)
        measured |= parts
        difference |= {key: parts[key] - predicted[key] for key in parts}
    found = {
        "scene": scene,
        **{f"predicted_{key}": value for key, value in predicted.items()},
        "law_z_abs": measurement.law_abs,
        "floquet_z_abs": measurement.floquet_abs,
        **{f"measured_{key}": value for key, value in measured.items()},
        **{f"difference_{key}": value for key, value in difference.items()},
        "measurable": measurement.measured is not None,
    }
    return cells(MEASUREMENTS.fields, measurement, found)


def forced_rows(scene: str, pair: HalvedStep) -> list[Row]:
    """Return what two runs at one point were predicted to force and did, the larger step first; SI units.

    None where there is nothing to compare; orders are between the two, and stand in the row of the smaller step.
    """
    return [
        cells(
            FORCED.fields,
            run,
            {
                "scene": scene,
                "gain_share": pair.share,
                "predicted_error": run.predicted,
                "measured_error": None if run.failure else run.measured,
                "quotient": None if run.reason else run.quotient,
                "predicted_order": pair.predicted_order if run is pair.half else None,
                "observed_order": None if run is pair.whole or pair.holds is None else pair.observed_order,
                "reason": run.reason or "",
            },
        )
        for run in (pair.whole, pair.half)
    ]


def forced_words(name: str, pairs: Sequence[HalvedStep]) -> str:
    """Return in words whether the method of that name forces what was predicted, and how that shrinks with the step."""
    kept = [pair for pair in pairs if pair.holds is not None]
    if not kept:
        return f"{name}: nothing could be compared."
    quotients = [run.quotient for pair in kept for run in (pair.whole, pair.half)]
    holds = "the prediction holds" if all(pair.holds for pair in kept) else "the prediction does NOT hold"
    predicted, seen = ([getattr(pair, name) for pair in kept] for name in ("predicted_order", "observed_order"))
    left_out = len(pairs) - len(kept)
    without = f" {left_out} of {len(pairs)} points could not be compared." if left_out else ""
    return (
        f"{name}: measured over predicted is {min(quotients):.3f} to {max(quotients):.3f}: {holds}. The order "
        f"in h is {min(seen):.2f} to {max(seen):.2f}, predicted {min(predicted):.2f} to {max(predicted):.2f}.{without}"
    )


def exact_rate_words(mechanism: Mechanism, measurements: Sequence[Measurement]) -> str:
    """Return along which motion the exact rates of one method are; why there are none, where the motion ends."""
    from bezstab.mechanism import Driver, revolution_period

    name = measurements[0].method.name
    if all(measurement.periodic for measurement in measurements):
        return (
            f"Exact rates of {name}: along the method's own motion, where there is none along the mechanism's motion."
        )
    why = ""
    if not any(isinstance(joint, Driver) for joint in mechanism.scene.joints):
        why = ", as nothing drives it"
    elif revolution_period(mechanism) is None:
        why = ", as its drivers have no common period"
    shown = "What is shown is how errors grow over the run."
    return f"No rate of {name} is exact: the motion does not begin anew{why}. {shown}"


def probed_pole_row(column: str, found: ProbedPole) -> Row:
    """Return the dominant pole in a column of a log, per row of it, angle in degrees; None where none is claimed."""
    parts: dict[str, float | None] = dict.fromkeys(complex_parts("z_", 0))
    if found.pole is not None:
        parts |= complex_parts("z_", found.pole)
    return cells(PROBED.fields, found, {"column": column, **parts})


def likeness_row(column: str, likeness: Likeness) -> Row:
    """Return how far the pole in a column of a log is from a method's, per row of the log, angle in degrees."""
    of_method = {
        "predicted_z_abs": abs(likeness.predicted),
        "predicted_z_angle_deg": complex_parts("", likeness.predicted)["angle_deg"],
    }
    return {"column": column, **cells(LIKENESS, likeness, of_method)}


def like_point_row(column: str, point: LikePoint, h: float | None) -> Row:
    """Return a point at which a method has the pole in a column of a log, with h (s) in 1/s too."""
    alpha, beta = (None, None) if h is None else alpha_and_beta(point.alpha_hat, point.beta_hat, h)
    at_point = cells(LIKE_POINT, point, {"h": h, "alpha": alpha, "beta": beta})
    return {"column": column, "method": point.method.name, **at_point}


def linted_row(linted: Linted) -> Row:
    """Return what an element of a MuJoCo model means, and whether it is safe: None where that was not judged.

    None, too, for advice where there is none.
    """
    safe = None if linted.verdict is None else not linted.unsafe
    return cells(LINTED.fields, linted, {"advice": linted.advice or None, "safe": safe})


def verdict_map_row(verdicts: VerdictMap) -> Row:
    """Return how far simulated verdicts agree with |z_p| < 1, and how near to one those lie that do not."""
    return cells(
        VERDICT_MAPS.fields,
        verdicts,
        {
            "run_steps": verdicts.run,
            "runs": verdicts.undecided.size,
            "undecided": verdicts.undecided.size - verdicts.judged,
            "judged_runs": verdicts.judged,
            "agreeing_share": verdicts.agreement,
            "too_close": int(verdicts.too_close.sum()),
            "farthest": verdicts.farthest_disagreement,
            "disagreeing": verdicts.disagreements_beyond_band,
        },
    )


def run_row(run: Run, front: str) -> Row:
    """Return one run of a sweep: its errors (SI), its cost (s of processor time), the fronts it is on."""
    found: Row = {"run_evaluations": run.evaluations, "observed_order": run.order, "front": front}
    return cells(SWEPT.fields, run, found)


def front_row(point: FrontPoint, h: float | None) -> Row:
    """Return a point of the front of |z_p| against forced error, with h (s) in 1/s too."""
    alpha, beta = (None, None) if h is None else alpha_and_beta(point.alpha_hat, point.beta_hat, h)
    return cells(FRONTS.fields, point, {"h": h, "alpha": alpha, "beta": beta})


def choice_cells(
    choice: Choice, h: Fraction | float | None, typed: tuple[Fraction, Fraction] | None = None
) -> dict[str, Value]:
    """Return what a step makes of a choice: alpha and beta in 1/s, how fast it settles, how far it may be off.

    `typed` is the point (alpha_hat, beta_hat) before it was rounded: what was typed in 1/s is shown so again.
    """
    alpha = beta = settle_seconds = h_limit = None
    margins = choice.margins
    if h is not None:
        alpha_hat, beta_hat = typed or (choice.alpha_hat, choice.beta_hat)
        alpha, beta = alpha_and_beta(alpha_hat, beta_hat, h)
        if choice.settle_steps is not None:
            settle_seconds = choice.settle_steps * float(h) * float(choice.method.step_multiple)
        h_limit = margins.h * float(h) if margins else None
    alpha_min, alpha_max = margins.alpha if margins else (None, None)
    beta_min, beta_max = margins.beta if margins else (None, None)
    return {
        **complex_parts("z_", choice.pole),
        "h": None if h is None else float(h),
        "alpha": alpha,
        "beta": beta,
        "settle_seconds": settle_seconds,
        "h_factor": margins.h if margins else None,
        "h_limit": h_limit,
        "alpha_factor_min": alpha_min,
        "alpha_factor_max": alpha_max,
        "beta_factor_min": beta_min,
        "beta_factor_max": beta_max,
    }


def chain_rows(engine: Engine, found: ChainMap) -> list[Row]:
    """Return a row for each number of bodies of a map, with the engine's own number of sweeps."""
    assert engine.sweeping
    own = engine.sweeping.iterations
    return [
        {
            "chain_mass_ratio": found.mass_ratio,
            "chain_bodies": bodies,
            "swept_iterations": own,
            "swept_z_abs": float(found.z_abs[bodies - 1, own - 1]),
            "stable_iterations": fewest,
        }
        for bodies, fewest in enumerate(found.stable_iterations, start=1)
    ]


def engine_row(engine: Engine, point: tuple[Fraction, Fraction] | None, h: Fraction) -> Row:
    """Return an engine's words, and its setting for (alpha_hat, beta_hat) at a step h (s), or why it has none."""
    setting = None
    if point:
        try:
            setting = engine.setting(point, h)
        except InputError as error:
            setting = str(error)
    sweeping = engine.sweeping
    found: dict[str, Value] = {
        "engine": engine.name,
        "parameters": ", ".join(engine.parameters),
        "optional": ", ".join(engine.optional),
        "units": ", ".join(engine.units),
        "witness": witness_of(engine.name),
        "setting": setting,
        "swept_iterations": sweeping.iterations if sweeping else None,
        "swept_word": sweeping.word if sweeping else None,
        "swept_source": sweeping.source if sweeping else None,
        "swept_excludes": sweeping.excludes if sweeping else None,
    }
    return cells(ENGINES_LISTED.fields, engine, found)
