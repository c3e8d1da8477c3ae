"""How the tests run commands in this process."""

import json
from pathlib import Path
from typing import Any

import numpy as np
from click.testing import CliRunner, Result

from bezstab.cli import main

DATA = Path(__file__).parent / "data"


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
