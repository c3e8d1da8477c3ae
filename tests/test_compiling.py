import sys

import pytest

from bezstab.compiling import COMPILED_CHOICE, compiled_choice, compiler
from bezstab.errors import InputError


def test_the_environment_says_auto_yes_or_no(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv(COMPILED_CHOICE, raising=False)
    assert compiled_choice() == "auto"
    for choice in ("auto", "yes", "no"):
        monkeypatch.setenv(COMPILED_CHOICE, choice)
        assert compiled_choice() == choice
    monkeypatch.setenv(COMPILED_CHOICE, "maybe")
    with pytest.raises(InputError, match="BEZSTAB_COMPILED=maybe: expected auto, yes or no"):
        compiled_choice()


def test_a_missing_compiler_is_refused_in_a_line(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "numba", None)
    with pytest.raises(InputError, match=r"pip install 'bezstab\[fast\]'"):
        compiler()
