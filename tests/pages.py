"""What pages say that the code says already: `python -m tests.pages` writes it, and a test holds that it is fresh.

bezstab/README.md has a table of files for each room: each file with its first line, below those that it imports.
README.md has the number of engines.
"""

import ast
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path

ROOT = Path(__file__).parent.parent
PACKAGE = ROOT / "bezstab"
ROOMS = ("engines", "methods", "motion", "stability", "mechanism", "evidence", "questions", "show", "cli", "paper")
"""From data upwards: a room imports only from rooms before it."""


@cache
def tree_of(path: Path) -> ast.Module:
    """Return the syntax tree of a file of the package, given by its path in it."""
    return ast.parse((PACKAGE / path).read_text(encoding="utf-8"))


@cache
def imports(path: Path, with_types: bool = True) -> list[tuple[str, tuple[str, ...]]]:
    """Return each module that a file imports, inside functions too, with the names taken from it."""
    return list(_imports(path, with_types))


def _imports(path: Path, with_types: bool) -> Iterator[tuple[str, tuple[str, ...]]]:
    for node in _nodes(tree_of(path), with_types):
        if isinstance(node, ast.ImportFrom) and node.module:
            yield node.module, tuple(alias.name for alias in node.names)
        elif isinstance(node, ast.Import):
            for alias in node.names:
                yield alias.name, ()


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


def files_in_order(room: str) -> list[Path]:
    """Return the files of a room, each below those that it imports, else by name; ValueError for a circle."""
    files = sorted(path.relative_to(PACKAGE) for path in (PACKAGE / room).glob("[!_]*.py"))
    waiting = {path: _imported(path, room) & {other.stem for other in files} for path in files}
    ordered: list[Path] = []
    while waiting:
        ready = next((path for path, needs in waiting.items() if needs <= {done.stem for done in ordered}), None)
        if ready is None:
            raise ValueError(f"{room}: files import each other in a circle: {sorted(path.stem for path in waiting)}")
        ordered.append(ready)
        del waiting[ready]
    return ordered


def _imported(path: Path, room: str) -> set[str]:
    """Return the names of modules of a room that a file of it imports, for types too."""
    found: set[str] = set()
    for module, names in own_imports(path):
        if module == room:
            found |= set(names)
        elif module.startswith(f"{room}."):
            found.add(module.rpartition(".")[2])
    return found


def table_of(room: str) -> str:
    """Return the table of a room's files: each with the first line of its docstring."""
    lines = ["| file | owns |", "|---|---|"]
    for path in files_in_order(room):
        first = (ast.get_docstring(tree_of(path)) or "").partition("\n")[0].removesuffix(".").replace("|", "\\|")
        lines.append(f"| `{path.stem}` | {first} |")
    return "\n".join(lines)


def with_tables(page: str) -> str:
    """Return the page of the layout with the table of each room as the code has it now."""
    for room in ROOMS:
        section = re.compile(rf"(### {room}/: [^\n]*\n\n)(?:\|[^\n]*\n)+")
        if not section.search(page):
            raise ValueError(f"bezstab/README.md has no table for {room}/")
        page = section.sub(lambda found, room=room: f"{found[1]}{table_of(room)}\n", page)  # type: ignore[misc]
    return page


def with_numbers(page: str) -> str:
    """Return the first page with the number of engines as the code has it now."""
    from bezstab.engines import ENGINES

    return re.sub(r"lists \d+ engines", f"lists {len(ENGINES)} engines", page)


PAGES = {PACKAGE / "README.md": with_tables, ROOT / "README.md": with_numbers}
"""Each generated page with the function that makes it fresh."""

if __name__ == "__main__":
    for path, fresh in PAGES.items():
        path.write_text(fresh(path.read_text(encoding="utf-8")), encoding="utf-8")
