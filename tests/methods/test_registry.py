"""Families of methods against independent routes, names, method files, and the exact reading of numbers."""

from collections.abc import Callable, Sequence
from dataclasses import FrozenInstanceError, replace
from fractions import Fraction
from itertools import pairwise
from pathlib import Path

import mpmath as mp
import pytest
import sympy as sp
from hypothesis import example, given, settings
from hypothesis import strategies as st

from bezstab.errors import InputError
from bezstab.methods import (
    REGISTRY,
    LinearMultistep,
    Method,
    Partitioned,
    PredictorCorrector,
    RungeKutta,
    adams_bashforth,
    adams_bashforth_moulton,
    bezier,
    evaluations,
    lookup,
    read_method,
    steps,
)

NAMES = list(REGISTRY)
HALF = Fraction(1, 2)


def fractions(text: str) -> tuple[Fraction, ...]:
    return tuple(map(Fraction, text.split()))


def multistep(method: Method) -> LinearMultistep:
    assert isinstance(method.scheme, LinearMultistep)
    return method.scheme


def pece(method: Method) -> PredictorCorrector:
    assert isinstance(method.scheme, PredictorCorrector)
    return method.scheme


def runge_kutta(method: Method) -> RungeKutta:
    assert isinstance(method.scheme, RungeKutta)
    return method.scheme


def weights(method: Method) -> tuple[Fraction, ...]:
    """b_0, b_1, ... of y_{k+1} = y_k + h sum_j b_j f_{k-j}."""
    scheme = multistep(method)
    assert scheme.rho == (1, -1, *[0] * (scheme.steps - 1))
    assert scheme.sigma[0] == 0
    return scheme.sigma[1:]


# Families


@pytest.mark.parametrize(
    ("n", "expected"),
    [
        (1, "1"),
        (2, "3/2 -1/2"),
        (3, "19/12 -2/3 1/12"),
        (4, "175/108 -3/4 5/36 -1/108"),
    ],
)
def test_bezier_weights_are_those_of_theory(n: int, expected: str) -> None:
    assert weights(bezier(n)) == fractions(expected)


def test_bezier_two_is_adams_bashforth_two() -> None:
    assert bezier(2).scheme == adams_bashforth(2).scheme


def test_bezier_one_is_adams_bashforth_one() -> None:
    assert bezier(1).scheme == adams_bashforth(1).scheme


@pytest.mark.parametrize("n", range(2, 13))
def test_bezier_step_integrates_the_curve_of_de_casteljau(n: int) -> None:
    """De Casteljau's corner cutting on the control points f_{k-m}, ..., f_k, run past its end, integrated a step."""
    x = sp.Symbol("x")  # time since t_k in steps
    u = 1 + x / sp.Integer(n - 1)  # 0 at the oldest point, 1 at the newest
    for j in range(n):
        points = [sp.Poly(int(i == n - 1 - j), x, domain="QQ") for i in range(n)]
        while len(points) > 1:
            points = [sp.Poly(1 - u, x) * p + sp.Poly(u, x) * q for p, q in pairwise(points)]
        integral = points[0].integrate().eval(1)
        assert weights(bezier(n))[j] == Fraction(int(integral.p), int(integral.q))


@pytest.mark.parametrize("n", range(2, 13))
def test_bezier_weights_alternate_and_integrate_straight_lines_only(n: int) -> None:
    b = weights(bezier(n))
    assert all(b_j * (-1) ** j > 0 for j, b_j in enumerate(b))
    moments = [sum(b_j * (-j) ** p for j, b_j in enumerate(b)) for p in range(3)]
    # the Bernstein curve of t^2, t in steps, is t^2 plus the variance of the binomial law, -t (t + m)/m
    assert moments == [1, HALF, Fraction(1, 3) - (Fraction(1, 3 * (n - 1)) + HALF)]


