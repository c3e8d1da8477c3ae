"""Method files: read exactly, or refused in one line; a family by coefficients, whatever the name."""

from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from bezstab.errors import InputError
from bezstab.methods import (
    Family,
    LinearMultistep,
    Method,
    RungeKutta,
    accuracy,
    adams_bashforth,
    bezier,
    closed_loop_polynomial,
    implicit,
    lookup,
    read_method,
    second_order_form,
    steps,
)
from tests.methods import kinds
from tests.methods.exact_lists import fractions

NAMES = kinds.MU_METHODS


EBDF2 = 'rho = ["1", "-4/3", "1/3"]\nsigma = ["0", "4/3", "-2/3"]\n'


TRAPEZOID = 'rho = ["1", "-1"]\nsigma = ["1/2", "1/2"]\n'


VERLET = """
[update]
x1 = "x0 + v0 + 1/2 a0"
vh = "v0 + 1/2 a0"
a1 = "acceleration(x1, vh)"
v1 = "vh + 1/2 a1"
"""


HEUN = 'A = [["0", "0"], ["1", "0"]]\nb = ["1/2", "1/2"]\n'


def written(folder: Path, content: str | bytes, name: str = "own.toml") -> Path:
    path = folder / name
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return path


def test_a_multistep_file_is_read_exactly(tmp_path: Path) -> None:
    path = written(tmp_path, 'name = "mine"\nsource = "me, 2020"\n' + EBDF2)
    method = read_method(path)
    assert method == Method("mine", LinearMultistep(fractions("1 -4/3 1/3"), fractions("0 4/3 -2/3")), "me, 2020")


def test_a_butcher_file_is_read_exactly(tmp_path: Path) -> None:
    method = read_method(written(tmp_path, HEUN))
    assert method.scheme == RungeKutta((fractions("0 0"), fractions("1 0")), fractions("1/2 1/2"))


def test_a_file_of_equations_is_read_exactly(tmp_path: Path) -> None:
    method = read_method(written(tmp_path, 'name = "mine"\nsource = "me, 2020"\n' + VERLET))
    assert method == Method("mine", lookup("verlet-half").scheme, "me, 2020")


def test_what_is_implicit_is_found_not_declared(tmp_path: Path) -> None:
    assert not implicit(read_method(written(tmp_path, VERLET)))
    for content in (TRAPEZOID, VERLET.replace("x1, vh", "x1, v1"), 'A = [["1/2"]]\nb = ["1"]'):
        assert implicit(read_method(written(tmp_path, content)))


def test_the_order_of_equations_that_do_not_wait_for_each_other_does_not_matter(tmp_path: Path) -> None:
    head, *equations = VERLET.split("\n")[1:-1]
    backwards = read_method(written(tmp_path, "\n".join([head, *equations[::-1]])))
    assert not implicit(backwards)
    assert closed_loop_polynomial(backwards) == closed_loop_polynomial(lookup("verlet-half"))


def test_a_file_without_name_and_source_takes_both_from_its_path(tmp_path: Path) -> None:
    path = written(tmp_path, HEUN)
    assert (read_method(path).name, read_method(path).source) == ("own", str(path))


def listed(coefficients: Sequence[Fraction]) -> str:
    return "[" + ", ".join(f'"{c}"' for c in coefficients) + "]"


def file_content(scheme: LinearMultistep | RungeKutta) -> str:
    match scheme:
        case LinearMultistep(rho, sigma):
            return f"rho = {listed(rho)}\nsigma = {listed(sigma)}\n"
        case RungeKutta(tableau, b):
            return f"A = [{', '.join(listed(row) for row in tableau)}]\nb = {listed(b)}\n"


WRITABLE = [name for name in NAMES if isinstance(lookup(name).scheme, LinearMultistep | RungeKutta)]


@pytest.mark.parametrize("name", WRITABLE)
def test_every_multistep_and_runge_kutta_method_survives_a_file(name: str, tmp_path: Path) -> None:
    scheme = lookup(name).scheme
    assert isinstance(scheme, LinearMultistep | RungeKutta)
    assert read_method(written(tmp_path, file_content(scheme))).scheme == scheme


# Families: identity, not names


