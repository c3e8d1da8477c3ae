"""How commands answer: rows on standard output; files; messages and progress on standard error."""

import re
import shutil
import sys
import textwrap
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO, TypeVar

import click

from bezstab.files import output_directory, write_whole
from bezstab.show.cells import MISSING, visible
from bezstab.show.columns import SENTENCE, Column, row_of
from bezstab.show.tables import Format, for_programs, lines_below, shown_width, table, wrapped

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from bezstab.stability.arrays import Arrays

Item = TypeVar("Item")
INDENT = " " * 4
"""Before a command line that is to be copied; lines that continue it have it twice."""

CONTINUED = " \\"
"""Ends a line of a command that goes on in the next."""


UNLIMITED = sys.maxsize
"""Characters of a line of text where no terminal limits it, as on a pipe: there nothing wraps."""


def text_width() -> int:
    """Return how many characters a line on standard output can have: COLUMNS, else as many as the terminal has."""
    return shutil.get_terminal_size((UNLIMITED, 1)).columns


def chosen_format() -> Format:
    """Return the --format of the running command."""
    form: Format = click.get_current_context().params["form"]
    return form


def for_reading() -> bool:
    """Return whether people read the answer of the running command: then texts are printed, too."""
    return chosen_format() in ("text", "markdown")


Table = tuple[Sequence[Column[Any]], Sequence[Any]]
"""Columns, and answers that have them."""


def show_answers(
    columns: Sequence[Column[Item]],
    answers: Sequence[Item],
    *,
    in_blocks: bool = False,
    below: Sequence[Table] = (),
) -> None:
    """Print answers on standard output: every column as JSON and CSV, else the brief ones, or with --all every one.

    As text each answer is its sentence, if a column has one, with a line for each other column below; several are a
    table, if that is not wider than the terminal, unless they are to be `in_blocks`. A command without --all shows
    every one. Tables of another kind follow `below`, as `show_tables` has them.
    """
    if for_reading():
        click.echo(_text((columns, answers), _every_column(), in_blocks=in_blocks or len(answers) == 1))
        show_tables(below)
    else:
        show_tables([(columns, answers), *below])


def show_tables(tables: Sequence[Table], *, every_column: bool | None = None) -> None:
    """Print answers of several kinds: a table of each that there are, below an empty line; as JSON and CSV one list.

    There every row has the keys of all kinds. A command that has --all shows brief columns alone without it, unless
    told which.
    """
    if not for_reading():
        rows = [row_of(columns, answer) for columns, answers in tables for answer in answers]
        click.echo(for_programs(rows, chosen_format()))
        return
    for each in tables:
        if text := _text(each, _every_column() if every_column is None else every_column):
            click.echo(f"\n{text}")


def _every_column() -> bool:
    """Return whether people want every column: --all, where a command has it."""
    chosen: bool = click.get_current_context().params.get("every_column", True)
    return chosen


def _text(table: Table, every_column: bool, *, in_blocks: bool = False) -> str:
    """Return a table of answers; or of each, where that is wider than the terminal, its sentence and a line a column.

    People see every column, or the brief ones and those that tell several answers apart.
    """
    columns, answers = table
    shown = [
        each for each in columns if each.heading and (every_column or each.brief or (each.apart and len(answers) > 1))
    ]
    if chosen_format() == "markdown" or not in_blocks:
        as_table = _table_of(shown, answers)
        if chosen_format() == "markdown" or shown_width(as_table) <= text_width():
            return as_table
    sentences = [each for each in columns if each.key == SENTENCE.key]
    return "\n\n".join(
        lines_below(
            "".join(each.text(answer) for each in sentences),
            [(each.heading, each.text(answer)) for each in shown],
            text_width(),
        )
        for answer in answers
    )


def _table_of(columns: Sequence[Column[Item]], answers: Sequence[Item]) -> str:
    """Return a table of those columns that have something to show of some answer; nothing without answers."""
    rows = [[each.text(answer) for each in columns] for answer in answers]
    known = [(each.heading, *cells) for each, *cells in zip(columns, *rows, strict=True) if {*cells} - {MISSING}]
    return table(list(zip(*known, strict=True)), chosen_format()) if known else ""


