"""What is said of a judged point in words: the verdict, how fast errors fall, what may grow, what it costs."""

import math
from fractions import Fraction

from bezstab.feedback.judgement import Judgement
from bezstab.methods.rotation_torque import stage_torque
from bezstab.motion.modulated_circle import steps_to_breakdown
from bezstab.questions.chains import SweptAnswer
from bezstab.questions.energy import spinning_class
from bezstab.questions.motions import ReferenceMotion
from bezstab.questions.scene_runs import MOST_GAINED
from bezstab.questions.trial_runs import Trials
from bezstab.stability.choices import Choice, steps_to_settle
from bezstab.stability.turning import MovingPole
from bezstab.words import (
    as_sentence,
    change_words,
    counted,
    errors_words,
    plain,
    point_words,
    seconds_words,
    times_words,
)

KEPT = 5e-5
"""Of the largest kinetic energy in a run, or of a motion's in a second: less is no change that anybody sees."""

MOVED = 0.01
"""Of the energy, in a second: what a motion may gain or lose without a word."""

HARD = 0.999
"""Of an impedance: above it the energy of a closed four-bar is that of hard constraints, to some hundredths."""

COSTLY = 10.0
"""Times the least error: from here on a sentence says what the feedback costs."""


def judgement_sentence(judged: Judgement, *more: str | None) -> str:
    """Return what was judged, whether it is safe, how fast an error falls, and how far each number alone may grow.

    With a scene also what happens over the motion; of an engine that solves its constraints one after another, for how
    many that is. `more` is what else is known.
    """
    safe = "safe" if judged.safe else "not safe"
    if judged.swept_over:
        safe += f" {'in' if judged.swept else 'for'} {judged.swept_over}"
    elif judged.safe and judged.run is None:
        safe += " at rest"
    clauses = [
        *(_swept(judged, judged.swept) if judged.swept else _errors(judged)),
        _growth(judged),
        _at_rest(judged.sag),
        *more,
        _assumed(judged),
    ]
    place = point_words(judged.alpha_hat, judged.beta_hat, judged.h)
    return " ".join([f"{place}: {safe}.", *map(as_sentence, filter(None, clauses))])


def trials_words(trials: Trials, rule: Choice, h: Fraction) -> str:
    """Return that runs found a point, and what it gains over that of a rule, of a motion that was run."""
    return (
        f"chosen by {trials.runs:,} runs of {seconds_words(trials.seconds)}, steps up to {seconds_words(trials.h_max)}"
        f": to this motion they come {times_words(trials.times_nearer)} times nearer than with the rule's "
        f"{point_words(rule.alpha_hat, rule.beta_hat, h)}"
    )


def _at_rest(sag: float | None) -> str | None:
    """Return how far one constraint is off under its load: a length, or the angle of a joint that turns."""
    if sag is None:
        return None
    return f"under the load it rests off by {sag_words(sag)}" if sag else "under the load it does not sag"


def sag_words(sag: float) -> str:
    """Return an offset at rest (m or rad) in mm, and in degrees: 0.245 mm (of an angle 0.0141°)."""
    return f"{1000 * sag:.3g} mm (of an angle {math.degrees(sag):.3g}°)"


def _assumed(judged: Judgement) -> str | None:
    """Return the motion that a choice was made for, if nobody gave its rate."""
    motion = judged.conditions.motion
    if judged.goal != "accurate" or not motion.assumed:
        return None
    omega_h = float(motion.omega_h)
    whose = f"ωh = {omega_h:g}" if judged.h is None else f"{omega_h / judged.h:.3g} rad/s (ωh = {omega_h:g})"
    return f"without --omega a motion {'with' if judged.h is None else 'of'} {whose} is assumed"


