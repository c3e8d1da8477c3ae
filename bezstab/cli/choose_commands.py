"""Commands that answer which parameters to take: choose, check, engines, explore."""

from collections.abc import Iterable, Iterator, Sequence
from fractions import Fraction
from itertools import groupby
from typing import TYPE_CHECKING, Any

import click

from bezstab.cli.asking import (
    TypedPoint,
    asked,
    chain_options,
    given_point_options,
    h_min_option,
    hold_option,
    moving_scene_options,
    omega_option,
    say_varying,
    show_below,
)
from bezstab.cli.held_drives import (
    HeldTiming,
    bandwidth_option,
    check_held,
    choose_held,
    inertia_option,
    timing_options,
)
from bezstab.cli.options import (
    ENGINE,
    NUMBER,
    SECONDS,
    SHARE,
    USUAL_METHODS,
    Rule,
    format_option,
    methods_option,
    ruled,
    step_option,
)
from bezstab.cli.output import for_reading, progress, say, show_rows, show_text
from bezstab.engines import ENGINES, RUN_UNDERNEATH, Drive, Engine
from bezstab.errors import InputError, NumericalError
from bezstab.goals import GOALS, Goal
from bezstab.methods import Method
from bezstab.show import (
    CHECKED,
    CHOICES,
    ENGINES_LISTED,
    LARGEST_STEPS,
    Format,
    alone_words,
    answer_row,
    costs_words,
    largest_step_row,
    trade_words,
)

if TYPE_CHECKING:
    from bezstab.questions import Answer, Question

WITHOUT_ACCURACY = ("total_error", "order_left", "times_least_velocity")
"""What tables of a drive leave out: nothing feeds its target's acceleration forward."""
OF_ONE_ALONE = (
    *("worst", "settle_steps", "settle_seconds", "h_limit"),
    *("alpha_factor_min", "alpha_factor_max", "beta_factor_min", "beta_factor_max"),
)
"""What tables of constraints that an engine sweeps over leave out: it is told of one of them alone."""


@click.command()
@methods_option()
@click.option("--h", type=SECONDS, required=True, help="Step size in s.")
@click.option(
    "--goal",
    type=click.Choice(list(GOALS)),
    help="; ".join(f"{goal}: {meaning}" for goal, meaning in GOALS.items())
    + " [accurate; robust with --pd, and with an --engine whose α and β depend on each other].",
)
@omega_option
@click.option(
    "--h-max",
    type=SECONDS,
    help="The largest step in s that may occur: for the goals accurate and robust, and with --h-min [--h].",
)
@h_min_option
@hold_option
@click.option("--spread", type=SHARE, default="0.1", help="α and β may be off by this share.")
@click.option(
    "--settle",
    type=SECONDS,
    help="The time in s in which errors fall a thousandfold: for the goals gentle and accurate, and with --pd.",
)
@click.option("--keep", "equal", type=click.Choice(["alpha=beta"]), help="Only points with α = β.")
@click.option(
    "--engine",
    metavar="NAME",
    type=ENGINE,
    help="Choose only what this engine can express, and print the line to paste.",
)
@chain_options
@inertia_option
@bandwidth_option
@timing_options
@moving_scene_options("Choose for this mechanism as it moves.")
@format_option
@ruled(Rule("--bandwidth", "it is that of a drive", needs=("--pd",)))
@click.pass_context
def choose(
    context: click.Context,
    /,
    methods: Sequence[Method],
    goal: Goal | None,
    settle: Fraction | None,
    equal: str | None,
    engine: Engine | None,
    drive: Drive | None,
    bandwidth: Fraction | None,
    timing: HeldTiming,
    form: Format,
    **typed: Any,
) -> None:
    """Recommend α and β for an integrator and its step size.

    The answer is proven stable, and its margins are printed. You may ask for more: that it is safe as a mechanism
    moves (--scene), for steps that vary (--h-min), or in a chain of bodies (--chain). Exit status 1 if that is not
    proven.

    On a mechanism that moves, feedback makes errors of its own. The default goal, accurate, makes them as small as it
    can. It allows only points that settle within --settle, or while the motion turns by 14 rad. --omega or --scene say
    how fast the motion is. Two lines below the answer say what faster decay would cost and what slower decay would
    gain.

    "within the spread" is the largest |z_p| if α and β are off by --spread. At the goal fastest |z_p| rises steeply as
    soon as α grows; the goal robust keeps away from such points. Some methods are stable however strong the feedback
    is. For these only αh and βh up to 4 are searched, and "searched" says so.

    --engine searches only what that engine can express. Its own method is used unless you name another. Of several
    points that are equally good the one with the least α̂ and β̂ is taken. --pd shows each way of applying a joint
    drive, with the kp and kd to set. With --bandwidth or --settle the gains are critically damped and leave a margin.
    They also allow for a controller that is slower than the physics (--every, --late, --filter).

    With --h-min, "varying steps" says whether errors decay for every sequence of steps up to --h-max. Many engines
    solve their constraints one after another, in sweeps. With --chain or --scene their answer is at most the strongest
    feedback that these constraints allow with --spread to spare, at --iterations sweeps. Below it is what one
    constraint alone would get, and how many sweeps that takes.

    Example: bezstab choose --method B4 --h 0.001
    """
    from bezstab.questions import answers, usual_goal

    gains_asked = bandwidth is not None or (drive is not None and settle is not None and goal is None)
    if held := timing.question(drive, typed["h"], methods, always=gains_asked):
        context.exit(0 if choose_held(held, bandwidth, settle, form) else 1)
    question = asked(
        methods=methods,
        goal=goal or usual_goal(engine, drive),
        settle=settle,
        equal=equal is not None,
        engine=(engine, None) if engine else None,
        drive=drive,
        **typed,
    )
    chosen = list(progress(answers(question), question.goal or "", len(question.methods)))
    show_rows(CHOICES, [answer_row(answer) for answer in chosen], form, _left_out(question))
    if for_reading(form):
        say_varying(chosen)
        for answer in chosen if not (drive or question.swept) else ():
            if lines := trade_words(answer):
                name = f"{answer.method.name}: " if len(chosen) > 1 else ""
                show_text("\n" + "\n".join(f"{name}{line}" for line in lines))
    show_below(question, chosen, form)
    for line in map(alone_words, chosen):
        if line and for_reading(form):
            show_text(f"\n{line}")
    context.exit(0 if all(answer.safe for answer in chosen) else 1)


