"""The run that shows errors grow where steps vary: as a line to type."""

import math
import shlex
from collections.abc import Sequence
from fractions import Fraction
from itertools import groupby

from bezstab.errors import InputError
from bezstab.methods import lookup
from bezstab.questions.answering import Answer
from bezstab.rationals import typed_number

AT_REST = "--scene driven_slider_crank --speed 1e-9"
"""A mechanism without degrees of freedom, all but at rest: what changes in it is the error alone, at any step."""

PERTURBED = 1e-6  # m, the error at first: small enough to grow visibly before it is no longer small
GROWN = 1e4  # times that
MOST_STEPS = 10**5  # of a run: some seconds


def growing_run(answer: Answer) -> str | None:
    """Return the line with which simulate shows an error of PERTURBED grow about GROWN times.

    None unless a sequence of steps was found that lets errors grow, and where no run shows it: of a method without a
    name to type, and where errors grow too slowly.
    """
    varying, steps = answer.varying, answer.question.steps
    if varying is None or steps is None or varying.sequence is None or not (varying.growth and varying.growth > 1):
        return None
    rounds = max(1, math.floor(math.log(GROWN) / math.log(varying.growth)))
    if not _can_be_typed(answer) or rounds * len(varying.sequence) > MOST_STEPS:
        return None
    alpha_hat, beta_hat = answer.point
    time = sum(varying.sequence) * answer.method.step_multiple * rounds
    return (
        f"bezstab simulate {AT_REST} --method {shlex.quote(answer.method.name)} --alpha {typed_number(alpha_hat)} "
        f"--beta {typed_number(beta_hat)} --h {typed_number(steps.h)} --steps {_typed_sequence(varying.sequence)}"
        f"{' --hold' if steps.hold else ''} --perturb {PERTURBED:g} --time {float(time):.6g}"
    )


def _can_be_typed(answer: Answer) -> bool:
    """Return whether the method has a name to type: not so a user's own, from a file."""
    try:
        return lookup(answer.method.name) == answer.method
    except InputError:
        return False


def _typed_sequence(sequence: Sequence[Fraction]) -> str:
    repeated = [(typed_number(step), len(list(same))) for step, same in groupby(sequence)]
    return ",".join(step if count == 1 else f"{count}*{step}" for step, count in repeated)
