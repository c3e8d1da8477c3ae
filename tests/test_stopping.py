"""Processes that end when they are told to: by what line and status, and after what."""

import signal
import subprocess
import sys
from pathlib import Path
from textwrap import indent

import pytest

from bezstab.runs.parallel import _deaf_to_terminals

ROOT = Path(__file__).parent.parent
RAISE = "signal.raise_signal(number)"
START = """
import os, signal, sys
for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
    signal.signal(number, signal.SIG_DFL)
from bezstab.stopping import Stopped, end_if_told, stop_when_told
stop_when_told()
number = signal.Signals[sys.argv[1]]
try:
"""


def run(code: str, name: str) -> "subprocess.CompletedProcess[str]":
    """Run code in a process of its own that ends when it is told to; `number` is the signal called `name`."""
    return subprocess.run(
        [sys.executable, "-c", f"{START}{indent(code, '    ')}\nfinally:\n    end_if_told()", name],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )


@pytest.mark.parametrize(
    ("name", "word", "status"),
    [("SIGINT", "interrupted", 130), ("SIGTERM", "terminated", 143), ("SIGHUP", "hung up", 129)],
)
def test_a_signal_ends_a_process_with_one_line(name: str, word: str, status: int) -> None:
    ended = run(RAISE, name)
    assert (ended.returncode, ended.stdout, ended.stderr) == (status, "", f"bezstab: {word}\n")


def test_before_there_is_a_handler_an_interrupt_is_one_line_too() -> None:
    """Ctrl-C while the module that makes the handlers is looked for, the first of the command line's."""
    early = """
import sys
class Interrupted:
    def find_spec(self, name, path, target=None):
        if name == "bezstab.stopping":
            raise KeyboardInterrupt
sys.meta_path.insert(0, Interrupted())
import bezstab.__main__
"""
    ended = subprocess.run([sys.executable, "-c", early], cwd=ROOT, capture_output=True, text=True, check=False)
    assert (ended.returncode, ended.stdout, ended.stderr) == (130, "", "bezstab: interrupted\n")


def test_even_where_python_would_forget_an_exception() -> None:
    ended = run("class A:\n    def __del__(self): signal.raise_signal(number)\nA()\nprint('still here')", "SIGINT")
    assert (ended.returncode, ended.stdout, ended.stderr) == (130, "", "bezstab: interrupted\n")


def test_what_must_not_be_left_behind_goes_first_whatever_else_comes() -> None:
    ended = run(
        """
try:
    signal.raise_signal(number)
except Exception:
    print("an error")
finally:
    print("gone", flush=True)
print("never")
""",
        "SIGTERM",
    )
    assert (ended.returncode, ended.stdout, ended.stderr) == (143, "gone\n", "bezstab: terminated\n")


@pytest.mark.parametrize(
    ("code", "status", "said"),
    [
        (
            f"try:\n    {RAISE}\nexcept BaseException:\n    raise ImportError from None",
            130,
            "interrupted",
        ),  # as libraries
        ("raise SystemExit(3)", 3, ""),  # it was not told
        # ignored before, as nohup does
        ("signal.signal(number, signal.SIG_IGN)\nstop_when_told()\n" + RAISE, 0, ""),
    ],
)
def test_it_ends_as_it_was_told_to(code: str, status: int, said: str) -> None:
    ended = run(code, "SIGINT")
    assert (ended.returncode, ended.stderr) == (status, f"bezstab: {said}\n" if said else "")


def test_a_process_that_is_started_for_chunks_does_not_hear_a_terminal() -> None:
    ask = "import signal; print(sorted(signal.pthread_sigmask(signal.SIG_BLOCK, [])))"
    with _deaf_to_terminals():
        blocked = subprocess.run([sys.executable, "-c", ask], capture_output=True, text=True, check=True).stdout
    assert blocked == f"{sorted((signal.SIGINT, signal.SIGHUP))}\n"
    assert not signal.pthread_sigmask(signal.SIG_BLOCK, [])
