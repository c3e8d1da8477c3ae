"""How well the measured poles of a method agree with the predicted ones, over all points that were tried."""

from collections.abc import Sequence
from dataclasses import dataclass
from statistics import median

from bezstab.evidence.measured_poles import Measurement
from bezstab.methods import Method


@dataclass(frozen=True)
class MeasurementSummary:
    """Errors of |z|, and verdicts that contradict theory, of `measured` among all `points` of a method.

    Of the points that were `followed` over a revolution also the median errors of the rate at rest, of the law's and of
    the exact one, and of how many each is on the wrong side of one; None and "" where none was.
    """

    method: Method
    points: int
    measured: int
    median_error: float | None
    largest_error: float | None
    called: int
    wrong: int
    followed: int
    map_error: float | None
    law_error: float | None
    floquet_error: float | None
    wrong_sides: str


def measurement_summary(measurements: Sequence[Measurement]) -> MeasurementSummary:
    """Return how well the measured poles of one method agree; there is at least one measurement."""
    errors = [abs(each.difference_abs) for each in measurements if each.difference_abs is not None]
    agreements = [each.verdicts_agree for each in measurements]
    followed = [(each, each.measured_rate) for each in measurements if each.measured_rate is not None]
    rates = [
        [(abs(each.predicted), measured) for each, measured in followed],
        [(each.law_abs, measured) for each, measured in followed],
        [(each.floquet_abs, measured) for each, measured in followed if each.floquet_abs is not None],
    ]
    map_error, law_error, floquet_error = (_median([abs(a - b) for a, b in pairs]) for pairs in rates)
    wrong_sides = [str(sum((a > 1) != (b > 1) for a, b in pairs)) for pairs in rates]
    return MeasurementSummary(
        method=measurements[0].method,
        points=len(measurements),
        measured=len(errors),
        median_error=_median(errors),
        largest_error=max(errors, default=None),
        called=sum(agree is not None for agree in agreements),
        wrong=sum(agree is False for agree in agreements),
        followed=len(followed),
        map_error=map_error,
        law_error=law_error,
        floquet_error=floquet_error,
        wrong_sides=", ".join(wrong_sides) if followed else "",
    )


def _median(values: Sequence[float]) -> float | None:
    return float(median(values)) if values else None
