"""Every option that commands share, declared once; the types of values; rules for options that are typed together."""

import os
import re
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass, fields
from fractions import Fraction
from functools import partial, wraps
from pathlib import Path
from typing import Any, get_args

import click
from click.shell_completion import CompletionItem

from bezstab.cli.output import NOTES, Files
from bezstab.compiling import COMPILED_CHOICE, compiler
from bezstab.engines.conversions import Engine, Point
from bezstab.engines.engine_list import ENGINES, engine_and_values, engine_named
from bezstab.errors import InputError
from bezstab.methods.registry import REGISTRY, lookup
from bezstab.rationals import rational
from bezstab.show.file_forms import FIGURE_FORMS, TABLE_FORMS
from bezstab.show.tables import Format
from bezstab.units import LEAST_STEP, LONGEST_STEP, to_dimensionless

EngineValues = tuple[Engine, tuple[Fraction, ...]]
Function = Callable[..., Any]
Option = Callable[..., click.Option]
"""`click.Option`, with all but what a command may change of the option."""

MOST_IN_SEQUENCE = 10**6  # steps: a run of minutes
USUAL_METHODS = ("B2", "B3", "B4", "AB2", "AB3", "AB4", "RK4@5", "SIE")
"""The methods that poles shows without --method: the Bezier methods and their usual alternatives."""


@dataclass(frozen=True)
class ParsedType(click.ParamType):  # type: ignore[type-arg]  # generic since click 8.3
    """A type whose values `parse` makes of the typed text. Its InputError becomes a message that names the option.

    The shell offers the `names` when it completes a value.
    """

    name: str
    parse: Callable[[str], object]
    names: Callable[[], Iterable[str]] | None = None

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """Return the parsed value; fail with a message that names the option if there is none."""
        try:
            return self.parse(value)
        except InputError as error:
            self.fail(str(error), param, ctx)

    def shell_complete(
        self, ctx: click.Context, param: click.Parameter, incomplete: str
    ) -> "list[CompletionItem[Any]]":
        """Return the names that begin with the typed text, in upper or lower case; files where none does."""
        if self.names is None:
            return []
        fitting = [name for name in self.names() if name.lower().startswith(incomplete.lower())]
        return [CompletionItem(name) for name in fitting] or [CompletionItem(incomplete, type="file")]


def _scenes() -> Iterable[str]:
    from bezstab.mechanism.scene_files import shipped_scenes

    return shipped_scenes()


def _positive(text: str) -> Fraction:
    number = rational(text)
    if number <= 0:
        raise InputError(f"{text} is not positive")
    return number


def _within_squares(text: str, unit: str) -> Fraction:
    """Return a positive number whose square is within float64; messages name the unit."""
    number = _positive(text)
    if not LEAST_STEP <= float(number) <= LONGEST_STEP:
        raise InputError(f"{text}: expected {LEAST_STEP:g} to {LONGEST_STEP:g} {unit}")
    return number


def _sequence(text: str) -> list[Fraction]:
    """Return the steps (s) of a text such as 3*0.01,0.02 (0.01 three times, then 0.02), or of a file of such texts."""
    if os.path.isfile(text):  # pathlib raises for a sequence that is too long to be a file's name
        try:
            text = Path(text).read_text(encoding="utf-8")
        except (OSError, ValueError) as error:
            raise InputError(f"cannot read {text[:50]!r}: {error}") from None
    sequence: list[Fraction] = []
    for part in re.split(r"[,\s]+", text.strip()):
        count, star, step = part.rpartition("*")
        times = rational(count) if star else Fraction(1)
        if times.denominator != 1 or not 1 <= times <= MOST_IN_SEQUENCE - len(sequence):
            raise InputError(f"{part[:50]!r}: expected a number of steps from 1, and {MOST_IN_SEQUENCE} in all")
        sequence += [_within_squares(step, "s")] * int(times)
    return sequence


def _engine_values(text: str) -> EngineValues:
    """Return an engine and its values; note which they are, to be said beside an answer, if its defaults are taken."""
    engine, values = engine_and_values(text)
    if engine.defaults and not text.partition("=")[2]:
        listed = ", ".join(f"{name} = {float(value):g}" for name, value in zip(engine.units, values, strict=False))
        note = f"{engine.name}: without values, its defaults are taken: {listed}"
        click.get_current_context().meta.setdefault(NOTES, []).append(note)
    return engine, values