@pytest.mark.parametrize("j", range(6))
def test_bezier_weights_converge_to_their_limit_like_one_over_m(j: int) -> None:
    """b_j -> int_0^1 e^x (-x)^j / j! dx, and m times the error to what (1 + x/m)^(m-j) m!/(m-j)!/m^j leaves of 1/m."""

    def integral(factor: Callable[[mp.mpf], mp.mpf]) -> mp.mpf:
        return mp.quad(lambda x: mp.exp(x) * (-x) ** j / mp.factorial(j) * factor(x), [0, 1])

    limit, slope = integral(lambda x: 1), integral(lambda x: -x * x / 2 - j * x - j * (j - 1) / 2)
    exact = (weights(bezier(m + 1))[j] for m in (64, 128))
    first, second = (
        m * (mp.mpf(b.numerator) / b.denominator - limit) - slope for m, b in zip((64, 128), exact, strict=True)
    )
    assert abs(second) < abs(slope) / 8
    # what is left is of order 1/m again: doubling m halves it, up to O(1/m)
    assert abs(first / second - 2) < 0.2


@pytest.mark.parametrize(
    ("n", "expected"),
    [
        (2, "3/2 -1/2"),
        (3, "23/12 -4/3 5/12"),
        (4, "55/24 -59/24 37/24 -9/24"),
        (5, "1901/720 -2774/720 2616/720 -1274/720 251/720"),
    ],
)
def test_adams_bashforth_weights_are_classical(n: int, expected: str) -> None:
    assert weights(adams_bashforth(n)) == fractions(expected)


@pytest.mark.parametrize("n", range(1, 9))
def test_adams_bashforth_integrates_every_polynomial_its_points_determine(n: int) -> None:
    b = weights(adams_bashforth(n))
    for p in range(n):
        assert sum(b_j * (-j) ** p for j, b_j in enumerate(b)) == Fraction(1, p + 1)
    assert sum(b_j * (-j) ** n for j, b_j in enumerate(b)) != Fraction(1, n + 1)


@pytest.mark.parametrize(
    ("n", "predictor", "corrector"),
    [
        (2, "3/2 -1/2", "1/2 1/2 0"),
        (3, "23/12 -4/3 5/12", "5/12 8/12 -1/12 0"),
        (4, "55/24 -59/24 37/24 -9/24", "9/24 19/24 -5/24 1/24 0"),
    ],
)
def test_adams_bashforth_moulton_weights_are_classical(n: int, predictor: str, corrector: str) -> None:
    scheme = pece(adams_bashforth_moulton(n))
    assert scheme.predictor.sigma == (0, *fractions(predictor))
    assert scheme.corrector.sigma == fractions(corrector)
    assert scheme.predictor.rho == scheme.corrector.rho == (1, -1, *[0] * (n - 1))


@pytest.mark.parametrize(
    ("name", "tableau", "b"),
    [
        ("RK1", ["0"], "1"),
        ("RK2", ["0 0", "1/2 0"], "0 1"),
        ("RK3", ["0 0 0", "1/2 0 0", "-1 2 0"], "1/6 2/3 1/6"),
        ("RK4", ["0 0 0 0", "1/2 0 0 0", "0 1/2 0 0", "0 0 1 0"], "1/6 1/3 1/3 1/6"),
        ("SIE", ["0 0", "1 0"], "0 1"),
    ],
)
def test_butcher_tableaux_are_classical(name: str, tableau: list[str], b: str) -> None:
    assert runge_kutta(lookup(name)) == RungeKutta(tuple(map(fractions, tableau)), fractions(b))


def test_symplectic_euler_takes_the_velocity_first() -> None:
    backward, forward = (
        LinearMultistep(fractions("1 -1"), fractions("1 0")),
        LinearMultistep(fractions("1 -1"), fractions("0 1")),
    )
    assert lookup("SYM").scheme == Partitioned(position=backward, velocity=forward)


def test_the_registry_holds_every_method_of_the_theory() -> None:
    expected = {*(f"B{n}" for n in range(1, 5)), *(f"AB{n}" for n in range(1, 9)), "ABM4", "RK4", "SIE", "SYM"}
    assert expected <= set(REGISTRY)


# What holds for every method


@pytest.mark.parametrize("name", NAMES)
def test_a_registered_name_looks_up_its_method(name: str) -> None:
    method = lookup(name)
    assert method.name == name
    assert method.source.strip()
    assert method.step_multiple == 1
    assert method == REGISTRY[name]()


@pytest.mark.parametrize("name", NAMES)
def test_a_method_is_frozen_data(name: str) -> None:
    method = lookup(name)
    assert hash(method) == hash(REGISTRY[name]())
    assert len({method, REGISTRY[name](), replace(method, step_multiple=Fraction(2))}) == 2
    for instance, field in ((method, "name"), (method.scheme, next(iter(method.scheme.__dataclass_fields__)))):
        with pytest.raises(FrozenInstanceError):
            setattr(instance, field, None)


