"""What the shell offers after a press of the tab key."""

import pytest
from click.shell_completion import ShellComplete

from bezstab.cli.command_group import main
from bezstab.mechanism.scene_files import shipped_scenes
from bezstab.methods.registry import REGISTRY


def completions(words: str) -> list[str]:
    """Return what is offered for the last word: names, or what shells look for among files."""
    *before, incomplete = words.split(" ")
    shell = ShellComplete(main, {}, "bezstab", "_BEZSTAB_COMPLETE")
    return [str(item.value) for item in shell.get_completions(before, incomplete)]


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        ("methods rk", [name for name in REGISTRY if name.lower().startswith("rk")]),
        ("simulate --scene ", list(shipped_scenes())),
        ("check --engine muj", ["mujoco="]),
        ("trad", ["tradeoff"]),
        ("methods own/meth", ["own/meth"]),
    ],
)
def test_names_are_completed(words: str, expected: list[str]) -> None:
    assert completions(words) == expected
