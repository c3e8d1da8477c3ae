"""The command that recommends α and β: choose."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

import click

from bezstab.cli.asking import asked_of_scene, show_below, show_sentences
from bezstab.cli.options import SECONDS, SHARE, changed, command, option
from bezstab.cli.output import for_reading, progress, show_rows
from bezstab.goals import GOALS, Goal
from bezstab.show.result_sentences import spare_words, trade_words
from bezstab.show.row_kinds import CHOICES, STEPS_OF_CHOICES
from bezstab.show.rows import answer_row, left_out

if TYPE_CHECKING:
    from bezstab.questions.answering import Answer


@command(
    "methods",
    changed("h", help="Step size in s. Not needed with --omega where α and β follow the motion, whatever the step."),
    option(
        "--goal",
        click.Choice(list(GOALS)),
        "; ".join(f"{goal}: {meaning}" for goal, meaning in GOALS.items())
        + " [accurate; robust with an --engine whose α and β depend on each other].",
    ),
    "omega",
    option("--h-max", SECONDS, "Largest step in s that can occur; for the goals accurate and robust [--h]."),
    option("--spread", SHARE, "The share by which α and β may be wrong.", default="0.1"),
    option(
        "--settle",
        SECONDS,
        "The time in s in which errors fall to a thousandth. For the goals gentle and accurate.",
    ),
    option("--keep equal", click.Choice(["alpha=beta"]), "Only points with α = β."),
    "engine",
    changed("scene", help="Choose for this mechanism as it moves."),
    "speed",
    changed("duration", help="With --scene: how long it is run, in s [10 s, or 10,000 steps if that is less]."),
    "form",
)
def choose(goal: Goal | None, equal: str | None, **typed: Any) -> bool:
    """Recommend α and β for an integrator and its step size.

    The answer is proven stable, and its margins are printed. With --scene the answer must also be safe as
    that mechanism moves: exit status 1 if it is not. `bezstab steps` finds feedback for steps that vary.

    On a moving mechanism the feedback adds an error. The default goal, accurate, minimises it among all points that
    settle within --settle, or while the motion turns by 14 rad. --omega or --scene say how fast the motion is. Most
    Runge-Kutta methods need that rate, because α and β are multiples of it; then --omega needs no --h, and the answer
    says up to which h they are stable. Other methods assume ωh = 0.01 without it. Their α is near that rate, and β as
    large as a margin of --spread allows. Errors of the start and of disturbances decay with α: for short runs and
    collisions, give a shorter --settle or --goal robust, which is the default with --engine. Two more lines say what
    faster or slower decay would change.

    "worst |z_p|" allows for α and β wrong by --spread. With the goal fastest it is much larger than |z_p|. Some methods
    are stable however strong the feedback is. For these only αh and βh up to 4 are searched, and "searched" says so.

    --engine searches only what that engine can express. Its own method is used unless you name another. Of several
    points that are equally good the one with the least α̂ and β̂ is taken.

    Many engines solve their constraints one after another, in sweeps. Their answer is limited to feedback that a chain
    of 10 equal bodies, or --scene, tolerates with --spread to spare. The line below shows the answer for a single
    constraint. Other chains: `bezstab chain`.

    Example: bezstab choose --method B4 --h 0.001
    """

    from bezstab.questions.answering import answers
    from bezstab.questions.question import Question, usual_goal

    goal = goal or usual_goal(typed["engine"], typed["methods"])
    question = asked_of_scene(Question, goal=goal, equal=equal is not None, **typed)
    if question.h is None:
        raise click.MissingParameter(param_hint="'--h'", param_type="option")
    chosen = list(progress(answers(question), goal, len(question.methods)))
    if typed["h"] is None:
        show_rows(STEPS_OF_CHOICES, map(STEPS_OF_CHOICES.row, chosen))
        return all(answer.safe for answer in chosen)
    show_rows(CHOICES, map(answer_row, chosen), left_out(question))
    if for_reading() and not question.swept:
        show_sentences(_trades(chosen))
    show_below(question, chosen)
    show_sentences(map(spare_words, chosen))
    return all(answer.safe for answer in chosen)


def _trades(chosen: Sequence[Answer]) -> Iterator[str]:
    """Yield for each choice how long disturbances are seen, what faster decay would cost, and slower gain."""
    for answer in chosen:
        name = f"{answer.method.name}: " if len(chosen) > 1 else ""
        yield "\n".join(f"{name}{line}" for line in trade_words(answer))
