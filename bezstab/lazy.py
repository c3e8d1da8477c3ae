"""Names of a package that are loaded when first used (PEP 562), so that importing the package stays light."""

import importlib
from collections.abc import Callable, Iterable, Mapping, Sequence


def lazy_names(
    package: str, names_by_module: Mapping[str, Sequence[str]], modules: Sequence[str] = ()
) -> Callable[[str], object]:
    """Return a `__getattr__` for `package` that finds each name in the module that defines it, on first use.

    The keys are modules of that package, or dotted ones of another; `modules` are those of its own modules that are
    public themselves. AttributeError for any other name, with the nearest. The package repeats the
    imports under TYPE_CHECKING, for tools that read instead of run; a test holds the two together.
    """
    homes = {name: module for module, names in names_by_module.items() for name in names}

    def load(name: str) -> object:
        if name in modules:
            return importlib.import_module(f"{package}.{name}")
        if name not in homes:
            # With its name given, Python adds no suggestion of its own, which only a traceback would show.
            raise AttributeError(f"module {package!r} has no attribute {name!r}{_suggestion(name, homes)}", name=name)
        module = homes[name] if "." in homes[name] else f"{package}.{homes[name]}"
        return getattr(importlib.import_module(module), name)

    return load


def _suggestion(name: str, known: Iterable[str]) -> str:
    """Return a question with the nearest known name, '' if none is near."""
    import difflib  # which nobody needs who types what there is

    near = difflib.get_close_matches(name, list(known), n=1)
    return f": did you mean {near[0]}?" if near else ""
