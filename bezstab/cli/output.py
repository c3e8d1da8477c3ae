"""How commands answer: rows on standard output, files, messages and progress on standard error."""

import re
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from operator import length_hint
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO, TypeVar

import click

from bezstab.cli.options import FigureForm, TableForm
from bezstab.cli.terminal import text_width
from bezstab.files import write_whole
from bezstab.show import Column, Format, Row, block, finite, fits, render, visible, wrapped
from bezstab.stopping import if_stopped

if TYPE_CHECKING:
    import numpy as np
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from bezstab.evidence import Arrays

Item = TypeVar("Item")
Sentence = Callable[[Row], str]
"""Says in words what a row does in numbers."""

INDENT = " " * 4
"""Of a command line that is shown to be copied, and once more of its continued lines."""

CONTINUED = " \\"
"""Ends a line of a command that goes on in the next."""


def show_rows(
    rows: Sequence[Row], columns: Sequence[Column], form: Format, heading: str = "", sentence: Sentence | None = None
) -> None:
    """Print rows on standard output, below a heading where people read them.

    As text, a single row is a block of lines below its sentence; so is each row of a table wider than the terminal.
    """
    if heading and for_reading(form):
        show_text(f"{heading}\n")
    answer = render(rows, columns, form)
    if form == "text" and rows and (len(rows) == 1 or not fits(answer, text_width())):
        show_blocks(rows, columns, sentence)
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
    """Print a message on standard error, in one line; where that cannot be written, nobody wants to read it."""
    with suppress(OSError):
        click.echo(visible(message), err=True)


def for_reading(form: Format) -> bool:
    """Return whether people read that format, not programs: then there is room for words."""
    return form in ("text", "markdown")


def file_name(name: str) -> str:
    """Return a method's or a scene's name with nothing that a file's name cannot have, whatever the system's names."""
    encoding = sys.getfilesystemencoding()
    return re.sub(r"[^\w@.+-]", "_", name.encode(encoding, "replace").decode(encoding))


def write_file(path: Path, write: Callable[[BinaryIO], object]) -> None:
    """Write a file whole, or not at all, and say so on standard error; InputError where the system refuses."""
    write_whole(path, write)
    say(f"wrote {path}")


def write_table(path: Path, columns: "Mapping[str, NDArray[np.generic]]", form: TableForm) -> None:
    """Write equally long arrays by name into `path` + .csv or .npz, or nothing if the form is none."""
    if form == "none":
        return
    from bezstab.show import write_arrays

    write_file(path.with_name(f"{path.name}.{form}"), lambda file: write_arrays(columns, form, file))


def write_figure(path: Path, draw: "Callable[[], Figure]", form: FigureForm) -> None:
    """Write the figure that `draw` makes into `path` + its form; if that is none, nothing is drawn or loaded."""
    if form == "none":
        return
    figure = draw()
    from bezstab.show import save

    write_file(path.with_name(f"{path.name}.{form}"), lambda file: save(figure, form, file))


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
    work: "Callable[[Any], Arrays]",
    chunks: Sequence[Any],
    path: Path,
    job: str,
    workers: int | None,
    scheduler: str | None,
    resume: bool,
) -> "Iterator[list[Arrays]]":
    """Give the results of independent chunks, in their order, from processes or a cluster's workers.

    What is finished is kept in `path` + .chunks, for `resume` by the same `job`, and goes once the caller has used it.
    What is damaged there is computed again, and said so. InputError while another run is at work there.
    """
    from bezstab.evidence import chunk_store, completed_chunks, worker_pool

    def say_damaged(file: Path) -> None:
        say(f"bezstab: {file} is damaged: computed again")

    def say_how_to_go_on() -> None:
        say(f"bezstab: what is finished lies in {store.path}: --resume goes on from there")

    kept_in = path.with_name(f"{path.name}.chunks")
    with worker_pool(workers, scheduler) as pool, chunk_store(kept_in, job, resume) as store:
        with if_stopped(say_how_to_go_on):
            arriving = completed_chunks(work, chunks, pool, store, say_damaged)
            results = dict(progress(arriving, path.name, len(chunks)))
        yield [results[number] for number in range(len(chunks))]
        store.discard()
