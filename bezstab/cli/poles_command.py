"""The command that prints poles at a point: poles."""

from dataclasses import replace
from typing import Any

from bezstab.cli.asking import asked_of_scene, show_below, show_point
from bezstab.cli.options import USUAL_METHODS, Rule, changed, command, flag
from bezstab.cli.output import show_rows
from bezstab.show.row_kinds import POLES
from bezstab.show.rows import pole_rows
from bezstab.show.sentences import one_pole_sentence


@command(
    changed("methods", default=USUAL_METHODS),
    "given_point",
    flag("--all-poles", "Print every pole, not only the dominant one."),
    "omega",
    changed("scene", help="Also say what the motion of this mechanism does to the poles; needs --h."),
    *("speed", "form"),
    Rule(("--h",), "α̂ and β̂ have no unit", ("--physical", "--engine", "--scene", "--omega")),
)
def poles(all_poles: bool, **typed: Any) -> None:
    """Print each method's dominant pole at one point, and the verdict.

    converges: every |z| < 1, so errors shrink. marginal: errors stay bounded but do not shrink. diverges: errors
    grow. The verdict is proven in exact arithmetic on the numbers as typed (Schur-Cohn test).

    On a moving mechanism the feedback also adds an error. "error" is that error as a share of the motion's amplitude.
    "error / least" compares it with the error at the point of `choose --goal accurate`.

    Example: bezstab poles --alpha 0.5 --beta 0.1
    """

    from bezstab.questions.answering import answers
    from bezstab.questions.question import Question
    from bezstab.stability.closed_loop import poles

    question = asked_of_scene(Question, **typed)
    at_point = [each for each in answers(question, margins=False) if each.goal == "as given"]
    rows = [
        row
        for each in at_point
        for row in pole_rows(each, poles(each.method, each.alpha_hat, each.beta_hat) if all_poles else [each.pole])
    ]
    kind = replace(POLES, sentence=one_pole_sentence) if all_poles else POLES
    without = ("total_error", "times_least") if all_poles else ()
    show_point(typed, question.given.point, () if all_poles else rows)
    show_rows(kind, rows, without)
    show_below(question, at_point, motion=not all_poles)
