"""The command `bezstab paper`: write the tables and figures that are asked for."""

from operator import methodcaller
from pathlib import Path

import click

from bezstab.cli import shared_options as shared
from bezstab.cli.output import Files, write_file
from bezstab.files import output_directory

PARTS = [*(f"table{number}" for number in range(1, 7)), *(f"fig{number}" for number in range(1, 10))]


@click.command()
@click.option(
    "--only",
    type=click.Choice(PARTS),
    metavar="PART",
    multiple=True,
    help="One of table1 to table6 and fig1 to fig9; repeatable.",
)
@shared.compiled
@click.option("--figure", type=click.Choice(shared.FIGURES), default="png", help="Format of the figures.")
@shared.output
def paper(only: tuple[str, ...], figure: str, output: Path) -> None:
    """Make the paper's tables and figures anew.

    Writes Tables 1 to 6 as paper_table1.md and so on, Figures 1 to 9 as paper_fig1a.png and so on. What came of the
    paper's claims stands in figures/LEDGER.md.

    Example: bezstab paper --only table4
    """
    from bezstab.paper.figures import FIGURES
    from bezstab.paper.tables import TABLES

    wanted, files = only or PARTS, Files(output, figure)
    output_directory(files.output)
    for name, table in TABLES.items():
        if name in wanted:
            text = table().encode()
            write_file(files.output / f"paper_{name}.md", methodcaller("write", text))
    for name, draw in FIGURES.items():
        if name.rstrip("abc") in wanted:
            files.write(files.path("paper", name), draw)
