"""Commands that answer which parameters to take: choose, check, engines, explore."""

from collections.abc import Iterable, Iterator, Sequence
from fractions import Fraction
from itertools import groupby
from typing import TYPE_CHECKING

import click

from bezstab.cli.asking import (
    as_typed_option,
    asked,
    chain_option,
    drive_option,
    engine_values_option,
    h_min_option,
    hold_option,
    iterations_option,
    mass_ratio_option,
    methods_typed,
    moving_scene_option,
    moving_speed_option,
    omega_option,
    prepare,
    say_unknown_costs,
    say_varying,
    say_what_is_left_out,
    say_what_was_made,
)
from bezstab.cli.held_drives import (
    bandwidth_option,
    check_held,
    choose_held,
    inertia_option,
    timing_options,
    timing_typed,
)
from bezstab.cli.options import (
    ENGINE,
    NUMBER,
    SECONDS,
    USUAL_METHODS,
    EngineValues,
    both_or_none,
    format_option,
    methods_option,
    physical_option,
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
    Row,
    alone_words,
    answer_row,
    answer_sentence,
    costs_words,
    largest_step_row,
    motion_words,
    safe_step_text,
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
    + " [accurate; robust with --pd and for an --engine that can express a curve alone].",
)
@omega_option
@click.option(
    "--h-max", type=SECONDS, help="accurate, robust, or with --h-min: the largest step in s that may occur [--h]."
)
@h_min_option
@hold_option
@click.option("--spread", type=NUMBER, default="0.1", help="By what share α and β may be off.")
@click.option(
    "--settle", type=SECONDS, help="gentle, accurate, or with --pd: the time in s in which c falls a thousandfold."
)
@click.option("--keep", type=click.Choice(["alpha=beta"]), help="Only points with α = β.")
@click.option("--engine", metavar="NAME", type=ENGINE, help="Choose what that engine can express; print what to paste.")
@chain_option
@mass_ratio_option
@iterations_option
@inertia_option
@bandwidth_option
@timing_options
@moving_scene_option("Choose for this mechanism as it moves.")
@moving_speed_option
@format_option
def choose(
    methods: Sequence[Method],
    h: Fraction,
    goal: Goal | None,
    omega: Fraction | None,
    h_max: Fraction | None,
    h_min: Fraction | None,
    hold: bool,
    spread: Fraction,
    settle: Fraction | None,
    keep: str | None,
    engine: Engine | None,
    chain: int | None,
    mass_ratio: Fraction | None,
    iterations: int | None,
    drive: Drive | None,
    bandwidth: Fraction | None,
    every: int | None,
    late: Fraction | None,
    filter_seconds: Fraction | None,
    scene: str | None,
    speed: Fraction,
    form: Format,
) -> None:
    """Recommend α and β for an integrator and its step size.

    The answer is proven stable, and its margins are printed. Exit status 1 if it is not proven safe: over the
    motion of a --scene, for steps that vary, or in a chain, where you ask for that.

    On a mechanism that moves, feedback makes errors of its own. The default goal, accurate, has the least of them
    among what settles within --settle, or while the motion turns by 14 rad. --omega or --scene say how fast the
    motion is. Below the answer, two lines say what faster decay would cost and what slower decay would gain.
    "within the spread" is the largest |z_p| with α and β off by --spread. At the fastest point |z_p| rises like a
    square root as soon as damping grows; robust keeps away from it. Where arbitrarily strong feedback is stable,
    only αh and βh up to 4 are searched, and "searched" says so.

    --engine searches only what that engine can express, with its own method unless you name another. Where several
    points are best, the mildest is taken. --pd shows each way of applying a joint drive, with the kp and kd to set.
    With --bandwidth or --settle, or a controller that is slower than the physics (--every, --late, --filter), these
    are critically damped gains for the explicit way, with a margin.

    --h-min lets steps vary: "varying steps" says whether errors decay for every sequence of steps up to --h-max.
    Many engines solve their constraints one after another, in sweeps. With --chain, a straight chain of bodies, or with
    --scene the answer is at most the strongest feedback that these constraints allow with --spread to spare, at
    --iterations sweeps. Below it is what one constraint alone would get, and how many sweeps that takes.

    Example: bezstab choose --method B4 --h 0.001
    """
    from bezstab.questions import Question, answers, typed_chain, usual_goal
    from bezstab.stability import Timing

    timing = timing_typed(every, late, filter_seconds, drive, h)
    if bandwidth is not None and drive is None:
        raise InputError("--bandwidth is that of a drive: it needs --pd")
    if drive and (timing or bandwidth is not None or (settle is not None and goal is None)):
        chosen_methods = methods_typed(methods, has_usual_ones=True)
        safe = choose_held(drive.inertia, h, timing or Timing(), chosen_methods, bandwidth, settle, form)
        click.get_current_context().exit(0 if safe else 1)
    question = Question(
        methods=methods_typed(methods, engine is not None or drive is not None),
        goal=goal or usual_goal(engine, drive),
        h=h,
        h_min=h_min,
        h_max=h_max,
        hold=hold,
        engine=engine,
        drive=drive,
        omega=omega,
        scene=scene,
        speed=speed,
        spread=float(spread),
        settle=settle,
        equal=keep is not None,
        chain=typed_chain(chain, mass_ratio),
        iterations=iterations,
    )
    prepare(question)
    chosen = list(progress(answers(question), question.goal or "", len(question.methods)))
    rows = [answer_row(answer) for answer in chosen]
    columns = CHOICES.columns(rows, _left_out(question))
    show_rows(rows, columns, form, sentence=answer_sentence)
    say_unknown_costs(chosen)
    if for_reading(form):
        say_varying(chosen)
        for answer in chosen if not (drive or question.swept) else ():
            if lines := trade_words(answer):
                name = f"{answer.method.name}: " if len(chosen) > 1 else ""
                show_text("\n" + "\n".join(f"{name}{line}" for line in lines))
        if not drive:
            show_text(f"\n{motion_words(question.motion)}")
        for line in map(alone_words, chosen):
            if line:
                show_text(f"\n{line}")
        if engine:
            say_what_is_left_out(engine, many=question.swept is not None)
    if not all(answer.safe for answer in chosen):
        click.get_current_context().exit(1)


