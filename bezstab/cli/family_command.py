"""The command that shows how methods change with their number of steps: family."""

from typing import TYPE_CHECKING

import click

from bezstab import show
from bezstab.cli.options import command, option
from bezstab.cli.output import Files, show_rows
from bezstab.errors import InputError
from bezstab.methods import STEP_FAMILIES

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@command(
    option("--from first", click.IntRange(min=1), "Smallest n.", default=2),
    option("--to last", click.IntRange(min=1), "Largest n [12 for bezier, 8 for adams-bashforth]."),
    "picture",
    "form",
)
@click.argument("name", metavar="|".join(STEP_FAMILIES), type=click.Choice(list(STEP_FAMILIES)))
def family(name: str, first: int, last: int | None, files: Files) -> None:
    """Show how a family of methods changes with its number of steps n.

    Prints the area of each region, the least |z_p| and the error constant. The Bézier methods tend to a limit, which
    has a region of its own. The regions of the Adams-Bashforth methods shrink to nothing, but each step more gains an
    order. The figure shows both.

    Example: bezstab family bezier --from 2 --to 5
    """
    from bezstab import stability

    largest = STEP_FAMILIES[name].largest
    last = largest if last is None else last
    if not first <= last <= largest:
        raise InputError(f"--from {first} --to {last}: expected 1 <= from <= to <= {largest} for {name}")
    files.check_output()
    members = stability.family_members(name, first, last)
    limit = stability.bezier_limit() if name == "bezier" else None
    rows: list[show.Row] = [show.MEMBERS.row(member) for member in members]
    if limit:  # which has no number of steps
        rows.append(show.MEMBERS.row(limit, steps=None, method="B∞", order=2))
    show_rows(show.MEMBERS, rows)

    def draw() -> "Figure":
        families = {each: stability.family_members(each, 2, family.largest) for each, family in STEP_FAMILIES.items()}
        return show.family_figure(families | {name: members}, name, limit)

    files.write(files.path("family", name), draw)
