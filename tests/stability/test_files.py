"""The files of the room, in the order in which its door lists them."""

import ast
from pathlib import Path

import pytest

import bezstab.stability

ROOM = Path(bezstab.stability.__file__).parent
LISTED = [line.split()[0] for line in (bezstab.stability.__doc__ or "").splitlines() if line.startswith("    ")]


def test_the_door_lists_every_file() -> None:
    assert sorted(LISTED) == sorted(path.stem for path in ROOM.glob("*.py") if path.stem != "__init__")


@pytest.mark.parametrize("name", LISTED)
def test_a_file_imports_only_from_those_above_it(name: str) -> None:
    tree = ast.parse((ROOM / f"{name}.py").read_text(encoding="utf-8"))
    modules = {node.module or "" for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)}
    inside = {module.rpartition(".")[2] for module in modules if module.startswith("bezstab.stability")}
    assert inside <= set(LISTED[: LISTED.index(name)])
