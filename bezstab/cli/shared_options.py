"""Options that several commands share, as click decorators: `@h`, `@method`; and groups of them: `@output_options`."""

from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar, get_args

import click

from bezstab.cli.options import A_METHOD, METHOD, NUMBER, SECONDS
from bezstab.show.file_forms import FIGURE_FORMS
from bezstab.show.tables import Format

Command = TypeVar("Command", bound=Callable[..., Any])

alpha = click.option("--alpha", type=NUMBER, help="α̂ as a decimal or a fraction, read exactly.")
beta = click.option("--beta", type=NUMBER, help="β̂ as a decimal or a fraction, read exactly.")
physical = click.option("--physical", is_flag=True, help="--alpha and --beta are α and β in 1/s; needs --h.")
h = click.option("--h", type=SECONDS, required=True, help="Step size in s.")
methods = click.option("--method", "methods", type=METHOD, multiple=True, help=f"{A_METHOD} Repeatable.")
figure = click.option(
    "--figure", type=click.Choice([*FIGURE_FORMS, "none"]), default="none", help="Format of the figure."
)
output = click.option(
    "-o", "--output", type=click.Path(path_type=Path), default=".", help="Directory for what is written."
)
form = click.option(
    "--format", "form", type=click.Choice(get_args(Format)), default="text", help="What to print on standard output."
)
every_column = click.option("--all", "every_column", is_flag=True, help="Print every column, not the main ones alone.")


def point(command: Command) -> Command:
    """Add what gives a point of the plane: --alpha, --beta and --physical."""
    for option in (physical, beta, alpha):
        command = option(command)
    return command


def output_options(command: Command) -> Command:
    """Add what says how a command answers: --all, --format, --figure and --output."""
    for option in (output, figure, form, every_column):
        command = option(command)
    return command