@click.command()
@methods_option()
@given_point_options
@chain_options
@timing_options
@omega_option
@h_min_option
@click.option("--h-max", type=SECONDS, help="With --h-min: the longest step in s [--h].")
@hold_option
@moving_scene_options("Is it safe for this mechanism as it moves? Needs --h.")
@format_option
@click.pass_context
def check(
    context: click.Context,
    /,
    methods: Sequence[Method],
    point: TypedPoint,
    timing: HeldTiming,
    form: Format,
    **typed: Any,
) -> None:
    """Tell whether a choice is safe: exit status 0 if so, 1 if not.

    Safe means that errors are proven to shrink, with every method named. Prints the verdict, the margins, the largest
    stable step, and what `choose` gives instead. With α and β in 1/s (--physical) but no --h, prints the step up to
    which every step is safe.

    Without --h-min all steps are equally long. Steps that are each stable alone may still let errors grow when they
    alternate. With --h-min and --h-max, safe means proven for every sequence of steps in that range.

    What is safe may still be inaccurate. On a mechanism that moves, feedback makes errors of its own if it is strong,
    or if it is weak. A sentence says so if they are at least ten times the least.

    --engine judges an engine's own values, with its own method unless you name another. What the engine does to its
    values, such as clamps, is applied first. What the conversion leaves out is printed. The largest step is for the
    engine's values as they are. What `choose` gives instead is a line to paste. Many engines solve their constraints
    one after another, in sweeps. The answer is then about one constraint alone: a chain of them may diverge all the
    same. With --chain, safe means stable for so many bodies in a straight chain. Its last body is --mass-ratio times
    as heavy, and a step makes --iterations sweeps. With --scene, safe means so for the constraints of that mechanism at
    its start, in the order of its file.

    --pd kp,kd,inertia judges a joint's drive, applied in four ways: explicit (SYM), implicit in velocity (imex-euler,
    as MuJoCo's implicitfast), as stable PD (stable-pd), fully implicit (implicit-euler, as PhysX). All four must be
    safe unless --method names yours. Gains that are stable in an implicit engine may explode in an explicit one.
    "used up" names the gain that is at its limit, or nearest to it. "to" says how far each may go alone. An explicit
    drive needs 2 kd h + kp h² < 4 inertia: mostly it is kd that is too large. An implicit velocity takes any kd.

    --every, --late and --filter are for a controller that is slower than the physics. Its torque is held for several
    steps, comes late, or uses a filtered velocity. "used up" then names gains, rate or delay. A contact of stiffness k
    and damping c between bodies of reduced mass m is --pd k,c,m while it is closed.

    Example: bezstab check --method RK2 --h 0.002 --alpha 50 --beta 50 --physical
    """
    from bezstab.questions import answers, check_speed

    drive = typed["drive"]
    if held := timing.question(drive, typed["h"], methods):
        context.exit(0 if check_held(held, form) else 1)
    if point.physical and not any(typed[name] for name in NEEDING_A_STEP):
        check_speed(None, typed["speed"])
        context.exit(0 if _check_without_step(methods, point, form) else 1)
    question = asked(methods=methods, point=point, **typed)
    found = list(_with_instead(answers(question)))
    given = [answer for answer in found if answer.role == "given"]
    if for_reading(form):
        without = _left_out(question)
        show_rows(CHECKED, [answer_row(answer) for answer in given], form, without)
        say_varying(given)
        for sentence in map(costs_words, given if not drive else ()):
            if sentence:
                show_text(f"\n{sentence}")
        if instead := [answer_row(answer) for answer in found if answer.role == "instead"]:
            show_text("\nWhat `choose` gives instead:\n")
            show_rows(CHECKED, instead, form, without)
    else:
        show_rows(CHECKED, [answer_row(answer) for answer in found], form)
    show_below(question, found, form)
    context.exit(0 if all(answer.safe for answer in given) else 1)


