"""Method files: read exactly, or refused in one line."""

from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from bezstab.errors import InputError
from bezstab.methods.method_files import read_method
from bezstab.methods.orders import accuracy
from bezstab.methods.registry import lookup
from bezstab.methods.schemes import LinearMultistep, Method, RungeKutta, steps
from tests.methods import kinds
from tests.methods.random_recipes import VERLET

EBDF2 = 'rho = ["1", "-4/3", "1/3"]\nsigma = ["0", "4/3", "-2/3"]\n'
HEUN = 'A = [["0", "0"], ["1", "0"]]\nb = ["1/2", "1/2"]\n'
UPDATE = "\n[update]\n" + "".join(f'{result} = "{text}"\n' for result, text in VERLET.items())


def written(folder: Path, content: str | bytes, name: str = "own.toml") -> Path:
    path = folder / name
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return path


def test_a_file_of_equations_is_read_exactly(tmp_path: Path) -> None:
    method = read_method(written(tmp_path, 'name = "mine"\nsource = "me, 2020"\n' + UPDATE))
    assert method == Method("mine", lookup("verlet-half").scheme, "me, 2020")


def test_a_file_without_name_and_source_takes_both_from_its_path(tmp_path: Path) -> None:
    for content in (HEUN, EBDF2):
        path = written(tmp_path, content)
        method = read_method(path)
        assert (method.name, method.source) == ("own", str(path))


def listed(coefficients: Sequence[Fraction]) -> str:
    return "[" + ", ".join(f'"{c}"' for c in coefficients) + "]"


def file_content(scheme: LinearMultistep | RungeKutta) -> str:
    match scheme:
        case LinearMultistep(rho, sigma):
            return f"rho = {listed(rho)}\nsigma = {listed(sigma)}\n"
        case RungeKutta(tableau, b):
            return f"A = [{', '.join(listed(row) for row in tableau)}]\nb = {listed(b)}\n"


@pytest.mark.parametrize("name", [*kinds.MULTISTEP, *kinds.RUNGE_KUTTA])
def test_a_file_has_the_scheme_of_its_coefficients_whatever_it_is_called(name: str, tmp_path: Path) -> None:
    scheme = lookup(name).scheme
    assert isinstance(scheme, LinearMultistep | RungeKutta)
    path = written(tmp_path, f'name = "AB4"\nsource = "me"\n{file_content(scheme)}')
    assert read_method(path) == Method("AB4", scheme, "me")


def test_bare_whole_numbers_are_coefficients(tmp_path: Path) -> None:
    for content in (HEUN, EBDF2):
        bare = content
        for number in ("0", "1"):
            bare = bare.replace(f'"{number}"', number)
        assert bare != content
        assert read_method(written(tmp_path, bare)) == read_method(written(tmp_path, content))


DIGITS = "1" * 5000
REFUSED: dict[str, tuple[str | bytes, str]] = {
    "empty A": ("A = []\nb = []", ""),
    "floats": ("rho = [1.0, -1.0]\nsigma = [0.0, 1.0]", "rational strings"),
    "truth": ("rho = [true, -1]\nsigma = [0, 1]", "whole numbers and rational strings"),
    "code": ('rho = ["__import__(\'os\')", "-1"]\nsigma = ["0", "1"]', "rho"),
    "huge digits": (f'rho = ["{DIGITS}", "-{DIGITS}"]\nsigma = ["0", "{DIGITS}"]', "rho"),
    "squares beyond float64": ('A = [["0", "0"], ["1e200", "0"]]\nb = ["1/2", "1/2"]', "0 or a size of 1e-50 to 1e50"),
    "deep nesting": ("rho = " + "[" * 20000 + "]" * 20000 + "\nsigma = []", "brackets nested too deeply"),
    "stages": (f"A = {[['0'] * 21] * 21}\nb = {['1', *['0'] * 20]}", "21 stages: expected at most 20"),
    "steps": (f"rho = {['1', '-1', *['0'] * 100]}\nsigma = {['0', '1', *['0'] * 100]}", "expected at most 100"),
    "unknown key": (EBDF2 + 'order = "2"', "order"),
    "both kinds": (EBDF2 + HEUN, "found A, b, rho, sigma"),
    "no keys": ("", "found none"),
    "update: number": ("[update]\nx1 = 3", "update: 'x1' = 3: expected a text like 'x0"),
    "update: empty": ("[update]", "no equation"),
    "update: line breaks in a key": ('[update]\n"a\\nb\\u2028" = "x0"', ""),
    "update: long equation": (f'[update]\nx1 = "{"x0 + " * 50_000}x0"', ""),
    "update: 20000 equations": ("[update]\n" + "\n".join(f'w{i} = "x0"' for i in range(20_000)), "20000 equations"),
}
"""Contents, and a part of what is said of each. What a text cannot say is in test_recipes and test_second_order."""


