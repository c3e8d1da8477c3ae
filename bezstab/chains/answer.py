"""Is a chain of bodies stable in an engine that sweeps over its constraints, with how many sweeps, and what to set?"""

import cmath
import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction

import numpy as np

from bezstab.arguments import Number, exact_number, exact_or_none, in_keywords, whole_number
from bezstab.chains.links import Links, Load, links
from bezstab.engines.conversions import Engine
from bezstab.engines.engine_list import engine_and_values
from bezstab.engines.sweeping import check_iterations, motor_named
from bezstab.errors import InputError
from bezstab.questions.chains import SweptConstraints
from bezstab.stability.arrays import FloatArray
from bezstab.stability.choices import TENTH, steps_to_settle
from bezstab.stability.sweeps import SlowestMotion
from bezstab.units import check_step
from bezstab.words import as_sentence, change_words, counted

SPREAD = 0.1
"""The share by which the setting to paste may be stronger and the chain still be stable."""

SWEEPS_DRAWN = 50

NO_SAG = 1e-9
"""m: impulses that are kept hold a load without an error; what is computed then is rounding."""


@dataclass(frozen=True, repr=False)
class ChainAnswer:
    """All that is known of a chain in an engine with such values, at a step of h (s) with so many sweeps.

    `z_abs` is the factor by which a step multiplies its errors in the long run, computed and off by at most `accuracy`;
    `alone_z_abs` that of one constraint alone. `growing` are the errors of its links, from the world on, that decay
    last, or grow: sizes as shares of the largest. `tenth_steps` and `settle_steps`: steps until an error is a tenth, a
    thousandth; None where it does not fall. `stable_iterations`: from how many sweeps errors decay; None if
    from none that is tried. `setting`: the strongest values with which this chain is stable even if they were SPREAD
    stronger; None where there are none, or where the engine has nothing to set. `sag`: how far (m) some body rests from
    its place, at most, under a `load`; None without a load, and if not safe. `jitter`: the root mean square of the
    worst joint's error (m) where growth ends, if the chain hangs from one end under the load, or gravity: `_jitter`.
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
    load: Load | None
    sag: float | None
    jitter: float | None
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
    motor: str | None = None,
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
        Masses from the world on, in place of `bodies` and `mass_ratio`; in kg where there is a force.
    both_ends : bool
        Whether the world also holds the last body.
    motor : str, optional
        A motor in each joint; bodies are then equally long rods. "rate" holds the joint's rate at 0, "angle" its angle
        as hard as its pin, "5,1" its angle by an implicit spring of 5 Hz and damping ratio 1.
    iterations : int, optional
        Sweeps in a step; by default the engine's own number.
    load : int, float, str or Fraction, optional
        A steady force (N) on the end of the chain, which needs `masses`, or "gravity" on all of it; along the chain,
        with motors across it. `sag` says how far it sags.

    Returns
    -------
    ChainAnswer
        True if errors decay; `sentence` says it in words. The map is linear: the chain is nearly straight.

    Raises
    ------
    InputError
        The engine does not sweep, or it is not known how; the numbers are no chain; or nothing holds the load.
    NumericalError
        Rounding leaves open whether errors decay.
    """
    named, values = engine_and_values(engine)
    pulls: Load | None = "gravity" if load == "gravity" else exact_or_none(load, "load")
    whole = links(
        whole_number(bodies, "bodies"),
        exact_number(mass_ratio, "mass_ratio"),
        None if masses is None else tuple(exact_number(mass, "masses") for mass in masses),
        both_ends=both_ends,
        motor=None if motor is None else motor_named(motor),
        load=pulls,
    )
    sweeps = None if iterations is None else whole_number(iterations, "iterations")
    return judge_chain(named, values, exact_number(h, "h"), whole, sweeps, pulls)


def judge_chain(
    engine: Engine,
    values: tuple[Fraction, ...],
    h: Fraction,
    chained: Links,
    iterations: int | None = None,
    load: Load | None = None,
) -> ChainAnswer:
    """Return what a step of h (s) does to the errors of a chain; errors as `chain`."""
    swept = swept_links(engine, h, chained, iterations)
    found, motion = swept.answer(values), swept.slowest_motion(values)
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
        growing=chained.gaps(motion.errors),
        tenth_steps=steps_to_settle(found.growth.factor, TENTH) if safe else None,
        settle_steps=steps_to_settle(found.growth.factor) if safe else None,
        stable_iterations=found.stable_iterations,
        setting=_setting(swept),
        load=load,
        sag=None if load is None or not safe else _sag(swept, values, chained, load),
        jitter=None if safe else _jitter(swept, motion, chained, load or "gravity"),
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
    if chained.motor and chained.motor.kind not in engine.sweeping.motors:
        known = ", ".join(engine.sweeping.motors) or "none"
        raise InputError(f"--motor {chained.motor.kind}: of {engine.name}'s motors are known here: {known}")
    return SweptConstraints(engine, h, chained.constraints(h), sweeps)


