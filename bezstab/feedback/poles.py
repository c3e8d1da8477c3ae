"""The poles that a feedback makes: the dominant one of each method at a point, or every one.

methods, Given, Conditions   →   poles_at   →   CheckAnswer, by method and pole
"""

from collections.abc import Sequence
from dataclasses import replace

from bezstab.feedback.checking import CheckAnswer, checks
from bezstab.feedback.conditions import Conditions, Given
from bezstab.methods.schemes import Method
from bezstab.stability.closed_loop import poles


def poles_at(methods: Sequence[Method], given: Given, asked: Conditions, *, every: bool = False) -> list[CheckAnswer]:
    """Return the point that is given, judged, with the dominant pole of each method, or with each of them in turn.

    Of a pair the upper one stands for both. Errors as `judge`.
    """
    alone = replace(given, made=replace(given.made, also=()))
    dominant = checks(methods, alone, asked, margins=False, cost=False)
    if not every:
        return dominant
    part = "Each step multiplies this pole's part of the error by |z|."
    return [
        replace(each, pole=complex(z), sentence=f"{each.method.name} {each.verdict}. {part}")
        for each in dominant
        for z in poles(each.method, each.alpha_hat, each.beta_hat)
        if z.imag >= 0
    ]
