"""Is a chain of bodies stable in an engine that sweeps over its constraints, with how many sweeps, and what to set?

world --o--[m]--o--[m]--o--[m]          links of a straight chain, swept from the world on; with both ends pinned
                                        one more holds the last body
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction

import numpy as np

from bezstab.arguments import Number, exact_number, in_keywords, whole_number
from bezstab.engines.conversions import Engine
from bezstab.engines.engine_list import engine_and_values
from bezstab.engines.sweeping import check_iterations
from bezstab.errors import InputError
from bezstab.questions.chains import Constraints, SweptConstraints
from bezstab.stability.arrays import FloatArray
from bezstab.stability.choices import TENTH, steps_to_settle
from bezstab.stability.sweeps import inverse_effective_masses
from bezstab.units import check_step
from bezstab.words import change_words, counted, decay_words

MOST_BODIES = 100
"""Of a chain: its matrices have three times as many rows."""
LARGEST_RATIO = 1e6
"""Of masses: beyond, rounding of the inverse effective masses leaves too few digits of the growth."""

SPREAD = 0.1
"""The share by which the setting to paste may be stronger and the chain still be stable."""

SWEEPS_DRAWN = 50

NO_SAG = 1e-9
"""m: impulses that are kept hold a load without an error; what is computed then is rounding."""


@dataclass(frozen=True)
class Links:
    """A straight chain along its own line: the masses of its bodies from the world on, in any unit.

    With `both_ends` the last body is held by the world, too. InputError for masses that are no chain.
    """

    masses: tuple[Fraction, ...]
    both_ends: bool = False

    def __post_init__(self) -> None:
        if not 1 <= len(self.masses) <= MOST_BODIES:
            raise InputError(f"--bodies {len(self.masses)}: expected 1 to {MOST_BODIES} bodies")
        least, most = min(self.masses), max(self.masses)
        if least <= 0 or most > LARGEST_RATIO * least:
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
        return f"{words}, pinned at both ends" if self.both_ends else words

    @property
    def jacobian(self) -> FloatArray:
        """What each link's error is of the places of the bodies, shape (links, bodies)."""
        count = len(self.masses)
        jacobian = np.eye(count) - np.eye(count, k=-1)  # each link: where its body is, less where the one before is
        return np.vstack([jacobian, -np.eye(count)[-1]]) if self.both_ends else jacobian

    def constraints(self) -> Constraints:
        """Return its links as constraints in the order in which they are swept over."""
        jacobian = self.jacobian
        inverse_masses = inverse_effective_masses(np.diag([float(mass) for mass in self.masses]), jacobian)
        return Constraints(self.words, inverse_masses, tuple(range(len(jacobian))))


def links(bodies: int, mass_ratio: Fraction = Fraction(1), *, both_ends: bool = False) -> Links:
    """Return a chain of so many bodies, the last one `mass_ratio` times as heavy as each other one."""
    if not 1 / LARGEST_RATIO <= mass_ratio <= LARGEST_RATIO:
        raise InputError(f"--mass-ratio {float(mass_ratio):g}: expected {1 / LARGEST_RATIO:g} to {LARGEST_RATIO:g}")
    return Links((*[Fraction(1)] * (bodies - 1), mass_ratio)[: max(bodies, 0)], both_ends)


@dataclass(frozen=True, repr=False)
class ChainAnswer:
    """All that is known of a chain in an engine with such values, at a step of h (s) with so many sweeps.

    `z_abs` is the factor by which a step multiplies its errors in the long run, computed and off by at most `accuracy`;
    `alone_z_abs` that of one constraint alone. `growing` are the errors of its links, from the world on, that decay
    last, or grow: sizes as shares of the largest. `tenth_steps` and `settle_steps`: steps until an error is a tenth, a
    thousandth; None where it does not fall. `stable_iterations`: from how many sweeps errors decay; None if
    from none that is tried. `setting`: the strongest values with which this chain is stable even if they were SPREAD
    stronger; None where there are none, or where the engine has nothing to set. `sag`: how far (m) some body rests from
    its place, at most, where all accelerate by `load` (m/s^2) along the chain; None without a load, and if not safe.
    `sentence`: the answer in words.
    """

    engine: Engine
    values: tuple[Fraction, ...]
    h: Fraction
    links: Links
    iterations: int
    safe: bool
    z_abs: float
    accuracy: float
    alone_z_abs: float
    growing: tuple[float, ...]
    tenth_steps: int | None
    settle_steps: int | None
    stable_iterations: int | None
    setting: str | None
    load: Fraction | None
    sag: float | None
    sentence: str = field(compare=False)

    def __repr__(self) -> str:
        return f"{self.sentence} [{self.engine.name}, |z| = {self.z_abs:.6g}]"

    def __bool__(self) -> bool:
        return self.safe