@pytest.mark.parametrize("name", NAMES)
def test_every_coefficient_is_exact(name: str) -> None:
    def leaves(value: object) -> list[object]:
        if isinstance(value, tuple):
            return [leaf for entry in value for leaf in leaves(entry)]
        if hasattr(value, "__dataclass_fields__"):
            return [leaf for field in value.__dataclass_fields__ for leaf in leaves(getattr(value, field))]
        return [value]

    coefficients = leaves(lookup(name).scheme)
    assert coefficients
    assert all(type(c) is Fraction for c in coefficients)


@pytest.mark.parametrize("n", range(1, 9))
def test_an_n_step_method_keeps_n_points_and_evaluates_once(n: int) -> None:
    for family in (bezier, adams_bashforth):
        assert (steps(family(n)), evaluations(family(n))) == (n, 1)


@pytest.mark.parametrize(
    ("name", "points", "calls"), [("ABM4", 4, 2), ("RK1", 1, 1), ("RK4", 1, 4), ("SIE", 1, 2), ("SYM", 1, 1)]
)
def test_steps_and_evaluations_count_what_one_step_needs(name: str, points: int, calls: int) -> None:
    assert (steps(lookup(name)), evaluations(lookup(name))) == (points, calls)


# Schemes that cannot be built

EULER = LinearMultistep(fractions("1 -1"), fractions("0 1"))
TRAPEZE = LinearMultistep(fractions("1 -1"), fractions("1/2 1/2"))


def test_rho_is_made_monic_and_sigma_with_it() -> None:
    assert LinearMultistep(fractions("-2 2"), fractions("0 -2")) == EULER


@pytest.mark.parametrize(
    ("rho", "sigma", "why"),
    [
        ("1 -1", "0 1 0", "same number"),
        ("1", "1", "at least two"),
        ("", "", "at least two"),
        ("0 1 -1", "0 0 1", "leading coefficient of rho"),
        ("1 -1/2", "0 1/2", r"inconsistent: rho\(1\) = 1/2"),
        ("1 -1", "0 2", r"inconsistent: sigma\(1\) = 2, but rho'\(1\) = 1"),
        ("1 -1", f"0 {1 + Fraction(1, 10**20)}", "inconsistent"),
        ("1 -3 2", "0 0 -1", "zero-unstable"),  # the root 2
        ("1 4 -5", "0 4 2", "zero-unstable"),  # of order three, the classical example: the root -5
        ("1 -2 1", "0 0 0", "zero-unstable"),  # the double root 1
        ("1 -1 1 -1 0", "0 2 0 0 0", None),  # 1 and +-i, simple: weakly stable is stable
    ],
)
def test_a_multistep_method_is_consistent_and_zero_stable(rho: str, sigma: str, why: str | None) -> None:
    if why is None:
        assert LinearMultistep(fractions(rho), fractions(sigma)).steps == len(rho.split()) - 1
    else:
        with pytest.raises(InputError, match=why):
            LinearMultistep(fractions(rho), fractions(sigma))


@pytest.mark.parametrize(
    ("tableau", "b", "why"),
    [
        (["0 0", "1 0"], "1", "square"),
        (["0", "1 0"], "0 1", "square"),
        ([], "", "square"),
        (["0 0", "1/2 1/2"], "0 1", "implicit"),
        (["0 1", "0 0"], "0 1", "implicit"),
        (["1"], "1", "implicit"),
        (["0 0", "1/2 0"], "1/2 1/3", "inconsistent: the weights b sum to 5/6"),
    ],
)
def test_a_runge_kutta_method_is_explicit_and_consistent(tableau: list[str], b: str, why: str) -> None:
    with pytest.raises(InputError, match=why):
        RungeKutta(tuple(map(fractions, tableau)), fractions(b))


