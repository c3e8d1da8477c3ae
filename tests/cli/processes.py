"""Commands as processes of their own: with whatever environment, limits and streams, and told to stop at a moment."""

import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import IO, Any

ROOT = Path(__file__).parent.parent.parent
PATIENCE = 120
"""s, after which a process that does not end is a failure."""


def default_signals() -> None:
    """Have Ctrl-C, TERM and HUP in a child as a terminal gives them: tests in the background ignore some."""
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, signal.SIG_DFL)


@contextmanager
def started(
    *arguments: str,
    cwd: Path,
    environment: Mapping[str, str | None] | None = None,
    prepare: Callable[[], object] = lambda: None,
    stdout: int | IO[bytes] = subprocess.PIPE,
    stderr: int | IO[bytes] = subprocess.PIPE,
) -> Iterator[subprocess.Popen[bytes]]:
    """Give a running command, in a process group of its own, and leave none of that group behind.

    `environment` is added to this one's, None takes a variable away; `prepare` runs in the child before the command.
    """
    asked = {**os.environ, "PYTHONPATH": str(ROOT), **(environment or {})}
    variables = {name: value for name, value in asked.items() if value is not None}

    def prepared() -> None:
        default_signals()
        prepare()

    command = [sys.executable, "-m", "bezstab", *arguments]
    running = subprocess.Popen(
        command,
        cwd=cwd,
        env=variables,
        stdout=stdout,
        stderr=stderr,
        preexec_fn=prepared,  # noqa: PLW1509 - the tests start no threads
        start_new_session=True,
    )
    try:
        yield running
    finally:
        for process in (running.pid, *group_members(running.pid)):
            with suppress(ProcessLookupError):
                os.kill(process, signal.SIGKILL)
        running.communicate()


def finished(*arguments: str, **options: Any) -> subprocess.CompletedProcess[bytes]:
    """Return what a command printed, and its exit status; the options are those of `started`."""
    with started(*arguments, **options) as running:
        answer, errors = running.communicate(timeout=PATIENCE)
        return subprocess.CompletedProcess(arguments, running.returncode, answer, errors)


def wait_until(condition: Callable[[], object], running: subprocess.Popen[bytes] | None = None) -> None:
    """Wait until the condition holds; AssertionError if the process ends before, or after PATIENCE."""
    deadline = time.monotonic() + PATIENCE
    while not condition():
        assert running is None or running.poll() is None, "the process ended first"
        assert time.monotonic() < deadline, "nothing happened"
        time.sleep(0.005)


def catches(number: int, process: int) -> bool:
    """Return whether a process has a handler of its own for a signal."""
    try:
        status = Path(f"/proc/{process}/status").read_text(encoding="ascii", errors="replace")
    except OSError:
        return False
    caught = re.search(r"SigCgt:\s*([0-9a-f]+)", status)
    return bool(caught and int(caught[1], 16) >> (number - 1) & 1)


def group_members(leader: int) -> list[int]:
    """Return the processes of a group that are alive, without its leader."""
    members: list[int] = []
    for stat in Path("/proc").glob("[0-9]*/stat"):
        try:
            fields = stat.read_text(encoding="ascii", errors="replace").rpartition(")")[2].split()
        except OSError:
            continue  # it has just ended
        if fields[0] != "Z" and int(fields[2]) == leader != int(stat.parent.name):
            members.append(int(stat.parent.name))
    return members


def files_below(path: Path) -> Sequence[str]:
    """Return the names of all files and directories below a path, ascending."""
    return sorted(str(entry.relative_to(path)) for entry in path.rglob("*"))