@pytest.mark.parametrize("name", WRITABLE)
@pytest.mark.parametrize("called", ["AB4", "mine"])
def test_a_file_is_of_the_family_of_its_coefficients_whatever_it_is_called(
    name: str, called: str, tmp_path: Path
) -> None:
    scheme = lookup(name).scheme
    assert isinstance(scheme, LinearMultistep | RungeKutta)
    method = read_method(written(tmp_path, f'name = "{called}"\n{file_content(scheme)}'))
    # B1 is AB1 and B2 is AB2, under whose names everybody knows them
    known = {"B1": "AB1", "B2": "AB2"}.get(name, name)
    assert method.family == lookup(known).family
    assert method.name == called


def test_a_file_with_ab4_called_b4_is_adams_bashforth_of_four_steps(tmp_path: Path) -> None:
    scheme = adams_bashforth(4).scheme
    assert isinstance(scheme, LinearMultistep)
    method = read_method(written(tmp_path, 'name = "B4"\n' + file_content(scheme)))
    assert method.family == Family("Adams-Bashforth", 4)


def test_where_two_families_share_a_member_they_share_those_of_fewer_steps() -> None:
    assert bezier(1).scheme == adams_bashforth(1).scheme
    assert bezier(2).scheme == adams_bashforth(2).scheme
    assert all(bezier(n).scheme != adams_bashforth(n).scheme for n in range(3, 13))


@pytest.mark.parametrize("content", [EBDF2, HEUN])
def test_a_method_of_its_own_has_no_family(content: str, tmp_path: Path) -> None:
    assert read_method(written(tmp_path, content)).family is None


def test_a_file_of_many_steps_is_read_at_once(tmp_path: Path) -> None:
    """Explicit Euler, its weight followed by 99 zeros: no family's weights are derived for so many steps."""
    zeros = [Fraction(0)] * 99
    rho = listed([Fraction(1), Fraction(-1), *zeros])
    sigma = listed([Fraction(0), Fraction(1), *zeros])
    content = f"rho = {rho}\nsigma = {sigma}"
    assert steps(read_method(written(tmp_path, content))) == 100


# What is refused


DIGITS = "1" * 5000


