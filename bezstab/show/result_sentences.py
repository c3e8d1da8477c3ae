"""What results say in sentences, beside their rows: what feedback costs, where it is best, when errors grow."""

from __future__ import annotations

from typing import TYPE_CHECKING

from bezstab.rationals import typed_number
from bezstab.units import from_dimensionless
from bezstab.words import counted, times_words

if TYPE_CHECKING:
    from fractions import Fraction

    from bezstab.questions.answering import Answer
    from bezstab.questions.motions import ReferenceMotion

COSTLY = 10.0
"""Times the least error: from here on a sentence says what the feedback costs."""

GAIN = 0.95
"""Of an error: what is not below is called no gain."""


def costs_words(answer: Answer) -> str | None:
    """Return that the feedback of an answer costs accuracy, and how much; None where that is little, or not known.

    The better point is given in 1/s where there is a step, and not at all where an engine has words of its own.
    """
    cost, question = answer.cost, answer.question
    if cost is None or cost.least_at is None or not (cost.times_least and cost.times_least_velocity):
        return None
    times = cost.times_least, cost.times_least_velocity
    if max(times) < COSTLY:
        return None
    assert cost.total_error is not None
    amplitude = question.motion.amplitude
    in_units = "" if amplitude is None else f" ({cost.total_error * amplitude:.1e} m or rad)"
    least = "the least" if question.engine else _point_words(cost.least_at, question.h)
    return (
        f"This feedback costs accuracy: {answer.method.name} keeps order {cost.order_left} of {cost.order}. Compared "
        f"with {least}: {_errors_words(times)}. They are {cost.total_error:.1e} of the motion's amplitude{in_units} "
        f"and {cost.velocity_error:.1e} of its velocity's."
    )


def _point_words(point: tuple[float, float], h: Fraction | None) -> str:
    """Return a point in 1/s, or without a step (s) as it is."""
    if h is None:
        return "α̂ = {:.3g}, β̂ = {:.3g}".format(*point)
    return "α = {:.3g} 1/s, β = {:.3g} 1/s".format(*from_dimensionless(*point, float(h)))


def trade_words(answer: Answer) -> list[str]:
    """Return how long a disturbance of a choice lasts, and what faster or slower decay would change, where known."""
    from bezstab.methods.schemes import implicit  # with sympy, which answers have loaded
    from bezstab.methods.steady_errors import velocity_lag

    if answer.cost is None or answer.cost.total_error is None:
        return []
    lines = []
    if answer.goal == "accurate":
        lines.append(
            "Errors of the start and of disturbances decay as slowly. If a run is short or often disturbed, give a "
            "shorter --settle."
        )
        if velocity_lag(answer.method) < 0 and not implicit(answer.method):
            lines.append(
                "Start with velocities half a step back, v − ½hq̈ (simulate --start steady): begun on the motion the "
                "method moves as if they were half a step ahead."
            )
    faster, slower, settle = answer.faster, answer.slower, answer.slower_settle
    if faster is None:
        lines.append("No other goal decays faster.")
    elif times := answer.times_the_errors(faster):
        moduli = f"|z_p| {abs(faster.pole):.4f} instead of {abs(answer.pole):.4f}"
        lines.append(f"Faster decay: --goal {faster.goal} gives {moduli}, {_errors_words(times)}.")
    if slower is not None and settle and (times := answer.times_the_errors(slower)):
        goal = "" if answer.goal == "accurate" else "--goal accurate "
        slow = f"Slower decay: {goal}--settle {typed_number(settle)} gives {_errors_words(times)}."
        lines.append(slow if min(times) < GAIN else "Slower decay would not be more accurate.")
    return lines


def _errors_words(times: tuple[float, float]) -> str:
    """Return by how many times the errors of constraint and velocity are larger or smaller."""
    of_constraint, of_velocity = map(_ratio_words, times)
    return f"constraint error {of_constraint}, velocity error {of_velocity}"


def _ratio_words(times: float) -> str:
    """Return how one error compares with another that it is so many times as large as."""
    words = times_words(max(times, 1 / times))
    return "unchanged" if words == "1" else f"{words} times {'larger' if times > 1 else 'smaller'}"


def spare_words(answer: Answer) -> str | None:
    """Return what a choice leaves to spare in an engine that sweeps, and what one constraint alone would get.

    The latter where it is another; None where no spare is known, as without sweeps.
    """
    swept, enough = answer.swept, answer.sweeps_to_spare
    if swept is None or enough is None or enough > swept.iterations:
        return None
    spread, sweeps = 100 * answer.question.spread, counted(swept.iterations, "sweep")
    words = f"This leaves {spread:g} % to spare at {sweeps} over {swept.constraints.words}."
    alone = answer.alone
    if alone is None:
        return words
    needed = alone.sweeps_to_spare
    takes = "more sweeps than were tried" if needed is None else counted(needed, "sweep")
    return f"{words} A single constraint would get {alone.setting}; here that needs {takes} for the same margin."


def motion_words(motion: ReferenceMotion) -> str:
    """Return what errors are shares of, and what is called the least."""
    shares = f"Errors are relative to the amplitude of a motion, here {motion.words}."
    return f"{shares} The smallest possible errors are those of --goal accurate."


def combined_words(motion: ReferenceMotion) -> str:
    """Return what combined errors are shares of."""
    return (
        "\nErrors of position and velocity are relative to the amplitudes of a motion's position and velocity, here "
        f"{motion.words}."
    )


def energy_words(motion: ReferenceMotion) -> str:
    """Return what growths of energy are shares of."""
    return (
        "\nGrowth is a share of the energy of a mass on a circle, in each revolution. Its rate varies by 30 % to both "
        f"sides. Here it is {motion.words}. A negative growth is a loss. In n revolutions it takes the "
        "motion off its course by 1.6 n² times as much of its amplitude."
    )
