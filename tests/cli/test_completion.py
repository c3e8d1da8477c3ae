"""What the shell offers after a press of the tab key."""

import os
import subprocess
import sys

import pytest
from click.shell_completion import CompletionItem, ShellComplete

from bezstab.cli import main
from bezstab.cli.completion import QuotingBash, offered
from bezstab.engines import ENGINES
from bezstab.mechanism import shipped_scenes
from bezstab.methods import REGISTRY, lookup


def completions(*words: str) -> list[str]:
    """Return what is offered for the last word."""
    *before, incomplete = words
    shell = ShellComplete(main, {}, "bezstab", "_BEZSTAB_COMPLETE")
    return [str(item.value) for item in shell.get_completions(before, incomplete) if item.type == "plain"]


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (("methods", "verlet-h"), ["verlet-half"]),
        (("methods", "rk"), [name for name in REGISTRY if name.lower().startswith("rk")]),
        (("poles", "--method", "newm"), ["newmark(1/4,1/2)"]),
        (("simulate", "--method", "gen"), ["generalized-alpha", "generalized-alpha(4/5)"]),
        (("simulate", "--scene", ""), list(shipped_scenes())),
        (("poles", "--scene", "four"), ["four_bar"]),
        (("choose", "--engine", "bul"), ["bullet"]),
        (("check", "--engine", "muj"), ["mujoco="]),
        (("family", "ad"), ["adams-bashforth"]),
        (("schema", "cho"), ["choose"]),
        (("sche",), ["schema"]),
        (("poles", "--alpha", "1"), []),
    ],
)
def test_names_are_completed(words: tuple[str, ...], expected: list[str]) -> None:
    assert completions(*words) == expected


def test_every_method_scene_and_engine_is_offered_and_is_one() -> None:
    offered_methods = completions("methods", "")
    assert set(REGISTRY) <= set(offered_methods)
    assert all(lookup(name) for name in offered_methods)
    assert completions("engines", "--al") == ["--alpha"]
    assert completions("choose", "--engine", "") == list(ENGINES)


def test_where_no_name_fits_the_shell_completes_files() -> None:
    assert [(item.value, item.type) for item in offered(["B4"], "own/meth")] == [("own/meth", "file")]


def test_bash_is_offered_what_it_can_read() -> None:
    assert QuotingBash(main, {}, "bezstab", "x").format_completion(CompletionItem("hht(-1/20)")) == "plain,'hht(-1/20)'"
    environment = {
        **os.environ,
        "_BEZSTAB_COMPLETE": "bash_complete",
        "COMP_WORDS": "bezstab methods newm",
        "COMP_CWORD": "2",
    }
    code = "import sys; sys.argv = ['bezstab']; from bezstab.__main__ import run; run()"
    shell = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True)
    assert shell.stdout.split() == ["plain,'newmark(1/4,1/2)'"]