REFUSED: dict[str, str | bytes] = {
    "inconsistent: rho(1)": 'rho = ["1", "-1/2"]\nsigma = ["0", "1/2"]',
    "inconsistent: sigma(1)": 'rho = ["1", "-1"]\nsigma = ["0", "2"]',
    "inconsistent: b": 'A = [["0"]]\nb = ["2"]',
    "zero-unstable: 2": 'rho = ["1", "-3", "2"]\nsigma = ["0", "0", "-1"]',
    "zero-unstable: double 1": 'rho = ["1", "-2", "1"]\nsigma = ["0", "1", "-1"]',
    "lengths of rho and sigma": 'rho = ["1", "-1"]\nsigma = ["0", "1", "0"]',
    "lengths of A and b": 'A = [["0"]]\nb = ["1/2", "1/2"]',
    "ragged A": 'A = [["0"], ["1", "0"]]\nb = ["1/2", "1/2"]',
    "empty rho": "rho = []\nsigma = []",
    "empty A": "A = []\nb = []",
    "leading zero": 'rho = ["0", "1", "-1"]\nsigma = ["0", "0", "1"]',
    "floats": "rho = [1.0, -1.0]\nsigma = [0.0, 1.0]",
    "integers": "rho = [1, -1]\nsigma = [0, 1]",
    "TOML nan": "rho = [nan, -1.0]\nsigma = [0.0, inf]",
    "float in A": 'A = [["0", "0"], [0.5, "0"]]\nb = ["0", "1"]',
    "string for a list": 'rho = "1 -1"\nsigma = "0 1"',
    "string for A": 'A = "0"\nb = ["1"]',
    "flat A": 'A = ["0"]\nb = ["1"]',
    "number for A": 'A = 0\nb = ["1"]',
    "table for rho": '[rho]\nz = "1"\n[sigma]\nz = "1"',
    "nan": 'rho = ["nan", "-1"]\nsigma = ["0", "1"]',
    "inf": 'rho = ["1", "-1"]\nsigma = ["0", "inf"]',
    "1/0": 'rho = ["1", "-1"]\nsigma = ["0", "1/0"]',
    "code": 'rho = ["__import__(\'os\')", "-1"]\nsigma = ["0", "1"]',
    "newline in a number": 'rho = ["1\\n2", "-1"]\nsigma = ["0", "1"]',
    "huge digits": f'rho = ["{DIGITS}", "-{DIGITS}"]\nsigma = ["0", "{DIGITS}"]',
    "huge exponent": 'rho = ["1e999999999", "-1"]\nsigma = ["0", "1"]',
    "huge TOML integer": f"rho = [{DIGITS}]\nsigma = [1]",
    "deep nesting": "rho = " + "[" * 20000 + "]" * 20000 + "\nsigma = []",
    "stages": f"A = {[['0'] * 41] * 41}\nb = {['1', *['0'] * 40]}",
    "steps": f"rho = {['1', '-1', *['0'] * 100]}\nsigma = {['0', '1', *['0'] * 100]}",
    "unknown key": EBDF2 + 'order = "2"',
    "unknown key with a line break": EBDF2 + '"a\\nb" = "2"',
    "both kinds": EBDF2 + HEUN,
    "half a kind": 'rho = ["1", "-1"]',
    "A with sigma": 'A = [["0"]]\nsigma = ["1"]',
    "no keys": "",
    "only a name": 'name = "mine"',
    "name is no text": "name = 4\n" + EBDF2,
    "name is empty": 'name = ""\n' + EBDF2,
    "name of two lines": 'name = "a\\nb"\n' + EBDF2,
    "source of two lines": 'source = "a\\u2028b"\n' + EBDF2,
    "not TOML": "rho: [1, -1]\nsigma: [0, 1]",
    "duplicate key": EBDF2 + EBDF2,
    "unclosed": 'rho = ["1", "-1"\n\n',
    "raw line break in a string": 'rho = ["1\n", "-1"]',
    "impossible date": "rho = 2023-02-30",
    "binary": bytes(range(256)),
    "NUL": b"\0" * 64,
    "UTF-16": EBDF2.encode("utf-16"),
    "update: number": "[update]\nx1 = 3",
    "update: table": f'{VERLET}\n[update.x2]\ny = "1"',
    "update: list": 'update = ["x1 = x0"]',
    "update with rho": f"{EBDF2}{VERLET}",
    "update with another key": f'order = "2"\n{VERLET}',
    "update: empty": "[update]",
    "update: empty equation": '[update]\nx1 = ""',
    "update: code": "[update]\nx1 = \"__import__('os').system('true')\"",
    "update: call": '[update]\nx1 = "x0 + v0 + exec(x0)"',
    "update: attribute": '[update]\nx1 = "x0.real"',
    "update: power": '[update]\nx1 = "x0**2"',
    "update: product": '[update]\nx1 = "x0 v0"',
    "update: exponent": '[update]\nx1 = "x0 + 1e-3 v0"',
    "update: constant": '[update]\nx1 = "x0 + 1"',
    "update: division by a quantity": '[update]\nx1 = "1/x0"',
    "update: division by zero": '[update]\nx1 = "x0/0"',
    "update: a quotient by zero": '[update]\nx1 = "1/0 x0"',
    "update: another minus": '[update]\nx1 = "x0 − v0"',
    "update: another zero": '[update]\nx1 = "x0 + v０"',
    "update: NUL": '[update]\nx1 = "x0\\u0000"',
    "update: line breaks in a key": '[update]\n"a\\nb\\u2028" = "x0"',
    "update: reversed text in a key": '[update]\n"\\u202ex1" = "x0"',
    "update: long key": f'[update]\n"{"a" * 100_000}" = "x0"',
    "update: empty key": '[update]\n"" = "x0"',
    "update: long name": f'[update]\nx1 = "{"a" * 1000}"',
    "update: long equation": f'[update]\nx1 = "{"x0 + " * 50_000}x0"',
    "update: long number": f'[update]\nx1 = "{"9" * 1500} x0"',
    "update: deep": f'[update]\nx1 = "{"(" * 900}x0{")" * 900}"',
    "update: open parenthesis": '[update]\nx1 = "(x0 + v0"',
    "update: thousands of equations": "[update]\n" + "\n".join(f'w{i} = "x0"' for i in range(20_000)),
    "update: one equation twice": '[update]\nx1 = "x0"\nx1 = "x0"',
    "update: one quantity twice": VERLET + '"x[1]" = "x0"',
    "update: one quantity at two steps": VERLET + 'a0 = "acceleration(x0, v0)"',
    "update: far ahead": VERLET + '"w[99]" = "x0"',
    "update: far back": VERLET + 'w = "x[-21]"',
    "update: what nobody gives": VERLET + 'w = "x0 + u"',
    "update: what is later than given": VERLET + 'w = "a2"',
    "update: circle": '[update]\nx1 = "v1"\nv1 = "x1"\na1 = "acceleration(x1, v1)"',
    "update: itself": '[update]\nx1 = "x1"\nv1 = "v0 + a1"\na1 = "acceleration(x1, v1)"',
    "update: a sum with an acceleration": '[update]\nx1 = "x0 + acceleration(x0, v0)"',
    "update: one argument": '[update]\na1 = "acceleration(x0)"',
    "update: three arguments": '[update]\na1 = "acceleration(x0, v0, v0)"',
    "update: no step": '[update]\nx1 = "x + v0"',
    "update: no acceleration": '[update]\nx1 = "x0 + v0"\nv1 = "v0"',
    "update: no velocity": '[update]\nx1 = "x0 + a0"\na1 = "acceleration(x1, x0)"',
    "update: wrong motion": VERLET.replace("x0 + v0", "x0 + 2 v0"),
    "update: half an acceleration": VERLET.replace("vh + 1/2 a1", "vh"),
    "update: twice the velocity": '[update]\nx1="x0 + 1/2 v0"\nv1="v0 + 2 a0"\na0="acceleration(x0, 1/2 v0)"',
    "update: zero-unstable": VERLET.replace("x0 + v0 ", "3 x0 - 2 x[-1] - v0 "),
    "update: all at once": "[update]\n"
    + "".join(
        f'w{i} = "{" + ".join(f"1/{i + j + 2} w{j}[{-k}]" for j in range(9) for k in range(9) if i != j)} + x0"\n'
        for i in range(40)
    ),
}


