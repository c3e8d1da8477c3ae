"""Help in groups: `@grouped("Your simulation", h, method)` lists these options of a GroupedCommand below a heading."""

from collections.abc import Callable
from typing import Any, TypeVar

import click

Command = TypeVar("Command", bound=Callable[..., Any])
Decorator = Callable[[Any], Any]


def grouped(heading: str, *options: Decorator) -> Callable[[Command], Command]:
    """Return a decorator that adds options, as `click.option` makes them, and has help list them below a heading."""

    def decorate(command: Command) -> Command:
        before = len(getattr(command, "__click_params__", ()))
        for option in reversed(options):
            command = option(command)
        for added in command.__click_params__[before:]:  # type: ignore[attr-defined]  # where click keeps them
            vars(added)["heading"] = heading
        return command

    return decorate


class GroupedCommand(click.Command):
    """A command whose help lists its options below the headings of `grouped`; those without one go with the last."""

    def format_options(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the options below their headings."""
        groups: dict[str, list[tuple[str, str]]] = {}
        heading = "Options"
        for parameter in self.get_params(ctx):
            heading = vars(parameter).get("heading", heading)
            record = parameter.get_help_record(ctx) if isinstance(parameter, click.Option) else None
            if record is not None:
                groups.setdefault(heading, []).append(record)
        for heading, records in groups.items():
            with formatter.section(heading):
                formatter.write_dl(records)
