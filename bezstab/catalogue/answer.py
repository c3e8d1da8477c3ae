"""What is known of an engine: its words, what its defaults mean at a step, what to set for a point.

engine, h, point or none, omega or none   →   engine_facts   →   EngineFacts
"""

from dataclasses import dataclass
from fractions import Fraction

from bezstab.engines.conversions import Engine, Point
from bezstab.engines.engine_list import WITNESSES, engine_and_values
from bezstab.errors import InputError
from bezstab.questions.energy import engine_energy_rate


@dataclass(frozen=True)
class EngineFacts:
    """What is known of an engine at a step.

    `usual` is (alpha_hat, beta_hat) of its defaults, None where it has none. `setting` is what to set for the point
    that was asked about, or why there is nothing; None without a point. `energy_rate` is what a second adds to the
    energy of a motion of the rate that was asked about, as a share of it; None without a rate, or where errors grow.
    `witness` is the test that ran the engine itself, None where the row rests on its source.
    """

    engine: Engine
    usual: Point | None
    setting: str | None
    energy_rate: float | None
    witness: str | None


def engine_facts(engine: Engine, h: Fraction, point: Point | None = None, omega: Fraction | None = None) -> EngineFacts:
    """Return what is known of an engine at a step h (s), for a point (dimensionless) and a motion's rate omega (1/s).

    InputError for a motion that turns too far in a step, or hardly.
    """
    return EngineFacts(
        engine=engine,
        usual=_usual(engine, h),
        setting=_setting(engine, point, h) if point else None,
        energy_rate=None if omega is None else engine_energy_rate(engine, point, h, omega),
        witness=WITNESSES.get(engine.name),
    )


def _usual(engine: Engine, h: Fraction) -> Point | None:
    """Return the point of the engine's defaults; None where it has none, or they mean nothing at this step."""
    try:
        _, values = engine_and_values(engine.name)
        return engine.applied(values, h).point
    except InputError:
        return None


def _setting(engine: Engine, point: Point, h: Fraction) -> str:
    try:
        return engine.setting(point, h)
    except InputError as error:
        return str(error)
