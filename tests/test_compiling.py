import sys

import pytest

from bezstab.compiling import compiler
from bezstab.errors import InputError


def test_a_missing_compiler_is_refused_in_a_line(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "numba", None)
    with pytest.raises(InputError, match=r"pip install 'bezstab\[fast\]'"):
        compiler()
