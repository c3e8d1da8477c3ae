"""Commands as processes of their own: in a line that a shell runs, or told to stop at a moment."""

import os
import re
import shlex
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

COMMAND = [sys.executable, "-m", "bezstab"]
ENVIRONMENT = {**os.environ, "PYTHONPATH": str(Path(__file__).parents[2])}
PATIENCE = 120
"""s, after which a process that does not end is a failure."""


def shell(line: str, path: Path, **options: Any) -> "subprocess.CompletedProcess[bytes]":
    """Return what a shell's line prints that is typed below a path, and its exit status."""
    options = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, **options}
    typed = line.replace("bezstab", shlex.join(COMMAND))
    return subprocess.run(typed, shell=True, cwd=path, env=ENVIRONMENT, timeout=PATIENCE, check=False, **options)


def default_signals() -> None:
    """Have Ctrl-C, TERM and HUP in a child as a terminal gives them: tests in the background ignore some."""
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, signal.SIG_DFL)


@contextmanager
def started(line: str, path: Path) -> Iterator["subprocess.Popen[bytes]"]:
    """Give a running command, in a process group of its own, and leave none of that group behind."""
    running = subprocess.Popen(
        [*COMMAND, *line.split()],
        cwd=path,
        env=ENVIRONMENT,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        preexec_fn=default_signals,  # noqa: PLW1509 - the tests start no threads
        start_new_session=True,
    )
    try:
        yield running
    finally:
        with suppress(ProcessLookupError):
            os.killpg(running.pid, signal.SIGKILL)
        running.communicate()


def wait_until(condition: Callable[[], object]) -> None:
    """Wait until the condition holds; AssertionError after PATIENCE."""
    deadline = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < deadline, "nothing happened"
        time.sleep(0.005)


def catches(number: int, process: int) -> bool:
    """Return whether a process has a handler of its own for a signal."""
    status = Path(f"/proc/{process}/status").read_text(encoding="ascii", errors="replace")
    return bool(int(re.findall(r"SigCgt:\s*([0-9a-f]+)", status)[0], 16) >> (number - 1) & 1)


def group_members(leader: int) -> list[int]:
    """Return the processes of a group that are alive, without its leader."""
    members: list[int] = []
    for stat in Path("/proc").glob("[0-9]*/stat"):
        with suppress(OSError):  # it has just ended
            state, _, group = stat.read_text(encoding="ascii", errors="replace").rpartition(")")[2].split()[:3]
            if state != "Z" and int(group) == leader != int(stat.parent.name):
                members.append(int(stat.parent.name))
    return members


def files_below(path: Path) -> Sequence[str]:
    """Return the names of all files and directories below a path, ascending."""
    return sorted(str(entry.relative_to(path)) for entry in path.rglob("*"))
