"""Names of methods: each built-in one, with or without a step multiple, and what is said of any other."""

import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import pytest

from bezstab.errors import InputError
from bezstab.methods import GROUPS, REGISTRY, Family, lookup, read_method, second_order_form

NAMES = list(REGISTRY)

ISSUED = """
implicit-euler trapezoid implicit-midpoint bdf1 bdf2 bdf3 bdf4 bdf5 bdf6 am2 am3 am4 am5 am6 newmark(1/4,1/2)
fox-goodwin linear-acceleration average-acceleration central-difference hht(-1/5) hht generalized-alpha(4/5)
verlet-half verlet-predicted verlet-old verlet-implicit verlet-kdk imex-euler stable-pd heun ralston ssprk3 bs3 dopri5
tsit5 cash-karp ruth3 forest-ruth yoshida4 rkn4 sdirk2 radau3 gauss4
"""


def test_the_registry_holds_every_method_of_the_theory() -> None:
    expected = {*(f"B{n}" for n in range(1, 5)), *(f"AB{n}" for n in range(1, 9)), "ABM4", "RK4", "SIE", "SYM"}
    assert expected <= set(REGISTRY)


@pytest.mark.parametrize("name", NAMES)
def test_a_registered_name_looks_up_its_method(name: str) -> None:
    method = lookup(name)
    assert method.name.partition("(")[0] == name  # what may follow are its parameters
    assert method.source.strip()
    assert method.step_multiple == 1
    assert method == REGISTRY[name]()


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("multiple", ["5", "1/2", "0.25"])
def test_name_at_m_is_the_method_with_a_step_of_m_h(name: str, multiple: str) -> None:
    method = lookup(f"{name}@{multiple}")
    assert method == replace(lookup(name), name=f"{lookup(name).name}@{multiple}", step_multiple=Fraction(multiple))


@pytest.mark.parametrize(
    "text", ["RK4@0", "RK4@-5", "RK4@", "RK4@nan", "RK4@1e999", "RK4@1e7", "RK4@1e-7", "RK4@5@5", "RK4@x\ny"]
)
def test_a_step_multiple_out_of_range_is_refused(text: str) -> None:
    with pytest.raises(InputError) as caught:
        lookup(text)
    assert len(str(caught.value).splitlines()) == 1


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("spell", [str.lower, str.upper, lambda name: name.replace("-", "_")])
def test_a_name_is_known_in_upper_and_lower_case(name: str, spell: Callable[[str], str]) -> None:
    assert lookup(spell(name)) == lookup(name)
    assert lookup(f"{spell(name)}@1/2") == lookup(f"{name}@1/2")


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("misspell", [lambda name: f"{name}?", lambda name: f"{name[0]}:{name[1:]}"])
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
        lookup("b 5@12")


@pytest.mark.parametrize("name", ISSUED.split())
def test_the_names_of_the_issue_work_as_typed(name: str) -> None:
    own = lookup(name).name
    assert own.partition("(")[0] == name.partition("(")[0]  # what follows are the parameters, each named
    for typed in (name, name.upper(), own, f"{name}@1/2"):
        method = lookup(typed)
        assert method.name == (f"{own}@1/2" if "@" in typed else own)
        assert method.scheme == lookup(name).scheme


def test_the_groups_hold_every_listed_method_once() -> None:
    names = [name for group in GROUPS for name in group.methods]
    assert names == list(REGISTRY)
    assert len({name.lower() for name in names}) == len(names)
    assert len({group.heading for group in GROUPS}) == len(GROUPS)