@click.command()
@methods_option()
@click.option("--alpha", type=NUMBER, help="α̂; α in 1/s with --physical.")
@click.option("--beta", type=NUMBER, help="β̂; β in 1/s with --physical.")
@click.option("--h", type=SECONDS, help="Step size in s; needed with --engine and --pd.")
@physical_option
@engine_values_option
@as_typed_option
@chain_option
@mass_ratio_option
@iterations_option
@drive_option
@timing_options
@omega_option
@h_min_option
@click.option("--h-max", type=SECONDS, help="With --h-min: the longest step in s [--h].")
@hold_option
@moving_scene_option("Safe for this mechanism as it moves? Needs --h.")
@moving_speed_option
@format_option
@click.pass_context
def check(
    context: click.Context,
    methods: Sequence[Method],
    alpha: Fraction | None,
    beta: Fraction | None,
    h: Fraction | None,
    physical: bool,
    engine: EngineValues | None,
    as_typed: bool,
    chain: int | None,
    mass_ratio: Fraction | None,
    iterations: int | None,
    drive: Drive | None,
    every: int | None,
    late: Fraction | None,
    filter_seconds: Fraction | None,
    omega: Fraction | None,
    h_min: Fraction | None,
    h_max: Fraction | None,
    hold: bool,
    scene: str | None,
    speed: Fraction,
    form: Format,
) -> None:
    """Tell whether a choice is safe: exit status 0 if so, 1 if not.

    Safe means proven stable, for every method named. Prints the verdict, the margins, the largest stable step, and
    what `choose` gives instead. α and β in 1/s (--physical) without --h: prints the step up to which every step is
    safe.

    That is about constant steps. Steps that are each stable alone may still let errors grow when they alternate.
    With --h-min and --h-max, safe means proven for every sequence of steps in that range.

    What is safe may still be inaccurate. On a mechanism that moves, feedback makes errors of its own if it is
    strong, or if it is weak. A sentence says so where they are ten times the least or more.

    --engine judges an engine's own values, with its own method unless you name another. What the engine does to its
    values (clamps, scaling) is applied first, and what the conversion does not cover is printed. The largest step
    is that of the engine's values. What to take instead is what the engine can express, as a line to paste. Many
    engines solve their constraints one after another, in sweeps. Their answer is about one constraint alone: chains
    of them may diverge all the same. With --chain, safe means stable for so many bodies in a straight chain, the
    last one --mass-ratio times as heavy, with --iterations sweeps. With --scene, it means so for the constraints of
    that mechanism at its start, in the order of its file.

    --pd kp,kd,inertia judges a joint's drive, applied in four ways: explicit (SYM), implicit in velocity
    (imex-euler, as MuJoCo's implicitfast), as stable PD (stable-pd), fully implicit (implicit-euler, as PhysX). All
    four count unless --method names yours. Gains that were stable in an implicit engine explode in an explicit one:
    is it kp or kd? "used up" names the one at its limit, or nearest to it, and "to" says how far each may go alone.
    Explicit needs 2 kd h + kp h² < 4 inertia. Mostly it is kd, which has no limit where the velocity is implicit.

    --every, --late and --filter are for a controller that is slower than the physics: its torque is held for
    several steps, comes late, or uses a filtered velocity. "used up" then names gains, rate or delay, and "to" says
    how far each may go alone. A contact of stiffness k and damping c between bodies of reduced mass m is --pd k,c,m
    while it is closed.

    Example: bezstab check --method RK2 --h 0.002 --alpha 50 --beta 50 --physical
    """
    from bezstab.questions import answers, turning_of

    timing = timing_typed(every, late, filter_seconds, drive, h)
    if timing and drive and h:
        context.exit(0 if check_held(drive, h, timing, methods_typed(methods, has_usual_ones=True), form) else 1)
    if physical and not (h or h_min or scene or engine or drive or as_typed or hold or omega):
        turning_of(None, speed, None)  # no speed without a scene
        context.exit(0 if _check_without_step(methods, both_or_none(alpha, beta), form) else 1)
    question = asked(
        methods,
        alpha,
        beta,
        h,
        physical,
        engine,
        drive,
        as_typed=as_typed,
        omega=omega,
        scene=scene,
        speed=speed,
        h_min=h_min,
        h_max=h_max,
        hold=hold,
        chain=chain,
        mass_ratio=mass_ratio,
        iterations=iterations,
    )
    found = list(_with_instead(answers(question)))
    given = [answer for answer in found if answer.role == "given"]
    rows = [answer_row(answer) for answer in found]
    given_rows, instead_rows = ([row for row in rows if row["role"] == role] for role in ("given", "instead"))
    without = _left_out(question)
    if for_reading(form):
        show_rows(given_rows, CHECKED.columns(given_rows, without), form, sentence=answer_sentence)
        say_varying(given)
        for sentence in map(costs_words, given if not drive else ()):
            if sentence:
                show_text(f"\n{sentence}")
        if instead_rows:
            show_text("\nWhat `choose` gives instead:\n")
            show_rows(instead_rows, CHECKED.columns(instead_rows, without), form, sentence=answer_sentence)
        if not drive:
            show_text(f"\n{motion_words(question.motion)}")
    else:
        show_rows(rows, [], form)
    say_unknown_costs(found)
    say_what_was_made(question, form)
    context.exit(0 if all(answer.safe for answer in given) else 1)


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