def _sag(swept: SweptConstraints, values: tuple[Fraction, ...], chained: Links, load: Load) -> float:
    """Return how far (m) some body of a chain rests from its place, at most, under a load."""
    if chained.motor and chained.motor.kind == "rate":
        raise InputError("--load: motors that hold a rate hold no angle, so the chain droops on and on")
    sag = float(chained.moved(swept.rest(values, float(swept.h) ** 2 * chained.pull(load))).max())
    return sag if sag > NO_SAG else 0.0


JITTER = 2.5
"""Times the law of `_jitter`: the median of 271 runs of pymunk with random chains, from 0.01 % to 15 % of a link.

Of these 84 % are within a factor of two, 96 % within three. Of 270 runs of bepu's springs in two dimensions, by loops
over links, 93 % are within three.
"""


def _jitter(swept: SweptConstraints, motion: SlowestMotion, chained: Links, load: Load) -> float | None:
    """Return the error (m) of the worst joint at which growth ends; None for arms, two pinned ends, and no swing.

    Growth ends when impulses swing as far as those that hold the load: then links also push, and the chain buckles.
    The faster it grows in the time of a swing, the further it gets: by the root of that, as runs show. The law is for
    links that are far longer than the jitter. Else the chain comes apart.
    """
    turn = abs(cmath.phase(motion.pole))
    if chained.motor or chained.both_ends or not 0 < turn < math.pi:
        return None
    holding = np.linalg.solve(swept.constraints.inverse_masses, float(swept.h) ** 2 * chained.pull(load))
    swing = np.linalg.norm(holding) / np.linalg.norm(motion.impulses)
    return float(JITTER * motion.errors.max() * swing * math.sqrt(abs(motion.pole) - 1) / turn)


def _setting(swept: SweptConstraints) -> str | None:
    """Return the line to paste of the strongest feedback that a chain allows; None if there is none, or none to set."""
    if not (swept.engine.curve and swept.engine.parameters):
        return None
    strongest = swept.strongest(SPREAD)
    return None if strongest is None else swept.engine.setting(strongest, swept.h)


def _sentence(answer: ChainAnswer) -> str:
    """Return whether a chain is stable, how fast its errors fall or grow, and from how many sweeps it is stable."""
    judged = f"{answer.engine.name}, {answer.links.words}, {counted(answer.iterations, 'sweep')}"
    change = change_words(
        answer.z_abs, "converges" if answer.safe else "diverges", answer.settle_steps, float(answer.h)
    )
    if not answer.safe and len(answer.growing) > 1:
        change += f", most at link {1 + int(np.argmax(answer.growing))} from the world"
    enough = "No number of sweeps that was tried is stable"
    if answer.stable_iterations is not None:
        enough = f"It is stable from {counted(answer.stable_iterations, 'sweep')}"
    sentence = f"{judged}: {'safe' if answer.safe else 'not safe'}. {as_sentence(change)} {enough}."
    if answer.sag is not None:
        sags = f"sags by {_length_words(answer.sag)}" if answer.sag else "does not sag"
        sentence += f" Under {_load_words(answer.load)} {'across' if answer.links.motor else 'along'} it, it {sags}."
    if answer.jitter is not None:
        hangs = f"Hanging under {_load_words(answer.load)} it jitters, if links are far longer: joints are off by about"
        sentence += f" {hangs} {_length_words(answer.jitter, 2)}, within a factor of three."
    if answer.setting and not answer.safe:
        sentence += f" With these sweeps {answer.setting} is stable, with {SPREAD:.0%} to spare."
    return sentence


def _load_words(load: Load | None) -> str:
    return f"{float(load):g} N at its end" if isinstance(load, Fraction) else "gravity"


def _length_words(metres: float, digits: int = 3) -> str:
    return f"{metres:.{digits}g} m" if metres >= 1 else f"{1000 * metres:.{digits}g} mm"


def chain_map(engine: Engine, values: tuple[Fraction, ...], h: Fraction, longest: Links) -> FloatArray:
    """Return the factors by which a step multiplies errors, with 1 to 50 sweeps, of all chains up to the longest.

    A shorter one is its end. Shape (bodies, SWEEPS_DRAWN). Errors as `chain`.
    """
    bodies = range(1, len(longest.masses) + 1)
    chains = [swept_links(engine, h, replace(longest, masses=longest.masses[-count:]), 1) for count in bodies]
    return np.array([[each.growth(values, sweeps + 1).factor for sweeps in range(SWEEPS_DRAWN)] for each in chains])