@pytest.mark.parametrize(
    ("typed", "name"),
    [
        ("newmark(1/4,1/2)", "newmark(beta=1/4,gamma=1/2)"),
        ("Newmark( 0.25 , .5 )", "newmark(beta=1/4,gamma=1/2)"),
        ("newmark(γ=1/2, beta = 0.25)", "newmark(beta=1/4,gamma=1/2)"),
        ("newmark", "newmark(beta=1/4,gamma=1/2)"),
        ("newmark(0,1/2)@2", "newmark(beta=0,gamma=1/2)@2"),
        ("hht", "hht(alpha=-1/20)"),
        ("HHT(-0.2)", "hht(alpha=-1/5)"),
        ("hht(alpha=-0.1)", "hht(alpha=-1/10)"),
        ("hht-alpha(-1/3)", "hht(alpha=-1/3)"),
        ("generalized-alpha", "generalized-alpha(rho_inf=4/5)"),
        ("generalized-alpha(0.8)", "generalized-alpha(rho_inf=4/5)"),
        ("generalized-alpha(rho_inf=0.8)@2", "generalized-alpha(rho_inf=4/5)@2"),
        ("Generalised-Alpha(0)", "generalized-alpha(rho_inf=0)"),
        ("generalized_alpha(RHO_INF=1)", "generalized-alpha(rho_inf=1)"),
    ],
)
def test_parameters_are_exact_and_the_name_says_them(typed: str, name: str) -> None:
    assert lookup(typed).name == name
    assert lookup(typed) == lookup(name)


@pytest.mark.parametrize(
    ("given", "explicit"),
    [
        ("newmark", "average-acceleration"),
        ("newmark(1/6,1/2)", "linear-acceleration"),
        ("newmark(1/12,1/2)", "fox-goodwin"),
        ("newmark(0,1/2)", "central-difference"),
        ("central-difference", "verlet-implicit"),
        ("hht", "hht(-1/20)"),
        ("generalized-alpha", "generalized-alpha(4/5)"),
        ("bdf1", "implicit-euler"),
        ("am2", "trapezoid"),
    ],
)
def test_some_names_stand_for_the_same_step(given: str, explicit: str) -> None:
    first, second = (second_order_form(lookup(name).scheme).table for name in (given, explicit))
    assert first == second


@pytest.mark.parametrize(
    ("typed", "why"),
    [
        ("newmark(1/4)", r"1 parameters given, expected newmark\(beta,gamma\)"),
        ("newmark()", r"0 parameters given, expected newmark\(beta,gamma\)"),
        ("newmark(1/4,1/2,0)", "3 parameters given"),
        ("newmark(-1/4,1/2)", "beta = -1/4: expected 0 to 10"),
        ("newmark(1/4,x)", "gamma: 'x' is not"),
        ("newmark(1e999,1/2)", "beta: .* outside the range"),
        ("hht(1/5)", "alpha = 1/5: expected -1/3 to 0"),
        ("hht()", r"0 parameters given, expected hht\(alpha\)"),
        ("hht(-0.34)", "alpha = -0.34: expected -1/3 to 0"),
        ("generalized-alpha(1.01)", "rho_inf = 1.01: expected 0 to 1"),
        ("generalized-alpha(1/0)", "rho_inf: '1/0' is not"),
        ("hht(beta=0)", r"expected hht\(alpha=\.\.\.\), or the values alone"),
        ("hht(alpha=)", "alpha: '' is not"),
        ("hht(alpha=1/5)", "alpha = 1/5: expected -1/3 to 0"),
        ("newmark(beta=1/4,1/2)", r"expected newmark\(beta=\.\.\.,gamma=\.\.\.\)"),
        ("newmark(beta=1/4,beta=1/2)", r"expected newmark\(beta=\.\.\.,gamma=\.\.\.\)"),
        ("SYM(1)", "SYM has no parameters"),
        ("Semi-Implicit-Euler(1)", "SYM has no parameters"),
        ("bdf2(1,2)@2", "bdf2 has no parameters"),
        ("leapfrog(2)", "which velocity"),
        ("newmark((1/4,1/2)", "did you mean newmark"),
        ("newmark(1/4,1/2)x", "did you mean newmark"),
    ],
)
def test_bad_parameters_are_refused_in_one_line(typed: str, why: str) -> None:
    with pytest.raises(InputError, match=why) as caught:
        lookup(typed)
    assert len(str(caught.value).splitlines()) == 1


@pytest.mark.parametrize("code", ["lookup('B4')", "lookup('RK4@5')", "lookup('gauss4')"])
def test_naming_a_method_loads_no_algebra(code: str) -> None:
    probe = f"import sys; from bezstab.methods import lookup; {code}; print('sympy' in sys.modules)"
    run = subprocess.run([sys.executable, "-c", probe], capture_output=True, text=True, check=True)
    assert run.stdout.strip() == "False"


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
