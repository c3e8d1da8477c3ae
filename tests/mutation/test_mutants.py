"""Mutants are what they are said to be: one change each, of what computes, and the same for the same seed."""

import ast
from difflib import SequenceMatcher
from functools import cache
from pathlib import Path

import pytest

from tests.mutation import campaign
from tests.mutation.mutants import KINDS, ROOT, Mutant, all_mutants, sampled

every_mutant = cache(all_mutants)  # some 10,700: a second or two


@pytest.fixture
def every() -> list[Mutant]:
    return every_mutant()


@pytest.mark.slow
def test_every_mutant_is_a_python_file_that_differs_from_the_original_in_one_place(every: list[Mutant]) -> None:
    for mutant in sampled(every, 40, seed=3):
        original = (ROOT / mutant.path).read_text(encoding="utf-8")
        assert ast.dump(ast.parse(mutant.source)) != ast.dump(ast.parse(original))
        matcher = SequenceMatcher(None, original.splitlines(), mutant.source.splitlines(), autojunk=False)
        (changed,) = [code for code in matcher.get_opcodes() if code[0] != "equal"]
        assert changed[1] + 1 == mutant.line


@pytest.mark.slow
def test_keys_tell_mutants_apart(every: list[Mutant]) -> None:
    assert len({mutant.key for mutant in every}) == len(every)


def test_a_sample_has_as_many_of_each_kind_and_is_the_same_for_the_same_seed(
    every: list[Mutant],
) -> None:
    sample = sampled(every, 201, seed=1)
    counts = [sum(mutant.kind == kind for mutant in sample) for kind in KINDS]
    assert sorted(counts) == [50, 50, 50, 51]
    assert sample == sampled(every[::-1], 201, seed=1)
    assert {mutant.key for mutant in sampled(every, 100, seed=1)} < {mutant.key for mutant in sample}
    assert sample != sampled(every, 201, seed=2)


@pytest.mark.parametrize(("status", "expected"), [(1, "caught"), (2, "caught"), (0, "survived"), (5, "survived")])
def test_a_mutant_is_caught_if_a_test_fails_on_it_and_the_tree_is_itself_again(
    every: list[Mutant], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, status: int, expected: str
) -> None:
    mutant = every[0]
    changed = tmp_path / mutant.path
    changed.parent.mkdir(parents=True)
    changed.write_text("the original", encoding="utf-8")

    def tests_of(tree: Path, *options: str, seconds: float | None = None) -> int:
        assert (tree / mutant.path).read_text(encoding="utf-8") == mutant.source
        return status

    monkeypatch.setattr(campaign, "quick_tests", tests_of)
    assert campaign.outcome(mutant, tmp_path, seconds=1.0) == expected
    assert changed.read_text(encoding="utf-8") == "the original"
