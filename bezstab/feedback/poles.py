"""The poles that a feedback makes: the dominant one of each method at a point, or every one.

methods, Given, Conditions   →   poles_at   →   PoleAnswer, by method and pole
"""

from collections.abc import Sequence
from dataclasses import dataclass

from bezstab.feedback.conditions import AS_GIVEN, Conditions, Given
from bezstab.feedback.judgement import Judgement, judge
from bezstab.feedback.sentences import judgement_sentence
from bezstab.methods.schemes import Method
from bezstab.stability.choices import describe_point
from bezstab.stability.closed_loop import poles


@dataclass(frozen=True, repr=False)
class PoleAnswer:
    """A pole z of a method at a point, and what is known of that point."""

    judged: Judgement
    z: complex
    sentence: str

    def __repr__(self) -> str:
        return self.sentence


def poles_at(methods: Sequence[Method], given: Given, asked: Conditions, *, every: bool = False) -> list[PoleAnswer]:
    """Return the dominant pole of each method at the point that is given, or every one.

    Of a pair the upper one stands for both. Errors as `judge`.
    """
    found = []
    for method in methods:
        at_point = describe_point(method, AS_GIVEN, *given.made.point, asked.spread)
        judged = judge(asked, at_point, "given", given, margins=False, cost=False)
        if every:
            sentence = f"{method.name} {judged.verdict}. Each step multiplies this pole's part of the error by |z|."
            found += [
                PoleAnswer(judged, complex(z), sentence)
                for z in poles(method, judged.alpha_hat, judged.beta_hat)
                if z.imag >= 0
            ]
        else:
            found.append(PoleAnswer(judged, judged.pole, judgement_sentence(judged)))
    return found
