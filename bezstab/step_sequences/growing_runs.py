"""The run that shows errors grow where steps vary: as a line to type."""

import math
import shlex
from collections.abc import Sequence
from fractions import Fraction
from itertools import groupby

from bezstab.engines.conversions import Point
from bezstab.errors import InputError
from bezstab.methods.registry import lookup
from bezstab.methods.schemes import Method
from bezstab.rationals import typed_number
from bezstab.step_sequences.varying_steps import Steps, VaryingSteps

AT_REST = "--scene driven_slider_crank --speed 1e-9"
"""A mechanism without degrees of freedom, all but at rest: what changes in it is the error alone, at any step."""

PERTURBED = 1e-6  # m, the error at first: small enough to grow visibly before it is no longer small
GROWN = 1e4  # times that
MOST_STEPS = 10**5  # of a run: some seconds


def growing_run(method: Method, point: Point, steps: Steps, found: VaryingSteps) -> str | None:
    """Return the line with which simulate shows an error of PERTURBED grow about GROWN times.

    The point is that of the longest step. None unless a sequence of steps was found that lets errors grow, and where no
    run shows it: of a method without a name to type, and where errors grow too slowly.
    """
    if found.sequence is None or not (found.growth and found.growth > 1):
        return None
    rounds = max(1, math.floor(math.log(GROWN) / math.log(found.growth)))
    if not _can_be_typed(method) or rounds * len(found.sequence) > MOST_STEPS:
        return None
    alpha_hat, beta_hat = point
    time = sum(found.sequence) * method.step_multiple * rounds
    return (
        f"bezstab simulate {AT_REST} --method {shlex.quote(method.name)} --alpha {typed_number(alpha_hat)} "
        f"--beta {typed_number(beta_hat)} --h {typed_number(steps.h_max)} --steps {_typed_sequence(found.sequence)}"
        f"{' --hold' if steps.hold else ''} --perturb {PERTURBED:g} --time {float(time):.6g}"
    )


def _can_be_typed(method: Method) -> bool:
    """Return whether the method has a name to type: not so a user's own, from a file."""
    try:
        return lookup(method.name) == method
    except InputError:
        return False


def _typed_sequence(sequence: Sequence[Fraction]) -> str:
    repeated = [(typed_number(step), len(list(same))) for step, same in groupby(sequence)]
    return ",".join(step if count == 1 else f"{count}*{step}" for step, count in repeated)
