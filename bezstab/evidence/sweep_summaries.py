"""What a sweep over methods and steps says, method by method and in words."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from operator import truediv
from typing import Literal

import numpy as np

from bezstab.evidence.accuracy_costs import ABOVE_REFERENCE, Cost, Run
from bezstab.evidence.forced_runs import HOLDS
from bezstab.methods import Method, accuracy, evaluations, implicit, is_bezier, leading_error, steps
from bezstab.stability import critical_damping_limit, region

Held = Literal["own choice", "alpha and beta", "alpha_hat and beta_hat", "no feedback"]
"""What stays while h shrinks: the goal of `choose`, by which each step has a point of its own, or these parameters."""

HELD_WORDS: dict[Held, str] = {
    "own choice": "of each step's own choice",
    "alpha and beta": "with α and β held while h shrinks",
    "alpha_hat and beta_hat": "with α̂ and β̂ held while h shrinks",
    "no feedback": "without feedback",
}

COSTS: tuple[Cost, Cost] = ("projection", "time")
"""Factorizations, then seconds: what projection is compared with feedback by."""

ORDER_LOST = 0.5
"""Of an order: below the stated one by more, it has fallen."""

ALIKE = 1.05
"""Ratios nearer to one are neither won nor lost."""


def cost_for(error: float, costs: Sequence[tuple[float, float]]) -> float | None:
    """Return the cost at which an error falls to `error`, from pairs of cost and error, the largest step's first.

    None beyond them. Between two neighbours log error falls linearly with log cost, a power law; the first two count
    between which the error lies.
    """
    for (cheaper, larger), (dearer, smaller) in pairwise(costs):
        if smaller <= error <= larger:
            share = np.log(larger / error) / np.log(larger / smaller) if larger > smaller else 0.0
            return float(cheaper * (dearer / cheaper) ** share)
    return None


def largest_alpha_step(method: Method) -> float | None:
    """Return the largest alpha h per evaluation with alpha = beta up to which all are stable, dimensionless.

    None where there is no largest, and for an implicit method, whose evaluations are not so many for each step.
    """
    limit = critical_damping_limit(method)
    return None if limit is None or implicit(method) else limit / evaluations(method)


def known_costs(ended: Sequence[Run]) -> list[tuple[float, float]]:
    """Return evaluations and trajectory errors (SI) of one method's runs, none of which failed, as they stand.

    Those are left out that are as near as the reference itself: what they show is the reference's error.
    """
    return _costs([run for run in ended if run.order is not None or run is ended[0]], "evaluations")


def sweep_sentences(runs: Sequence[Run], tolerance: float, held: Held) -> list[str]:
    """Return the answers as sentences: the cheapest run within the tolerance (SI), orders kept and lost, comparisons.

    The runs of each method stand with the largest step first; `held` says by what each has its point. The Bezier method
    of most steps is compared with each that is none. NumericalError where a method's region cannot be traced.
    """
    methods = dict.fromkeys(run.method for run in runs)
    ended = {method: [run for run in runs if run.method == method and run.trajectory_error] for method in methods}
    bezier = [method for method in methods if is_bezier(method.scheme) and method.step_multiple == 1]
    sentences = [_cheapest_sentence(runs, tolerance), *_order_sentences(ended, held), *_prediction_sentence(runs)]
    if bezier and held != "no feedback":
        most_steps = max(bezier, key=steps)
        sentences += [_comparison_sentence(most_steps, other, ended) for other in methods if other not in bezier]
    return sentences


def _cheapest_sentence(runs: Sequence[Run], tolerance: float) -> str:
    """Return which run is the cheapest within the tolerance, or the least error if none is."""
    known = [(run, run.trajectory_error) for run in runs if run.trajectory_error is not None]
    within = [(run, error) for run, error in known if error <= tolerance]
    if not within:
        least = f"{min(error for _, error in known):.1e}" if known else "-"
        return f"No run meets the tolerance {tolerance:g}; the least error is {least}."
    best, error = min(within, key=lambda pair: pair[0].evaluations)
    return (
        f"Cheapest for a trajectory error of {tolerance:g}: {best.method.name} at h = {best.h:g} s, error "
        f"{error:.1e}, {best.evaluations} evaluations, {best.seconds:.2g} s."
    )


def _order_sentences(ended: Mapping[Method, Sequence[Run]], held: Held) -> Iterator[str]:
    """Yield the orders of accuracy that are lost, and those that are kept, if there are any.

    That of a method is observed between the two smallest steps whose error is well above the reference's.
    """
    texts: dict[str, list[str]] = {"lost": [], "kept": []}
    started = []
    for method, runs in ended.items():
        orders = [run.order for run in runs if run.order is not None]
        if orders:
            stated, _ = accuracy(method)
            lost = orders[-1] < stated - ORDER_LOST
            texts["lost" if lost else "kept"].append(f"{method.name} {orders[-1]:.1f} (of {stated})")
            if lost and _has_start_of_stages(method):
                started.append(method.name)
    for verb, those in texts.items():
        if those:
            yield f"Order of accuracy {HELD_WORDS[held]}, {verb}: {', '.join(those)}."
    if started and held in ("own choice", "alpha_hat and beta_hat"):
        yield (
            f"{' and '.join(started)} would keep the order; the start by RK4 loses it, and in a short run its error is "
            "the largest."
        )


def _prediction_sentence(runs: Sequence[Run]) -> Iterator[str]:
    """Yield how near the measured constraint errors are to those predicted, if there are any."""
    quotients = [run.measured_error / run.predicted_error for run in runs if run.measured_error and run.predicted_error]
    if quotients:
        near = sum(abs(quotient - 1) <= HOLDS for quotient in quotients)
        yield (
            f"Constraint error in the later half of a run, measured over predicted: within {HOLDS:.0%} of one in "
            f"{near} of {len(quotients)} runs, from {min(quotients):.2g} to {max(quotients):.2g} in all."
        )


def _has_start_of_stages(method: Method) -> bool:
    """Return whether a method keeps its order at fixed alpha_hat and beta_hat, but not its start, which is RK4."""
    kept = min(leading_error(method, "x").power, leading_error(method, "v").power)
    return steps(method) > 1 and not implicit(method) and kept >= accuracy(method)[0]


def _comparison_sentence(bezier: Method, other: Method, ended: Mapping[Method, Sequence[Run]]) -> str:
    """Return where a Bezier method wins and where it loses against another, with the numbers."""
    wins, loses = [], []
    for times_better, text in _advantages(bezier, other, ended):
        if times_better > ALIKE:
            wins.append(text)
        elif times_better < 1 / ALIKE:
            loses.append(text)
    clauses = [f"{verb}: {', '.join(texts)}" for verb, texts in (("wins", wins), ("loses", loses)) if texts]
    return f"{bezier.name} against {other.name} {'; '.join(clauses) or 'does as well'}."


def _advantages(bezier: Method, other: Method, ended: Mapping[Method, Sequence[Run]]) -> Iterator[tuple[float, str]]:
    """Yield how many times better the Bezier method is (less than one: worse), and in what."""
    areas = [region(method).area for method in (bezier, other)]
    if all(areas):  # or one is unbounded, or empty
        ratio = truediv(*areas)
        yield ratio, f"region {ratio:.2g} times as large"
    if critical_damping_limit(other) is None:
        yield 0.0, "stable up to some α = β, the other at every"
    alpha_steps = [largest_alpha_step(method) for method in (other, bezier)]
    if all(alpha_steps):
        ratio = truediv(*alpha_steps)
        yield 1 / ratio, f"stable at one α = β with {ratio:.2g} times the evaluations"
    if ended[bezier] and ended[other]:
        largest, by_other = ended[bezier][0].h, ended[other][0].h
        yield largest / by_other, f"runs through up to h = {largest:g} s, the other up to {by_other:g} s"
        costs = [known_costs(ended[method]) for method in (bezier, other)]
        # the least that runs of both have reached
        error = max(min(error for _, error in of_method) for of_method in costs)
        needed = [cost_for(error, of_method) for of_method in costs]
        if all(needed):
            ratio = truediv(*needed)
            yield 1 / ratio, f"a trajectory error of {error:.1e} with {ratio:.2g} times the evaluations"


@dataclass(frozen=True)
class Comparison:
    """A method with feedback, at the advised point or a given one, against the same method with projection.

    Both come to within `error` (m, rad) of the trajectory. `factorizations` and `seconds` say how many times as many
    projection takes for that, or, if `at_most`, takes at most: then it is as near at its largest step already, as on a
    mechanism that is driven throughout. `held` and `projected` are the runs with feedback and with projection at the
    smallest step.
    """

    held: Run
    projected: Run
    error: float
    factorizations: float
    seconds: float
    at_most: bool


def comparisons(runs: Sequence[Run], reference_error: float) -> Iterator[Comparison]:
    """Yield for each method and point how projection compares; the runs of each stand with the largest step first.

    The error compared at is the least that both reach, of errors that the reference's (SI) does not blur; that of
    feedback alone where projection has none. Nothing is yielded where feedback has none.
    """
    for method in dict.fromkeys(run.method for run in runs):
        own = [run for run in runs if run.method == method]
        projected = [run for run in own if run.stabilise == "projection"]
        for advised in (True, False):
            held = [run for run in own if run.stabilise == "baumgarte" and run.advised == advised]
            if found := _compared(held, projected, ABOVE_REFERENCE * reference_error):
                yield found


def _compared(held: Sequence[Run], projected: Sequence[Run], known: float) -> Comparison | None:
    """Return the comparison of runs of one method, None where they have no error in common above what is known."""
    ended = [run for run in projected if run.trajectory_error is not None]
    least = [error for _, error in _costs(held, "projection") if error > known]
    if not ended or not least:
        return None
    blurred = [error for _, error in _costs(ended, "projection") if error > known]
    error = max(min(least), min(blurred, default=0.0))
    at_most = (ended[0].trajectory_error or 0.0) <= error
    ratios = []
    for against in COSTS:
        by_feedback = cost_for(error, _costs(held, against))
        by_projection = ended[0].cost(against) if at_most else cost_for(error, _costs(ended, against))
        if by_feedback is None or by_projection is None:
            return None
        ratios.append(by_projection / by_feedback)
    return Comparison(held[-1], ended[-1], error, factorizations=ratios[0], seconds=ratios[1], at_most=at_most)


def _costs(runs: Sequence[Run], against: Cost) -> list[tuple[float, float]]:
    return [(run.cost(against), run.trajectory_error) for run in runs if run.trajectory_error]


def projection_sentences(runs: Sequence[Run], reference_error: float) -> list[str]:
    """Return a sentence for each method and point: what projection costs for the same error of the trajectory."""
    sentences = []
    for each in comparisons(runs, reference_error):
        held, projected = each.held, each.projected
        most = "at most " if each.at_most else ""
        points = "the advised points" if held.advised else "the given point"
        sentences.append(
            f"{held.method.name}: for a trajectory error of {each.error:.1e} projection takes {most}"
            f"{each.factorizations:.2g} times the factorizations and {each.seconds:.2g} times the time of feedback at "
            f"{points}; at the smallest step |c| is {projected.c_max:.0e} and not {held.c_max:.0e}, the energy's drift "
            f"{abs(projected.energy_drift):.0e} J and not {abs(held.energy_drift):.0e} J."
        )
    return sentences