def refusal(path: Path) -> str:
    with pytest.raises(InputError) as caught:
        read_method(path)
    message = str(caught.value)
    assert len(message.splitlines()) == 1
    return message


@pytest.mark.parametrize("case", REFUSED)
def test_a_bad_file_is_refused_in_one_line_that_names_it_and_what_is_wrong(case: str, tmp_path: Path) -> None:
    content, why = REFUSED[case]
    path = written(tmp_path, content)
    message = refusal(path)
    assert str(path) in message
    assert why in message


RADAU = """
A = [
  ["(88 - 7*sqrt(6))/360", "(296 - 169*sqrt(6))/1800", "(-2 + 3*sqrt(6))/225"],
  ["(296 + 169*sqrt(6))/1800", "(88 + 7*sqrt(6))/360", "(-2 - 3*sqrt(6))/225"],
  ["(16 - sqrt(6))/36", "(16 + sqrt(6))/36", "1/9"],
]
b = ["(16 - sqrt(6))/36", "(16 + sqrt(6))/36", "1/9"]
"""
"""Hairer & Wanner II, Table IV.5.6."""


def test_coefficients_with_roots_are_those_of_the_book(tmp_path: Path) -> None:
    """Weights that add up to one by way of the roots do so exactly, or the file would be refused."""
    own, built_in = read_method(written(tmp_path, RADAU)), lookup("radau5")
    assert isinstance(own.scheme, RungeKutta)
    assert isinstance(built_in.scheme, RungeKutta)
    for mine, theirs in zip(own.scheme.tableau, built_in.scheme.tableau, strict=True):
        assert all(abs(a - b) < Fraction(1, 10**38) for a, b in zip(mine, theirs, strict=True))
    assert own.digits == built_in.digits == 40
    assert accuracy(own)[0] == 5


def test_equations_with_roots_are_reckoned_exactly(tmp_path: Path) -> None:
    update = "[update]\na0 = 'acceleration(x0, v0)'\nv1 = 'v0 + sqrt(2)/2 a0 + (a0 - a0/sqrt(2))'\nx1 = 'x0 + v1'\n"
    own = read_method(written(tmp_path, update))
    assert np.array_equal(own.scheme.second_order.table, lookup("SYM").scheme.second_order.table)
    assert own.digits == 40


def test_a_path_that_leads_to_no_file_is_refused_in_one_line(tmp_path: Path) -> None:
    (folder := tmp_path / "folder.toml").mkdir()
    below_a_file = written(tmp_path, HEUN) / "below.toml"
    for path in (tmp_path / "missing.toml", folder, below_a_file, tmp_path / ("x" * 300 + ".toml")):
        assert str(path) in refusal(path)
    for name in ("a\nb.toml", "a\0b.toml"):
        refusal(tmp_path / name)


@settings(deadline=None)  # the file system has no bounded time
@given(st.binary(max_size=200) | st.text(alphabet='rhosigmaAb[]"=/.-0123456789eEn \n\\u', max_size=80).map(str.encode))
@example(b'rho = ["1", "-1"]\nsigma = ["0", "1"]')
def test_any_bytes_are_a_method_or_one_line_of_refusal(
    tmp_path_factory: pytest.TempPathFactory, content: bytes
) -> None:
    path = written(tmp_path_factory.getbasetemp(), content)
    try:
        method = read_method(path)
    except InputError:
        assert str(path) in refusal(path)
    else:
        assert steps(method) >= 1
