"""The command `paper`; it goes with the merge, which brings bezstab/paper/command.py."""

from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from bezstab.cli.options import FigureForm, figure_option, format_option, output_option
from bezstab.cli.output import for_reading, progress, show_rows, write_figure, write_file
from bezstab.files import output_directory
from bezstab.paper.printed import PARTS, Finding
from bezstab.show import PROPERTIES, Format, column, render, row, transposed

if TYPE_CHECKING:
    from bezstab.paper.experiments import Experiment
    from bezstab.paper.report import Report

FINDINGS = [column(key, key) for key in ("where", "claim", "paper", "here", "agreement")]


@click.command()
@click.option("--only", type=click.Choice(PARTS), multiple=True, help="This part alone. Repeatable.")
@output_option
@figure_option
@format_option
def paper(only: Sequence[str], output: Path, figure: FigureForm, form: Format) -> None:
    """Regenerate the paper's tables and figures, and test its claims.

    Writes paper_table1.md, ..., paper_fig9.png and, unless --only asks for parts, LEDGER.md, and prints what agrees
    with the paper and what does not.

    Example: bezstab paper --only table4
    """
    from bezstab.paper import report

    chosen = set(only or PARTS)
    output_directory(output)
    findings: list[Finding] = []
    for parts, make in report.REPORTS.items():
        if chosen & set(parts):
            made = make(_Labelled(parts[0]))
            _write_parts(made, chosen, output, figure)
            if made.aside and for_reading(form):
                click.echo(f"{made.aside}\n")
            findings += made.findings
    if not only:
        write_file(output / "LEDGER.md", lambda file: file.write(report.ledger(findings).encode()))
    rows = [row(finding) for finding in findings]
    if form == "text":
        click.echo("\n\n".join(render(transposed(finding), PROPERTIES, form) for finding in rows))
    else:
        show_rows(rows, FINDINGS, form)


class _Labelled:
    """The progress of the runs of one part."""

    def __init__(self, label: str) -> None:
        self.label = label

    def __call__(self, runs: "Iterator[Experiment]", length: int) -> "Iterable[Experiment]":
        return progress(runs, self.label, length)


def _write_parts(made: "Report", chosen: set[str], output: Path, figure: FigureForm) -> None:
    for name, text in made.tables.items():
        if name in chosen:
            write_file(output / f"paper_{name}.md", lambda file, text=text: file.write(text.encode()))  # type: ignore[misc]
    for name, drawn in made.figures.items():
        if name.rstrip("abc") in chosen:
            write_figure(output / f"paper_{name}", lambda drawn=drawn: drawn, figure)  # type: ignore[misc]