NEEDING_A_STEP = ("h", "h_min", "scene", "engine", "drive", "as_typed", "hold", "omega")
"""Without any of these, α and β in 1/s are asked about for every step."""


def _left_out(question: "Question") -> tuple[str, ...]:
    """Return the keys that tables of a question leave out."""
    return (*(WITHOUT_ACCURACY if question.drive else ()), *(OF_ONE_ALONE if question.swept else ()))


def _with_instead(given: "Iterable[Answer]") -> "Iterator[Answer]":
    """Yield the answers that were given, and for each method what to take instead; where there is nothing, say why."""
    for _, of_method in groupby(given, lambda answer: answer.method):
        answers_of_method = list(of_method)
        yield from answers_of_method
        try:
            yield answers_of_method[0].instead
        except (InputError, NumericalError) as error:  # the verdict stands without it
            say(f"bezstab: nothing instead: {error}")


def _check_without_step(methods: Sequence[Method], point: TypedPoint, form: Format) -> bool:
    """Print up to which step alpha and beta (1/s) are safe with each method; return whether each has such a step."""
    from bezstab.questions import largest_step, methods_for

    if point.numbers is None:
        raise click.UsageError("a point is needed: --alpha with --beta, --engine, or --pd")
    found = [largest_step(method, *point.numbers) for method in methods_for(tuple(methods), None, None)]
    show_rows(LARGEST_STEPS, [largest_step_row(each) for each in found], form)
    return all(each.safe for each in found)


@click.command()
@step_option
@click.option("--alpha", type=NUMBER, help="α̂: with --beta, say what to set for this point.")
@click.option("--beta", type=NUMBER, help="β̂.")
@format_option
def engines(h: Fraction, alpha: Fraction | None, beta: Fraction | None, form: Format) -> None:
    """List what other engines call the feedback, and what to set.

    "level" is where an engine applies the feedback. acceleration: true Baumgarte feedback, and the integrator
    decides. velocity or position: the engine feeds the error back into velocities or positions; each such step is a
    step of the method named. "left out" is what the conversion does not cover. "rests on" says whether we ran the
    engine itself or rely on its source.

    Example: bezstab engines --alpha 1 --beta 0.2 --h 0.002
    """
    from bezstab.show import engine_row

    point = TypedPoint(alpha, beta, physical=False).numbers
    rows = [engine_row(engine, point, h) for engine in ENGINES.values()]
    show_rows(ENGINES_LISTED, rows, form)
    if for_reading(form):
        show_text("\nAnd others, by what they run underneath:\n")
        for name, underneath in RUN_UNDERNEATH.items():
            show_text(f"{name}: {underneath}")


@click.command()
@methods_option(*USUAL_METHODS)
@step_option
def explore(methods: Sequence[Method], h: Fraction) -> None:
    """Open a window: point at the region, see poles and decay.

    A click proves the verdict; n shows the next method; p prints the point as options for the other commands.

    Example: bezstab explore --method B4 --method AB4
    """
    from bezstab.show import open_explorer

    open_explorer(methods, float(h), click.echo)
