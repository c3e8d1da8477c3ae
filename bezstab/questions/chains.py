"""Chains of bodies and scenes in an engine that sweeps over constraints: are they stable, and with how many sweeps?"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import partial

import numpy as np

from bezstab.engines import Engine, Point, check_iterations
from bezstab.errors import InputError
from bezstab.mechanism import Scene, compiled_mechanism, constraint_jacobian, initial_state
from bezstab.questions.motions import name_of, scene_at_speed
from bezstab.rationals import rational
from bezstab.stability import (
    FloatArray,
    Growth,
    chain,
    fewest_sweeps,
    first_where,
    inverse_effective_masses,
    swept_growth,
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
    joint, rising.
    """

    words: str
    inverse_masses: FloatArray
    joints: tuple[int, ...]

    @property
    def count(self) -> int:
        """How many there are."""
        return len(self.joints)


ALONE = Constraints("one constraint alone", np.ones((1, 1)), (0,))


def constraints_of_chain(bodies: int, mass_ratio: Fraction | None = None) -> Constraints:
    """Return the links of a straight chain, from the world on, its last body `mass_ratio` (None: 1) times as heavy.

    InputError for numbers that are no chain.
    """
    ratio = 1.0 if mass_ratio is None else float(mass_ratio)
    last = " equal bodies" * (bodies > 1) if ratio == 1 else f" with the last body {ratio:g} times as heavy"
    return Constraints(f"a chain of {bodies}{last}", chain(bodies, ratio), tuple(range(bodies)))


def constraints_of(scene: str | Scene, speed: Fraction) -> Constraints:
    """Return the constraints of a scene at its start, in the order of the file, as if it were at rest there.

    A driver is one of them. InputError as `load_scene` and `initial_state`.
    """
    mechanism = compiled_mechanism(scene_at_speed(scene, speed))
    q, _ = initial_state(mechanism)
    masses = inverse_effective_masses(np.diag(mechanism.mass), constraint_jacobian(mechanism, 0.0, q))
    words = f"{name_of(scene)} at its start, with its {len(mechanism.joints)} constraints"
    return Constraints(words, masses, mechanism.joints)


def check_sweeps(
    bodies: int | None,
    mass_ratio: Fraction | None,
    iterations: int | None,
    engine: Engine | None,
    scene: str | Scene | None = None,
    speed: Fraction = Fraction(1),
) -> None:
    """Raise InputError if a question has a chain or a number of sweeps, and no engine that is known to sweep.

    InputError, too, for numbers that are no chain, and if there is nothing to sweep over. Errors as `load_scene`.
    """
    if bodies is not None:
        constraints_of_chain(bodies, mass_ratio)
    elif mass_ratio is not None:
        raise InputError("--mass-ratio needs --chain: it says how heavy the last body of the chain is")
    if iterations is not None:
        check_iterations(iterations)
    if bodies is not None and scene:
        raise InputError("--chain and --scene are two mechanisms: give one")
    if iterations is not None and bodies is None and not scene:
        raise InputError("--iterations needs --chain or --scene: one constraint alone needs one sweep only")
    if bodies is None and iterations is None:
        return
    option = "--iterations" if bodies is None else "--chain"
    if engine is None:
        raise InputError(f"{option} needs --engine: it asks how that engine sweeps over its constraints")
    if not engine.sweeps:
        raise InputError(
            f"{option}: {engine.name} solves all constraints together: many are as stable as one, so ask without it"
        )
    if engine.sweeping is None:
        raise InputError(f"{option}: how {engine.name} sweeps over its constraints is not known here")
    if scene and len(compiled_mechanism(scene_at_speed(scene, speed)).joints) == 1:
        raise InputError(f"--iterations: {name_of(scene)} has one constraint alone: there is nothing to sweep over")


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
        sweeping = self.engine.sweeping
        assert sweeping
        step = sweeping.step(sweeps or self.iterations, self.h, *values)
        joints = self.constraints.joints if sweeping.together else None
        return swept_growth(self.constraints.inverse_masses, step, joints)

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

    def sweeps_to_spare(self, point: Point, spread: float) -> int | None:
        """Return from how many sweeps a point on the engine's curve is stable even if it were `spread` stronger."""

        def as_strong(share: float) -> bool:
            return self._point_at(share)[1] >= point[1]

        turn = first_where(np.vectorize(as_strong, otypes=[bool]), SHARES)
        return self.fewest(self._values_at(float(turn[1] if turn else SHARES[-1]), spread))

    def _point_at(self, share: float) -> Point:
        """Return the point for a share of the strongest feedback on the engine's curve."""
        assert self.engine.curve
        alpha_hat, beta_hat = self.engine.curve(share)
        return Fraction(alpha_hat), Fraction(beta_hat)

    def _values_at(self, share: float, spread: float) -> list[Fraction]:
        """Return the values for a share of the strongest feedback that is `spread` stronger, at most for all of it."""
        point = self._point_at(min(share * (1 + spread), 1.0))
        return [rational(value) for value in self.engine.values(point, self.h)]


@dataclass(frozen=True)
class ChainMap:
    """What an engine's sweeps make of chains of 1 to so many bodies, the last one `mass_ratio` times as heavy.

    `z_abs` has shape (bodies, sweeps): the factor by which a step multiplies the error, in the row of n bodies with 1,
    2, ... sweeps. `stable_iterations` are the fewest stable sweeps by bodies, None where none that is tried is.
    """

    mass_ratio: float
    z_abs: FloatArray
    stable_iterations: tuple[int | None, ...]


def chain_map(
    engine: Engine, values: tuple[Fraction, ...], h: Fraction, mass_ratio: Fraction, bodies: int, sweeps: int
) -> ChainMap:
    """Return the map of an engine with such values at a step of h (s); errors as `check_sweeps`."""
    check_sweeps(bodies, mass_ratio, sweeps, engine)
    chains = [
        SweptConstraints(engine, h, constraints_of_chain(links, mass_ratio), sweeps) for links in range(1, bodies + 1)
    ]
    z_abs = [[each.growth(values, so_many).factor for so_many in range(1, sweeps + 1)] for each in chains]
    return ChainMap(float(mass_ratio), np.array(z_abs), tuple(each.fewest(values) for each in chains))
