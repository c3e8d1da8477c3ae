r"""The house: floors (a room imports only from below), doors (through a room's __init__), walls (nobody enters paper).

cli      paper           paper is an extension: nothing imports it; the main group finds its command by name
  |        |
  api ---- show          what people type, and what they see
         |
      evidence           the only place where stability and mechanism meet
      /      |
stability  mechanism     neither knows of the other
      \      |
      methods            schemes as exact data
         |
errors, stopping, rationals, files, toml_tables, units, engines
"""

import ast
import subprocess
import sys
from pathlib import Path

import pytest

PACKAGE = Path(__file__).parent.parent / "bezstab"
ROOMS = ("methods", "stability", "mechanism", "evidence", "show", "cli", "paper")
FOUNDATIONS = {"lazy", "errors", "stopping", "rationals", "files", "toml_tables", "units", "engines"}
BELOW = {
    "methods": FOUNDATIONS,
    "stability": FOUNDATIONS | {"methods"},
    "mechanism": FOUNDATIONS | {"methods"},
    "evidence": FOUNDATIONS | {"methods", "stability", "mechanism"},
    "show": FOUNDATIONS | {"methods", "stability", "mechanism", "evidence"},
    "cli": FOUNDATIONS | {"methods", "stability", "mechanism", "evidence", "show"},
    "paper": FOUNDATIONS | {"methods", "stability", "mechanism", "evidence", "show", "cli"},
}
FILES = sorted(path.relative_to(PACKAGE) for path in PACKAGE.rglob("*.py") if path.parent != PACKAGE)


def imported(path: Path) -> set[str]:
    """Return every module of the package that a file imports, inside functions too, as dotted names."""
    names = set()
    for node in ast.walk(ast.parse((PACKAGE / path).read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and node.module and node.module.split(".")[0] == "bezstab":
            names.add(node.module.removeprefix("bezstab").removeprefix("."))
    return names


@pytest.mark.parametrize("path", FILES, ids=str)
def test_a_room_imports_only_from_below(path: Path) -> None:
    room = path.parts[0]
    others = {name.split(".")[0] for name in imported(path) if name} - {room}
    assert others <= BELOW[room]


@pytest.mark.parametrize("code", ["import bezstab", "from bezstab.cli import main; main(['--help'])"])
def test_import_and_help_are_light(code: str) -> None:
    heavy = "{'sympy', 'matplotlib', 'mujoco', 'distributed'}"
    probe = f"import atexit, sys; atexit.register(lambda: print('heavy:', {heavy} & set(sys.modules)))\n"
    run = subprocess.run([sys.executable, "-c", probe + code], capture_output=True, text=True, check=True)
    assert run.stdout.rstrip().endswith("heavy: set()")
