"""What is printed of engines: their columns."""

from collections.abc import Sequence

from bezstab.catalogue.answer import EngineFacts
from bezstab.engines.conversions import Engine
from bezstab.rationals import rational
from bezstab.show.columns import Column
from bezstab.show.fields import MISSING

SPINNING = {
    "acceleration": "gains, as θ⁴",
    "bias": "loses, as θ⁴",
    "beside": "loses θ² a step",
    "projected": "loses 2θ² a step",
}
"""What becomes of the energy of a body that spins by θ in a step, by the class of an engine."""


def _set_words(engine: Engine) -> str:
    """Return the values that are needed, else those that there are."""
    return ", ".join(engine.parameters or engine.optional) or "nothing"


def _defaults(facts: EngineFacts) -> list[float] | None:
    texts = facts.engine.defaults.split(",") if facts.engine.defaults else ()
    return [float(rational(text)) for text in texts] or None


def _short(numbers: Sequence[float]) -> str:
    return ",".join(f"{number:.6g}" for number in numbers)


def _usual_words(facts: EngineFacts) -> str:
    """Return the point of an engine's defaults: 1, 0.2."""
    return MISSING if facts.usual is None else ", ".join(f"{float(number):.4g}" for number in facts.usual)


def _of_usual(facts: EngineFacts, place: int) -> float | None:
    return None if facts.usual is None else float(facts.usual[place])


def _spinning_words(engine: Engine) -> str:
    if engine.energy_class is None:
        return "by the integrator" if engine.level == "acceleration" else MISSING
    return SPINNING[engine.energy_class]


def _units(engine: Engine) -> str:
    return ", ".join(engine.units.values())


COLUMNS: Sequence[Column[EngineFacts]] = (
    Column("engine", "engine", lambda facts: facts.engine.name, "name of the engine", brief=True),
    Column("what you set", "", lambda facts: _set_words(facts.engine), "", brief=True),
    Column("defaults", "defaults", _defaults, "values unless you set them", form=_short, brief=True),
    Column("as α̂, β̂", "", _usual_words, "", brief=True),
    Column("", "alpha_hat", lambda facts: _of_usual(facts, 0), "α̂ of the defaults at this step; null without them"),
    Column("", "beta_hat", lambda facts: _of_usual(facts, 1), "β̂ of the defaults at this step; null without them"),
    Column(
        "to paste",
        "setting",
        lambda facts: facts.setting,
        "what to set for --alpha and --beta, or why there is nothing; null without them",
        brief=True,
    ),
    Column(
        "energy gained a second",
        "energy_rate",
        lambda facts: facts.energy_rate,
        "what a second adds to the energy of a motion of the rate --omega, as a share of it; null without a rate, or "
        "where errors grow",
        form=".2e",
        brief=True,
    ),
    Column("verified by", "", lambda facts: "a run" if facts.witness else "its source", "", brief=True),
    Column(
        "",
        "witness",
        lambda facts: facts.witness,
        "test that runs the engine itself and holds the conversion; null where its source alone says it",
    ),
    Column(
        "level",
        "level",
        lambda facts: facts.engine.level,
        "where the feedback acts; at acceleration level the integrator decides what becomes of it",
    ),
    Column(
        "steps as",
        "method",
        lambda facts: facts.engine.method,
        "method whose step the engine's is; null where that is your integrator's",
    ),
    Column("", "parameters", lambda facts: ", ".join(facts.engine.parameters) or None, "parameters of the feedback"),
    Column("may follow", "optional", lambda facts: ", ".join(facts.engine.optional) or None, "those that may follow"),
    Column("units", "units", lambda facts: _units(facts.engine) or None, "units of the parameters, in their order"),
    Column("a spinning body", "", lambda facts: _spinning_words(facts.engine), ""),
    Column(
        "",
        "energy_class",
        lambda facts: facts.engine.energy_class,
        "how errors are taken back, which decides what a step does to the energy of a body that spins about a pin; "
        "null where the integrator decides, or nothing spins",
    ),
    Column("left out", "excludes", lambda facts: facts.engine.excludes, "what the conversion leaves out"),
    Column("source", "source", lambda facts: facts.engine.source, "where the conversion is from"),
    Column(
        "sweeps",
        "sweeps",
        lambda facts: facts.engine.sweeps,
        "whether the engine solves one constraint after another, so that `bezstab chain` is asked about many",
    ),
    Column(
        "sweeps in a step",
        "swept_iterations",
        lambda facts: facts.engine.sweeping.iterations if facts.engine.sweeping else None,
        "its own number of sweeps; null where it does not sweep, or it is not known how",
    ),
    Column(
        "called",
        "swept_word",
        lambda facts: facts.engine.sweeping.word if facts.engine.sweeping else None,
        "what the engine calls that number",
    ),
    Column(
        "left out of sweeps",
        "swept_excludes",
        lambda facts: facts.engine.sweeping.excludes if facts.engine.sweeping else None,
        "what is left out of how it sweeps",
    ),
    Column(
        "source of sweeps",
        "swept_source",
        lambda facts: facts.engine.sweeping.source if facts.engine.sweeping else None,
        "where it is from how the engine sweeps",
    ),
)
