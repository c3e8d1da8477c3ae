"""What runs as machine code, run as the Python that it is written in: a few points take no time, and no compiler."""

import importlib.util
from types import ModuleType
from unittest.mock import patch

from bezstab import compiling


def in_python(name: str) -> ModuleType:
    """Return a module of compiled functions as one of Python's own, beside the one that is imported by its name."""
    spec = importlib.util.find_spec(name)
    assert spec
    assert spec.loader
    module = importlib.util.module_from_spec(spec)
    with patch.object(compiling, "machine_code", lambda function: function):
        spec.loader.exec_module(module)
    return module
