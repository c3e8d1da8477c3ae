"""How commands answer: rows on standard output; files; messages and progress on standard error."""

import re
import sys
from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from functools import partial
from operator import length_hint
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO, TypeVar

import click

from bezstab.cli.options import gathered
from bezstab.cli.terminal import text_width
from bezstab.files import output_directory, write_whole
from bezstab.show import (
    FIGURE_FORMS,
    TABLE_FORMS,
    Column,
    Format,
    Row,
    RowKind,
    Sentence,
    block,
    finite,
    fits,
    render,
    visible,
    wrapped,
)
from bezstab.stopping import if_stopped

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from bezstab.evidence import Arrays

Item = TypeVar("Item")
INDENT = " " * 4
"""Before a command line that is to be copied; lines that continue it have it twice."""

CONTINUED = " \\"
"""Ends a line of a command that goes on in the next."""


def show_rows(
    kind: RowKind, rows: Sequence[Row], form: Format, without: Collection[str] = (), heading: str = ""
) -> None:
    """Print rows of a kind on standard output, below a heading where people read them; `without` as RowKind.columns.

    As text, a single row is a block of lines below its sentence; so is each row of a table wider than the terminal.
    """
    if heading and for_reading(form):
        show_text(f"{heading}\n")
    columns = kind.columns(rows, without) if for_reading(form) else []
    answer = render(rows, columns, form)
    if form == "text" and rows and (len(rows) == 1 or not fits(answer, text_width())):
        show_blocks(rows, columns, kind.sentence)
    else:
        click.echo(answer)


def show_blocks(rows: Sequence[Row], columns: Sequence[Column], sentence: Sentence | None = None) -> None:
    """Print a block of lines for each row, below its sentence, on standard output."""
    blocks = [block(row, columns, text_width(), sentence(finite(row)) if sentence else "") for row in rows]
    click.echo("\n\n".join(blocks))


def show_groups(
    groups: Sequence[tuple[str, Sequence[Row]]], columns: Sequence[Column], sentence: Sentence | None = None
) -> None:
    """Print groups of rows for reading, each below its heading, all in one table's columns if that is not too wide."""
    table = render([row for _, rows in groups for row in rows], columns, "text")
    if not fits(table, text_width()):
        for heading, of_group in groups:
            show_text(f"{heading}\n")
            show_blocks(of_group, columns, sentence)
            click.echo()
        return
    head, *lines = table.splitlines()
    click.echo(head)
    for heading, of_group in groups:
        show_text(f"\n{heading}")
        for line in lines[: len(of_group)]:
            click.echo(line)
        del lines[: len(of_group)]


def show_text(text: str) -> None:
    """Print a text on standard output, its lines no longer than the terminal's."""
    click.echo(wrapped(text, text_width()))


def show_command(command: str) -> None:
    """Print a command line to be copied: in one line, or, where the terminal is narrower, continued as in sh."""
    first, *options = visible(command).split(" --")
    lines = [INDENT + first]
    for option in options:
        if len(lines[-1]) + len(f" --{option}{CONTINUED}") <= text_width():
            lines[-1] += f" --{option}"
        else:
            lines.append(f"{2 * INDENT}--{option}")
    click.echo(f"{CONTINUED}\n".join(lines))


def say(message: str) -> None:
    """Print a message on standard error, in one line; if that cannot be written, go on."""
    with suppress(OSError):
        click.echo(visible(message), err=True)


def for_reading(form: Format) -> bool:
    """Return whether the format is for people to read: then sentences are printed, too."""
    return form in ("text", "markdown")


def file_name(name: str) -> str:
    """Return the name of a method or a scene without characters that a file's name cannot have."""
    encoding = sys.getfilesystemencoding()
    return re.sub(r"[^\w@.+-]", "_", name.encode(encoding, "replace").decode(encoding))


def write_file(path: Path, write: Callable[[BinaryIO], object]) -> None:
    """Write a whole file and say so on standard error; InputError, and no file, if the system refuses."""
    write_whole(path, write)
    say(f"wrote {path}")