NUMBER = ParsedType("number", rational)
POSITIVE = ParsedType("number", _positive)
SECONDS = ParsedType("seconds", partial(_within_squares, unit="s"))
SPEED = ParsedType("number", partial(_within_squares, unit="times the scene's own speed"))
SEQUENCE = ParsedType("steps", _sequence)
NUMBERS = ParsedType("number,number,...", lambda text: tuple(map(rational, text.split(","))))
METHOD = ParsedType("method", lookup, lambda: REGISTRY)
SHARE = ParsedType("number", lambda text: float(rational(text)))
ENGINE = ParsedType("name", engine_named, lambda: ENGINES)
ENGINE_VALUES = ParsedType("name[=values]", _engine_values, lambda: [f"{name}=" for name in ENGINES])
SCENE = ParsedType("scene", str, _scenes)


def option(names: str, kind: Any, meaning: str, **more: Any) -> Option:
    """Return an option: its names as `click.Option` has them, with spaces between; its values' type; its help."""
    return partial(click.Option, names.split(), type=kind, help=meaning, **more)


def flag(names: str, meaning: str) -> Option:
    """Return an option without a value."""
    return partial(click.Option, names.split(), is_flag=True, help=meaning)


def choose_compiled(_context: click.Context, _option: click.Parameter, choice: str) -> None:
    """Set the environment variable to the value of the option: worker processes inherit it.

    InputError if numba is asked for and missing.
    """
    if choice == "yes":
        compiler()
    os.environ[COMPILED_CHOICE] = choice


A_METHOD = "A method's name, as `bezstab methods` lists it, or a .toml file; NAME@m takes steps of m h."

OPTIONS = {
    "methods": option("--method methods", METHOD, f"{A_METHOD} Repeatable.", multiple=True),
    "method": option("--method", METHOD, A_METHOD),
    "alpha": option("--alpha", NUMBER, "α̂ as a decimal or a fraction, read exactly. With --physical: α in 1/s."),
    "beta": option("--beta", NUMBER, "β̂ as a decimal or a fraction, read exactly. With --physical: β in 1/s."),
    "physical": flag("--physical", "--alpha and --beta are α and β in 1/s; needs --h."),
    "h": option("--h", SECONDS, "Step size in s."),
    "engine": option("--engine", ENGINE, "Choose only what this engine can express, and print the line to paste."),
    "engine_values": option(
        "--engine",
        ENGINE_VALUES,
        "An engine's own values, such as mujoco=0.02,1 [its defaults], in place of --alpha and --beta; needs --h.",
    ),
    "scene": option("--scene", SCENE, "A shipped scene's name, or a .toml file."),
    "speed": option(
        "--speed", SPEED, "Multiply the speed of the scene's drivers and initial velocities by this.", default="1"
    ),
    "omega": option(
        "--omega",
        POSITIVE,
        "The rate of the mechanism's motion in 1/s. The errors that the feedback makes depend on it. Needs --h [the "
        "rate of --scene, else ωh = 0.01].",
    ),
    "duration": option("--time duration", SECONDS, "Duration in s."),
    "compiled": option(
        "--compiled",
        click.Choice(["auto", "yes", "no"]),
        "Compile runs of explicit methods without projection, with numba. auto: if numba is installed and compiling "
        "saves time.",
        default="auto",
        envvar=COMPILED_CHOICE,
        expose_value=False,
        callback=choose_compiled,
    ),
    "output": option("-o --output", click.Path(path_type=Path), "Directory for what is written.", default="."),
    "figure": option("--figure", click.Choice([*FIGURE_FORMS, "none"]), "Format of the figure.", default="png"),
    "form": option(
        "--format form", click.Choice(get_args(Format)), "What to print on standard output.", default="text"
    ),
    "table": option("--table", click.Choice([*TABLE_FORMS, "none"]), "Format of the table.", default="none"),
}
"""The options that several commands take. Most are called like the field of a question that they give."""


def changed(name: str, **more: Any) -> Option:
    """Return the option of that name in OPTIONS as one command has it, with another default, help or type."""
    return partial(OPTIONS[name], **more)


