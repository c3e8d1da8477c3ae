"""What each file of the package imports, read from its syntax tree."""

import ast
from collections.abc import Iterator
from functools import cache
from pathlib import Path

from bezstab.cli.command_group import COMMANDS

ROOT = Path(__file__).parent.parent
PACKAGE = ROOT / "bezstab"
ROOMS = (
    "engines",
    "methods",
    "motion",
    "stability",
    "mechanism",
    "questions",
    "show",
    "cli",
    "regions",
    "runs",
    "feedback",
    "catalogue",
    "chains",
    "drives",
    "step_sequences",
    "mujoco",
    "probes",
    "paper",
)
"""From data upwards: a room imports only from rooms before it."""

SUBJECTS = {
    module.split(".")[1]: name
    for listed in COMMANDS.values()
    for name, module in listed.items()
    if module.endswith(".command")
}
"""Folders of one question each, with the command that it is asked by: nobody imports them."""


@cache
def imports(path: Path, with_types: bool = True) -> list[tuple[str, tuple[str, ...]]]:
    """Return each module that a file of the package imports, inside functions too, with the names taken from it."""
    found: list[tuple[str, tuple[str, ...]]] = []
    for node in _nodes(ast.parse((PACKAGE / path).read_text(encoding="utf-8")), with_types):
        if isinstance(node, ast.ImportFrom) and node.module:
            found.append((node.module, tuple(alias.name for alias in node.names)))
        elif isinstance(node, ast.Import):
            found += [(alias.name, ()) for alias in node.names]
    return found


def _nodes(node: ast.AST, with_types: bool) -> Iterator[ast.AST]:
    for child in ast.iter_child_nodes(node):
        for_types = isinstance(child, ast.If) and getattr(child.test, "id", "") == "TYPE_CHECKING"
        if with_types or not for_types:
            yield child
            yield from _nodes(child, with_types)


def own_imports(path: Path) -> Iterator[tuple[str, tuple[str, ...]]]:
    """Yield what a file imports of the package, its first name left out: ("methods.schur", ("verdict",))."""
    for module, names in imports(path):
        if module == "bezstab":
            yield from ((name, ()) for name in names)
        elif module.startswith("bezstab."):
            yield module.removeprefix("bezstab."), names
