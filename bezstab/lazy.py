"""Names of a package that are loaded when first used (PEP 562), so that importing the package stays light."""

import importlib
from collections.abc import Callable, Mapping, Sequence


def lazy_names(
    package: str, names_by_module: Mapping[str, Sequence[str]], modules: Sequence[str] = ()
) -> Callable[[str], object]:
    """Return a `__getattr__` for `package` that finds each name in the module that defines it, on first use.

    The keys are modules of that package, or dotted ones of another; `modules` are those of its own modules that are
    public themselves. AttributeError for any other name. The package repeats the imports under TYPE_CHECKING, for
    tools that read instead of run; a test holds the two together.
    """
    homes = {name: module for module, names in names_by_module.items() for name in names}

    def load(name: str) -> object:
        if name in modules:
            return importlib.import_module(f"{package}.{name}")
        if name not in homes:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        module = homes[name] if "." in homes[name] else f"{package}.{homes[name]}"
        return getattr(importlib.import_module(module), name)

    return load
