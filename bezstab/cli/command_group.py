"""The group of all commands: how they are listed, found and ended."""

import importlib
import os
import sys
import traceback
from collections.abc import Mapping, Sequence
from typing import Any, NoReturn

import click

from bezstab import __version__
from bezstab.cli.chains_command import chains
from bezstab.cli.choose_commands import check, choose, engines, explore
from bezstab.cli.evidence_commands import extremes, simulate, tradeoff
from bezstab.cli.lint_command import lint
from bezstab.cli.map_commands import family, methods, poles
from bezstab.cli.output import NUMERICAL_TROUBLE, say
from bezstab.cli.probe_command import probe
from bezstab.cli.region_command import region
from bezstab.cli.schema_command import schema
from bezstab.cli.verify_command import verify
from bezstab.errors import InputError, NumericalError

SECTIONS: Mapping[str, Sequence[click.Command]] = {
    "Maps": (poles, region, methods, family),
    "Choose": (choose, check, lint, engines, chains, explore),
    "Evidence": (simulate, verify, probe, tradeoff, extremes),
    "Programs": (schema,),
}
"""What `bezstab --help` lists under which heading, in this order."""

LOADED_LATE: Mapping[str, Mapping[str, str]] = {"Paper": {"paper": "bezstab.paper.command:paper"}}
"""Extensions by heading and name, each as module:command: nothing imports them, the group finds them by name."""


COMPLETE = "_BEZSTAB_COMPLETE"
"""Environment variable in which a shell says that it wants to complete a command."""

READER_GONE = 128 + 13
"""Exit status where nobody reads the answer any more: as a shell has it for SIGPIPE, and unlike 1, "fault is found"."""


DEFECT = 70
"""Exit status of a defect of this program: EX_SOFTWARE of BSD's sysexits.h, and unlike 1, "fault is found"."""


class BezstabGroup(click.Group):
    """A group that lists its commands under headings, finds extensions when asked for, and ends errors in one line.

    Exit status 2 for a user's mistake and for what the system refuses (a full disk, a closed standard output), 3 for
    numerical trouble, 70 for a defect of this program. A signal that ends a run is 128 + its number, as a shell has it:
    130 after Ctrl-C, 143 after TERM, 129 when the terminal is gone (bezstab.stopping), 141 where nobody reads the
    answer any more (`| head`).
    """

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Return the names of all commands in the order of their sections."""
        return [name for names in self._names_by_section().values() for name in names]

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """Return the command of that name, an extension's loaded now; None if there is none."""
        for commands in LOADED_LATE.values():
            if cmd_name in commands:
                module, _, function = commands[cmd_name].partition(":")
                command: click.Command = getattr(importlib.import_module(module), function)
                return command
        return super().get_command(ctx, cmd_name)

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write a heading for each section and a sentence for each command."""
        longest = max(len(name) for name in self.list_commands(ctx))
        room = formatter.width - 6 - longest  # as click counts it: two indents and the gap between name and sentence
        for heading, names in self._names_by_section().items():
            sentences: list[tuple[str, str]] = []
            for name in names:
                command = self.get_command(ctx, name)
                assert command
                sentences.append((name.ljust(longest), command.get_short_help_str(room)))
            with formatter.section(heading):
                formatter.write_dl(sentences)

    def invoke(self, ctx: click.Context) -> Any:
        """Run the command that was typed, and let it alone speak: matplotlib has words where it finds no home."""
        import logging

        logging.getLogger("matplotlib").setLevel(logging.ERROR)
        try:
            return super().invoke(ctx)
        except BrokenPipeError:  # the reader, such as `head`, has seen enough; click itself would exit with 1
            _give_up_output()
            sys.exit(READER_GONE)

    def main(self, *args: Any, **kwargs: Any) -> NoReturn:
        """Run the command line and exit."""
        if COMPLETE in os.environ:  # the shell asks what it may offer
            importlib.import_module("bezstab.cli.completion")
        try:
            status = super().main(*args, **{**kwargs, "standalone_mode": False})
        except click.ClickException as error:
            _complain(error.format_message())
            sys.exit(2)
        except InputError as error:
            _complain(str(error))
            sys.exit(2)
        except NumericalError as error:
            _complain(str(error))
            sys.exit(NUMERICAL_TROUBLE)
        except click.Abort:
            _complain("interrupted")
            sys.exit(130)
        except OSError as error:
            _give_up_output()
            _complain(f"{error.filename}: {error.strerror}" if error.filename else error.strerror or str(error))
            sys.exit(2)
        except Exception:  # a defect of this program: Python would exit with 1, "unsafe", though nothing was judged
            traceback.print_exc()
            _complain("this is a defect of bezstab: no verdict")
            sys.exit(DEFECT)
        sys.exit(status if isinstance(status, int) else 0)  # a command that calls ctx.exit(status) returns it here

    def _names_by_section(self) -> dict[str, list[str]]:
        sections = {heading: [command.name or "" for command in commands] for heading, commands in SECTIONS.items()}
        for heading, commands in LOADED_LATE.items():
            sections.setdefault(heading, []).extend(commands)
        return sections


def _complain(message: str) -> None:
    """Print bad news in one line."""
    say(f"bezstab: {' '.join(message.split())}")


def _give_up_output() -> None:
    """Let what cannot be written on standard output vanish: Python would complain at exit, with a traceback."""
    try:
        sys.stdout.flush()
    except OSError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


@click.group(
    cls=BezstabGroup,
    commands=[command for commands in SECTIONS.values() for command in commands],
    context_settings={"help_option_names": ["-h", "--help"], "show_default": True},
    invoke_without_command=True,
)
@click.version_option(__version__)
@click.pass_context
def main(context: click.Context) -> None:
    """Which Baumgarte parameters are safe, and best, for an integrator at its step size?

    Everywhere α̂ = 2αh and β̂ = β²h² (dimensionless) for the feedback c̈ + 2αċ + β²c = 0 and a step of h seconds.
    """
    if context.invoked_subcommand is None:
        click.echo(context.get_help())