def _change(judged: Judgement, z_abs: float, verdict: str, bound: str = "") -> str:
    """Return how long an error takes to fall to a thousandth, or what a step does to one that does not fall."""
    steps = judged.settle_steps if z_abs == abs(judged.pole) else steps_to_settle(z_abs)
    own_step = None if judged.h is None else judged.h * float(judged.method.step_multiple)
    return change_words(z_abs, verdict, steps, own_step, bound=bound)


def _errors(judged: Judgement) -> list[str | None]:
    """Return what becomes of an error at rest, and over the motion of a scene."""
    at_rest = _change(judged, abs(judged.pole), judged.verdict)
    if judged.moving:
        return [f"at rest {at_rest}", _in_motion(judged, judged.moving), *_as_it_ran(judged)]
    return [at_rest, _on_a_motion(judged)]


def _in_motion(judged: Judgement, moving: MovingPole) -> str:
    """Return what becomes of an error as the mechanism moves, at most or at least, or why that is not settled."""
    if moving.verdict == "converges":
        return f"in motion {_change(judged, moving.at_most, 'converges', 'at most ')}"
    if moving.verdict == "diverges":
        return f"in motion {_change(judged, moving.at_least, 'diverges', 'at least ')}"
    if moving.at_most < 1:
        return "in motion it is not settled: the constraints turn too far in a step, or faster than the feedback works"
    how = "two poles nearly meet there"
    if math.isfinite(moving.at_most):
        how = f"a step may multiply the error by {moving.at_most:.3g}"
    return f"in motion this may diverge: {how}"


def _on_a_motion(judged: Judgement) -> str | None:
    """Return what a second does to the energy of a motion whose rate was given; nothing if that is a hundredth.

    Of a choice that does not weigh it, it is said anyway.
    """
    unweighed = judged.role == "chosen" and judged.goal != "accurate"
    if judged.energy_rate is None or not (abs(judged.energy_rate.gained) >= MOVED or unweighed):
        return None
    rate, omega = judged.energy_rate.gained, float(judged.conditions.omega or 0)
    spins = spinning_class(judged.conditions.engine, judged.method)
    motion = f"a body that spins about a pin at {omega:.3g} rad/s" if spins else f"a motion of {omega:.3g} rad/s"
    if spins and judged.impedance < 1:
        motion += f", with an impedance d of {judged.impedance:g},"
    if abs(rate) < KEPT:
        return f"{motion} keeps its energy"
    said = f"{motion} {'gains' if rate > 0 else 'loses'} {100 * abs(rate):.2g} % of its energy a second"
    # stages' torque grows as the cube of the rate
    if judged.h and not spins and stage_torque(judged.method).power == 2:
        end = judged.h * steps_to_breakdown(judged.method, judged.alpha_hat, judged.beta_hat, omega * judged.h)
        if end < 1 / MOVED:
            said += f" and breaks down after about {seconds_words(end)}: take heun or RK4, or gentler feedback"
    return said


def energy_sentence(judged: Judgement) -> str | None:
    """Return what a second does to the energy of a motion of rate omega; None where that is little, or not known."""
    said = _on_a_motion(judged)
    return said and as_sentence(said)


def _as_it_ran(judged: Judgement) -> list[str]:
    """Return what a run of the scene showed, and what helps if it is not safe; nothing if it was not run."""
    run = judged.run
    if run is None:
        return []
    said = [f"in a run of {seconds_words(run.duration)}: |c| at most {run.c_max:.1e}, {_energy_text(run.gained)}"]
    if run.failure:
        said = [f"a run breaks down {run.failure}"]
    if not run.decides:
        return [*said, "it passes a singular configuration, and decides nothing"]
    if run.failure:
        return said
    if run.grown:
        said.append("there the constraint error grows")
    if run.gained > MOST_GAINED and run.by_feedback:
        said.append("the feedback pumps the motion: take --goal accurate, or a shorter step")
    elif run.gained > MOST_GAINED:
        end = f", and breaks down after about {seconds_words(run.breakdown)}" if run.breakdown else ""
        said.append(f"the method speeds the motion up{end}: take heun or RK4, or gentler feedback")
    elif run.gained < -MOST_GAINED:
        said.append("the feedback brakes" if run.by_feedback else "the method takes that, whatever the feedback")
    if judged.impedance < HARD:
        said.append(f"the run is of hard constraints: an impedance d of {judged.impedance:g} brakes besides")
    if run.sound and judged.moving and judged.moving.verdict != "converges":
        said.append("the prediction settles nothing, but the run went through")
    return said


