"""How the tests run commands in this process."""

import json
import shlex
from pathlib import Path
from typing import Any

import numpy as np
from click.testing import CliRunner, Result

from bezstab.cli.command_group import main

DATA = Path(__file__).parent / "data"


def run(*parts: str) -> Result:
    """Return what a command prints, and its exit status; its line is given in parts, each of them as in a shell."""
    return CliRunner().invoke(main, [word for part in parts for word in shlex.split(part)])


def rows(*parts: str, status: int = 0) -> list[dict[str, Any]]:
    """Return the rows that a command prints, once it has ended with this exit status."""
    result = run(*parts, "--format json")
    assert result.exit_code == status, result.stderr
    data: list[dict[str, Any]] = json.loads(result.stdout)
    return data


def arrays(path: Path) -> dict[str, Any]:
    """Return the arrays of an NPZ file by name."""
    with np.load(path) as file:
        return dict(file)
