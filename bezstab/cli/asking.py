"""The options of a question, the question that was typed, and the sentences below its answers."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any, TypeVar

import click

from bezstab.cli.options import (
    ENGINE_VALUES,
    NUMBER,
    POSITIVE,
    SECONDS,
    SPEED,
    Decorator,
    ParsedType,
    Rule,
    gathered,
    left_at_default,
    physical_option,
    ruled,
    scene_option,
    together,
    typed_options,
)
from bezstab.cli.output import for_reading, progress, say, show_command, show_text
from bezstab.engines import Drive, Engine
from bezstab.errors import InputError
from bezstab.methods import Method
from bezstab.rationals import rational, typed_number
from bezstab.show import Format, motion_words
from bezstab.units import to_dimensionless

if TYPE_CHECKING:
    from bezstab.questions import Answer, Question

Asked = TypeVar("Asked")
GAINS = ("kp", "kd", "inertia")


def drive_of(text: str) -> Drive:
    """Return the drive of a text such as 100,2,0.01."""
    try:
        numbers = [rational(number) for number in text.split(",")]
    except InputError as error:
        raise InputError(f"{error}: expected {','.join(GAINS)}") from None
    if len(numbers) != len(GAINS):
        raise InputError(f"{len(numbers)} values, expected {','.join(GAINS)}")
    return Drive(*numbers)


def inertia_or_drive_of(text: str) -> Drive:
    """Return the drive of a text such as 100,2,0.01, or of an inertia alone: its gains are to be chosen."""
    return Drive(Fraction(0), Fraction(0), rational(text)) if "," not in text else drive_of(text)


DRIVE = ParsedType(",".join(GAINS), drive_of)


@dataclass(frozen=True)
class TypedPoint:
    """The options --alpha, --beta and --physical as typed: alpha_hat and beta_hat, or with `physical` both in 1/s."""

    alpha: Fraction | None
    beta: Fraction | None
    physical: bool

    @property
    def numbers(self) -> tuple[Fraction, Fraction] | None:
        """The two numbers, None without them; UsageError if one is missing."""
        if self.alpha is None and self.beta is None:
            return None
        if self.alpha is None or self.beta is None:
            raise click.UsageError("--alpha and --beta go together: they give one point")
        return self.alpha, self.beta

    def at(self, methods: Sequence[Method], h: Fraction | None, of_what: str = "") -> tuple[Fraction, Fraction] | None:
        """Return (alpha_hat, beta_hat) for a step of h (s), None if none was typed.

        If they look like numbers in 1/s, a note says so. UsageError if one of the two numbers is missing, and for
        numbers in 1/s without a step.
        """
        numbers = self.numbers
        if not self.physical:
            if numbers:
                say_if_units_were_mistaken(methods, *numbers, h, of_what)
            return numbers
        if numbers is None:
            raise click.UsageError("--physical needs --alpha and --beta: it says that they are in 1/s")
        if h is None:
            raise click.UsageError("--physical needs --h: α and β in 1/s need the step in s")
        return to_dimensionless(*numbers, h)


def point_options(alpha_help: str, beta_help: str, *default: str) -> Decorator:
    """Return the options --alpha, --beta and --physical, as the parameter `point`; without a default none is typed."""
    usual = dict(zip(("alpha", "beta"), default, strict=False))
    return gathered(
        TypedPoint,
        "point",
        click.option("--alpha", type=NUMBER, default=usual.get("alpha"), help=alpha_help),
        click.option("--beta", type=NUMBER, default=usual.get("beta"), help=beta_help),
        physical_option,
    )


given_point_options = together(
    point_options(
        "α̂ as a decimal or a fraction, read exactly. With --physical: α in 1/s.",
        "β̂ as a decimal or a fraction, read exactly. With --physical: β in 1/s.",
    ),
    click.option("--h", type=SECONDS, help="Step size in s, for --physical, --engine, --pd, --scene and --omega."),
    click.option(
        "--engine",
        type=ENGINE_VALUES,
        help="An engine's own values, such as mujoco=0.02,1, in place of --alpha and --beta; needs --h.",
    ),
    click.option(
        "--as-typed",
        is_flag=True,
        help="With --engine: take the values as typed, without what the engine does to them, such as clamps.",
    ),
    click.option(
        "--pd",
        "drive",
        type=DRIVE,
        help="A joint drive's gains and inertia (SI units), in place of --alpha and --beta; needs --h.",
    ),
    ruled(
        Rule("--engine", "it gives the point itself", excludes=("--alpha", "--beta", "--physical")),
        Rule("--pd", "it gives the point itself", excludes=("--alpha", "--beta", "--physical")),
    ),
)
"""How a point is given: in the plane, by an engine's own values, or by a drive's gains."""

chain_options = together(
    click.option("--chain", type=int, help="With --engine: ask about a straight chain of so many bodies."),
    click.option(
        "--mass-ratio", type=NUMBER, help="With --chain: the last body is so many times as heavy as each other one [1]."
    ),
    click.option(
        "--iterations",
        type=int,
        help="With --chain or --scene: the number of sweeps over all constraints in a step [the engine's own number].",
    ),
)
omega_option = click.option(
    "--omega",
    type=POSITIVE,
    help="The rate of the mechanism's motion in 1/s. The errors that the feedback makes depend on it. Needs --h [the "
    "rate of --scene, else ωh = 0.01].",
)
h_min_option = click.option(
    "--h-min",
    type=SECONDS,
    help="Steps vary from this one (s) up to --h-max: ask whether every sequence of them is safe.",
)
hold_option = click.option(
    "--hold",
    is_flag=True,
    help="With --h-min: α̂ and β̂ stay the same while steps vary, as in engines with an ERP. Without it α and β do.",
)


def moving_scene_options(help_text: str) -> Decorator:
    """Return the options --scene and --speed of a command that also works without a scene."""
    speed = click.option(
        "--speed",
        type=SPEED,
        default="1",
        help="With --scene: multiply the speed of its drivers and its initial velocities by this.",
    )
    return together(scene_option(None, help_text), speed)


def asked(kind: Callable[..., Asked], **typed: Any) -> Asked:
    """Return the question that was typed; `kind` is its class in `bezstab.questions`. Options have its fields' names.

    Without --method an engine or a drive has its own methods. If a point looks mistaken, a note says so. Errors as the
    class raises them.
    """
    from bezstab.questions import typed_chain

    if isinstance(typed.get("engine"), tuple):
        typed["engine"], typed["values"] = typed["engine"]
    if (typed.get("engine") or typed.get("drive")) and left_at_default("methods"):
        typed["methods"] = ()
    if "chain" in typed:
        typed["chain"] = typed_chain(typed["chain"], typed.pop("mass_ratio"))
    if "point" in typed:
        methods = typed["methods"] if "methods" in typed else [typed["method"]]
        if typed.get("sequence"):  # its point is where errors shall grow: the line that a refutation prints
            methods = []
        longest = typed["h"] or (typed.get("h_max") if typed.get("h_min") else None)
        typed["point"] = typed["point"].at(methods, longest)
    return kind(**typed)


def asked_of_feedback(**typed: Any) -> "Question":
    """Return the question about feedback that was typed, once it is known how its scene moves."""
    from bezstab.questions import Question

    question = asked(Question, **typed)
    find_turning(typed["scene"], question.speed, question.h)
    _ = question.motion
    say_if_it_turns_too_far(typed["scene"], question.speed, question.h)
    return question


def find_turning(scene: str | None, speed: Fraction, h: Fraction | None) -> None:
    """Find how the constraints of a scene turn at a step of h (s), with a bar on a terminal; errors as `turning_of`."""
    from bezstab.questions import turning_of, turning_stages

    if scene and h is not None:
        name, stages = turning_stages(scene, speed)
        for stage in progress(stages, name):
            stage()
    turning_of(scene, speed, h)


def say_if_it_turns_too_far(scene: str | None, speed: Fraction, h: Fraction | None) -> None:
    """Warn on standard error if a scene's constraints turn too far in a step (s) for the first-order law."""
    from bezstab.questions import turns_too_far

    if warning := turns_too_far(scene, speed, h):
        say(f"bezstab: {warning}")


