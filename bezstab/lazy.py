"""Names of a package that are loaded when first used (PEP 562), so that importing the package stays light.

A package names them once, in imports that only tools which read, instead of run, take at once:

    if TYPE_CHECKING:
        from bezstab.methods.orders import accuracy

    __getattr__ = lazy_names(__name__)
"""

import importlib
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
    """Return each name that a package imports under TYPE_CHECKING, with the module that has it."""
    import ast  # which nobody needs who uses none of these names
    import pkgutil

    homes: dict[str, str] = {}
    for node in ast.parse(pkgutil.get_data(package, "__init__.py") or b"").body:
        if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING":
            for each in node.body:
                if isinstance(each, ast.ImportFrom) and each.module:
                    homes |= {alias.name: each.module for alias in each.names}
    return homes
