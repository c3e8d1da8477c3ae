"""The command `bezstab paper`: make what is asked for, write tables, figures and the ledger, show what came out."""

from pathlib import Path
from typing import TYPE_CHECKING

import click

from bezstab.cli.options import command, option
from bezstab.cli.output import Files, progress, show_rows, write_file
from bezstab.files import output_directory
from bezstab.paper.printed import PARTS
from bezstab.show import CLAIMS

if TYPE_CHECKING:  # so that `bezstab --help`, which lists this command, loads nothing that computes or draws
    from bezstab.paper.reports import Finding, Report


EVERY_PART = [part for parts in PARTS for part in parts]


@command(
    option(
        "--only",
        click.Choice(EVERY_PART),
        "One of table1 to table6 and fig1 to fig9. Repeatable.",
        metavar="PART",
        multiple=True,
    ),
    *("compiled", "picture", "form"),
)
def paper(only: tuple[str, ...], files: Files) -> None:
    """Regenerate the paper's tables and figures, and test its claims.

    Writes Tables 1 to 6 as paper_table1.md and so on, Figures 1 to 9 as paper_fig1a.png and so on, and, unless --only
    asks for parts, LEDGER.md with what came of every claim, and prints what agrees with the paper and what does not.

    Example: bezstab paper --only table4
    """
    from bezstab.paper.ledger import SUBJECTS, ledger_text

    wanted = set(only or EVERY_PART)
    output_directory(files.output)
    findings: list[Finding] = []
    for parts, made_by in SUBJECTS.items():
        if wanted.isdisjoint(parts):
            continue
        report = made_by(progress)
        write_parts(report, wanted, files)
        findings += report.findings
    if not only:
        write_text(files.output / "LEDGER.md", ledger_text(findings))
    # as text one claim below the other: a table of them is too wide for any terminal
    show_rows(CLAIMS, [CLAIMS.row(finding) for finding in findings], in_blocks=True)


def write_parts(report: "Report", wanted: set[str], files: Files) -> None:
    """Write the tables and figures of a report that are asked for; a figure's panels, fig1a, go with it."""
    for name, table in report.tables.items():
        if name in wanted:
            write_text(files.output / f"paper_{name}.md", table)
    for name, draw in report.figures.items():
        if name.rstrip("abc") in wanted:
            files.write(files.path("paper", name), draw)


def write_text(path: Path, text: str) -> None:
    """Write a text to a file."""
    write_file(path, lambda file: file.write(text.encode()))
