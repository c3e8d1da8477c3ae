"""Names of methods: each built-in one, with or without a step multiple, and what is said of any other."""

from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import pytest

from bezstab.errors import InputError
from bezstab.methods import REGISTRY, Family, lookup, read_method

NAMES = list(REGISTRY)


def test_the_registry_holds_every_method_of_the_theory() -> None:
    expected = {*(f"B{n}" for n in range(1, 5)), *(f"AB{n}" for n in range(1, 9)), "ABM4", "RK4", "SIE", "SYM"}
    assert expected <= set(REGISTRY)


@pytest.mark.parametrize("name", NAMES)
def test_a_registered_name_looks_up_its_method(name: str) -> None:
    method = lookup(name)
    assert method.name == name
    assert method.source.strip()
    assert method.step_multiple == 1
    assert method == REGISTRY[name]()


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("multiple", ["5", "1/2", "0.25"])
def test_name_at_m_is_the_method_with_a_step_of_m_h(name: str, multiple: str) -> None:
    method = lookup(f"{name}@{multiple}")
    assert method == replace(lookup(name), name=f"{name}@{multiple}", step_multiple=Fraction(multiple))


@pytest.mark.parametrize(
    "text", ["RK4@0", "RK4@-5", "RK4@", "RK4@nan", "RK4@1e999", "RK4@1e7", "RK4@1e-7", "RK4@5@5", "RK4@x\ny"]
)
def test_a_step_multiple_out_of_range_is_refused(text: str) -> None:
    with pytest.raises(InputError) as caught:
        lookup(text)
    assert len(str(caught.value).splitlines()) == 1


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("misspell", [str.lower, lambda name: f"{name}?", lambda name: f"{name[0]}-{name[1:]}"])
def test_a_misspelt_name_suggests_the_right_one(name: str, misspell: Callable[[str], str]) -> None:
    with pytest.raises(InputError, match=f"did you mean {name}\\?") as caught:
        lookup(misspell(name))
    assert len(str(caught.value).splitlines()) == 1


@pytest.mark.parametrize("text", ["", " ", "@", "@5", "x", "RK4 ", "B0", "B-1", "a\nb", "B４", "toml"])
def test_an_unknown_name_is_refused_in_one_line_that_names_it(text: str) -> None:
    with pytest.raises(InputError) as caught:
        lookup(text)
    assert len(str(caught.value).splitlines()) == 1
    assert repr(text.rpartition("@")[0] or text) in str(caught.value) or repr(text) in str(caught.value)


def test_a_suggestion_heeds_the_name_and_not_the_step_multiple() -> None:
    with pytest.raises(InputError, match=r"did you mean B5\?"):
        lookup("b5@12")


def test_a_file_takes_a_step_multiple(tmp_path: Path) -> None:
    path = tmp_path / "own.toml"
    path.write_text('rho = ["1", "-1"]\nsigma = ["0", "1"]', encoding="utf-8")
    assert lookup(str(path)) == read_method(path)
    assert lookup(f"{path}@5") == replace(read_method(path), name="own@5", step_multiple=Fraction(5))


@pytest.mark.parametrize(
    ("name", "family"),
    [
        ("B4", Family("Bezier", 4)),
        ("B12", Family("Bezier", 12)),
        ("AB8", Family("Adams-Bashforth", 8)),
        ("ABM3", Family("Adams-Bashforth-Moulton", 3)),
        ("RK4@5", Family("Runge-Kutta", 4)),
        ("SIE@1/2", Family("SIE", 0)),
        ("SYM", Family("symplectic Euler", 0)),
    ],
)
def test_a_built_in_method_is_of_its_family_at_any_step_multiple(name: str, family: Family) -> None:
    assert lookup(name).family == family


def test_an_at_sign_in_a_files_name_is_part_of_it(tmp_path: Path) -> None:
    path = tmp_path / "a@2.toml"
    path.write_text('rho = ["1", "-1"]\nsigma = ["0", "1"]', encoding="utf-8")
    assert lookup(str(path)).step_multiple == 1
    assert lookup(f"{path}@3").step_multiple == 3
