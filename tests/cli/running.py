"""How the tests run commands: in this process, or as a child that hears Ctrl-C."""

import json
import sys
from pathlib import Path
from typing import Any

import numpy as np
from click.testing import CliRunner, Result

from bezstab.cli import main


def run(*arguments: str) -> Result:
    """Return what a command prints, and its exit status."""
    return CliRunner().invoke(main, list(arguments))


def rows(*arguments: str) -> list[dict[str, object]]:
    """Return the rows that a command prints, once it has ended well."""
    result = run(*arguments, "--format", "json")
    assert result.exit_code == 0, result.stderr
    data = json.loads(result.stdout)
    assert isinstance(data, list)
    return data


def arrays(path: Path) -> dict[str, Any]:
    """Return the arrays of an NPZ file by name."""
    with np.load(path) as file:
        return dict(file)


# A child inherits an ignored SIGINT, as every job in the background of a script has it, and Python then keeps it so.
HEARS_INTERRUPTS = (
    "import signal; signal.signal(signal.SIGINT, signal.default_int_handler); from bezstab.__main__ import run; run()"
)


def interruptible(*arguments: str) -> list[str]:
    """Return the words that start a command as a child process which Ctrl-C can stop, whatever started the tests."""
    return [sys.executable, "-c", HEARS_INTERRUPTS, *arguments]
