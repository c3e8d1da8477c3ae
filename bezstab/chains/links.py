"""A straight chain of bodies as constraints: its masses, whether both ends are pinned, motors in its joints, loads.

world --o--[m]--o--[m]--o--[m]          links of a straight chain, swept from the world on; with both ends pinned
                                        one more holds the last body
world ==M--[rod]--M--[rod]--M--[rod]    joints with motors: bodies are uniform rods, each as long as the others, and
                                        each joint is a pin and then a motor; the chain bends, too
"""

from dataclasses import dataclass
from fractions import Fraction
from typing import Literal

import numpy as np

from bezstab.engines.sweeping import Motor
from bezstab.errors import InputError
from bezstab.questions.chains import Constraints
from bezstab.stability.arrays import FloatArray
from bezstab.stability.sweeps import inverse_effective_masses
from bezstab.units import GRAVITY

MOST_BODIES = 100
"""Of a chain: its matrices have three times as many rows, with motors nine times."""
LARGEST_RATIO = 1e6
"""Of masses: beyond, rounding of the inverse effective masses leaves too few digits of the growth."""

Load = Fraction | Literal["gravity"]
"""A steady force (N) on the end of the last body, or gravity on all: along the chain, with motors across it."""


@dataclass(frozen=True)
class Links:
    """A straight chain along its own line: the masses of its bodies from the world on, in any unit.

    With `both_ends` the last body is held by the world, too. With a `motor` in each joint that holds a body, bodies are
    rods. InputError for masses that are no chain.
    """

    masses: tuple[Fraction, ...]
    both_ends: bool = False
    motor: Motor | None = None

    def __post_init__(self) -> None:
        most = MOST_BODIES // 3 if self.motor else MOST_BODIES
        if not 1 <= len(self.masses) <= most:
            raise InputError(
                f"--bodies {len(self.masses)}: expected 1 to {most} bodies{' with motors' * bool(self.motor)}"
            )
        if self.both_ends and self.motor and self.motor.kind == "rate":
            raise InputError(
                "--motor rate: with both ends pinned such motors keep the errors that the pins would take back"
            )
        if min(self.masses) <= 0 or max(self.masses) > LARGEST_RATIO * min(self.masses):
            raise InputError(f"--masses: expected positive masses, at most {LARGEST_RATIO:g} times the least")

    @property
    def words(self) -> str:
        """What the chain is: a chain of 10 with the last body 10 times as heavy."""
        last = self.masses[-1] / self.masses[0]
        if len(set(self.masses)) == 1:
            words = f"a chain of {len(self.masses)} equal bodies" if len(self.masses) > 1 else "a chain of 1"
        elif len(set(self.masses[:-1])) == 1:
            words = f"a chain of {len(self.masses)} with the last body {float(last):g} times as heavy"
        else:
            words = f"a chain of masses {', '.join(f'{float(mass):g}' for mass in self.masses)}"
        if self.motor:
            words += f", with motors {self.motor.words}"
        return f"{words}, pinned at both ends" if self.both_ends else words

    @property
    def rows(self) -> list[tuple[int, str]]:
        """The link of each constraint and what it holds, in the order in which they are swept over."""
        count = len(self.masses)
        held = ("along", "across", "angle") if self.motor else ("along",)
        return [
            (link, what)
            for link in range(count + self.both_ends)
            for what in held
            if what != "angle" or link < count  # the wall that holds the last body has no motor
        ]

    @property
    def inertias(self) -> FloatArray:
        """Masses of the coordinates: places of the bodies along their line; with motors across it, too, and angles.

        Angles are times the length of a rod.
        """
        masses = np.array(self.masses, dtype=np.float64)
        return np.concatenate([masses, masses, masses / 12]) if self.motor else masses

    @property
    def jacobian(self) -> FloatArray:
        """What each constraint's error is of the coordinates, shape (constraints, coordinates)."""
        count = len(self.masses)
        apart = np.eye(count) - np.eye(count, k=-1)  # each link: where its body is, less where the one before is
        halves = (np.eye(count) + np.eye(count, k=-1)) / 2  # from the middle of each of both rods to the pin
        pins = np.vstack([apart, -np.eye(count)[-1:] * self.both_ends])
        arms = np.vstack([-halves, -np.eye(count)[-1:] * self.both_ends / 2])
        nothing = np.zeros_like(pins)
        of = {
            "along": np.hstack([pins, nothing, nothing]),
            "across": np.hstack([nothing, pins, arms]),
            "angle": np.hstack([nothing[:count], nothing[:count], apart]),
        }
        return np.array([of[what][link] for link, what in self.rows])[:, : len(self.inertias)]

    def constraints(self, h: Fraction) -> Constraints:
        """Return its constraints in the order in which they are swept over, in steps of h (s)."""
        inverse_masses = inverse_effective_masses(np.diag(self.inertias), self.jacobian)
        joints = tuple(2 * link + (what == "angle") for link, what in self.rows)
        driven = tuple(what == "angle" for _, what in self.rows)
        return Constraints(self.words, inverse_masses, joints, self.motor.on(driven, h) if self.motor else None)

    def gaps(self, errors: FloatArray) -> tuple[float, ...]:
        """Return the size of each link's error, motors aside, as shares of the largest."""
        sizes = np.zeros(len(self.masses) + self.both_ends)
        for (link, what), error in zip(self.rows, errors, strict=True):
            if what != "angle":
                sizes[link] = np.hypot(sizes[link], error)
        return tuple((sizes / (sizes.max() or 1.0)).tolist())

    def pull(self, load: Load) -> FloatArray:
        """Return what a load adds to the rates of the constraints' errors in a second, shape (constraints,)."""
        count = len(self.masses)
        added = np.zeros((3 if self.motor else 1, count))
        places = 1 if self.motor else 0
        if load == "gravity":
            added[places] = float(GRAVITY)
        else:
            added[places, -1] = float(load / self.masses[-1])
            added[places + 1 :, -1] = 6 * float(load / self.masses[-1])  # half a length from the middle of the last rod
        return np.asarray(self.jacobian @ added.ravel())

    def moved(self, errors: FloatArray) -> FloatArray:
        """Return how far the bodies are from their places for such errors: rods at their ends, shape (bodies,)."""
        moved = np.linalg.lstsq(self.jacobian, errors, rcond=None)[0].reshape(-1, len(self.masses))
        return np.asarray(np.hypot(moved[0], moved[1] + moved[2] / 2) if self.motor else np.abs(moved[0]))


def links(
    bodies: int,
    mass_ratio: Fraction = Fraction(1),
    masses: tuple[Fraction, ...] | None = None,
    *,
    both_ends: bool = False,
    motor: Motor | None = None,
    load: Load | None = None,
) -> Links:
    """Return a chain of such masses, or else of so many, the last one `mass_ratio` times as heavy as each other one.

    InputError for a chain that is none, and for a force as a load without masses.
    """
    if masses is None:
        if isinstance(load, Fraction):
            raise InputError(f"--load {float(load):g}: a force needs the masses that it acts on: give --masses, in kg")
        if not 1 / LARGEST_RATIO <= mass_ratio <= LARGEST_RATIO:
            raise InputError(f"--mass-ratio {float(mass_ratio):g}: expected {1 / LARGEST_RATIO:g} to {LARGEST_RATIO:g}")
        masses = (*[Fraction(1)] * (bodies - 1), mass_ratio)[: max(bodies, 0)]
    return Links(masses, both_ends, motor)
