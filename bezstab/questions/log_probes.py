"""The log of another simulator: the pole in each column, and which method or feedback has that pole.

log, columns, steps, a point or methods   →   PoleQuestion   →   log_answers   →   Probe: likenesses, or points
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property

from bezstab.engines import Point
from bezstab.errors import InputError, NumericalError
from bezstab.evidence import (
    UNEVEN,
    Likeness,
    LikePoint,
    Log,
    ProbedPole,
    error_columns,
    likenesses,
    looks_absolute,
    points_like,
    probed_pole,
    row_step,
    time_column,
)
from bezstab.methods import REGISTRY, Method, lookup
from bezstab.words import point_words

ABSOLUTE = "it is never negative, as an absolute value or a norm is: log the signed error of one constraint"
"""Said of such a column, whose poles are not those of the error."""

SAME_STEP = 1e-3
"""The times between rows of two runs may differ by this share, as times in logs are rounded."""


@dataclass(frozen=True, kw_only=True)
class PoleQuestion:
    """Which of the `methods` (none: all) have a pole at a point? Without a `point`: at which points do they have it?

    The integrator takes `every` steps of `h` (s) from row to row. Constraints turn at the rate `turning` (1/s).
    InputError for a rate below 0, or without a step.

    With a `log` it is asked of the pole of each column. `columns` and `time` are names or numbers of its columns;
    without `columns` all but that of times are taken. `minus` is the log of another run, to subtract. With `jointly`
    one pole is fitted to all columns. InputError for a column that is not there, and for times that do not fit h.
    """

    every: int | None = None
    h: float | None = None
    point: Point | None = None
    methods: Sequence[Method] = ()
    turning: Fraction | None = None
    log: Log | None = None
    columns: Sequence[str] = ()
    time: str | None = None
    minus: Log | None = None
    jointly: bool = False

    def __post_init__(self) -> None:
        _ = self.groups
        if self.log and self.minus:
            own, others = (row_step(each, time_column(each)) for each in (self.log, self.minus))
            if own and others and abs(own - others) > SAME_STEP * own:
                other = f"{self.minus.name} has rows every {others:.6g} s"
                raise InputError(f"--minus: {other}, {self.log.name} every {own:.6g} s")
        _ = self.turned
        row = self.row_step
        if self.h is None or row is None:
            return
        apart = f"the log's times are {row:.6g} s apart"
        if self.compared and not self.steps:
            raise InputError(f"{apart}: expected a multiple of the step, --h {self.h:g}")
        if self.every is not None and round(row / self.h) != self.every:
            raise InputError(f"--every {self.every}: {apart}, {row / self.h:.4g} times --h {self.h:g}")

    @cached_property
    def groups(self) -> list[list[int]]:
        """The places of the columns to each of which, or to all of which jointly, a pole is fitted."""
        if self.log is None:
            return []
        places = error_columns(self.log, self.columns, time_column(self.log, self.time))
        return [places] if self.jointly else [[place] for place in places]

    @cached_property
    def row_step(self) -> float | None:
        """The time between rows in s; None without a log, or a column of times in it."""
        return row_step(self.log, time_column(self.log, self.time)) if self.log else None

    @cached_property
    def compared(self) -> Sequence[Method]:
        """The methods whose poles are compared, or whose points are looked for."""
        return self.methods or ([lookup(name) for name in REGISTRY] if self.point else [])

    @cached_property
    def steps(self) -> dict[Method, int]:
        """How many of its own steps each method takes from row to row; without those to which rows are no multiple."""
        if self.h is None or self.row_step is None:
            return dict.fromkeys(self.compared, self.every or 1)
        ratios = {method: self.row_step / (self.h * float(method.step_multiple)) for method in self.compared}
        return {method: round(ratio) for method, ratio in ratios.items() if abs(ratio - max(1, round(ratio))) <= UNEVEN}

    @property
    def turned(self) -> float | None:
        """How far the constraints turn in a step, kappa h; None without a rate."""
        if self.turning is None:
            return None
        if self.turning < 0:
            raise InputError(f"--turning {float(self.turning):g}: expected 0 or more, in 1/s")
        if self.h is not None:
            return float(self.turning) * self.h
        if self.row_step is None:
            raise InputError("--turning is a rate in 1/s: it needs --h, or a column of times in the log")
        return float(self.turning) * self.row_step / (self.every or 1)


@dataclass(frozen=True, repr=False)
class Probe:
    """The pole in a column of a log (or in all jointly, then called by all their names), and what has it."""

    question: PoleQuestion
    column: str
    found: ProbedPole

    def __repr__(self) -> str:
        point, h = self.question.point, self.question.h
        place = f"{point_words(float(point[0]), float(point[1]), h)}: " if point else ""
        return (
            f"Probe({place}{self.column}: {self.found!r}, {len(self.likenesses)} likenesses, {len(self.points)} points)"
        )

    @property
    def pole(self) -> complex | None:
        """The dominant pole per row; None if none can be told."""
        return self.found.pole

    @property
    def fitting(self) -> tuple[str, ...]:
        """The names of the methods that fit, the nearest first; without those of which that is no answer."""
        return tuple(one.method.name for one in self.likenesses if one.told)

    @cached_property
    def likenesses(self) -> list[Likeness]:
        """How near the pole is to each method's at the point, the nearest first; none without a pole or a point."""
        if self.question.point is None:
            return []
        return likenesses(self.found, self.question.steps, *self.question.point, self.question.turned)

    @property
    def points(self) -> list[LikePoint]:
        """Where the methods have the pole, if no point was given."""
        return [point for points, _ in self._points_and_remarks for point in points]

    @property
    def remarks(self) -> list[str]:
        """Why a method has the pole nowhere."""
        return [remark for _, remark in self._points_and_remarks if remark]

    @cached_property
    def _points_and_remarks(self) -> list[tuple[list[LikePoint], str]]:
        if self.question.point is not None:
            return []
        return [points_like(self.found, *method_and_steps) for method_and_steps in self.question.steps.items()]

    @property
    def told(self) -> bool:
        """Whether a pole could be told, and be compared."""
        return bool(self.likenesses) if self.question.point else self.pole is not None

    @property
    def fits(self) -> bool:
        """Whether a method fits, or has the pole somewhere; true, too, if no method is asked about."""
        return bool(self.fitting if self.question.point else self.points or not self.question.compared)


