"""What is printed of engines: their columns."""

from collections.abc import Sequence

from bezstab.catalogue.answer import EngineFacts
from bezstab.engines.conversions import Engine
from bezstab.engines.sweeping import Sweeping
from bezstab.rationals import rational
from bezstab.show.cells import MISSING
from bezstab.show.columns import Column, of_part

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


def _spinning_words(engine: Engine) -> str:
    if engine.energy_class is None:
        return "by the integrator" if engine.level == "acceleration" else MISSING
    return SPINNING[engine.energy_class]


def _parameters(facts: EngineFacts) -> str | None:
    """Return the parameters of an engine in their order with their units, optional ones in brackets."""
    engine = facts.engine
    named = {name: f"{name}: {unit}" for name, unit in engine.units.items()}
    return ", ".join(f"[{text}]" if name in engine.optional else text for name, text in named.items()) or None


SWEEPING: Sequence[Column[Sweeping]] = (
    Column(
        "sweeps in a step",
        "iterations",
        lambda sweeping: sweeping.iterations,
        "its own number of sweeps; null where it does not sweep, or it is not known how",
    ),
    Column("called", "", lambda sweeping: sweeping.word, ""),
    Column("left out of sweeps", "", lambda sweeping: sweeping.excludes, ""),
    Column("source of sweeps", "", lambda sweeping: sweeping.source, ""),
)

COLUMNS: Sequence[Column[EngineFacts]] = (
    Column("engine", "engine", lambda facts: facts.engine.name, "name of the engine", brief=True),
    Column("what you set", "", lambda facts: _set_words(facts.engine), "", brief=True),
    Column("defaults", "defaults", _defaults, "values unless you set them", form=_short, brief=True),
    Column("as α̂, β̂", "", _usual_words, "", brief=True),
    Column(
        "",
        "alpha_hat",
        lambda facts: facts.usual and float(facts.usual[0]),
        "α̂ of the defaults at this step; null without them",
    ),
    Column(
        "",
        "beta_hat",
        lambda facts: facts.usual and float(facts.usual[1]),
        "β̂ of the defaults at this step; null without them",
    ),
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
    Column("level", "", lambda facts: facts.engine.level, ""),
    Column(
        "steps as",
        "method",
        lambda facts: facts.engine.method,
        "method whose step the engine's is; null where that is your integrator's",
    ),
    Column(
        "parameters",
        "parameters",
        _parameters,
        "parameters of the feedback with their units, in brackets those that may follow",
    ),
    Column("a spinning body", "", lambda facts: _spinning_words(facts.engine), ""),
    Column("left out", "excludes", lambda facts: facts.engine.excludes, "what the conversion leaves out"),
    Column("source", "source", lambda facts: facts.engine.source, "where the conversion is from"),
    Column(
        "sweeps",
        "sweeps",
        lambda facts: facts.engine.sweeps,
        "whether the engine solves one constraint after another, so that `bezstab chain` is asked about many",
    ),
    *of_part(EngineFacts, lambda facts: facts.engine.sweeping, SWEEPING),
)