def wrong_pairs() -> list[Callable[[], object]]:
    two = adams_bashforth(2).scheme
    assert isinstance(two, LinearMultistep)
    return [
        lambda: PredictorCorrector(TRAPEZE, TRAPEZE),
        lambda: PredictorCorrector(EULER, EULER),
        lambda: PredictorCorrector(two, TRAPEZE),
        lambda: Partitioned(position=EULER, velocity=TRAPEZE),
        lambda: Partitioned(position=two, velocity=EULER),
        lambda: Partitioned(position=EULER, velocity=two),
        lambda: Method("M", TRAPEZE, "source"),
        lambda: Method("M", EULER, "source", Fraction(0)),
        lambda: Method("M", EULER, "source", Fraction(-1)),
    ]


@pytest.mark.parametrize("build", wrong_pairs())
def test_an_implicit_or_mismatched_pair_cannot_be_built(build: Callable[[], object]) -> None:
    with pytest.raises(InputError):
        build()


# Names


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


# Method files

EBDF2 = 'rho = ["1", "-4/3", "1/3"]\nsigma = ["0", "4/3", "-2/3"]\n'
HEUN = 'A = [["0", "0"], ["1", "0"]]\nb = ["1/2", "1/2"]\n'


def written(folder: Path, content: str | bytes, name: str = "own.toml") -> Path:
    path = folder / name
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return path


def test_a_multistep_file_is_read_exactly(tmp_path: Path) -> None:
    path = written(tmp_path, 'name = "mine"\nsource = "me, 2020"\n' + EBDF2)
    method = read_method(path)
    assert method == Method("mine", LinearMultistep(fractions("1 -4/3 1/3"), fractions("0 4/3 -2/3")), "me, 2020")
    assert lookup(str(path)) == method


def test_a_butcher_file_is_read_exactly(tmp_path: Path) -> None:
    method = read_method(written(tmp_path, HEUN))
    assert method.scheme == RungeKutta((fractions("0 0"), fractions("1 0")), fractions("1/2 1/2"))


def test_a_file_without_name_and_source_takes_both_from_its_path(tmp_path: Path) -> None:
    path = written(tmp_path, HEUN)
    assert (read_method(path).name, read_method(path).source) == ("own", str(path))


def test_a_file_takes_a_step_multiple(tmp_path: Path) -> None:
    assert lookup(f"{written(tmp_path, HEUN)}@5").step_multiple == 5


@pytest.mark.parametrize("name", NAMES)
def test_every_multistep_and_runge_kutta_method_survives_a_file(name: str, tmp_path: Path) -> None:
    def listed(coefficients: Sequence[Fraction]) -> str:
        return "[" + ", ".join(f'"{c}"' for c in coefficients) + "]"

    match lookup(name).scheme:
        case LinearMultistep(rho, sigma) as scheme:
            content = f"rho = {listed(rho)}\nsigma = {listed(sigma)}\n"
        case RungeKutta(tableau, b) as scheme:
            content = f"A = [{', '.join(map(listed, tableau))}]\nb = {listed(b)}\n"
        case PredictorCorrector() | Partitioned():
            return
    assert read_method(written(tmp_path, content)).scheme == scheme


DIGITS = "1" * 5000
REFUSED: dict[str, str | bytes] = {
    "inconsistent: rho(1)": 'rho = ["1", "-1/2"]\nsigma = ["0", "1/2"]',
    "inconsistent: sigma(1)": 'rho = ["1", "-1"]\nsigma = ["0", "2"]',
    "inconsistent: b": 'A = [["0"]]\nb = ["2"]',
    "zero-unstable: 2": 'rho = ["1", "-3", "2"]\nsigma = ["0", "0", "-1"]',
    "zero-unstable: double 1": 'rho = ["1", "-2", "1"]\nsigma = ["0", "1", "-1"]',
    "implicit sigma": 'rho = ["1", "-1"]\nsigma = ["1/2", "1/2"]',
    "implicit tableau": 'A = [["0", "0"], ["1/2", "1/2"]]\nb = ["1/2", "1/2"]',
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
        ("implicit sigma", "implicit"),
        ("implicit tableau", "implicit"),
        ("floats", "rho = .*rational strings"),
        ("float in A", "A = .*rational strings"),
        ("nan", "rho: 'nan'"),
        ("1/0", "sigma: '1/0'"),
        ("unknown key", "order"),
        ("half a kind", "found rho"),
        ("no keys", "found none"),
        ("name is empty", "name"),
    ],
)
def test_a_refusal_says_what_is_wrong(case: str, why: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=why):
        read_method(written(tmp_path, REFUSED[case]))


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
