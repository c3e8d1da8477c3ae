"""Options that several commands share, the types of their values, and rules for options that are typed together."""

import os
import re
from collections.abc import Callable, Collection, Iterable
from dataclasses import dataclass, fields
from fractions import Fraction
from functools import wraps
from pathlib import Path
from typing import TYPE_CHECKING, Any, get_args

import click

from bezstab.engines import ENGINES, Engine, engine_and_values, engine_named
from bezstab.errors import InputError
from bezstab.methods import REGISTRY, lookup
from bezstab.rationals import rational
from bezstab.show import Format

if TYPE_CHECKING:
    from click.shell_completion import CompletionItem

    from bezstab.mechanism import Stabilise

EngineValues = tuple[Engine, tuple[Fraction, ...]]
Function = Callable[..., Any]
Decorator = Callable[[Any], Any]
"""It takes a command's function and returns it with one more option."""

MOST_IN_SEQUENCE = 10**6  # steps: a run of minutes
SHORTEST = Fraction("1e-100")  # s, and the longest time's inverse: their squares are within float64
USUAL_METHODS = ("B2", "B3", "B4", "AB2", "AB3", "AB4", "RK4@5", "SIE")
"""The methods that poles and explore show without --method: the Bezier methods and their usual alternatives."""


OF_FEEDBACK = ("--alpha", "--beta", "--physical", "--hold", "--omega")
"""Options that are about feedback alone."""

WITH_PARAMETERS = ("newmark(1/4,1/2)", "hht(-1/20)", "generalized-alpha(4/5)")
"""Methods whose names have parameters, with usual values: the shell offers them, too."""


class ParsedType(click.ParamType):  # type: ignore[type-arg]  # generic since click 8.3
    """A type whose values `parse` makes of the typed text. Its InputError becomes a message that names the option.

    The shell offers the `names` when it completes a value.
    """

    def __init__(self, name: str, parse: Callable[[str], object], names: Iterable[str] = ()) -> None:
        self.name, self.parse, self.names = name, parse, names

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """Return the parsed value; fail with a message that names the option if there is none."""
        try:
            return self.parse(value) if isinstance(value, str) else value
        except InputError as error:
            self.fail(str(error), param, ctx)

    def shell_complete(
        self, ctx: click.Context, param: click.Parameter, incomplete: str
    ) -> "list[CompletionItem[Any]]":
        """Return the names that begin with the typed text."""
        if not self.names:
            return []
        from bezstab.cli.completion import offered

        return offered(self.names, incomplete)


def _offered_scenes(ctx: click.Context, param: click.Parameter, incomplete: str) -> "list[CompletionItem[Any]]":
    """Return the shipped scenes whose names begin with the typed text."""
    from bezstab.cli.completion import offered
    from bezstab.mechanism import shipped_scenes

    return offered(shipped_scenes(), incomplete)


def _positive(text: str) -> Fraction:
    number = rational(text)
    if number <= 0:
        raise InputError(f"{text} is not positive")
    return number


def _within_squares(unit: str) -> Callable[[str], Fraction]:
    """Return a function that reads a positive number whose square is within float64; messages name the unit."""

    def read(text: str) -> Fraction:
        number = _positive(text)
        if not SHORTEST <= number <= 1 / SHORTEST:
            raise InputError(f"{text}: expected {float(SHORTEST):g} to {float(1 / SHORTEST):g} {unit}")
        return number

    return read


def _sequence(text: str) -> list[Fraction]:
    """Return the steps (s) of a text such as 3*0.01,0.02 (0.01 three times, then 0.02), or of a file of such texts."""
    path = Path(text)
    try:
        if path.is_file():
            text = path.read_text(encoding="utf-8")
    except (OSError, ValueError) as error:  # no name of a file, or no text in it
        raise InputError(f"cannot read {text[:50]!r}: {error}") from None
    sequence: list[Fraction] = []
    for part in re.split(r"[,\s]+", text.strip()):
        count, star, step = part.rpartition("*")
        times = rational(count) if star else Fraction(1)
        if times.denominator != 1 or not 1 <= times <= MOST_IN_SEQUENCE - len(sequence):
            raise InputError(f"{part[:50]!r}: expected a number of steps from 1, and {MOST_IN_SEQUENCE} in all")
        sequence += [_within_squares("s")(step)] * int(times)
    return sequence


NUMBER = ParsedType("number", rational)
POSITIVE = ParsedType("number", _positive)
SECONDS = ParsedType("seconds", _within_squares("s"))
SPEED = ParsedType("number", _within_squares("times the scene's own speed"))
SEQUENCE = ParsedType("steps", _sequence)
METHOD = ParsedType("method", lookup, (*REGISTRY, *WITH_PARAMETERS))
SHARE = ParsedType("number", lambda text: float(rational(text)))
ENGINE = ParsedType("NAME", engine_named, ENGINES)
ENGINE_VALUES = ParsedType("name=values", engine_and_values, [f"{name}=" for name in ENGINES])


def methods_option(*default: str) -> Decorator:
    """Return the option --method, any number of times, as the parameter `methods`; without a default none are."""
    return click.option(
        "--method",
        "methods",
        type=METHOD,
        multiple=True,
        default=default,
        help="A method's name, as `bezstab methods` lists it, or a .toml file; NAME@m takes steps of m h. Repeatable.",
    )