def _energy_text(gained: float) -> str:
    """Return what became of the energy of a run, from the share that it gained."""
    if abs(gained) < KEPT:
        return "energy kept"
    return f"energy {100 * gained:+.2g} %" if gained < 1 else f"energy grown by {times_words(gained)} times its largest"


def _swept(judged: Judgement, swept: SweptAnswer) -> list[str | None]:
    """Return what becomes of an error of many constraints in an engine that sweeps, and how many sweeps are enough.

    What else was asked, of a scene that moves, is said of constraints that are solved exactly.
    """
    z_abs, stable = swept.growth.factor, swept.stable_iterations
    change = _change(judged, z_abs, "converges" if z_abs < 1 else "diverges")
    return [
        f"{change}; of one constraint alone, each step multiplies it by {swept.alone:.2f}",
        f"stable from {counted(stable, 'sweep')}" if stable else "no number of sweeps that was tried is stable",
        _on_a_motion(judged),
        f"that is at rest. Solved exactly: {_in_motion(judged, judged.moving)}" if judged.moving else None,
    ]


def _growth(judged: Judgement) -> str | None:
    """Return how far the step, α and β may grow: each alone, at rest; nothing if not asked.

    Nothing in an engine that sweeps, either: more of one constraint alone means nothing for a chain of them.
    """
    margins = judged.margins
    if not judged.safe or judged.swept_over:
        return None
    if judged.margins_reason:
        return f"how far the step, α and β may grow is not known: {judged.margins_reason}"
    if margins is None:
        return None
    factors = {"the step": margins.h if judged.h is None else math.inf, "α": margins.alpha[1], "β": margins.beta[1]}
    limits = [f"{name} up to {plain(factor)} times" for name, factor in factors.items() if factor < math.inf]
    if judged.h_limit is not None and judged.h_limit < math.inf:
        limits.insert(0, f"the step up to {seconds_words(judged.h_limit)}")
    stays = "at rest it stays" if judged.moving else "it stays"
    if not limits:
        return f"{stays} stable if one of h, α and β alone grows without limit"
    return f"{stays} stable with one of these alone: {', '.join(limits)}"


def costs_words(judged: Judgement) -> str | None:
    """Return that a feedback costs accuracy, and how much; None where that is little, or not known.

    The better point is not given where an engine has words of its own.
    """
    cost, asked = judged.cost, judged.conditions
    if cost is None or cost.least_at is None or not (cost.times_least and cost.times_least_velocity):
        return None
    times = cost.times_least, cost.times_least_velocity
    if max(times) < COSTLY:
        return None
    assert cost.total_error is not None
    amplitude = asked.motion.amplitude
    in_units = "" if amplitude is None else f" ({cost.total_error * amplitude:.1e} m or rad)"
    least = "the least" if asked.engine else point_words(*cost.least_at, judged.h)
    return (
        f"This feedback costs accuracy: {judged.method.name} keeps order {cost.order_left} of {cost.order}. Compared "
        f"with {least}: {errors_words(times)}. They are {cost.total_error:.1e} of the motion's amplitude{in_units} "
        f"and {cost.velocity_error:.1e} of its velocity's."
    )


def motion_words(motion: ReferenceMotion) -> str:
    """Return what errors are shares of, and what is called the least."""
    shares = f"Errors are relative to the amplitude of a motion, here {motion.words}."
    return f"{shares} The smallest possible errors are those of --goal accurate."
