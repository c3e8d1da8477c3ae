"""How a run ends that is told to: by INT (Ctrl-C), TERM or HUP (the terminal is gone), at any moment.

Each raises `Stopped` wherever the program happens to be, `finally` removes what must not be left behind, and the
process ends with one line and the exit status 128 + number. Where Python cannot raise, as while an object is collected,
it ends at once.

Only the command line asks for that; in anybody else's process nothing here has an effect. This module is loaded before
all others, so it imports little.
"""

import os
import signal
import sys
from types import FrameType

WORDS = {
    getattr(signal, name): word
    for name, word in {"SIGINT": "interrupted", "SIGTERM": "terminated", "SIGHUP": "hung up"}.items()
    if hasattr(signal, name)  # Windows has no SIGHUP
}
"""What is said of each signal that ends a run."""

STANDARD_ERROR = 2  # the descriptor: the stream may be in the middle of a write that the signal has interrupted

_came: list[int] = []


class Stopped(BaseException):
    """A signal tells the run to end: no error, which `except Exception` would take for one."""


def stop_when_told() -> None:
    """Have each signal of WORDS raise Stopped from now on.

    A signal that is ignored stays so: `nohup` and a shell's background jobs ask for that.
    """
    for number in WORDS:
        if signal.getsignal(number) != signal.SIG_IGN:
            signal.signal(number, _stop)
    sys.unraisablehook = _end_or_report


def end_if_told() -> None:
    """End the process with its line and its status if a signal has come; if not, let none change what is left to do."""
    for number in WORDS:
        signal.signal(number, signal.SIG_IGN)  # a terminal that closes may send several
    if _came:
        try:
            os.write(STANDARD_ERROR, f"bezstab: {WORDS[_came[0]]}\n".encode())
        finally:
            os._exit(128 + _came[0])


def _stop(number: int, _frame: FrameType | None) -> None:
    _came.append(number)
    raise Stopped


def _end_or_report(unraisable: "sys.UnraisableHookArgs") -> None:
    """Take what Python would print and forget."""
    if isinstance(unraisable.exc_value, Stopped):
        end_if_told()
    sys.__unraisablehook__(unraisable)