def scene_option(default: str | None, help_text: str = "A shipped scene's name, or a .toml file.") -> Decorator:
    """Return the option --scene; without a default the command works without a scene, too."""
    return click.option("--scene", default=default, help=help_text, shell_complete=_offered_scenes)


speed_option = click.option(
    "--speed",
    type=SPEED,
    default="1",
    help="Multiply the speed of the scene's drivers and initial velocities by this.",
)
step_option = click.option("--h", type=SECONDS, default="0.001", help="Step size in s.")
physical_option = click.option("--physical", is_flag=True, help="--alpha and --beta are α and β in 1/s; needs --h.")
format_option = click.option(
    "--format",
    "form",
    type=click.Choice(get_args(Format)),
    default="text",
    help="What to print on standard output.",
)


def _choose_compiled(context: click.Context, parameter: click.Parameter, choice: str) -> None:
    """Set the environment variable to the value of the option: worker processes inherit it.

    InputError if numba is asked for and missing.
    """
    if left_at_default(str(parameter.name)):
        return
    from bezstab.compiling import COMPILED_CHOICE, check_numba

    if choice == "yes":
        check_numba()
    before = os.environ.get(COMPILED_CHOICE)
    os.environ[COMPILED_CHOICE] = choice

    def restore() -> None:
        os.environ.pop(COMPILED_CHOICE)
        if before is not None:
            os.environ[COMPILED_CHOICE] = before

    context.call_on_close(restore)


compiled_option = click.option(
    "--compiled",
    type=click.Choice(["auto", "yes", "no"]),
    default="auto",
    expose_value=False,
    callback=_choose_compiled,
    help="Compile runs with numba. auto: if numba is installed and compiling saves time.",
)


def together(*options: Decorator) -> Decorator:
    """Return one decorator that adds several options, in this order."""

    def with_options(function: Function) -> Function:
        for option in reversed(options):
            function = option(function)
        return function

    return with_options


def gathered(kind: type, parameter: str, *options: Decorator) -> Decorator:
    """Return a decorator that adds options. The command gets one value of a dataclass, whose fields they are."""

    def with_options(function: Function) -> Function:
        @wraps(function)
        def with_one_value(*arguments: Any, **typed: Any) -> Any:
            own = {field.name: typed.pop(field.name) for field in fields(kind) if field.name in typed}
            return function(*arguments, **{parameter: kind(**own)}, **typed)

        with_option: Function = together(*options)(with_one_value)
        return with_option

    return with_options


stabilise_options = together(
    click.option(
        "--stabilise",
        type=click.Choice(["baumgarte", "projection", "none"]),
        default="baumgarte",
        help="How the constraints are held. baumgarte: by feedback with α and β. projection: each new state is moved "
        "onto the constraints, by the least change in the metric of the masses. none: not at all (α = β = 0).",
    ),
    click.option(
        "--iterations",
        type=click.IntRange(min=1),
        help="With projection: at most so many Newton iterations for the position in a step [as many as reach 1e-12].",
    ),
)


@dataclass(frozen=True)
class Rule:
    """An option needs one of some others, and excludes others. `why` is the reason that the message gives."""

    option: str
    why: str
    needs: tuple[str, ...] = ()
    excludes: tuple[str, ...] = ()

    def check(self) -> None:
        """Raise UsageError if the options of the running command break this rule."""
        typed = typed_options()
        if self.option not in typed:
            return
        if self.needs and not typed & set(self.needs):
            one_of = "one of " if len(self.needs) > 1 else ""
            raise click.UsageError(f"{self.option} needs {one_of}{', '.join(self.needs)}: {self.why}")
        refuse_beside(self.option, self.excludes, self.why)


def ruled(*rules: Rule) -> Decorator:
    """Return a decorator that checks these rules before the command runs."""

    def with_rules(function: Function) -> Function:
        @wraps(function)
        def checked(*arguments: Any, **typed: Any) -> Any:
            for rule in rules:
                rule.check()
            return function(*arguments, **typed)

        return checked

    return with_rules


def typed_options() -> set[str]:
    """Return the options that the user gave the running command, each by its long name."""
    context = click.get_current_context()
    return {parameter.opts[-1] for parameter in context.command.params if not left_at_default(str(parameter.name))}


def refuse_beside(option: str, others: Collection[str], why: str) -> None:
    """Raise UsageError if one of the others was typed together with that option in the running command."""
    for other in sorted(typed_options() & set(others)):
        raise click.UsageError(f"{other} does not go with {option}: {why}")


def left_at_default(parameter: str) -> bool:
    """Return whether the user has not given that parameter of the running command."""
    return click.get_current_context().get_parameter_source(parameter) != click.core.ParameterSource.COMMANDLINE


def refuse_feedback(stabilise: "Stabilise") -> None:
    """Raise UsageError if an option about feedback was typed, and there is to be no feedback."""
    if stabilise != "baumgarte":
        refuse_beside(f"--stabilise {stabilise}", OF_FEEDBACK, "it has no feedback")
