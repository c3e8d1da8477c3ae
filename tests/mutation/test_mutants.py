"""Mutants are what they are said to be: one change each, of what computes, and the same for the same seed."""

import ast
from collections.abc import Mapping
from difflib import SequenceMatcher
from functools import cache
from pathlib import Path

import pytest

from tests.mutation.campaign import harmless_reasons
from tests.mutation.executed_lines import ExecutedLines, rings
from tests.mutation.mutants import KINDS, ROOT, Mutant, all_mutants, sampled

every_mutant = cache(all_mutants)  # some 10,700: a second or two


@pytest.fixture
def every() -> list[Mutant]:
    return every_mutant()


def test_every_mutant_is_a_python_file_that_differs_from_the_original_in_one_place(every: list[Mutant]) -> None:
    for mutant in sampled(every, 40, seed=3):
        original = (ROOT / mutant.path).read_text(encoding="utf-8")
        assert ast.dump(ast.parse(mutant.source)) != ast.dump(ast.parse(original))
        matcher = SequenceMatcher(None, original.splitlines(), mutant.source.splitlines(), autojunk=False)
        (changed,) = [code for code in matcher.get_opcodes() if code[0] != "equal"]
        assert changed[1] + 1 == mutant.line


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


def test_what_is_listed_as_harmless_has_a_reason() -> None:
    assert all(len(reason) > 20 for reason in harmless_reasons().values())


ENERGIES = Path("bezstab/mechanism/energies.py")
OWN = "tests/mechanism/test_energies.py"
SECONDS = {
    f"{OWN}::slow": 2.0,
    f"{OWN}::quick": 0.1,
    f"{OWN}::of_something_else": 0.1,
    "other::quick": 0.01,
    "far": 1.0,
}


def mutant_of_energies(old: str, new: str) -> Mutant:
    (mutant,) = [
        mutant for mutant in every_mutant() if mutant.path == ENERGIES and mutant.key.endswith(f"| {old} -> {new}")
    ]
    return mutant


def line_of(text: str) -> int:
    lines = (ROOT / ENERGIES).read_text(encoding="utf-8").splitlines()
    (number,) = [number for number, line in enumerate(lines, start=1) if text in line]
    return number


def asked(mutant: Mutant, executed: Mapping[str, set[str]]) -> list[list[str]]:
    """Return the rings of tests where these tests execute the lines with these texts, and no others."""
    lines = {line_of(text): frozenset(tests) for text, tests in executed.items()}
    return rings(mutant, OWN, ExecutedLines(lambda path: lines if path == ENERGIES else {}), SECONDS)


def test_who_executes_the_line_is_asked_first_of_the_own_file_and_then_the_quickest() -> None:
    mutant = mutant_of_energies("2", "3")
    own, first, rest, second, third = asked(
        mutant,
        {
            "middle = (nodes - 1) // 2": {"far", "other::quick", f"{OWN}::slow", f"{OWN}::quick"},
            "weights = _interval_weights(nodes)": {"far", "another of the function"},
        },
    )
    assert own == [f"{OWN}::quick", f"{OWN}::slow"]
    assert first == ["other::quick", "far"]
    assert (rest, third) == ([], [])
    assert second == [f"{OWN}::of_something_else", "another of the function"]


def test_of_a_constant_those_are_asked_that_execute_a_line_with_its_name() -> None:
    mutant = mutant_of_energies("10", "11")
    _, first, *_ = asked(mutant, {"nodes = min(NODES, len(rates))": {"far"}, "bases = [": {"other::quick"}})
    assert first == ["far"]


def test_a_line_that_nobody_executes_is_asked_of_those_that_execute_the_module() -> None:
    mutant = mutant_of_energies("2", "3")
    own, first, _, second, third = asked(mutant, {"bases = [": {"other::quick"}})
    assert own == first == []
    assert sorted(second) == sorted(test for test in SECONDS if test.startswith(OWN))
    assert third == ["other::quick"]
