"""Names of methods: each built-in one, with or without a step multiple, and what is said of any other."""

import subprocess
import sys
from dataclasses import replace
from fractions import Fraction
from itertools import product
from pathlib import Path

import numpy as np
import pytest

from bezstab.errors import InputError
from bezstab.methods.method_files import read_method
from bezstab.methods.registry import GROUPS, REGISTRY, lookup
from bezstab.methods.second_order_methods import RECIPES

NAMES = list(REGISTRY)

PROMISED = """
B1 B2 B3 B4 B5 B6 B7 B8 B9 B10 B11 B12 AB1 AB2 AB3 AB4 AB5 AB6 AB7 AB8 ABM2 ABM3 ABM4 RK1 RK2 RK3 RK4 SIE SYM
implicit-euler trapezoid implicit-midpoint bdf1 bdf2 bdf3 bdf4 bdf5 bdf6 am2 am3 am4 am5 am6
fox-goodwin linear-acceleration average-acceleration central-difference hht generalized-alpha
verlet-half verlet-predicted verlet-old verlet-implicit verlet-kdk imex-euler stable-pd heun ralston ssprk3 bs3 dopri5
tsit5 cash-karp ruth3 forest-ruth yoshida4 rkn4 sdirk2 radau3 gauss4
"""


def refusal(text: str) -> str:
    with pytest.raises(InputError) as caught:
        lookup(text)
    assert len(str(caught.value).splitlines()) == 1
    return str(caught.value)


def test_the_registry_holds_every_method_once_under_one_heading() -> None:
    assert set(PROMISED.split()) <= set(REGISTRY)
    names = [name for group in GROUPS for name in group.methods]
    assert names == NAMES
    assert len({name.lower() for name in names}) == len(names)
    assert len({group.heading for group in GROUPS}) == len(GROUPS)
    assert set(RECIPES) <= set(REGISTRY)


def test_a_registered_name_looks_up_its_method_with_its_source() -> None:
    for name in NAMES:
        method = lookup(name)
        assert method.name.partition("(")[0] == name  # what may follow are its parameters
        assert lookup(method.name) == method == REGISTRY[name]()
        assert method.source.strip()
        assert method.step_multiple == 1


def test_name_at_m_is_the_method_with_a_step_of_m_h_however_it_is_spelt() -> None:
    for name, multiple in product(NAMES, ("5", "1/2", "0.25")):
        method = lookup(name)
        longer = replace(method, name=f"{method.name}@{multiple}", step_multiple=Fraction(multiple))
        spelt = (name, name.lower(), name.upper(), name.replace("-", "_"))
        assert [lookup(f"{each}@{multiple}") for each in spelt] == [longer] * 4


def test_a_misspelt_name_suggests_the_right_one() -> None:
    for name in NAMES:
        for misspelt in (f"{name}?", f"{name[0]}:{name[1:]}"):
            assert f"did you mean {name}?" in refusal(misspelt)
    assert "did you mean B5?" in refusal("b:5@12")  # not B12


@pytest.mark.parametrize(
    "text", ["", "@5", "x", "B0", "a\nb", "B４", *(f"RK4@{m}" for m in ("0", "", "1e7", "1e-7", "5@5"))]
)
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
    same = (
        "average-acceleration newmark(1/4,1/2)",
        "fox-goodwin newmark(1/12,1/2)",
        "central-difference verlet-implicit",
    )
    for names in (*same, "linear-acceleration newmark(1/6,1/2)", "bdf1 implicit-euler", "am2 trapezoid"):
        first, second = (lookup(name).scheme.second_order.table for name in names.split())
        assert np.array_equal(first, second)


@pytest.mark.parametrize(
    ("typed", "why"),
    [
        ("newmark(1/4)", "expected newmark(beta,gamma) or newmark(beta=...,gamma=...)"),
        ("newmark(1/4,1/2,1)", "expected newmark(beta,gamma)"),
        ("newmark()", "expected newmark(beta,gamma)"),
        ("newmark(-1/4,1/2)", "beta = -1/4: expected 0 to 10"),
        ("newmark(1/4,x)", "gamma: 'x' is not"),
        ("hht(1/5)", "alpha = 1/5: expected -1/3 to 0"),
        ("hht(beta=0)", "expected hht(alpha) or hht(alpha=...)"),
        ("newmark(beta=1/4,beta=1/2)", "newmark(beta=...,gamma=...)"),
        ("Semi-Implicit-Euler(1)", "'Semi-Implicit-Euler' has no parameters"),
        ("newmark(1/4,1/2)x", "did you mean newmark"),
    ],
)
def test_bad_parameters_are_refused_in_one_line(typed: str, why: str) -> None:
    assert why in refusal(typed)


def test_naming_a_method_loads_no_algebra() -> None:
    probe = (
        "import sys; from bezstab.methods.registry import lookup; [lookup(name) for name in ('B4', 'RK4@5', 'gauss4')]"
    )
    run = subprocess.run(
        [sys.executable, "-c", f"{probe}; print('sympy' in sys.modules)"], capture_output=True, text=True, check=True
    )
    assert run.stdout.strip() == "False"


def test_a_file_takes_a_step_multiple_and_an_at_sign_in_its_name_is_part_of_it(tmp_path: Path) -> None:
    for name in ("own", "a@2"):
        path = tmp_path / f"{name}.toml"
        path.write_text('rho = ["1", "-1"]\nsigma = ["0", "1"]', encoding="utf-8")
        assert lookup(str(path)) == read_method(path)
        assert lookup(f"{path}@5") == replace(read_method(path), name=f"{name}@5", step_multiple=Fraction(5))
