"""Chains of bodies and scenes in an engine that sweeps over constraints: are they stable, and with how many sweeps?"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import partial

import numpy as np

from bezstab.engines.conversions import Engine, Point
from bezstab.engines.sweeping import Motors, SweptStep
from bezstab.errors import InputError
from bezstab.mechanism.equations import Mechanism
from bezstab.mechanism.start import constraint_jacobian, initial_state
from bezstab.rationals import rational
from bezstab.stability.arrays import FloatArray
from bezstab.stability.searches import first_where
from bezstab.stability.sweeps import (
    Growth,
    SlowestMotion,
    chain,
    fewest_sweeps,
    inverse_effective_masses,
    slowest_motion,
    swept_growth,
    swept_rest,
)

SHARES = np.geomspace(1e-6, 1 - 1e-9, 50)
"""Shares of the strongest feedback. The largest share that constraints allow is searched for between two neighbours.
The last is below 1, because the engine may not be able to express the strongest feedback itself."""

USUAL_CHAIN = 10
"""Equal bodies of the chain that a choice is for, where nobody says what the engine sweeps over."""


@dataclass(frozen=True, eq=False)
class Constraints:
    """Constraints in the order in which an engine sweeps over them.

    `words` name the mechanism. `inverse_masses` is J M^-1 J', shape (m, m); `joints` the number of each constraint's
    joint, rising. `motors` are those among them that are not held as the others are.
    """

    words: str
    inverse_masses: FloatArray
    joints: tuple[int, ...]
    motors: Motors | None = None


ALONE = Constraints("one constraint alone", np.ones((1, 1)), (0,))


def constraints_of_chain(bodies: int) -> Constraints:
    """Return the links of a straight chain of equal bodies, from the world on; InputError for a number out of range."""
    return Constraints(f"a chain of {bodies}{' equal bodies' * (bodies > 1)}", chain(bodies), tuple(range(bodies)))


def constraints_of(mechanism: Mechanism) -> Constraints:
    """Return the constraints of a mechanism at its start, in the order of the file, as if it were at rest there.

    A driver is one of them. InputError as `initial_state`.
    """
    q, _ = initial_state(mechanism)
    masses = inverse_effective_masses(np.diag(mechanism.mass), constraint_jacobian(mechanism, 0.0, q))
    words = f"{mechanism.scene.name}, at its start, with its {len(mechanism.joints)} constraints"
    return Constraints(words, masses, mechanism.joints)


@dataclass(frozen=True)
class SweptAnswer:
    """What a step of an engine does to the errors of many constraints.

    `iterations` are the sweeps that were asked about, `alone` the factor by which a step multiplies the error of one
    constraint alone, `stable_iterations` from how many sweeps they are stable, None if from none that is tried.
    """

    constraints: Constraints
    iterations: int
    growth: Growth
    alone: float
    stable_iterations: int | None


@dataclass(frozen=True, eq=False)
class SweptConstraints:
    """Constraints over which an engine sweeps so many times in a step of h (s). Values are those of the engine."""

    engine: Engine
    h: Fraction
    constraints: Constraints
    iterations: int

    def growth(self, values: Sequence[Fraction], sweeps: int | None = None) -> Growth:
        """Return the factor by which a step multiplies their errors, with another number of sweeps if one is given."""
        return swept_growth(self.constraints.inverse_masses, *self._step(values, sweeps))

    def slowest_motion(self, values: Sequence[Fraction]) -> SlowestMotion:
        """Return their motion that decays last, or grows."""
        return slowest_motion(self.constraints.inverse_masses, *self._step(values))

    def rest(self, values: Sequence[Fraction], pull: FloatArray) -> FloatArray:
        """Return the errors at which they rest, for what a steady acceleration adds to their rates times h."""
        step, joints = self._step(values)
        return swept_rest(self.constraints.inverse_masses, step, pull, joints)

    def _step(self, values: Sequence[Fraction], sweeps: int | None = None) -> tuple[SweptStep, tuple[int, ...] | None]:
        sweeping = self.engine.sweeping
        assert sweeping
        step = replace(sweeping.step(sweeps or self.iterations, self.h, *values), motors=self.constraints.motors)
        return step, self.constraints.joints if sweeping.together else None

    def fewest(self, values: Sequence[Fraction]) -> int | None:
        """Return from how many sweeps their errors decay; None if from none that is tried."""
        return fewest_sweeps(partial(self.growth, values))

    def answer(self, values: Sequence[Fraction]) -> SweptAnswer:
        """Return what the sweeps do to their errors; NumericalError if rounding leaves open whether errors decay."""
        growth = self.growth(values)
        growth.check_settled()
        alone = replace(self, constraints=ALONE).growth(values).factor
        return SweptAnswer(self.constraints, self.iterations, growth, alone, self.fewest(values))

    def strongest(self, spread: float) -> Point | None:
        """Return the strongest feedback on the engine's curve that is stable even if it were `spread` stronger.

        A point (alpha_hat, beta_hat); None where no feedback on the curve is stable.
        """

        def refused(share: float) -> bool:
            try:
                return not self.growth(self._values_at(share, spread)).decays
            except InputError:  # the engine cannot express it
                return True

        turn = first_where(np.vectorize(refused, otypes=[bool]), SHARES)
        if turn and turn[0] == turn[1]:  # already the weakest
            return None
        return self._point_at(turn[0] if turn else SHARES[-1])

    def fewest_to_spare(self, point: Point, spread: float) -> int | None:
        """Return from how many sweeps a point on the engine's curve is stable even if it were `spread` stronger."""
        as_strong = np.vectorize(lambda share: self._point_at(share)[1] >= point[1], otypes=[bool])
        turn = first_where(as_strong, SHARES)
        return self.fewest(self._values_at(turn[1] if turn else SHARES[-1], spread))

    def _point_at(self, share: float) -> Point:
        """Return the point for a share of the strongest feedback on the engine's curve."""
        assert self.engine.curve
        alpha_hat, beta_hat = self.engine.curve(share)
        return Fraction(alpha_hat), Fraction(beta_hat)

    def _values_at(self, share: float, spread: float) -> list[Fraction]:
        """Return the values for a share of the strongest feedback that is `spread` stronger, at most for all of it."""
        point = self._point_at(min(share * (1 + spread), 1.0))
        return [rational(value) for value in self.engine.values(point, self.h)]
