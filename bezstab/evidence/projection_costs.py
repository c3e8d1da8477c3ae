"""Feedback against projection: what each costs for the same error of the trajectory, method by method and in words."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from bezstab.evidence.accuracy_costs import ABOVE_REFERENCE, Cost, Run
from bezstab.evidence.sweep_summaries import cost_for

COSTS: tuple[Cost, Cost] = ("projection", "time")
"""Factorizations, then seconds."""


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