def show_below(question: "Question", found: "Sequence[Answer]", form: Format, *, motion: bool = True) -> None:
    """Print below the answers on which motion errors are told; say on standard error why they are not known.

    For people to read, it is also said what an engine did to its values, and what the conversion leaves out.
    """
    for reason in dict.fromkeys(answer.cost_reason for answer in found):
        if reason:
            say(f"bezstab: {reason}")
    if not for_reading(form):
        return
    if motion and not question.drive:
        show_text(f"\n{motion_words(question.motion)}")
    if question.engine:
        for note in () if question.goal else question.given.notes or ():
            say(f"{question.engine.name}: {note} (--as-typed leaves that out)")
        say_what_is_left_out(question.engine, many=question.swept is not None)


def say_what_is_left_out(engine: Engine, *, many: bool = False) -> None:
    """Say on standard error what the conversion of an engine's values leaves out, for one constraint or for many."""
    swept = "; it solves each constraint by itself, in sweeps: chains of them may diverge all the same"
    ask = ": ask with --chain" if engine.sweeping else ""
    say(f"{engine.name}: left out: {engine.excludes}{swept + ask if engine.sweeps and not many else ''}")
    if many and engine.sweeping:
        say(f"{engine.name}: sweeps are its {engine.sweeping.word}; of them left out: {engine.sweeping.excludes}")


