"""The command that says what there is to know of methods: methods."""

from collections.abc import Sequence

import click

from bezstab.cli.options import METHOD, command, flag
from bezstab.cli.output import chosen_format, show_groups, show_rows, show_text
from bezstab.methods.registry import GROUPS, lookup
from bezstab.methods.schemes import Method
from bezstab.show.row_kinds import LISTED_METHODS, NAMED_METHODS
from bezstab.show.rows import method_row, whole_row


@command(flag("--latex", "Formulas as LaTeX."), "form")
@click.argument("methods", metavar="[NAME]...", type=METHOD, nargs=-1)
def methods(methods: Sequence[Method], latex: bool) -> None:
    """List the methods, or show all about those you name.

    Prints the number of steps, the evaluations of f in a step (of an implicit method in an iteration), the order of
    accuracy and the error constant. They are computed from the coefficients. In parentheses is the order if forces
    depend on positions alone.

    For a method that you name it also prints the recursion, s→z mapping, characteristic polynomial and stability region
    (the paper's Tables 1 and 2), the source, and the error that the method makes on a constraint that moves, as a share
    of that motion. The stage torque is D: each step multiplies the rate ω of a motion on a circle by 1 + D. Where D is
    positive, the motion speeds up.

    SIE is the paper's "Euler semi-implicit". It is not what engines call semi-implicit Euler: that is SYM.

    Example: bezstab methods B4
    """

    from bezstab.questions.regions import region_answer

    if methods:
        rows = [whole_row(region_answer(method), latex=latex) for method in methods]
        show_rows(NAMED_METHODS, rows, in_blocks=True)
        show_text("\nSteady errors are shares of a motion of ω rad/s, to leading order in θ = iωh.")
        return
    listed = [
        (group, [{**method_row(lookup(name)), "method": name, "group": group.heading} for name in group.methods])
        for group in GROUPS
    ]
    if chosen_format() == "text":
        show_groups(
            [("\n".join(filter(None, (group.heading, group.note))), rows) for group, rows in listed],
            LISTED_METHODS,
            ("source",),
        )
    else:
        show_rows(LISTED_METHODS, (row for _, rows in listed for row in rows))
