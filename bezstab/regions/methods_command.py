"""The command that says what there is to know of methods: methods."""

from collections.abc import Sequence

import click

from bezstab.cli import shared_options as shared
from bezstab.cli.options import METHOD
from bezstab.cli.output import show_answers, show_groups, show_text
from bezstab.methods.registry import GROUPS, lookup
from bezstab.methods.schemes import Method


@click.command()
@click.argument("methods", metavar="[NAME]...", type=METHOD, nargs=-1)
@click.option("--latex", is_flag=True, help="Formulas as LaTeX.")
@shared.form
def methods(methods: Sequence[Method], latex: bool, **_: object) -> None:
    """List the methods, or show all about those you name.

    NAME@m takes steps of m h. Prints the number of steps, the evaluations of f in a step (of an implicit method in an
    iteration), the order of accuracy, the error constant, and the added damping: the damping ratio of an oscillator
    that has none itself, to leading order in θ = ωh; a negative one drives it. In parentheses is the order if forces
    depend on positions alone.

    For a method that you name it also prints the recursion, s→z mapping, characteristic polynomial and stability region
    (the paper's Tables 1 and 2), the source, and the error that the method makes on a constraint that moves, as a share
    of that motion. The stage torque is D: each step multiplies the rate ω of a motion on a circle by 1 + D. Where D
    is positive, the motion speeds up.

    SIE is the paper's "Euler semi-implicit". It is not what engines call semi-implicit Euler: that is SYM.

    Example: bezstab methods B4
    """
    from bezstab.regions.columns import LISTED, WHOLE
    from bezstab.regions.methods import method_answer, whole_method

    if methods:
        found = [whole_method(method, latex=latex) for method in methods]
        show_answers(WHOLE, found, in_blocks=True)
        show_text("\nSteady errors are shares of a motion of ω rad/s, to leading order in θ = iωh.")
        return
    groups = [
        (
            "\n".join(filter(None, (group.heading, group.note))),
            [method_answer(lookup(name), name) for name in group.methods],
        )
        for group in GROUPS
    ]
    show_groups(LISTED, groups)