WITHOUT_ACCURACY = ("total_error", "order_left", "times_least_velocity")
"""Columns that tables of a drive omit: nothing feeds the acceleration of its target forward."""

OF_ONE_ALONE = (
    *("worst", "settle_steps", "settle_seconds", "h_limit"),
    *("alpha_factor_min", "alpha_factor_max", "beta_factor_min", "beta_factor_max"),
)
"""Columns that tables omit for constraints that an engine sweeps over: they are about one constraint alone."""


def left_out(question: "Question") -> tuple[str, ...]:
    """Return the keys that tables of a question leave out."""
    return (*(WITHOUT_ACCURACY if question.drive else ()), *(OF_ONE_ALONE if question.swept else ()))


def say_varying(answers: "Iterable[Answer]") -> None:
    """Print a sentence about steps that vary, and the command of a run in which errors grow."""
    from bezstab.show import growing_run, varying_words

    for answer in answers:
        if answer.varying:
            show_text("\n" + varying_words(answer.method.name, answer.varying))
            if line := growing_run(answer):
                show_text("\nThis shows errors grow:\n")
                show_command(line)


LARGE = 10
"""From this alpha_hat or beta_hat on, 1/s was probably meant: as alpha_hat it leaves e^-5 of an error after a step."""


def say_if_units_were_mistaken(
    methods: Sequence[Method], alpha: Fraction, beta: Fraction, h: Fraction | None, of_what: str = ""
) -> None:
    """Say on standard error if alpha_hat and beta_hat as typed look like alpha and beta in 1/s.

    They do if no method is stable there, and all methods are stable at alpha and beta in 1/s for the step h (s): the
    note then gives the line to type. They also do if no method is stable and one of the numbers is LARGE. `of_what` are
    the arguments of the command, if it has any.
    """
    from bezstab.stability import verdict

    if not methods or max(alpha, beta) < 1:
        return
    if any(verdict(method, alpha, beta) == "converges" for method in methods):
        return
    taken = "note: --alpha and --beta were taken as α̂ and β̂, without unit; if they are in 1/s, add --physical"
    if h is not None and _all_stable(methods, alpha, beta, h):
        command = f"bezstab {click.get_current_context().info_name}{of_what and ' '}{of_what}"
        given = "".join(f" --method {method.name}" for method in methods if "--method" in typed_options())
        numbers = f"--alpha {typed_number(alpha)} --beta {typed_number(beta)} --h {typed_number(h)}"
        say(f"{taken}: {command}{given} {numbers} --physical")
    elif max(alpha, beta) > LARGE:
        say(f"{taken}{' and your --h' if left_at_default('h') else ''}")


def _all_stable(methods: Sequence[Method], alpha: Fraction, beta: Fraction, h: Fraction) -> bool:
    """Return whether alpha and beta in 1/s are stable with every method at a step of h (s)."""
    from bezstab.stability import verdict

    try:
        point = to_dimensionless(alpha, beta, h)
    except InputError:  # out of range: not meant
        return False
    return all(verdict(method, *point) == "converges" for method in methods)
