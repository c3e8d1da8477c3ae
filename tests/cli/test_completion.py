"""What the shell offers after a press of the tab key."""

import pytest
from click.shell_completion import ShellComplete

from bezstab.cli.command_group import main
from bezstab.mechanism.scene_files import shipped_scenes
from bezstab.methods.registry import REGISTRY


def completions(words: str, kind: str = "plain") -> list[str]:
    """Return what is offered for the last word, of the kind that shells know as "plain" or "file"."""
    *before, incomplete = words.split(" ")
    shell = ShellComplete(main, {}, "bezstab", "_BEZSTAB_COMPLETE")
    return [str(item.value) for item in shell.get_completions(before, incomplete) if item.type == kind]


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        ("methods rk", [name for name in REGISTRY if name.lower().startswith("rk")]),
        ("simulate --scene ", list(shipped_scenes())),
        ("check --engine muj", ["mujoco="]),
        ("trad", ["tradeoff"]),
        ("poles --alpha 1", []),
    ],
)
def test_names_are_completed(words: str, expected: list[str]) -> None:
    assert completions(words) == expected


def test_every_method_is_offered_and_files_where_no_name_fits() -> None:
    assert set(REGISTRY) <= set(completions("methods "))
    assert (completions("methods own/meth"), completions("methods own/meth", "file")) == ([], ["own/meth"])
