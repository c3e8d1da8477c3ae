"""What is printed of steps that vary: its columns."""

from collections.abc import Sequence

from bezstab.show.columns import METHOD, SENTENCE, Column
from bezstab.step_sequences.answer import StepsAnswer
from bezstab.units import alpha_and_beta


def _rates(answer: StepsAnswer) -> tuple[float | None, float | None]:
    """Return alpha and beta (1/s), which are None where alpha_hat and beta_hat stay instead."""
    return (None, None) if answer.steps.hold else alpha_and_beta(answer.alpha_hat, answer.beta_hat, answer.steps.h_max)


COLUMNS: Sequence[Column[StepsAnswer]] = (
    METHOD,
    Column("verdict", "verdict", lambda answer: answer.verdict, "proven, refuted or not known", brief=True),
    Column("safe", "safe", lambda answer: answer.safe, "whether errors are proven to decay in every sequence of steps"),
    Column(
        "α (1/s)",
        "alpha",
        lambda answer: _rates(answer)[0],
        "damping, the same at every step; null if α̂ and β̂ are",
        "1/s",
        ".6g",
        apart=True,
    ),
    Column(
        "β (1/s)",
        "beta",
        lambda answer: _rates(answer)[1],
        "stiffness as a rate, the same at every step; null if α̂ and β̂ are",
        "1/s",
        ".6g",
        apart=True,
    ),
    Column("α̂", "alpha_hat", lambda answer: float(answer.alpha_hat), "2αh at the longest step", form=".6g"),
    Column("β̂", "beta_hat", lambda answer: float(answer.beta_hat), "β²h² at the longest step", form=".6g"),
    Column(
        "goal",
        "goal",
        lambda answer: answer.goal,
        "goal of `choose` that gave them, or as given, or which of the points that an engine makes of its values",
        apart=True,
    ),
    Column("proof", "", lambda answer: answer.found.kind, ""),
    Column(
        "form",
        "certificate",
        lambda answer: [list(map(str, row)) for row in answer.found.certificate] if answer.found.certificate else None,
        "rows of the quadratic form, as rational numbers",
    ),
    Column(
        "sequence",
        "sequence",
        lambda answer: list(map(float, answer.found.sequence)) if answer.found.sequence else None,
        "steps that do not let errors decay when they are repeated; null unless refuted",
        "s",
    ),
    Column(
        "growth each round",
        "growth",
        lambda answer: answer.found.growth,
        "errors are multiplied by it with each round of that sequence",
        form=".3g",
        brief=True,
    ),
    Column("", "shown_by", lambda answer: answer.shown_by, "line of `simulate` that shows errors grow; null if none"),
    SENTENCE,
)
