"""The command that tells whether a choice is safe: check."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import groupby
from typing import TYPE_CHECKING, Any

from bezstab.cli.asking import asked_of_scene, show_below, show_point, show_sentences
from bezstab.cli.options import TypedPoint, changed, command, typed_options
from bezstab.cli.output import for_reading, say, show_rows, show_text
from bezstab.errors import InputError, NumericalError
from bezstab.methods.schemes import Method
from bezstab.show.result_sentences import costs_words, spare_words
from bezstab.show.row_kinds import CHECKED, LARGEST_STEPS
from bezstab.show.rows import answer_row, largest_step_row, left_out

if TYPE_CHECKING:
    from bezstab.questions.answering import Answer

OF_EVERY_STEP = {"--alpha", "--beta", "--physical", "--method", "--format", "--speed"}
"""With no other option, a question about α and β in 1/s is about every step."""


@command(
    "methods",
    "given_point",
    "omega",
    changed("scene", help="Is it safe for this mechanism as it moves? Needs --h."),
    "speed",
    changed("duration", help="With --scene: how long it is run, in s [10 s, or 10,000 steps if that is less]."),
    "form",
)
def check(**typed: Any) -> bool:
    """Tell whether a choice is safe: exit status 0 if so, 1 if not.

    Safe means that errors are proven to shrink, with every method named. Prints the verdict, the margins, the largest
    stable step, and what `choose` gives instead. With α and β in 1/s (--physical) but no --h, prints the step up to
    which every step is safe.

    All steps are equally long. A sequence of stable steps can still diverge: see `bezstab steps`.

    With --scene the mechanism is also run, for --time. It is safe if errors shrink as it moves and the run goes well:
    constraints hold, and the energy grows by at most a tenth of the largest kinetic energy. If no prediction is
    possible, the run decides, and a sentence says so.

    A stable setting can still be inaccurate: on a moving mechanism the feedback adds an error. A sentence says so if it
    is at least ten times the smallest possible one.

    --engine judges an engine's own values, with its own method unless you name another. What the engine does to its
    values, such as clamps, is applied first. What the conversion leaves out is printed. The largest step is for the
    engine's values as they are. What `choose` gives instead is a line to paste. Many engines solve their constraints
    one after another, in sweeps. The answer is then for a single constraint; a chain of bodies can still diverge
    (`bezstab chain`). With --scene, the constraints of that mechanism are checked in its initial position, in the
    order of the file.

    Example: bezstab check --method RK2 --h 0.002 --alpha 50 --beta 50 --physical
    """

    from bezstab.questions.answering import answers
    from bezstab.questions.motions import check_speed
    from bezstab.questions.question import Question

    if typed["point"].physical and typed_options().keys() <= OF_EVERY_STEP:
        check_speed(None, typed["speed"])
        return _check_without_step(typed["methods"], typed["point"])
    question = asked_of_scene(Question, **typed)
    found = list(_with_instead(answers(question)))
    given = [answer for answer in found if answer.role == "given"]
    show_point(typed, question.point, given)
    if for_reading():
        show_rows(CHECKED, map(answer_row, given), left_out(question))
        if len(given) > 1:  # a single one has said so
            show_sentences(
                f"{each.method.name}, {each.goal}: {each.energy_sentence}" for each in given if each.energy_sentence
            )
        show_sentences(map(costs_words, given))
        if instead := [answer for answer in found if answer.role == "instead"]:
            show_text("\nWhat `choose` gives instead:\n")
            show_rows(CHECKED, map(answer_row, instead), left_out(instead[0].question))
            show_sentences(map(spare_words, instead))
    else:
        show_rows(CHECKED, map(answer_row, found))
    show_below(question, found)
    return all(answer.safe for answer in given)


def _with_instead(given: Iterable[Answer]) -> Iterator[Answer]:
    """Yield the given answers, and for each method the choice instead; say on standard error why there is none."""
    for _, of_method in groupby(given, lambda answer: answer.method):
        answers_of_method = list(of_method)
        yield from answers_of_method
        try:
            yield answers_of_method[0].instead
        except (InputError, NumericalError) as error:  # the verdict stands without it
            say(f"bezstab: nothing instead: {error}")


def _check_without_step(methods: tuple[Method, ...], point: TypedPoint) -> bool:
    """Print the step up to which alpha and beta (1/s) are safe with each method; return whether each method has one."""

    from bezstab.questions.answering import LargestStep
    from bezstab.questions.question import methods_for

    assert point.numbers
    found = [LargestStep(method, *point.numbers) for method in methods_for(methods, None)]
    show_rows(LARGEST_STEPS, map(largest_step_row, found))
    return all(each.safe for each in found)
