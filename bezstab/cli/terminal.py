"""What a terminal can show: how wide it is, and streams that take any text, whatever they were at the start."""

import io
import os
import shutil
import sys

UNLIMITED = sys.maxsize
"""Characters of a line of text where no terminal limits it, as on a pipe: there nothing wraps."""


def text_width() -> int:
    """Return how many characters a line on standard output can have: COLUMNS, else as many as the terminal has."""
    return shutil.get_terminal_size((UNLIMITED, 1)).columns


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
    if sys.stderr is None:
        sys.stderr = open(os.devnull, "w", encoding="utf-8")  # noqa: SIM115
    if sys.stdout is None:
        sys.stderr.write("bezstab: standard output is closed: there is nowhere to answer\n")
        sys.exit(2)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")