def refusal(path: Path) -> str:
    with pytest.raises(InputError) as caught:
        read_method(path)
    return str(caught.value)


@pytest.mark.parametrize("content", REFUSED.values(), ids=REFUSED.keys())
def test_a_bad_file_is_refused_in_one_line_that_names_it(content: str | bytes, tmp_path: Path) -> None:
    path = written(tmp_path, content)
    message = refusal(path)
    assert len(message.splitlines()) == 1
    assert str(path) in message


@pytest.mark.parametrize(
    ("case", "why"),
    [
        ("inconsistent: rho(1)", r"rho\(1\) = 1/2"),
        ("inconsistent: b", "sum to 2"),
        ("zero-unstable: 2", "zero-unstable"),
        ("zero-unstable: double 1", "zero-unstable"),
        ("floats", "rho = .*rational strings"),
        ("float in A", "A = .*rational strings"),
        ("nan", "rho: 'nan'"),
        ("1/0", "sigma: '1/0'"),
        ("stages", "41 stages: expected at most 40"),
        ("steps", "101 steps: expected at most 100"),
        ("deep nesting", "brackets nested too deeply"),
        ("unknown key", "order"),
        ("half a kind", "found rho"),
        ("no keys", "found none"),
        ("name is empty", "name"),
        ("update: number", "update: 'x1' = 3: expected a text like 'x0"),
        ("update: code", r"x1 = \.\.\.: found \"'\""),
        ("update: call", r"x1 = \.\.\.: found '\('"),
        ("update: power", r"x1 = \.\.\.: found '\*', expected \+, - or the end"),
        ("update: product", "found 'v0'"),
        ("update: exponent", "found '1e-3', expected a number like 1/2 or 0.5, without exponent"),
        ("update: constant", "found the end, expected a quantity"),
        ("update: a quotient by zero", "found '1/0', expected a number"),
        ("update: another minus", "found '−'"),
        ("update: thousands of equations", "20000 equations: expected at most 60"),
        ("update: one quantity twice", "x1: a second equation for x"),
        ("update: what nobody gives", "w: no equation gives u"),
        ("update: what is later than given", "w: uses a2, but a1 is the latest there is"),
        ("update: far back", "w: uses .*20 steps back"),
        ("update: circle", "do not determine x1 and v1"),
        ("update: itself", "do not determine x1 and v1"),
        ("update: a sum with an acceleration", "found 'acceleration'"),
        ("update: one argument", "found '\\)', expected ','"),
        ("update: no step", "found 'x', expected a step with it"),
        ("update: no acceleration", "no equation evaluates the acceleration"),
        ("update: no velocity", "no equation gives v1"),
        ("update: wrong motion", "inconsistent"),
        ("update: half an acceleration", "an acceleration does not act in full"),
        ("update: twice the velocity", "v1 is not the velocity of x1"),
        ("update: zero-unstable", "zero-unstable"),
    ],
)
def test_a_refusal_says_what_is_wrong(case: str, why: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=why):
        read_method(written(tmp_path, REFUSED[case]))


