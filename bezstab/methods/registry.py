"""Every method by name: those built in, those in a file, and both with a step of several h."""

from collections.abc import Callable
from dataclasses import replace
from functools import cache, partial
from pathlib import Path

from bezstab.errors import InputError, unknown_name
from bezstab.methods.families import adams_bashforth, adams_bashforth_moulton, bezier
from bezstab.methods.method_files import read_method
from bezstab.methods.one_step_methods import runge_kutta, semi_implicit_euler, symplectic_euler
from bezstab.methods.schemes import Method
from bezstab.rationals import rational

REGISTRY: dict[str, Callable[[], Method]] = {
    **{f"B{n}": partial(bezier, n) for n in range(1, 13)},
    **{f"AB{n}": partial(adams_bashforth, n) for n in range(1, 9)},
    **{f"ABM{n}": partial(adams_bashforth_moulton, n) for n in range(2, 5)},
    **{f"RK{n}": partial(runge_kutta, n) for n in range(1, 5)},
    "SIE": semi_implicit_euler,
    "SYM": symplectic_euler,
}
"""What makes each built-in method, by its name."""


@cache
def lookup(text: str) -> Method:
    """Return the method called `text`: a built-in name or the path of a TOML file, either with @m for a step of m h.

    'RK4', 'own.toml', 'RK4@5' and 'own.toml@1/2' are such texts; m is exact, from 1e-6 to 1e6.
    InputError, with the nearest name, if there is no such method, and for what `read_method` refuses.
    """
    name, multiple = _split_at_multiple(text)
    if name.endswith(".toml"):
        method = read_method(Path(name))
    elif name in REGISTRY:
        method = REGISTRY[name]()
    else:
        raise unknown_name("method", name or text, REGISTRY)
    if multiple is None:
        return method
    try:
        return replace(method, name=f"{method.name}@{multiple}", step_multiple=rational(multiple))
    except InputError as error:
        raise InputError(f"method {text!r}: {error}") from None


def _split_at_multiple(text: str) -> tuple[str, str | None]:
    """Return what stands before and after the last @; None if there is none, or only in a file's name."""
    if "@" not in text or text.endswith(".toml"):
        return text, None
    name, _, multiple = text.rpartition("@")
    return name, multiple
