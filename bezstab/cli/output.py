"""How commands answer: rows on standard output, files, messages and progress on standard error."""

import re
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from operator import length_hint
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO, TypeVar

import click

from bezstab.cli.options import FigureForm, TableForm
from bezstab.files import write_whole
from bezstab.show import Column, Format, Row, render

if TYPE_CHECKING:
    import numpy as np
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from bezstab.evidence import Arrays

Item = TypeVar("Item")


def show_rows(rows: Sequence[Row], columns: Sequence[Column], form: Format, heading: str = "") -> None:
    """Print rows on standard output, below a heading where people read them."""
    if heading and for_reading(form):
        click.echo(f"{heading}\n")
    click.echo(render(rows, columns, form))


def for_reading(form: Format) -> bool:
    """Return whether people read that format, not programs: then there is room for words."""
    return form in ("text", "markdown")


def file_name(name: str) -> str:
    """Return a method's or a scene's name with nothing that a file's name cannot have."""
    return re.sub(r"[^\w@.+-]", "_", name)


def write_file(path: Path, write: Callable[[BinaryIO], object]) -> None:
    """Write a file whole, or not at all, and say so on standard error; InputError where the system refuses."""
    write_whole(path, write)
    click.echo(f"wrote {path}", err=True)


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
    with click.progressbar(length=length or length_hint(items), label=label, file=sys.stderr) as bar:
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
    """
    from bezstab.evidence import chunk_store, completed_chunks, worker_pool

    with worker_pool(workers, scheduler) as pool:
        store = chunk_store(path.with_name(f"{path.name}.chunks"), job, resume)
        try:
            arriving = completed_chunks(work, chunks, pool, store)
            results = dict(progress(arriving, path.name, len(chunks)))
        except KeyboardInterrupt:
            click.echo(f"bezstab: what is finished lies in {store.path}: --resume goes on from there", err=True)
            raise
    yield [results[number] for number in range(len(chunks))]
    store.discard()
