"""What a sweep over methods and steps says, method by method and in words."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
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


@dataclass(frozen=True)
class Summary:
    """What a sweep says of one method; None where it says nothing.

    order: observed between the two smallest steps whose error is well above the reference's. alpha_step: the largest
    alpha h per evaluation with alpha = beta up to which all are stable, None for an implicit method, whose evaluations
    are not so many for each step; `unlimited` where there is no largest. costs: evaluations and trajectory errors (SI)
    of the runs that did not fail, the largest step first, down to those that are as near as the reference itself.
    largest_step: in s, of the runs that did not fail.
    """

    method: Method
    stated_order: int
    order: float | None
    area: float | None
    alpha_step: float | None
    unlimited: bool
    costs: Sequence[tuple[int, float]]
    largest_step: float | None

    @property
    def least_error(self) -> float | None:
        """The least trajectory error (SI) that is told of."""
        return min((error for _, error in self.costs), default=None)


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


def summary(runs: Sequence[Run]) -> Summary:
    """Return the summary of one method's runs, the largest step first.

    NumericalError where the method's region cannot be traced.
    """
    method = runs[0].method
    ended = [run for run in runs if run.failure is None]
    orders = [run.order for run in runs if run.order is not None]
    stated_order, _ = accuracy(method)
    limit = critical_damping_limit(method)
    return Summary(
        method=method,
        stated_order=stated_order,
        order=orders[-1] if orders else None,
        area=region(method).area,
        alpha_step=None if limit is None or implicit(method) else limit / evaluations(method),
        unlimited=limit is None,
        costs=[
            (run.evaluations, run.trajectory_error)
            for run in ended
            if run.trajectory_error and (run.order is not None or run is ended[0])  # else it is the reference's error
        ],
        largest_step=ended[0].h if ended else None,
    )


def sweep_sentences(runs: Sequence[Run], tolerance: float, held: Held) -> list[str]:
    """Return the answers as sentences: the cheapest run within the tolerance (SI), orders kept and lost, comparisons.

    The runs of each method stand with the largest step first; `held` says by what each has its point. The Bezier method
    of most steps is compared with each that is none.
    """
    methods = dict.fromkeys(run.method for run in runs)
    summaries = [summary([run for run in runs if run.method == method]) for method in methods]
    bezier = [one for one in summaries if is_bezier(one.method.scheme) and one.method.step_multiple == 1]
    sentences = [_cheapest_sentence(runs, tolerance), *_order_sentences(summaries, held), *_prediction_sentence(runs)]
    if bezier and held != "no feedback":
        most_steps = max(bezier, key=lambda one: steps(one.method))
        sentences += [_comparison_sentence(most_steps, other) for other in summaries if other not in bezier]
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


def _order_sentences(summaries: Sequence[Summary], held: Held) -> Iterator[str]:
    """Yield the orders of accuracy that are lost, and those that are kept, if there are any."""
    for verb, is_lost in (("lost", True), ("kept", False)):
        texts = [
            f"{one.method.name} {one.order:.1f} (of {one.stated_order})"
            for one in summaries
            if one.order is not None and _lost(one) is is_lost
        ]
        if texts:
            yield f"Order of accuracy {HELD_WORDS[held]}, {verb}: {', '.join(texts)}."
    started = [one.method.name for one in summaries if _lost(one) and _has_start_of_stages(one.method)]
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


def _lost(one: Summary) -> bool:
    """Return whether the observed order is well below the stated one."""
    return one.order is not None and one.order < one.stated_order - ORDER_LOST


def _comparison_sentence(bezier: Summary, other: Summary) -> str:
    """Return where a Bezier method wins and where it loses against another, with the numbers."""
    wins, loses = [], []
    for times_better, text in _advantages(bezier, other):
        if times_better > ALIKE:
            wins.append(text)
        elif times_better < 1 / ALIKE:
            loses.append(text)
    clauses = [f"{verb}: {', '.join(texts)}" for verb, texts in (("wins", wins), ("loses", loses)) if texts]
    return f"{bezier.method.name} against {other.method.name} {'; '.join(clauses) or 'does as well'}."


def _advantages(bezier: Summary, other: Summary) -> Iterator[tuple[float, str]]:
    """Yield how many times better the Bezier method is (less than one: worse), and in what."""
    if bezier.area is not None and other.area:
        ratio = bezier.area / other.area
        yield ratio, f"region {ratio:.2g} times as large"
    if other.unlimited:
        yield 0.0, "stable up to some α = β, the other at every"
    if other.alpha_step and bezier.alpha_step:
        ratio = other.alpha_step / bezier.alpha_step
        yield 1 / ratio, f"stable at one α = β with {ratio:.2g} times the evaluations"
    if bezier.largest_step and other.largest_step:
        ends = f"runs through up to h = {bezier.largest_step:g} s, the other up to {other.largest_step:g} s"
        yield bezier.largest_step / other.largest_step, ends
    if bezier.least_error and other.least_error:
        error = max(bezier.least_error, other.least_error)  # the least that runs of both have reached
        needed, by_other = cost_for(error, bezier.costs), cost_for(error, other.costs)
        if needed and by_other:
            ratio = needed / by_other
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