SDIRK2 = """
A = [["1 - sqrt(2)/2", "0"], ["1/sqrt(2)", "(2 - sqrt(2))/2"]]
b = ["sqrt(2)/2", "1/(2 + sqrt(2))"]
"""

RADAU = """
A = [
  ["(88 - 7*sqrt(6))/360", "(296 - 169*sqrt(6))/1800", "(-2 + 3*sqrt(6))/225"],
  ["(296 + 169*sqrt(6))/1800", "(88 + 7*sqrt(6))/360", "(-2 - 3*sqrt(6))/225"],
  ["(16 - sqrt(6))/36", "(16 + sqrt(6))/36", "1/9"],
]
b = ["(16 - sqrt(6))/36", "(16 + sqrt(6))/36", "1/9"]
"""


@pytest.mark.parametrize(("content", "name"), [(SDIRK2, "sdirk2"), (RADAU, "radau5")])
def test_coefficients_with_roots_are_those_of_the_book(content: str, name: str, tmp_path: Path) -> None:
    """Weights that add up to one by way of the roots do so exactly, or the file would be refused."""
    own, built_in = read_method(written(tmp_path, content)), lookup(name)
    assert isinstance(own.scheme, RungeKutta)
    assert isinstance(built_in.scheme, RungeKutta)
    for mine, theirs in zip(own.scheme.tableau, built_in.scheme.tableau, strict=True):
        assert all(abs(a - b) < Fraction(1, 10**38) for a, b in zip(mine, theirs, strict=True))
    assert own.digits == built_in.digits == 40
    assert accuracy(own)[0] == accuracy(built_in)[0]


def test_a_multistep_file_with_roots_has_the_order_of_the_exact_method(tmp_path: Path) -> None:
    """Of order two for every c: rho = (z - 1)(z - c) with the explicit sigma that belongs to it."""
    c, of_newest, of_oldest = "1/(1 + sqrt(5))", "(3 - 1/(1 + sqrt(5)))/2", "-(1 + 1/(1 + sqrt(5)))/2"
    content = f'rho = ["1", "-1 - {c}", "{c}"]\nsigma = ["0", "{of_newest}", "{of_oldest}"]\n'
    assert accuracy(read_method(written(tmp_path, content)))[0] == 2


def test_equations_with_roots_are_reckoned_exactly(tmp_path: Path) -> None:
    update = "[update]\na0 = 'acceleration(x0, v0)'\nv1 = 'v0 + sqrt(2)/2 a0 + (a0 - a0/sqrt(2))'\nx1 = 'x0 + v1'\n"
    own = read_method(written(tmp_path, update))
    assert second_order_form(own.scheme).table == second_order_form(lookup("SYM").scheme).table
    assert own.digits == 40


@pytest.mark.parametrize(
    "content",
    [
        'rho = ["1", "-1", "0", "0"]\nsigma = ["0", "1e200", "-1e200", "1"]',
        'rho = ["1", "-1", "0", "0"]\nsigma = ["0", "1", "1e-200", "-1e-200"]',
        'A = [["0", "0"], ["1e-200", "0"]]\nb = ["1/2", "1/2"]',
    ],
)
def test_sizes_whose_squares_float64_cannot_hold_are_refused(content: str, tmp_path: Path) -> None:
    assert "expected 0 or numbers of size 1e-100 to 1e100" in refusal(written(tmp_path, content))


def test_a_missing_file_or_a_folder_is_refused_in_one_line_that_names_it(tmp_path: Path) -> None:
    (folder := tmp_path / "folder.toml").mkdir()
    below_a_file = written(tmp_path, HEUN) / "below.toml"
    for path in (tmp_path / "missing.toml", folder, below_a_file, tmp_path / ("x" * 300 + ".toml")):
        message = refusal(path)
        assert len(message.splitlines()) == 1
        assert str(path) in message


@pytest.mark.parametrize("name", ["a\nb.toml", "a\0b.toml"])
def test_a_path_with_a_control_character_is_refused_in_one_line(name: str, tmp_path: Path) -> None:
    assert len(refusal(tmp_path / name).splitlines()) == 1


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
        message = refusal(path)
        assert len(message.splitlines()) == 1
        assert str(path) in message
    else:
        assert steps(method) >= 1
