"""What an engine is: its own words for the feedback, what it makes of them, and the method it steps with."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any, Literal

from bezstab.engines.sweeping import Sweeping
from bezstab.errors import InputError
from bezstab.rationals import ONE, rational, within_float64
from bezstab.units import feedback_gains, from_feedback_gains

Level = Literal["acceleration", "velocity", "position"]

EnergyClass = Literal["acceleration", "bias", "beside", "projected"]
"""How an engine takes errors back, which decides what it does to the energy of a motion: motion/spinning_bodies.py."""

Point = tuple[Fraction, Fraction]
"""alpha_hat and beta_hat."""

READ_BACK = 1e-7
"""Of a point, and beside one: what is read of the nine digits that are pasted differs by less from what was asked."""

Curve = Callable[[Any], tuple[Any, Any]]
"""alpha_hat and beta_hat of a share from 0 (no feedback, or hardly any) to 1 (the strongest); numbers or arrays."""


@dataclass(frozen=True)
class Applied:
    """The point that an engine makes of values, what it did to them (sentences), and points it also takes, labelled.

    Points are (alpha_hat, beta_hat), exact and dimensionless. `notes` are None where values were taken as typed, or no
    engine gave the point. `also` is for feedback that changes with the size of the error: safe is what is safe at those
    points, too.
    """

    point: Point
    notes: tuple[str, ...] | None = ()
    also: tuple[tuple[str, Point], ...] = ()

    @property
    def words(self) -> str:
        """What the engine did, in one line; nothing where it took values as they are."""
        return "as typed" if self.notes is None else "; ".join(self.notes)

    @property
    def points(self) -> list[Point]:
        """All of them."""
        return [self.point, *(point for _, point in self.also)]


@dataclass(frozen=True, eq=False)
class Engine:
    """An engine's own constraint parameters and what they mean in (alpha_hat, beta_hat) at a step of h seconds.

    acceleration: true Baumgarte feedback, so that the integrator decides. velocity, position: an engine that feeds the
    error back into velocities or positions; for one constraint its step is that of `method` at that point, no other.
    `method` is the name of the engine's own integrator, None for a library that has none: the user's decides.
    `parameters` are the values needed, `optional` those that may follow, each with its unit; those in `above_zero` and
    `from_zero` mean nothing below. `read(h, *values)` is the point of such values. `write(alpha_hat, beta_hat, h)` are
    the values of a point, in float64. As many `digits` of each are pasted: all, 17, where a value may be next to
    another. `defaults` are the values, as they are typed, that it has unless somebody sets them, empty where it has
    none. Points without values are found by reading them back: `reaches` says which have some. `paste` is the line
    to paste where it is not name = value, for as many values as it has {}. `apply(h, *values)` is what the engine does
    to values before it uses them (clamps, scaling), None if nothing. `marks` are the settings everybody meets: by
    label, the values as they are typed, or 2h for two steps. `excludes` is what the conversion leaves out. `curve` are
    the points to choose among, None for all of the plane. `jointly` is whether it solves all constraints together below
    acceleration level, too. `sweeping` is how it goes through a step in which it solves one after another, None where
    that is not written down here. `energy_class` is how it takes errors back, None likewise. `impedances(*values)` are
    the shares that soft constraints get of what they want, at no error and at large ones; else all.
    `rest(h, acceleration, *values)` is the error at which a constraint holds a load, None where that follows from the
    rest: stability/rest_offsets.py.
    """

    name: str
    level: Level
    parameters: Mapping[str, str]
    read: Callable[..., Point]
    write: Callable[[float, float, float], tuple[float, ...]]
    source: str
    excludes: str
    method: str | None = "SYM"
    optional: Mapping[str, str] = field(default_factory=dict)
    defaults: str = ""
    above_zero: tuple[str, ...] = ()
    from_zero: tuple[str, ...] = ()
    reaches: str = "α̂ >= 0 and β̂ >= 0 within the range of float64"
    apply: Callable[..., Applied] | None = None
    marks: Mapping[str, str] = field(default_factory=dict)
    paste: str | None = None
    curve: Curve | None = None
    digits: int = 9
    jointly: bool = False
    sweeping: Sweeping | None = None
    energy_class: EnergyClass | None = None
    impedances: Callable[..., tuple[Fraction, Fraction]] = lambda *_values: (ONE, ONE)
    rest: Callable[..., Fraction | float] | None = None

    @property
    def units(self) -> Mapping[str, str]:
        """The unit of each value, those that may follow included, by its name."""
        return {**self.parameters, **self.optional}

    @property
    def sweeps(self) -> bool:
        """Whether the engine solves each constraint by itself, one after another.

        Then what holds for one constraint alone says little about a chain of them.
        """
        return self.level != "acceleration" and not self.jointly

    def marked(self, h: Fraction) -> dict[str, Point]:
        """Return the points of the settings everybody meets, by their labels; h in s."""
        return {
            label: self.applied(tuple(_typed(number, h) for number in typed.split()), h).point
            for label, typed in self.marks.items()
        }

    def applied(self, values: tuple[Fraction, ...], h: Fraction, *, as_typed: bool = False) -> Applied:
        """Return what the engine makes of values, in their order and the engine's units, at a step of h (s).

        The point is that after its clamps and scaling, which are left out where `as_typed`. InputError for another
        number of values, for those that mean nothing and for a point outside float64's range.
        """
        self._check(values)
        if as_typed or self.apply is None:
            made = Applied(self.read(h, *values), None if as_typed else ())
        else:
            made = self.apply(h, *values)
        for alpha_hat, beta_hat in made.points:
            within_float64(alpha_hat, f"--engine {self.name}: α̂")
            within_float64(beta_hat, f"--engine {self.name}: β̂")
        return made

    def values(self, point: Point, h: Fraction) -> tuple[str, ...]:
        """Return the values that mean a point, as they are typed, h in s; InputError where there are none.

        They are read back, so that what is pasted is the point.
        """
        try:
            values = tuple(f"{value:.{self.digits}g}" for value in self.write(*map(float, (*point, h))))
            back = self.applied(tuple(map(rational, values)), h).point
            apart = max(abs(read - asked) - READ_BACK * asked for read, asked in zip(back, point, strict=True))
            reached = min(point) >= 0 and apart <= READ_BACK
        except (ArithmeticError, ValueError):  # the formula leaves the real numbers, or the range of float64
            reached = False
        if not reached:
            alpha_hat, beta_hat = map(float, point)
            raise InputError(f"{self.name} reaches only {self.reaches}, not ({alpha_hat:g}, {beta_hat:g})")
        return values

    def setting(self, point: Point, h: Fraction) -> str:
        """Return the line to paste for a point, h in s; InputError where there is nothing to set."""
        values = self.values(point, h)
        if self.paste and self.paste.count("{}") == len(values):
            return self.paste.format(*values)
        named = zip(self.units, values, strict=False)
        return ", ".join(f"{name} = {value}" for name, value in named) or "nothing to set"

    def words(self) -> str:
        """Return the parameters as they are typed, the optional ones in brackets: solref[0],solref[1][,solimp[0]]."""
        optional = "".join(f"[,{name}" for name in self.optional) + "]" * len(self.optional)
        return ",".join(self.parameters) + (optional if self.parameters else optional.replace("[,", "[", 1))

    def _check(self, values: tuple[Fraction, ...]) -> None:
        """Raise InputError for another number of values, and for those that mean nothing."""
        option = f"--engine {self.name}"
        if not len(self.parameters) <= len(values) <= len(self.units):
            expected = ", ".join(self.parameters) or "none"
            then = f", then {', '.join(self.optional)} if you like" if self.optional else ""
            raise InputError(f"{option}: {len(values)} values, expected {expected}{then}")
        for name, value in zip(self.units, values, strict=False):
            if (value < 0 and name in self.from_zero) or (value <= 0 and name in self.above_zero):
                expected = "0 or more" if name in self.from_zero else "above 0"
                raise InputError(f"{option}: {name} = {float(value):g}: expected {expected}")


def engine_without_parameters(point: Point, **facts: Any) -> Engine:
    """Return an engine whose feedback cannot be set: it has one point; `facts` are the other fields of `Engine`."""
    alpha_hat, beta_hat = map(float, point)
    return Engine(
        parameters={},
        read=lambda h: point,
        write=lambda alpha_hat, beta_hat, h: (),
        curve=lambda share: (alpha_hat, beta_hat),
        reaches=f"({alpha_hat:g}, {beta_hat:g})",
        **facts,
    )


def _typed(number: str, h: Fraction) -> Fraction:
    return Fraction(number.removesuffix("h")) * (h if number.endswith("h") else 1)


def point_of_gains(h: Fraction, stiffness: Fraction, damping: Fraction) -> Point:
    """Return the point of a stiffness beta^2 (1/s^2) and a damping 2 alpha (1/s), h in s."""
    return from_feedback_gains(damping, stiffness, h)


def stiffness_and_damping(alpha_hat: float, beta_hat: float, h: float) -> tuple[float, float]:
    """Return the stiffness beta^2 (1/s^2) and the damping 2 alpha (1/s) of a point, h in s."""
    damping, stiffness = feedback_gains(alpha_hat, beta_hat, h)
    return stiffness, damping


def hard(share: Any) -> tuple[Any, Any]:
    """Return the points of a constraint that ends every step with c' = 0 and takes back that share of the error."""
    return 1.0, share
