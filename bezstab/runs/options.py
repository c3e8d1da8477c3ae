"""Options of commands that run mechanisms: what holds the constraints, and who computes what takes long."""

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, TypeVar

import click

from bezstab.stabilising import STABILISE

Command = TypeVar("Command", bound=Callable[..., Any])

USUAL_STEP = Fraction("0.001")  # s

stabilise = click.option(
    "--stabilise",
    type=click.Choice(list(STABILISE)),
    metavar="WORD",
    help="baumgarte, projection or none [baumgarte].",
)
iterations = click.option("--iterations", type=int, help="With projection: Newton iterations in a step, at most.")


@dataclass(frozen=True)
class Work:
    """Who computes what takes long: a number of processes, or a cluster. `resume` continues a run that was stopped."""

    workers: int | None
    scheduler: str | None
    resume: bool


def shared_work(command: Command) -> Command:
    """Add what says who computes: --workers, --scheduler and --resume."""
    for option in (
        click.option("--resume", is_flag=True, help="Continue a run that was stopped."),
        click.option("--scheduler", help="Instead a Dask scheduler, tcp://host:port."),
        click.option("--workers", type=click.IntRange(1, 1000), metavar="N", help="Processes [one for each core]."),
    ):
        command = option(command)
    return command
