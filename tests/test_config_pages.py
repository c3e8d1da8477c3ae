"""The pages of configs/ document exactly the keys that the parsers know, and their examples run."""

import re
import tomllib
from collections import defaultdict
from pathlib import Path
from typing import Any

import pytest

from bezstab.mechanism.equations import compiled_mechanism
from bezstab.mechanism.runner import simulate
from bezstab.mechanism.scene_files import parse_scene
from bezstab.methods.derivation import closed_loop_polynomial
from bezstab.methods.method_files import read_method
from bezstab.methods.orders import accuracy
from bezstab.methods.registry import lookup
from bezstab.methods.schemes import steps
from bezstab.toml_tables import TomlTable

CONFIGS = Path(__file__).parent.parent / "configs"
METHODS_PAGE = (CONFIGS / "methods" / "README.md").read_text(encoding="utf-8")
SCENES_PAGE = (CONFIGS / "scenes" / "README.md").read_text(encoding="utf-8")


def examples(page: str) -> list[str]:
    return re.findall(r"```toml\n(.*?)```", page, re.DOTALL)


def documented_keys(text: str) -> set[str]:
    """Return the keys that begin an item of a list."""
    return set(re.findall(r"^- `(\w+)`: ", text, re.MULTILINE))


@pytest.fixture
def asked_keys(monkeypatch: pytest.MonkeyPatch) -> dict[str, set[str]]:
    """What the parsers ask for from here on, by the first word of the place."""
    asked: dict[str, set[str]] = defaultdict(set)
    entry = TomlTable.entry

    def noted(table: TomlTable, key: str, *arguments: Any, **options: Any) -> Any:
        asked[table.where.partition(" ")[0]].add(key)
        return entry(table, key, *arguments, **options)

    monkeypatch.setattr(TomlTable, "entry", noted)
    return asked


def test_a_shipped_method_has_its_order() -> None:
    orders = {path.stem: accuracy(read_method(path))[0] for path in (CONFIGS / "methods").glob("*.toml")}
    assert orders == {"ebdf2": 2, "ssprk3": 3, "verlet_half": 1, "houbolt": 2, "lobatto": 2}


def test_the_page_of_methods_has_every_key_and_no_other_and_its_examples_have_closed_loops(
    asked_keys: dict[str, set[str]], tmp_path: Path
) -> None:
    """A multistep method has two roots for each step; the helper of the running mean is one root more."""
    for example in examples(METHODS_PAGE):
        (path := tmp_path / "own.toml").write_text(example, encoding="utf-8")
        method = read_method(path)
        assert closed_loop_polynomial(method).degree() == (3 if "mean" in example else 2 * steps(method))
    assert documented_keys(METHODS_PAGE) == asked_keys[""] == {"name", "source", "rho", "sigma", "A", "b", "update"}


def test_the_page_of_scenes_has_every_key_of_every_table_and_no_other_and_its_examples_take_a_step(
    asked_keys: dict[str, set[str]],
) -> None:
    for example in examples(SCENES_PAGE):
        mechanism = compiled_mechanism(parse_scene(tomllib.loads(example)))
        run = simulate(mechanism, lookup("RK4"), h=1e-3, duration=1e-3, gains=(0.0, 0.0))
        assert (run.failure, len(run.t)) == (None, 2)
    sections = re.findall(r"^## (.*?)\n(.*?)(?=^## |\Z)", SCENES_PAGE, re.MULTILINE | re.DOTALL)
    assert {place: keys for place, text in sections if (keys := documented_keys(text))} == asked_keys
