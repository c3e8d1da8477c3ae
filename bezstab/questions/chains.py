"""A chain of bodies in an engine that sweeps over its constraints: is it stable, from how many sweeps, how strongly."""

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from bezstab.engines import Engine, SweptStep, check_iterations
from bezstab.errors import InputError
from bezstab.rationals import rational
from bezstab.stability import BoolArray, FloatArray, Growth, chain, fewest_sweeps, first_where, swept_growth

SHARES_TRIED = 64
"""Of the strongest feedback: the largest share that a chain allows is sought between two of these neighbours."""


@dataclass(frozen=True)
class Chain:
    """A straight chain of bodies, the last `mass_ratio` times as heavy; `iterations` sweeps, None: the engine's own.

    InputError for numbers that are no chain.
    """

    bodies: int
    mass_ratio: Fraction = Fraction(1)
    iterations: int | None = None

    def __post_init__(self) -> None:
        chain(self.bodies, float(self.mass_ratio))
        if self.iterations is not None:
            check_iterations(self.iterations)

    @property
    def words(self) -> str:
        """A chain of 10 with the last body 10 times as heavy."""
        last = "" if self.mass_ratio == 1 else f" with the last body {float(self.mass_ratio):g} times as heavy"
        return f"a chain of {self.bodies}{last}"


@dataclass(frozen=True)
class ChainAnswer:
    """What a step of an engine does to the errors of a chain.

    `iterations` are the sweeps that were asked about, `alone` the factor by which a step multiplies the error of one
    constraint alone, `stable_iterations` from how many sweeps the chain is stable, None if from none that is tried.
    """

    chain: Chain
    iterations: int
    growth: Growth
    alone: float
    stable_iterations: int | None


def check_chain(question_chain: Chain | None, engine: Engine | None) -> None:
    """Raise InputError where a chain is asked about without an engine that is known to sweep."""
    if question_chain is None:
        return
    if engine is None:
        raise InputError("--chain needs --engine: it asks how that engine sweeps over its constraints")
    if not engine.sweeps:
        raise InputError(
            f"--chain: {engine.name} solves all constraints together: a chain is as stable as one constraint, so ask "
            "without --chain"
        )
    if engine.sweeping is None:
        raise InputError(f"--chain: how {engine.name} sweeps over its constraints is not known here")


def chain_answer(engine: Engine, values: tuple[Fraction, ...], h: Fraction, asked: Chain) -> ChainAnswer:
    """Return what becomes of a chain with an engine's values at a step of h (s); the engine says how it sweeps.

    NumericalError where rounding leaves open whether errors decay.
    """
    assert engine.sweeping
    step = _steps(engine, values, h)
    iterations = asked.iterations or engine.sweeping.iterations
    masses = chain(asked.bodies, float(asked.mass_ratio))
    growth = swept_growth(masses, step(iterations))
    growth.check_settled()
    return ChainAnswer(
        chain=asked,
        iterations=iterations,
        growth=growth,
        alone=swept_growth(chain(1), step(iterations)).factor,
        stable_iterations=fewest_sweeps(lambda sweeps: swept_growth(masses, step(sweeps))),
    )


def strongest_setting(engine: Engine, h: Fraction, asked: Chain, spread: float) -> str | None:
    """Return the line to paste for the strongest feedback that the chain allows, even if it were `spread` stronger.

    None where no feedback on the engine's curve is stable, or the engine has none to set.
    """
    curve = engine.curve
    if curve is None or engine.sweeping is None or not engine.parameters:
        return None
    masses = chain(asked.bodies, float(asked.mass_ratio))
    iterations = asked.iterations or engine.sweeping.iterations

    def values_of(share: float) -> tuple[Fraction, ...]:
        alpha_hat, beta_hat = curve(share)
        point = Fraction(alpha_hat), Fraction(beta_hat)
        return tuple(rational(value) for value in engine.values(point, h))

    def allowed(share: float) -> bool:
        stronger = min(share * (1 + spread), 1.0)
        return swept_growth(masses, _steps(engine, values_of(stronger), h)(iterations)).decays

    def refused(shares: FloatArray) -> BoolArray:
        return np.array([not allowed(float(share)) for share in shares])

    shares = np.linspace(0, 1 - 1e-9, SHARES_TRIED + 1)[1:]  # the strongest itself may not be expressible
    turn = first_where(refused, shares)
    if turn and turn[0] == turn[1]:  # already the weakest
        return None
    alpha_hat, beta_hat = curve(turn[0] if turn else shares[-1])
    return engine.setting((Fraction(alpha_hat), Fraction(beta_hat)), h)


def _steps(engine: Engine, values: tuple[Fraction, ...], h: Fraction) -> Callable[[int], SweptStep]:
    """Return the engine's step by its number of sweeps."""
    assert engine.sweeping
    step = engine.sweeping.step
    return lambda iterations: step(iterations, h, *values)


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
    """Return the map of an engine with such values at a step of h (s); errors as `chain_answer`."""
    check_chain(Chain(bodies, mass_ratio, sweeps), engine)
    step = _steps(engine, values, h)
    z_abs = np.empty((bodies, sweeps))
    fewest = []
    for row in range(bodies):
        masses = chain(row + 1, float(mass_ratio))

        def growth(iterations: int, masses: FloatArray = masses) -> Growth:
            return swept_growth(masses, step(iterations))

        z_abs[row] = [growth(iterations).factor for iterations in range(1, sweeps + 1)]
        fewest.append(fewest_sweeps(growth))
    return ChainMap(float(mass_ratio), z_abs, tuple(fewest))