def log_answers(question: PoleQuestion) -> Iterator[Probe]:
    """Yield the answer for each column of the question's log, or for all jointly; InputError as `probed_pole`."""
    log, minus = question.log, question.minus
    assert log
    for group in question.groups:
        names, other = [log.columns[place] for place in group], None
        if minus:
            same = minus.columns == log.columns
            other = minus.values[:, group if same else [minus.number_of(name) for name in names]]
        pole = probed_pole(log.values[:, group], other)
        if any(looks_absolute(column) for column in log.values[:, group].T):
            pole = replace(pole, reason="; ".join(filter(None, (pole.reason, ABSOLUTE))))
        yield Probe(question, ", ".join(names), pole)


def check_told(found: Sequence[Probe]) -> None:
    """Raise NumericalError, which says why, if no column tells a pole that fits."""
    if any(answer.told and answer.fits for answer in found):
        return
    untold = [f"{answer.column}: {answer.found.reason}" for answer in found if not answer.told]
    likened = [answer for answer in found if answer.told]
    alike = [answer.column for answer in likened if any(one.fits for one in answer.likenesses)]
    unfit = [answer.column for answer in likened if answer.column not in alike]
    failures = [f"no pole can be told: {'; '.join(untold)}"] if untold else []
    failures += [f"no method can be told by {', '.join(alike)}"] if alike else []
    failures += [f"nothing fits {', '.join(unfit)}"] if unfit else []
    raise NumericalError("; ".join(failures))
