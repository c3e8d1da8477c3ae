"""Names of methods: each built-in one, with or without a step multiple, and what is said of any other."""

import subprocess
import sys
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

from bezstab.errors import InputError
from bezstab.methods.method_files import read_method
from bezstab.methods.registry import GROUPS, REGISTRY, lookup

NAMES = list(REGISTRY)


def refusal(text: str) -> str:
    with pytest.raises(InputError) as caught:
        lookup(text)
    assert len(str(caught.value).splitlines()) == 1
    return str(caught.value)


def test_the_registry_holds_every_method_once_under_one_heading() -> None:
    """Which methods there are stands in test_orders."""
    assert [name for group in GROUPS for name in group.methods] == NAMES
    assert len({name.lower() for name in NAMES}) == len(NAMES)
    assert len({group.heading for group in GROUPS}) == len(GROUPS)


def test_a_registered_name_looks_up_its_method_with_its_source() -> None:
    for name in NAMES:
        method = lookup(name)
        assert method.name.partition("(")[0] == name  # what may follow are its parameters
        assert lookup(method.name) == method == REGISTRY[name]()
        assert method.source.strip()
        assert method.step_multiple == 1


def test_name_at_m_is_the_method_with_a_step_of_m_h_however_it_is_spelt() -> None:
    for name, spelt in (("B4", "b4"), ("verlet-half", "Verlet_Half"), ("RK4", "rk4")):
        for multiple in ("5", "1/2", "0.25"):
            longer = replace(lookup(name), name=f"{name}@{multiple}", step_multiple=Fraction(multiple))
            assert lookup(f"{name}@{multiple}") == lookup(f"{spelt}@{multiple}") == longer


def test_a_misspelt_name_suggests_the_right_one() -> None:
    for name in NAMES:
        assert f"did you mean {name}?" in refusal(f"{name[0]}:{name[1:]}")
    assert "did you mean B5?" in refusal("b:5@12")  # not B12


@pytest.mark.parametrize("text", ["", "@5", "x", "a\nb", "B４", *(f"RK4@{m}" for m in ("0", "", "1e7", "1e-7", "5@5"))])
def test_an_unknown_name_or_a_multiple_out_of_range_is_refused_in_one_line(text: str) -> None:
    message = refusal(text)
    assert any(repr(part) in message for part in (text.rpartition("@")[0] or text, text)) or "expected 1e-6" in message


NAMED = {
    "Newmark( 0.25 , .5 )": "newmark(beta=1/4,gamma=1/2)",
    "newmark(γ=1/2, beta = 0.25)": "newmark(beta=1/4,gamma=1/2)",
    "newmark(0,1/2)@2": "newmark(beta=0,gamma=1/2)@2",
    "hht-alpha(alpha=-0.1)": "hht(alpha=-1/10)",
    "generalized-alpha": "generalized-alpha(rho_inf=4/5)",
    "generalized_alpha(RHO_INF=1)": "generalized-alpha(rho_inf=1)",
}


def test_parameters_are_exact_and_the_name_says_them() -> None:
    assert {typed: lookup(typed).name for typed in NAMED} == NAMED
    assert all(lookup(typed) == lookup(name) for typed, name in NAMED.items())


def test_some_names_stand_for_the_same_step() -> None:
    for names in ("central-difference verlet-implicit", "bdf1 implicit-euler", "am2 trapezoid"):
        first, second = (lookup(name).scheme.second_order.table for name in names.split())
        assert np.array_equal(first, second)


@pytest.mark.parametrize(
    ("typed", "why"),
    [
        ("newmark(1/4)", "expected newmark(beta,gamma) or newmark(beta=...,gamma=...)"),
        ("newmark(1/4,1/2,1)", "expected newmark(beta,gamma)"),
        ("newmark(-1/4,1/2)", "beta = -1/4: expected 0 to 10"),
        ("newmark(1/4,x)", "gamma: 'x' is not"),
        ("hht(beta=0)", "expected hht(alpha) or hht(alpha=...)"),
        ("newmark(beta=1/4,beta=1/2)", "newmark(beta=...,gamma=...)"),
        ("Semi-Implicit-Euler(1)", "'Semi-Implicit-Euler' has no parameters"),
        ("newmark(1/4,1/2)x", "did you mean newmark"),
    ],
)
def test_bad_parameters_are_refused_in_one_line(typed: str, why: str) -> None:
    assert why in refusal(typed)


def test_naming_a_method_loads_no_algebra() -> None:
    probe = "import sys; from bezstab.methods.registry import lookup; lookup('B4'), lookup('RK4@5'), lookup('gauss4')"
    run = [sys.executable, "-c", f"{probe}; print('sympy' in sys.modules)"]
    assert subprocess.run(run, capture_output=True, text=True, check=True).stdout.strip() == "False"


def test_a_file_takes_a_step_multiple_and_an_at_sign_in_its_name_is_part_of_it(tmp_path: Path) -> None:
    path = tmp_path / "a@2.toml"
    path.write_text('rho = ["1", "-1"]\nsigma = ["0", "1"]', encoding="utf-8")
    assert lookup(str(path)) == read_method(path)
    assert lookup(f"{path}@5") == replace(read_method(path), name="a@2@5", step_multiple=Fraction(5))
