"""Processes that end when they are told to: what they do first, what they finish first."""

import signal
import subprocess
import sys
from pathlib import Path

import pytest

from bezstab.stopping import FROM_TERMINALS, WORDS, signals_deferred

ROOT = Path(__file__).parent.parent
START = """
import os, signal, sys
for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
    signal.signal(number, signal.SIG_DFL)
from bezstab.stopping import if_stopped, signals_deferred, end_when_told
end_when_told()
number = signal.Signals[sys.argv[1]]
"""


def run(code: str, name: str) -> "subprocess.CompletedProcess[str]":
    """Run code in a process of its own that ends when it is told to; `number` is the signal called `name`."""
    return subprocess.run(
        [sys.executable, "-c", START + code, name], cwd=ROOT, capture_output=True, text=True, check=False
    )


@pytest.mark.parametrize(
    ("name", "word", "status"),
    [("SIGINT", "interrupted", 130), ("SIGTERM", "terminated", 143), ("SIGHUP", "hung up", 129)],
)
def test_a_signal_ends_a_process_with_one_line(name: str, word: str, status: int) -> None:
    ended = run("signal.raise_signal(number)", name)
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


def test_what_is_to_be_done_first_is_done_last_in_first_out_whatever_fails() -> None:
    ended = run(
        """
with if_stopped(lambda: os.write(2, b"never\\n")):
    pass
with if_stopped(lambda: os.write(2, b"outer\\n")), if_stopped(lambda: 1 / 0):
    with if_stopped(lambda: os.write(2, b"inner\\n")):
        signal.raise_signal(number)
""",
        "SIGTERM",
    )
    assert ended.stderr.split() == ["inner", "outer", "bezstab:", "terminated"]


def test_a_section_is_finished_first() -> None:
    ended = run(
        """
with signals_deferred():
    with signals_deferred():
        os.kill(os.getpid(), number)
    print("finished", flush=True)
print("never")
""",
        "SIGTERM",
    )
    assert (ended.returncode, ended.stdout) == (143, "finished\n")


def test_a_process_that_is_started_in_a_section_does_not_hear_ctrl_c() -> None:
    ask = "import signal; print(sorted(signal.pthread_sigmask(signal.SIG_BLOCK, [])))"
    with signals_deferred():
        blocked = subprocess.run([sys.executable, "-c", ask], capture_output=True, text=True, check=True).stdout
    assert blocked == f"{sorted(FROM_TERMINALS)}\n"
    assert not set(WORDS) & signal.pthread_sigmask(signal.SIG_BLOCK, [])
