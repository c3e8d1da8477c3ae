"""Method files: read exactly, or refused in one line."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from bezstab.errors import InputError
from bezstab.methods.method_files import read_method
from bezstab.methods.registry import lookup
from bezstab.methods.schemes import Method, steps
from tests.methods.random_recipes import VERLET

AB2 = 'rho = ["1", "-1", 0]\nsigma = [0, "3/2", "-0.5"]\n'
HEUN = 'A = [[0, "0"], [1, "0"]]\nb = ["1/2", "1/2"]\n'
UPDATE = "\n[update]\n" + "".join(f'{result} = "{text}"\n' for result, text in VERLET.items())


def written(folder: Path, content: str | bytes, name: str = "own.toml") -> Path:
    path = folder / name
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return path


def test_a_file_is_read_exactly_whatever_it_is_called(tmp_path: Path) -> None:
    """Whole numbers may be bare; name and source are the path's where the file has none."""
    for content, name in ((AB2, "AB2"), (HEUN, "heun"), (UPDATE, "verlet-half")):
        path = written(tmp_path, content)
        assert read_method(path) == Method("own", lookup(name).scheme, str(path))
        named = written(tmp_path, f'name = "AB4"\nsource = "me, 2020"\n{content}')
        assert read_method(named) == Method("AB4", lookup(name).scheme, "me, 2020")


def test_a_file_that_changed_is_read_anew(tmp_path: Path) -> None:
    schemes = [lookup(str(written(tmp_path, content))).scheme for content in (AB2, HEUN)]
    assert schemes == [lookup("AB2").scheme, lookup("heun").scheme]


DIGITS = "1" * 5000
REFUSED: dict[str, tuple[str | bytes, str]] = {
    "floats": ("rho = [1.0, -1.0]\nsigma = [0.0, 1.0]", "rational strings"),
    "huge digits": (f'rho = ["{DIGITS}", "-{DIGITS}"]\nsigma = ["0", "{DIGITS}"]', "rho"),
    "deep nesting": ("rho = " + "[" * 20000 + "]" * 20000 + "\nsigma = []", "brackets nested too deeply"),
    "stages": (f"A = {[['0'] * 21] * 21}\nb = {['1', *['0'] * 20]}", "21 stages: expected at most 20"),
    "both kinds": (AB2 + HEUN, "found A, b, rho, sigma"),
    "update: number": ("[update]\nx1 = 3", "update: 'x1' = 3: expected a text like 'x0"),
}
"""Contents, and a part of what is said of each. What a text cannot say is in test_recipes and test_second_order."""


def refusal(path: Path) -> str:
    with pytest.raises(InputError) as caught:
        read_method(path)
    message = str(caught.value)
    assert len(message.splitlines()) == 1
    assert str(path) in message or "\n" in str(path) or "\0" in str(path)
    return message


@pytest.mark.parametrize("case", REFUSED)
def test_a_bad_file_is_refused_in_one_line_that_names_it_and_what_is_wrong(case: str, tmp_path: Path) -> None:
    content, why = REFUSED[case]
    assert why in refusal(written(tmp_path, content))


def test_equations_with_roots_are_reckoned_exactly(tmp_path: Path) -> None:
    update = "[update]\na0 = 'acceleration(x0, v0)'\nv1 = 'v0 + sqrt(2)/2 a0 + (a0 - sqrt(0.5) a0)'\nx1 = 'x0 + v1'\n"
    own = read_method(written(tmp_path, update))
    assert np.array_equal(own.scheme.second_order.table, lookup("SYM").scheme.second_order.table)
    assert own.digits == 40


def test_a_path_that_leads_to_no_file_is_refused_in_one_line(tmp_path: Path) -> None:
    below_a_file = written(tmp_path, HEUN) / "below.toml"
    for name in ("missing.toml", "x" * 300 + ".toml", "a\0b.toml", below_a_file, tmp_path):
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
        refusal(path)
    else:
        assert steps(method) >= 1
