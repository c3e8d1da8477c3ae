"""The command that says what there is to know of methods: methods."""

from collections.abc import Sequence

import click

from bezstab.cli.options import METHOD, command, flag
from bezstab.cli.output import chosen_format, show_blocks, show_groups, show_rows, show_text
from bezstab.methods import GROUPS, Method, lookup
from bezstab.show import (
    LISTED_METHODS,
    NAMED_METHODS,
    Field,
    Row,
    column,
    method_row,
    render,
    whole_row,
    with_unbounded,
)


@command(flag("--latex", "Formulas as LaTeX."), "form")
@click.argument("methods", metavar="[NAME]...", type=METHOD, nargs=-1)
def methods(methods: Sequence[Method], latex: bool) -> None:
    """List the methods, or show all about those you name.

    Prints the number of steps, the evaluations of f in a step (of an implicit method in an iteration), the order of
    accuracy and the error constant. They are computed from the coefficients. In parentheses is the order if forces
    depend on positions alone.

    For a method that you name it also prints the recursion, s→z mapping, characteristic polynomial and stability region
    (the paper's Tables 1 and 2), the source, and the error that the method makes on a constraint that moves, as a share
    of that motion.

    SIE is the paper's "Euler semi-implicit". It is not what engines call semi-implicit Euler: that is SYM.

    Example: bezstab methods B4
    """
    from bezstab.questions import region_answer

    form = chosen_format()
    if not methods:
        listed = [
            (group, [method_row(lookup(name), name, group.heading) for name in group.methods]) for group in GROUPS
        ]
        rows = [row for _, of_group in listed for row in of_group]
        if form == "text":
            show_groups(
                [("\n".join(filter(None, (group.heading, group.note))), of_group) for group, of_group in listed],
                LISTED_METHODS.columns(rows, ("source",)),
                LISTED_METHODS.sentence,
            )
        else:
            show_rows(LISTED_METHODS, rows)
        return
    rows = [whole_row(region_answer(method), latex=latex) for method in methods]
    if form in ("json", "csv"):
        show_rows(NAMED_METHODS, rows)
        return
    for number, row in enumerate(map(with_unbounded, rows)):
        columns = [property_column(key, row) for key in row]
        if form == "markdown":
            properties = [{"property": each.heading, "value": each.cell(row)} for each in columns]
            click.echo(render(properties, [column(key, key) for key in properties[0]], form))
            continue
        if number:
            click.echo()
        show_blocks([row], columns, NAMED_METHODS.sentence)
    if form == "text":
        show_text("\nSteady errors are shares of a motion of ω rad/s, to leading order in θ = iωh.")


def property_column(key: str, row: Row) -> Field:
    """Return the column of a key as a row is read from top to bottom: numbers to ten digits."""
    return column(key.replace("_", " "), key, ".10g" if isinstance(row[key], float) else "")