@in_keywords()
def chain(
    engine: str,
    *,
    h: Number,
    bodies: int = 10,
    mass_ratio: Number = 1,
    masses: Sequence[Number] | None = None,
    both_ends: bool = False,
    iterations: int | None = None,
    load: Number | None = None,
) -> ChainAnswer:
    """Return whether a straight chain of bodies is stable in an engine that sweeps over its constraints.

    Parameters
    ----------
    engine : str
        An engine, with its values as on the command line: "chipmunk=0.0018"; without them its defaults.
    h : int, float, str or Fraction
        Step size (s).
    bodies : int
        Number of bodies.
    mass_ratio : int, float, str or Fraction
        The last body is so many times as heavy as each other one.
    masses : sequence of numbers, shape (bodies,), optional
        Masses from the world on, in any unit, in place of `bodies` and `mass_ratio`.
    both_ends : bool
        Whether the world also holds the last body.
    iterations : int, optional
        Sweeps in a step; by default the engine's own number.
    load : int, float, str or Fraction, optional
        A steady acceleration along the chain (m/s^2); `sag` says how far it sags.

    Returns
    -------
    ChainAnswer
        True if errors decay; `sentence` says it in words. The map is linear, along the chain's own line.

    Raises
    ------
    InputError
        The engine does not sweep, or it is not known how; or the numbers are no chain.
    NumericalError
        Rounding leaves open whether errors decay.
    """
    named, values = engine_and_values(engine)
    whole = links(whole_number(bodies, "bodies"), exact_number(mass_ratio, "mass_ratio"), both_ends=both_ends)
    if masses is not None:
        whole = Links(tuple(exact_number(mass, "masses") for mass in masses), both_ends)
    sweeps = None if iterations is None else whole_number(iterations, "iterations")
    along = None if load is None else exact_number(load, "load")
    return judge_chain(named, values, exact_number(h, "h"), whole, sweeps, along)


def judge_chain(
    engine: Engine,
    values: tuple[Fraction, ...],
    h: Fraction,
    chained: Links,
    iterations: int | None = None,
    load: Fraction | None = None,
) -> ChainAnswer:
    """Return what a step of h (s) does to the errors of a chain; errors as `chain`."""
    swept = swept_links(engine, h, chained, iterations)
    found = swept.answer(values)
    safe = found.growth.decays
    answer = ChainAnswer(
        engine=engine,
        values=values,
        h=h,
        links=chained,
        iterations=swept.iterations,
        safe=safe,
        z_abs=found.growth.factor,
        accuracy=found.growth.accuracy,
        alone_z_abs=found.alone,
        growing=tuple(swept.slowest_errors(values).tolist()),
        tenth_steps=steps_to_settle(found.growth.factor, TENTH) if safe else None,
        settle_steps=steps_to_settle(found.growth.factor) if safe else None,
        stable_iterations=found.stable_iterations,
        setting=_setting(swept),
        load=load,
        sag=None if load is None or not safe else _sag(swept, values, chained, load),
        sentence="",
    )
    return replace(answer, sentence=_sentence(answer))


def swept_links(engine: Engine, h: Fraction, chained: Links, iterations: int | None) -> SweptConstraints:
    """Return a chain in an engine that sweeps over it; InputError if it does not sweep, or it is not known how."""
    check_step(h, "h")
    if not engine.sweeps:
        raise InputError(f"{engine.name} solves all constraints together, so a chain is as stable as one constraint")
    if engine.sweeping is None:
        raise InputError(f"how {engine.name} sweeps over its constraints is not known here")
    sweeps = engine.sweeping.iterations if iterations is None else iterations
    check_iterations(sweeps)
    return SweptConstraints(engine, h, chained.constraints(), sweeps)


def _sag(swept: SweptConstraints, values: tuple[Fraction, ...], chained: Links, load: Fraction) -> float:
    """Return how far (m) some body of a chain rests from its place, at most, under a load (m/s^2)."""
    pull = float(swept.h**2 * load) * chained.jacobian.sum(axis=1)
    moved = np.cumsum(swept.rest(values, pull)[: len(chained.masses)])
    sag = float(np.abs(moved).max())
    return sag if sag > NO_SAG else 0.0


def _setting(swept: SweptConstraints) -> str | None:
    """Return the line to paste of the strongest feedback that a chain allows; None if there is none, or none to set."""
    if not (swept.engine.curve and swept.engine.parameters):
        return None
    strongest = swept.strongest(SPREAD)
    return None if strongest is None else swept.engine.setting(strongest, swept.h)


def _sentence(answer: ChainAnswer) -> str:
    """Return whether a chain is stable, how fast its errors fall or grow, and from how many sweeps it is stable."""
    judged = f"{answer.engine.name}, {answer.links.words}, {counted(answer.iterations, 'sweep')}"
    change = change_words(answer.z_abs, "converges" if answer.safe else "diverges")
    if not answer.safe and len(answer.growing) > 1:
        change += f", most at link {1 + int(np.argmax(answer.growing))} from the world"
    if answer.settle_steps:
        change = decay_words(answer.settle_steps, float(answer.h))
    enough = "No number of sweeps that was tried is stable"
    if answer.stable_iterations is not None:
        enough = f"It is stable from {counted(answer.stable_iterations, 'sweep')}"
    sentence = f"{judged}: {'safe' if answer.safe else 'not safe'}. {change[0].upper()}{change[1:]}. {enough}."
    if answer.sag is not None:
        sags = f"sags by {1000 * answer.sag:.3g} mm" if answer.sag else "does not sag"
        sentence += f" Under {float(answer.load or 0):g} m/s² along it, it {sags}."
    if answer.setting and not answer.safe:
        sentence += f" With these sweeps {answer.setting} is stable, with {SPREAD:.0%} to spare."
    return sentence


def chain_map(
    engine: Engine, values: tuple[Fraction, ...], h: Fraction, longest: int, mass_ratio: Fraction, *, both_ends: bool
) -> FloatArray:
    """Return the factors by which a step multiplies errors, for chains of 1 to `longest` bodies with 1 to 50 sweeps.

    Shape (longest, SWEEPS_DRAWN). Errors as `chain`.
    """
    chains = [swept_links(engine, h, links(n, mass_ratio, both_ends=both_ends), 1) for n in range(1, longest + 1)]
    return np.array([[each.growth(values, sweeps + 1).factor for sweeps in range(SWEEPS_DRAWN)] for each in chains])
