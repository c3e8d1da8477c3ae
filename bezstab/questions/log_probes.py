"""The pole of a response that somebody else's simulator gave, and which method or feedback has that pole.

a response, a point or methods, steps   →   PoleQuestion, ProbedPole   →   Probe: likenesses, or points
"""

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property

from bezstab.engines.conversions import Point
from bezstab.errors import InputError
from bezstab.evidence.probed_poles import TURNED, Likeness, LikePoint, ProbedPole, likenesses, point_like, told
from bezstab.methods.registry import lookup
from bezstab.methods.schemes import Method
from bezstab.words import point_words

MOST_USED = ("SYM", "RK1", "RK2", "RK4", "AB2", "verlet-kdk", "implicit-euler", "trapezoid", "bdf2", "hht")
"""The methods that most simulators use, and their own: what is compared where less than two are named."""

ONE_POLE = "a single real pole, or one that no such method has: it gives no α and β"


@dataclass(frozen=True, kw_only=True)
class PoleQuestion:
    """Which of the `methods` have a pole at a point? Without a `point`: at which points do they have it?

    At a point one method alone, or none, is compared with MOST_USED too. The integrator takes `every` steps of `h` (s)
    from row to row. Constraints turn at the rate `turning` (1/s); None: by TURNED in a step. InputError for a rate
    below 0 or without a step, and for rows that are no whole number of a method's own steps apart.
    """

    point: Point | None = None
    methods: Sequence[Method] = ()
    every: int = 1
    h: Fraction | None = None
    turning: Fraction | None = None

    def __post_init__(self) -> None:
        _ = self.turned
        for method in self.compared:
            if Fraction(self.every) % method.step_multiple:
                own = float(method.step_multiple)
                raise InputError(f"--every {self.every}: expected a multiple of {own:g}: a step of {method.name}")

    @cached_property
    def compared(self) -> Sequence[Method]:
        """The methods whose poles are compared, or whose points are looked for."""
        beside = map(lookup, MOST_USED if self.point and len(self.methods) < 2 else ())
        return tuple(dict.fromkeys((*self.methods, *beside)))

    @property
    def turned(self) -> float:
        """How far the constraints turn in a step, in rad."""
        if self.turning is None:
            return TURNED
        if self.turning < 0:
            raise InputError(f"--turning {float(self.turning):g}: expected 0 or more, in 1/s")
        if self.h is None:
            raise InputError("--turning is a rate in 1/s: it needs --h")
        return float(self.turning * self.h)


@dataclass(frozen=True, repr=False)
class Probe:
    """The pole of a response, called by its column's name, and what has it."""

    question: PoleQuestion
    column: str
    found: ProbedPole

    def __repr__(self) -> str:
        return f"Probe({self.sentence})"

    @property
    def sentence(self) -> str:
        """The answer in words."""
        if self.reason or not self.pole:
            return f"{self.column}: {self.reason}."
        z = f"{self.column}: |z_p| = {abs(self.pole):.6g} ± {self.found.uncertainty:.1g}"
        if not self.question.point:
            return f"{z}."
        alpha_hat, beta_hat = map(float, self.question.point)
        place = point_words(alpha_hat, beta_hat, self.question.h)
        return f"{z}, as {' and '.join(self.fitting)} {'has' if len(self.fitting) == 1 else 'have'} it at {place}."

    @property
    def pole(self) -> complex | None:
        """The dominant pole per row; None if none can be told."""
        return self.found.pole

    @property
    def fitting(self) -> tuple[str, ...]:
        """The names of the methods that have the pole at the point; none where more is allowed than methods differ."""
        return tuple(one.method.name for one in told(self.likenesses))

    @cached_property
    def likenesses(self) -> list[Likeness]:
        """How near the pole is to each method's at the point, the nearest first; none without a pole or a point."""
        asked = self.question
        return likenesses(self.found, asked.compared, asked.every, *asked.point, asked.turned) if asked.point else []

    @cached_property
    def points(self) -> list[LikePoint]:
        """Where each method has the pole, if no point was given."""
        methods = () if self.question.point else self.question.methods
        found = (point_like(self.found, method, self.question.every) for method in methods)
        return [point for point in found if point]

    @property
    def reason(self) -> str:
        """Why there is no answer; "" where there is one."""
        if self.pole is None:
            return self.found.reason
        if self.question.point is None:
            return "" if self.points or not self.question.methods else ONE_POLE
        alike = [one for one in self.likenesses if one.fits]
        if not alike:
            return "none of these methods has this pole there"
        if self.fitting:
            return ""
        names, allowed = ", ".join(one.method.name for one in alike), max(one.allowed for one in alike)
        return f"{names} cannot be told from others: {allowed:.1g} is allowed to the pole, and theirs differ by less"
