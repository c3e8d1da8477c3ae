"""The group of all commands: how they are listed, found and ended; and the streams that they answer on."""

import importlib
import io
import os
import sys
import traceback
from collections.abc import Mapping
from operator import itemgetter
from typing import Any, NoReturn

import click

from bezstab import __version__
from bezstab.cli.removed import where_it_went
from bezstab.errors import InputError, NumericalError
from bezstab.stopping import end_if_told

COMMANDS: Mapping[str, Mapping[str, str]] = {
    "Maps": {
        "poles": "bezstab.feedback.poles_command",
        "region": "bezstab.regions.region_command",
        "methods": "bezstab.regions.methods_command",
    },
    "Choose": {
        "choose": "bezstab.feedback.choose_command",
        "check": "bezstab.feedback.check_command",
        "steps": "bezstab.step_sequences.command",
        "drive": "bezstab.drives.command",
        "lint": "bezstab.mujoco.command",
        "engines": "bezstab.catalogue.command",
        "chain": "bezstab.chains.command",
    },
    "Evidence": {
        "simulate": "bezstab.runs.simulate_command",
        "verify": "bezstab.runs.verify_command",
        "probe": "bezstab.probes.command",
        "tradeoff": "bezstab.runs.tradeoff_command",
    },
    "Paper": {
        "paper": "bezstab.paper.command",
    },
}
"""What `bezstab --help` lists under which heading, in this order: each command, and the module that has it."""

NUMERICAL_TROUBLE = 3
"""Exit status if a part of an answer could not be found, or a run broke down; a message says why."""

READER_GONE = 128 + 13
"""Exit status if nobody reads the answer any more: the shell's for SIGPIPE, and not 1, which means "unsafe"."""


DEFECT = 70
"""Exit status of a defect of this program: EX_SOFTWARE of BSD's sysexits.h, and not 1, which means "unsafe"."""


class BezstabGroup(click.Group):
    """A group that lists its commands under headings, loads a command when it is called, and ends errors in one line.

    A command returns nothing, or whether what it judges is safe (exit status 0 or 1), or an exit status. The status is
    2 for a user's mistake and for what the system refuses (a full disk, a closed standard output), 3 for numerical
    trouble, 70 for a defect of this program. A signal that ends a run is 128 + its number, as a shell has it: 130 after
    Ctrl-C, 143 after TERM, 129 when the terminal is gone (bezstab.stopping), 141 where nobody reads the answer any more
    (`| head`).
    """

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Return the names of all commands in the order of their sections."""
        return [name for names in COMMANDS.values() for name in names]

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """Return the command of that name, loaded now; None if there is none."""
        return _loaded(cmd_name) if cmd_name in self.list_commands(ctx) else None

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """Return the command that was typed; UsageError, which says where it went, if it was removed."""
        if (went := where_it_went(args[0])) and not ctx.resilient_parsing:
            raise click.UsageError(went)
        return super().resolve_command(ctx, args)

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write a heading for each section and a sentence for each command."""
        for heading, names in filter(itemgetter(1), COMMANDS.items()):
            with formatter.section(heading):
                formatter.write_dl([(name, (_loaded(name).help or "").partition("\n")[0]) for name in names])

    def invoke(self, ctx: click.Context) -> Any:
        """Run the command that was typed; matplotlib, which warns if it finds no home, is silent."""
        import logging

        logging.getLogger("matplotlib").setLevel(logging.ERROR)
        try:
            result = super().invoke(ctx)
            from bezstab.cli.output import say_notes  # which loads more than --help needs

            say_notes()
            return result
        except BrokenPipeError:  # the reader, such as `head`, has seen enough; click itself would exit with 1
            _give_up_output()
            sys.exit(READER_GONE)

    def main(self, *args: Any, **kwargs: Any) -> NoReturn:
        """Run the command line and exit."""
        try:
            status = super().main(*args, **{**kwargs, "standalone_mode": False})
        except click.NoSuchOption as error:
            command = error.ctx.info_name if error.ctx else None
            _complain(where_it_went(f"{command} {error.option_name}") or error.format_message())
            sys.exit(2)
        except click.ClickException as error:
            _complain(error.format_message())
            sys.exit(2)
        except (InputError, NumericalError) as error:
            _complain(str(error))
            sys.exit(2 if isinstance(error, InputError) else NUMERICAL_TROUBLE)
        except OSError as error:
            _give_up_output()
            _complain(f"{error.filename}: {error.strerror}" if error.filename else error.strerror or str(error))
            sys.exit(2)
        except Exception:  # a defect of this program: Python would exit with 1, "unsafe", though nothing was judged
            end_if_told()  # which a library has made an error of
            traceback.print_exc()
            _complain("this is a defect of bezstab: no verdict")
            sys.exit(DEFECT)
        if isinstance(status, bool):  # whether what a command judges is safe
            sys.exit(0 if status else 1)
        sys.exit(status or 0)


def one_thread_for_algebra() -> None:
    """Let numpy compute on one thread, unless the environment says on how many; before numpy is loaded.

    The matrices here are so small that threads only wait for each other: a model of sixty joints took four times as
    long with two of them.
    """
    for library in ("OPENBLAS", "MKL"):
        os.environ.setdefault(f"{library}_NUM_THREADS", "1")


def prepare_streams() -> None:
    """Make the standard streams of this process fit for any text: what their encoding lacks is a question mark.

    A closed standard error is silent. With a closed standard output there is nowhere to answer: one line, exit
    status 2. The descriptor of a closed stream is taken, or the next file that is opened would get it, and with it
    what libraries print there.
    """
    for descriptor in (0, 1, 2):
        try:
            os.fstat(descriptor)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # it gets the lowest number that is free, which is this one
    if sys.stdin is None:
        sys.stdin = open(os.devnull, encoding="utf-8")  # noqa: SIM115
    if sys.stderr is None:
        sys.stderr = open(os.devnull, "w", encoding="utf-8")  # noqa: SIM115
    if sys.stdout is None:
        sys.stderr.write("bezstab: standard output is closed: there is nowhere to answer\n")
        sys.exit(2)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")


def _loaded(name: str) -> click.Command:
    """Return the command of this name."""
    (module,) = [names[name] for names in COMMANDS.values() if name in names]
    command: click.Command = getattr(importlib.import_module(module), name)
    return command


def _complain(message: str) -> None:
    """Print bad news in one line."""
    from bezstab.cli.output import say  # which loads more than --version needs

    say(f"bezstab: {' '.join(message.split())}")


def _give_up_output() -> None:
    """Drop what cannot be written on standard output: else Python would complain at exit, with a traceback."""
    try:
        sys.stdout.flush()
    except OSError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


@click.group(
    cls=BezstabGroup,
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