def _check_without_step(methods: Sequence[Method], point: tuple[Fraction, Fraction] | None, form: Format) -> bool:
    """Print up to which step alpha and beta (1/s) are safe with each method; return whether each has such a step."""
    from bezstab.questions import largest_step, methods_for

    if point is None:
        raise click.UsageError("--alpha and --beta are needed, or --engine, or --pd")
    found = [largest_step(method, *point) for method in methods_for(tuple(methods), None, None)]
    rows = [largest_step_row(each) for each in found]
    show_rows(rows, LARGEST_STEPS.columns(rows), form, sentence=step_sentence)
    return all(each.safe for each in found)


def step_sentence(row: Row) -> str:
    """Return up to which step alpha and beta are safe."""
    limit = safe_step_text(row)
    if limit == "none":
        return "Not safe at small steps."
    return "Safe at any h." if limit == "unlimited" else f"Safe up to h = {limit} s."


def engine_sentence(row: Row) -> str:
    """Return what to write for the point, or what the engine calls the feedback where none is given."""
    if row["setting"] is None:
        return f"In {row['engine']} the feedback is set by {row['parameters']}."
    return f"At this point: {row['setting']}."


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

    point = both_or_none(alpha, beta)
    rows = [engine_row(engine, point, h) for engine in ENGINES.values()]
    show_rows(rows, ENGINES_LISTED.columns(rows), form, sentence=engine_sentence)
    if for_reading(form):
        show_text("\nAnd others, by what they run underneath:\n")
        for name, underneath in RUN_UNDERNEATH.items():
            show_text(f"{name}: {underneath}")


@click.command()
@methods_option(*USUAL_METHODS)
@step_option
def explore(methods: Sequence[Method], h: Fraction) -> None:
    """Open a window: move over the region, see poles and decay.

    A click proves the verdict; n shows the next method; p prints the point as options for the other commands.

    Example: bezstab explore --method B4 --method AB4
    """
    from bezstab.show import open_explorer

    open_explorer(methods, float(h), click.echo)
