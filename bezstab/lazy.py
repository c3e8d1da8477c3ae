"""Names of a package that are loaded when first used (PEP 562), so that importing the package stays light.

A package names them once, in imports that only tools which read, instead of run, take at once:

    if TYPE_CHECKING:
        from bezstab.methods.orders import accuracy

    __getattr__ = lazy_names(__name__)
"""

import importlib
import sys
from collections.abc import Callable, Mapping
from functools import cache


def lazy_names(package: str) -> Callable[[str], object]:
    """Return a `__getattr__` for `package` that loads, on first use, what it imports under TYPE_CHECKING.

    A name that it imports from itself is one of its modules. AttributeError for any other name; Python adds the nearest
    to its traceback.
    """

    def load(name: str) -> object:
        homes = imported_for_types(package)
        if name not in homes:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        if homes[name] == package:
            return importlib.import_module(f"{package}.{name}")
        return getattr(importlib.import_module(homes[name]), name)

    return load


@cache
def imported_for_types(package: str) -> Mapping[str, str]:
    """Return each name that a package imports from another module, under TYPE_CHECKING or at once, with that module.

    It is looked up in the compiled package: there may be no source.
    """
    import dis  # which nobody needs who uses none of these names
    from typing import Any

    loader: Any = sys.modules[package].__loader__
    home, homes = "", {}
    for each in dis.get_instructions(loader.get_code(package)):
        if each.opname == "IMPORT_NAME":
            home = each.argval
        elif each.opname == "IMPORT_FROM":
            homes[each.argval] = home
    return homes