def show_groups(columns: Sequence[Column[Item]], groups: Sequence[tuple[str, Sequence[Item]]]) -> None:
    """Print one table of the brief columns of several groups, each group below its heading.

    As Markdown and for programs it is `show_answers` of all.
    """
    everything = [answer for _, answers in groups for answer in answers]
    if chosen_format() != "text":
        show_answers(columns, everything)
        return
    head, *lines = _table_of([each for each in columns if each.brief], everything).splitlines()
    click.echo(head)
    for heading, answers in groups:
        click.echo(f"\n{heading}")
        for _ in answers:
            click.echo(lines.pop(0))


def show_text(text: str) -> None:
    """Print a text for people on standard output, its lines no longer than the terminal's; nothing for programs."""
    if for_reading():
        click.echo(wrapped(text, text_width()))


def show_command(command: str) -> None:
    """Print a command line to be copied: in one line, or, where the terminal is narrower, continued as in sh."""
    lines = textwrap.wrap(
        visible(command),
        text_width() - len(CONTINUED),
        initial_indent=INDENT,
        subsequent_indent=2 * INDENT,
        break_long_words=False,
        break_on_hyphens=False,
    )
    click.echo(f"{CONTINUED}\n".join(lines))


NOTES = "bezstab.notes"
"""Where the running command keeps what is to be said beside its answer, but not beside a mistake."""


def say_notes() -> None:
    """Say on standard error what the running command has kept to be said beside its answer."""
    for note in click.get_current_context().meta.get(NOTES, []):
        say(note)


def say(message: str) -> None:
    """Print a message on standard error, in one line; if that cannot be written, go on."""
    with suppress(OSError):
        click.echo(visible(message), err=True)


def file_name(name: str) -> str:
    """Return the name of a method or a scene, or of its file, without characters that a file's name cannot have."""
    encoding = sys.getfilesystemencoding()
    named = Path(name).stem if name.endswith(".toml") else name
    return re.sub(r"[^\w@.+-]", "_", named.encode(encoding, "replace").decode(encoding))


def write_file(path: Path, write: Callable[[BinaryIO], object]) -> None:
    """Write a whole file and say so on standard error; InputError, and no file, if the system refuses."""
    write_whole(path, write)
    say(f"wrote {path}")


@dataclass(frozen=True)
class Files:
    """Where a command writes (--output), and in which forms (--figure, --table).

    The directory is made at once, before anything runs, if something is to be written; InputError if that fails.
    """

    output: Path
    figure: str
    table: str = "none"

    def __post_init__(self) -> None:
        if self.wanted:
            output_directory(self.output)

    @property
    def wanted(self) -> bool:
        """Whether anything is to be written."""
        return self.figure != "none" or self.table != "none"

    def path(self, *names: str | None) -> Path:
        """Return the path, without an ending, of a file that is named after what was asked for."""
        return self.output / "_".join(file_name(name) for name in names if name)

    def write(
        self, path: Path, figure: "Callable[[], Figure] | None", table: "Callable[[], Arrays] | None" = None
    ) -> None:
        """Call these functions and write what they return: a table of equally long arrays, and a figure.

        The files are `path` + .csv, .png, ... What is not asked for is neither made nor loaded.
        """

        from bezstab.show.arrays import write_arrays
        from bezstab.show.style import save
        from bezstab.show.window import show_in_window

        if table and self.table != "none":
            write_file(path.with_name(f"{path.name}.{self.table}"), partial(write_arrays, table(), self.table))
        if figure and self.figure == "window":
            show_in_window(figure())
        elif figure and self.figure != "none":
            write_file(path.with_name(f"{path.name}.{self.figure}"), partial(save, figure(), self.figure))


def progress(items: Iterable[Item], label: str | None, length: int | None = None) -> Iterator[Item]:
    """Yield the items; `length` is their number. A terminal shows meanwhile how many are done, below a label, if any.

    The bar is on standard error.
    """
    hidden = not (label and sys.stderr.isatty())
    bar = click.progressbar(items, length=length, label=visible(label or ""), hidden=hidden, file=sys.stderr)
    with bar:  # which hides the cursor, and shows it again
        yield from bar


def worked_out(work: Callable[[], Item], label: str | None) -> Item:
    """Return what some work finds, with a bar as `progress` has it."""
    (found,) = [each() for each in progress([work], label)]
    return found
