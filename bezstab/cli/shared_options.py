"""Options that several commands share, as click decorators: `@h`, `@method`; and groups of them: `@output_options`."""

from fractions import Fraction
from pathlib import Path
from typing import get_args

import click

from bezstab.cli.options import (
    ENGINE_VALUES,
    METHOD,
    NUMBER,
    POSITIVE,
    SCENE,
    SECONDS,
    SPEED,
    ParsedType,
    choose_compiled,
)
from bezstab.compiling import COMPILED_CHOICE
from bezstab.errors import InputError
from bezstab.rationals import rational
from bezstab.show.file_forms import FIGURE_FORMS, TABLE_FORMS
from bezstab.show.tables import Format
from bezstab.units import GRAVITY

alpha = click.option("--alpha", type=NUMBER, help="α̂, or with --physical α in 1/s.")
beta = click.option("--beta", type=NUMBER, help="β̂, or with --physical β in 1/s.")
physical = click.option("--physical", is_flag=True, help="--alpha and --beta are α and β in 1/s; with --h.")
point = (alpha, beta, physical)


def _load(text: str) -> Fraction:
    """Return the acceleration of gravity, or of a force and the mass that it acts on: 50,2."""
    if text == "gravity":
        return GRAVITY
    force, comma, mass = text.partition(",")
    if not comma:
        raise InputError(f"{text}: expected gravity, or a load with the mass that it acts on, such as 50,2 (N and kg)")
    if (inertia := rational(mass)) <= 0:
        raise InputError(f"{text}: expected a mass above 0")
    return rational(force) / inertia


LOAD = ParsedType("gravity|load,mass", _load, lambda: ["gravity"])

FIGURES, TABLES = [*FIGURE_FORMS, "none"], [*TABLE_FORMS, "none"]
"""Formats of what a command writes."""

METHOD_HELP, FIGURE_HELP, TABLE_HELP = (
    "A name of `bezstab methods`, or a .toml file.",
    f"{', '.join(FIGURES)}.",
    f"{', '.join(TABLES)}.",
)

h = click.option("--h", type=SECONDS, required=True, help="Step size in s.")
methods = click.option("--method", "methods", type=METHOD, multiple=True, help=f"{METHOD_HELP} Repeatable.")
engine_values = click.option(
    "--engine",
    type=ENGINE_VALUES,
    help="An engine's own values, such as mujoco=0.02,1 [its defaults], in place of --alpha and --beta; needs --h.",
)
as_typed = click.option(
    "--as-typed", is_flag=True, help="With --engine: take values as typed, without its clamps and scales."
)
omega = click.option(
    "--omega", type=POSITIVE, help="Rate of the motion in 1/s; needs --h [that of --scene, or ωh = 0.01]."
)
scene = click.option("--scene", type=SCENE, help="A mechanism that moves: a shipped scene, or a .toml file.")
speed = click.option("--speed", type=SPEED, default="1", help="Run --scene so many times as fast.")
time = click.option("--time", "duration", type=SECONDS, help="Run --scene for so many s [10 s, at most 10,000 steps].")
compiled = click.option(
    "--compiled",
    type=click.Choice(["auto", "yes", "no"]),
    default="auto",
    envvar=COMPILED_CHOICE,
    expose_value=False,
    callback=choose_compiled,
    metavar="WORD",
    show_default=False,
    help="auto, yes, no: runs as machine code, by numba [auto].",
)
table = click.option("--table", type=click.Choice(TABLES), default="none", metavar="FORM", help=TABLE_HELP)
figure = click.option("--figure", type=click.Choice(FIGURES), default="none", help="Format of the figure.")
output = click.option(
    "-o", "--output", type=click.Path(path_type=Path), default=".", help="Directory for what is written."
)
FORMS = get_args(Format)
form = click.option(
    "--format", "form", type=click.Choice(FORMS), default="text", metavar="FORM", help=f"{', '.join(FORMS)}."
)
every_column = click.option("--all", "every_column", is_flag=True, help="Print every column, not only the main ones.")


load = click.option(
    "--load", type=LOAD, help="Sag of --engine under gravity, or under 50,2: N and kg, or N m and kg m²."
)
output_options = (every_column, form, figure, output)
"""What says how a command answers that draws if it is asked to."""