@dataclass(frozen=True)
class Files:
    """Where a command writes (--output), and in which forms (--figure, --table)."""

    output: Path
    figure: str
    table: str = "none"

    @property
    def wanted(self) -> bool:
        """Whether anything is to be written."""
        return self.figure != "none" or self.table != "none"

    def check_output(self) -> None:
        """Make the directory before anything runs, if something is to be written; InputError if that fails."""
        if self.wanted:
            output_directory(self.output)

    def path(self, *names: str) -> Path:
        """Return the path, without an ending, of a file that is named after methods and scenes."""
        return self.output / "_".join(file_name(name) for name in names)

    def write(
        self, path: Path, figure: "Callable[[], Figure] | None", table: "Callable[[], Arrays] | None" = None
    ) -> None:
        """Call these functions and write what they return: a table of equally long arrays, and a figure.

        The files are `path` + .csv, .png, ... What is not asked for is neither made nor loaded.
        """
        if table and self.table != "none":
            columns = table()
            from bezstab.show import write_arrays

            write_file(path.with_name(f"{path.name}.{self.table}"), partial(write_arrays, columns, self.table))
        if figure and self.figure != "none":
            drawn = figure()
            from bezstab.show import save

            write_file(path.with_name(f"{path.name}.{self.figure}"), partial(save, drawn, self.figure))


_where_and_figure = (
    click.option("-o", "--output", type=click.Path(path_type=Path), default=".", help="Directory for what is written."),
    click.option("--figure", type=click.Choice([*FIGURE_FORMS, "none"]), default="png", help="Format of the figure."),
)
_table_forms = click.Choice([*TABLE_FORMS, "none"])

picture_options = gathered(Files, "files", *_where_and_figure)
"""For a command that writes a figure and no table."""

figure_options, file_options = (
    gathered(
        Files,
        "files",
        *_where_and_figure,
        click.option("--table", type=_table_forms, default=usual, help="Format of the table."),
    )
    for usual in ("none", "csv")
)
"""For commands that also write a table: only if it is asked for, or by default."""


@dataclass(frozen=True)
class Work:
    """Who computes what takes long: a number of processes, or a cluster. `resume` continues a run that was stopped."""

    workers: int | None
    scheduler: str | None
    resume: bool


work_options = gathered(
    Work,
    "work",
    click.option("--workers", type=click.IntRange(1, 1000), help="Number of processes [one for each core]."),
    click.option("--scheduler", help="Address of a Dask scheduler, tcp://host:port, in place of --workers."),
    click.option("--resume", is_flag=True, help="Continue a run with the same options that was stopped."),
)


def progress(
    items: Iterable[Item], label: str, length: int = 0, size: Callable[[Item], int] = lambda _: 1
) -> Iterator[Item]:
    """Yield the items, with a progress bar on standard error where that is a terminal.

    `length` is the sum of their sizes; without it their number.
    """
    if not sys.stderr.isatty():
        yield from items
        return
    bar = click.progressbar(length=length or length_hint(items), label=visible(label), file=sys.stderr)
    with bar, if_stopped(bar.render_finish):  # which shows the cursor again
        for item in items:
            yield item
            bar.update(size(item))


@contextmanager
def results_of_chunks(
    compute: "Callable[[Any], Arrays]", chunks: Sequence[Any], path: Path, job: str, work: Work
) -> "Iterator[list[Arrays]]":
    """Give the results of independent chunks, in their order; processes or a cluster's workers compute them.

    Finished chunks are kept in `path` + .chunks, so that a run of the same `job` can resume; once the results are used
    they are deleted. A damaged chunk is computed again, and a message says so. InputError while another run uses them.
    """
    from bezstab.evidence import chunk_store, completed_chunks, worker_pool

    def say_damaged(file: Path) -> None:
        say(f"bezstab: {file} is damaged: computed again")

    def say_how_to_go_on() -> None:
        say(f"bezstab: what is finished lies in {store.path}: --resume goes on from there")

    kept_in = path.with_name(f"{path.name}.chunks")
    with worker_pool(work.workers, work.scheduler) as pool, chunk_store(kept_in, job, work.resume) as store:
        with if_stopped(say_how_to_go_on):
            arriving = completed_chunks(compute, chunks, pool, store, say_damaged)
            results = dict(progress(arriving, path.name, len(chunks)))
        yield [results[number] for number in range(len(chunks))]
        store.discard()