@dataclass(frozen=True)
class Rule:
    """Each of some options needs one of some others, and excludes others; `why` is the reason that a message gives.

    The options may be "--stabilise none": with that value alone.
    """

    options: tuple[str, ...]
    why: str
    needs: tuple[str, ...] = ()
    excludes: tuple[str, ...] = ()

    def check(self) -> None:
        """Raise UsageError if the options of the running command break this rule."""
        typed = typed_options()
        with_values = {f"{option} {value}" for option, value in typed.items()}
        for option in self.options:
            if option not in with_values | typed.keys():
                continue
            if self.needs and typed.keys().isdisjoint(self.needs):
                one_of = "one of " if len(self.needs) > 1 else ""
                raise click.UsageError(f"{option} needs {one_of}{', '.join(self.needs)}: {self.why}")
            refuse_beside(option, {*self.excludes} - {option}, self.why)


def typed_options() -> dict[str, Any]:
    """Return the values that the user gave the running command, each by the long name of its option."""
    context = click.get_current_context()
    names = {str(parameter.name): parameter.opts[-1] for parameter in context.command.params}
    return {
        option: context.params.get(name)
        for name, option in names.items()
        if context.get_parameter_source(name) == click.core.ParameterSource.COMMANDLINE
    }


def refuse_beside(option: str, others: Collection[str], why: str) -> None:
    """Raise UsageError if one of the others was typed together with that option in the running command."""
    for other in sorted(typed_options().keys() & set(others)):
        raise click.UsageError(f"{other} does not go with {option}: {why}")


GROUPS: Mapping[str, tuple[str | Option | Rule, ...]] = {
    "point": ("alpha", "beta", "physical"),
    "given_point": (  # in the plane, or by an engine's own values
        "point",
        changed("h", help="Step size in s, for --physical, --engine, --scene and --omega."),
        "engine_values",
        flag(
            "--as-typed",
            "With --engine: take the values as typed, without what the engine does to them, such as clamps.",
        ),
        Rule(("--engine",), "it gives the point itself", excludes=("--alpha", "--beta", "--physical")),
    ),
    "picture": (
        "output",
        "figure",
    ),
    "files": ("picture", "table"),
}
"""Options that go together, by a name for all of them, with their rules."""


@dataclass(frozen=True)
class TypedPoint:
    """The options --alpha, --beta and --physical as typed: alpha_hat and beta_hat, or with `physical` both in 1/s."""

    alpha: Fraction | None
    beta: Fraction | None
    physical: bool = False

    @property
    def numbers(self) -> Point | None:
        """The two numbers, None without them; UsageError if one is missing."""
        if self.alpha is not None and self.beta is not None:
            return self.alpha, self.beta
        if self.alpha is not None or self.beta is not None:
            raise click.UsageError("--alpha and --beta go together: they give one point")
        if self.physical:
            raise click.UsageError("--physical needs --alpha and --beta: it says that they are in 1/s")
        return None

    def at(self, h: Fraction | None) -> Point | None:
        """Return the point (alpha_hat, beta_hat) for a step of h (s), None without one; UsageError as `numbers`."""
        if self.numbers is None or not self.physical:
            return self.numbers
        if h is None:
            raise click.UsageError("--physical needs --h: α and β in 1/s need the step in s")
        return to_dimensionless(*self.numbers, h)


GATHERED = {"point": TypedPoint, "files": Files}
"""What a command gets as one value, whose fields are the options that it takes of these."""


def command(*options: str | Option | Rule) -> Callable[[Function], click.Command]:
    """Return a decorator that makes a command with options, in this order: of OPTIONS or GROUPS, changed, or its own.

    Rules are checked before the command runs. The command does not get --format: `bezstab.cli.output` knows it.
    """
    every = list(_one_by_one(options))

    def with_options(function: Function) -> click.Command:
        @wraps(function)
        def checked(**typed: Any) -> Any:
            for rule in every:
                if isinstance(rule, Rule):
                    rule.check()
            typed.pop("form", None)
            for parameter, kind in GATHERED.items():
                if own := {field.name: typed.pop(field.name) for field in fields(kind) if field.name in typed}:
                    typed[parameter] = kind(**own)
            return function(**typed)

        return click.command(params=[each() for each in every if not isinstance(each, Rule)])(checked)

    return with_options


def _one_by_one(options: Iterable[str | Option | Rule]) -> Iterator[Option | Rule]:
    """Yield options and rules for their names, and one by one for the names of groups."""
    for each in options:
        if not isinstance(each, str):
            yield each
        elif each in GROUPS:
            yield from _one_by_one(GROUPS[each])
        else:
            yield OPTIONS[each]
