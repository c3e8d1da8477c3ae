"""The command that says what the others print for programs: schema."""

import json

import click

from bezstab.show import ROW_KINDS, json_schema


@click.command()
@click.argument("command", metavar="COMMAND", type=click.Choice(list(ROW_KINDS)))
def schema(command: str) -> None:
    """Print the JSON Schema of what a command prints as JSON.

    Every key with its type, meaning and unit (draft 2020-12). The same key means the same in all commands.

    Example: bezstab schema check
    """
    click.echo(json.dumps(json_schema(command), indent=2))
