"""What check and poles say beside their answers: which point was judged, and what an engine did to its values."""

from collections.abc import Sequence

from bezstab.cli.asking import say_what_is_left_out
from bezstab.cli.output import say, show_text
from bezstab.feedback.conditions import Conditions
from bezstab.feedback.judgement import Judgement
from bezstab.words import point_words


def show_point(judged: Sequence[Judgement]) -> None:
    """Print which point was judged, above a table: the sentence of a single answer says it."""
    if len(judged) > 1:
        first = judged[0]
        show_text(f"{point_words(first.alpha_hat, first.beta_hat, first.h)}\n")


def say_what_the_engine_did(asked: Conditions) -> None:
    """Say on standard error what an engine did to its values, and what the conversion leaves out; else nothing."""
    if asked.engine is None or asked.made is None:
        return
    for note in asked.made.notes or ():
        say(f"{asked.engine.name}: {note} (--as-typed leaves that out)")
    say_what_is_left_out(asked.engine, many=asked.swept is not None)
