"""How a run ends that is told to: by INT (Ctrl-C), TERM or HUP (the terminal is gone), at any moment.

Python's own way, an exception wherever the program happens to be, is not safe at any moment: raised while a module is
imported or an object is collected, it is printed with a traceback and forgotten. Here the run ends inside the signal
handler: what must not be left behind is removed, one line is said, and the process is gone.

Only the command line asks for that, by `end_when_told`; in anybody else's process nothing here has an effect. This
module is loaded before all others, so it imports little.
"""

import os
import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from types import FrameType

WORDS = {
    getattr(signal, name): word
    for name, word in {"SIGINT": "interrupted", "SIGTERM": "terminated", "SIGHUP": "hung up"}.items()
    if hasattr(signal, name)  # Windows has no SIGHUP
}
"""What is said of each signal that ends a run."""

FROM_TERMINALS = WORDS.keys() - {signal.SIGTERM}
"""The signals that a terminal sends to every process of a command."""

STANDARD_ERROR = 2  # the descriptor: the stream may be in the middle of a write that the signal has interrupted

_actions: list[Callable[[], object]] = []
"""What is to be done first if a signal ends the run."""

_deferred: list[list[int]] = []
"""For each section that must not be cut in two, innermost last, the signals that came meanwhile."""


def end_when_told() -> None:
    """End this process from now on, by one line and exit status 128 + number, on each signal of WORDS.

    A signal that is ignored stays so: `nohup` and a shell's background jobs ask for that.
    """
    for number in WORDS:
        if signal.getsignal(number) != signal.SIG_IGN:
            signal.signal(number, _end)


def ignore_signals() -> None:
    """Ignore the signals of WORDS from now on: what is left to do takes milliseconds."""
    for number in WORDS:
        signal.signal(number, signal.SIG_IGN)


@contextmanager
def if_stopped(action: Callable[[], object]) -> Iterator[None]:
    """Have `action` done if a signal ends the run inside this context. What it raises is dropped."""
    _actions.append(action)
    try:
        yield
    finally:
        _actions.remove(action)


@contextmanager
def signals_deferred() -> Iterator[None]:
    """Let no signal end the run inside this context: it is taken up at the end.

    A process that is started inside has the signals of FROM_TERMINALS blocked: what a terminal sends to every process
    of a command does not reach it.
    """
    came: list[int] = []
    _deferred.append(came)
    can_block = hasattr(signal, "pthread_sigmask")  # not on Windows
    if can_block:
        mask_before = signal.pthread_sigmask(signal.SIG_BLOCK, FROM_TERMINALS)
    try:
        yield
    finally:
        if can_block:
            signal.pthread_sigmask(signal.SIG_SETMASK, mask_before)
        _deferred.pop()
        if came:
            signal.raise_signal(came[0])


def _end(number: int, _frame: FrameType | None) -> None:
    """End the process, as a signal handler; nothing is unwound."""
    if _deferred:
        _deferred[-1].append(number)
        return
    ignore_signals()  # a terminal that closes may send several
    for action in reversed(_actions):
        with suppress(Exception):
            action()
    with suppress(OSError):
        os.write(STANDARD_ERROR, f"bezstab: {WORDS[number]}\n".encode())
    os._exit(128 + number)
