"""Every field of every row, and which fields the rows of each command have: the one place that says so.

A new column is a line here: a `Field` among those of its kind of row. Rows, tables, CSV, JSON and the table of keys
(keys.csv) take it from there.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial

from bezstab.show.cells import (
    SPINNING,
    modulus_words,
    unbounded,
)
from bezstab.show.fields import MISSING, Field, RowKind, integer, number, text, truth

NOT_MEASURED = "where nothing could be measured; `reason` says why"
NO_SWEEPS = "where the engine does not sweep, or it is not known how"

METHOD = text(
    "method",
    "Name of the integration method, with @m where its step is m times h",
    "method",
    otherwise=lambda _: "yours",
)
Z_REAL = number("z_real", "Real part of the pole", path="pole.real")
Z_IMAG = number("z_imag", "Imaginary part of the pole, that of the upper one of a pair", path="pole.imag")
Z_ABS = number(
    "z_abs", "Modulus of the pole: each step multiplies errors by it", "|z_p|", modulus_words, path="pole.abs"
)
Z_ANGLE_DEG = number(
    "z_angle_deg",
    "Angle of the pole: errors turn by it in each step",
    "∠z (deg)",
    ".3f",
    unit="degrees",
    path="pole.angle_deg",
)
# the pole of an answer; `pole_fields` makes those of others from it
POLE = (Z_REAL, Z_IMAG, Z_ABS, Z_ANGLE_DEG)


def pole_fields(name: str, which: str, null: str = "") -> Sequence[Field]:
    """Return the fields of one pole of several, by its name: those of POLE, which tell the pole by what it is."""
    return [
        replace(
            field,
            key=f"{name}_{field.key}",
            meaning=field.meaning.replace("the pole", f"the pole {which}"),
            heading=field.heading and f"{name} {field.heading}",
            path=field.path.replace("pole", name),
            null=null,
        )
        for field in POLE
    ]


PREDICTED_Z_REAL, PREDICTED_Z_IMAG, PREDICTED_Z_ABS, PREDICTED_Z_ANGLE_DEG = pole_fields(
    "predicted", "predicted for the mechanism at rest"
)
MEASURED_Z_REAL, MEASURED_Z_IMAG, MEASURED_Z_ABS, MEASURED_Z_ANGLE_DEG = pole_fields(
    "measured", "measured in the simulation", null=NOT_MEASURED
)
end = partial(number, form=".8g", otherwise=unbounded, null="where the region has no end there, or is empty")
SOURCE = text("source", "Where a method or a conversion is from", "source")
SETTING = text(
    "setting",
    "What to write in the engine's words",
    "to paste",
    null="where no point is given, or the engine's values are",
)
SWEEPS = truth(
    "sweeps",
    "Whether the engine solves each constraint by itself, in sweeps, so that what is said of one alone says "
    "little about a chain of them",
    path="question.engine.sweeps",
)
EXCLUDES = text("excludes", "What the conversion leaves out", "left out", path="question.engine.excludes")

# what --omega adds without a scene
ENERGY_RATE = number(
    "energy_rate",
    "What a second adds to the energy of a motion of that rate, which varies by 30 %, or in an engine of a body that "
    "spins about a pin, as a share of it",
    "energy gained a second",
    ".2e",
    null="without --omega, or where an error grows",
    path="energy_rate.0",
)
# constraints that an engine sweeps over, also of `chains` and `engines`
SWEPT_ITERATIONS = integer(
    "swept_iterations", "Sweeps that the engine makes in a step", "sweeps", null=NO_SWEEPS, path="swept.iterations"
)
# printed by `engines`
ENGINES_LISTED = RowKind(
    "an engine",
    fields=(
        text("engine", "Name of an engine", "engine", path="name"),
        text(
            "level",
            "Where the engine's feedback acts",
            "level",
        ),
        METHOD,
        text("parameters", "What the engine calls the feedback's parameters", "parameters"),
        text("optional", "Which of the parameters may be left away", "optional"),
        text("units", "Units of the parameters, in their order", "units"),
        SETTING,
        text(
            "energy_class",
            "How the engine takes errors back, which decides what a step does to the energy of a body that spins about "
            "a pin: motion/README.md",
            "a spinning body",
            text=lambda row: SPINNING[row["energy_class"]],
            otherwise=lambda row: "by the integrator" if row["level"] == "acceleration" else MISSING,
            null="where the integrator decides, or nothing spins",
        ),
        ENERGY_RATE,
        text(
            "witness",
            "With which engine a run has confirmed the conversion",
            "verified by",
            text=lambda row: "a run" if row["witness"] else "its source",
            null="where its source alone says it",
        ),
        SOURCE,
        EXCLUDES,
        SWEEPS.shown("sweeps"),
        SWEPT_ITERATIONS.hidden.of("sweeping.iterations"),
        text("swept_word", "What the engine calls their number", null=NO_SWEEPS, path="sweeping.word"),
        text("swept_source", "Where it is from how the engine sweeps", null=NO_SWEEPS, path="sweeping.source"),
        text("swept_excludes", "What is left out of how it sweeps", null=NO_SWEEPS, path="sweeping.excludes"),
    ),
)
ROW_KINDS: Mapping[str, Sequence[RowKind]] = {
    "engines": (ENGINES_LISTED,),
}
"""The kinds of rows that each command prints."""

FIELDS: Mapping[str, Field] = {
    field.key: field for kinds in ROW_KINDS.values() for kind in kinds for field in (*kind.fields, *kind.added)
}
"""Every key that any command prints, by name."""
