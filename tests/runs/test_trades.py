from fractions import Fraction
from functools import partial

from bezstab.methods.registry import lookup
from bezstab.runs.accuracy_costs import NO_FEEDBACK
from bezstab.runs.trades import _all_compiled, trade
from bezstab.stabilising import NOTHING, after_step

SYM, STEPS, POINT = [lookup("SYM")], (Fraction("0.02"), Fraction("0.01")), (Fraction(1), Fraction("0.5"))
small = partial(trade, "pendulum", SYM, STEPS, duration=Fraction("0.1"), numbers=POINT)


def test_against_projection_each_method_runs_with_feedback_and_with_projection() -> None:
    asked = small()
    assert [(sweep.point, sweep.after) for sweep in asked.sweeps] == [((1, 0.5), NOTHING)]
    assert asked.omega is None  # no point is advised
    assert [(each.point, each.after) for each in small(against="projection", omega=Fraction(1)).sweeps] == [
        (None, NOTHING),
        ((1, 0.5), NOTHING),
        (NO_FEEDBACK, after_step("projection")),
    ]


def test_all_runs_of_a_sweep_are_compiled_or_none() -> None:
    for names, steps, expected in (("AB2", 1e3, False), ("AB2 SYM", 1e8, True), ("AB2 bdf2", 1e8, False)):
        assert _all_compiled(list(map(lookup, names.split())), [(None, NOTHING)], steps) is expected
