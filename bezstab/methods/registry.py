"""Every method by name: those built in, those in a file, and both with a step of several h."""

import re
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path

from bezstab.errors import InputError, shown
from bezstab.methods.aliases import ALIASES, folded, unknown_method
from bezstab.methods.method_files import built_in_group, read_method
from bezstab.methods.multistep_methods import EXPLICIT_MULTISTEP, IMPLICIT_MULTISTEP
from bezstab.methods.runge_kutta_methods import SOLVED_FOR
from bezstab.methods.schemes import Method
from bezstab.methods.second_order_methods import NEWMARK_AND_ALPHA, PARAMETRIC, ParametricMethod
from bezstab.rationals import rational

GROUPS = (
    *EXPLICIT_MULTISTEP,
    built_in_group(
        "explicit",
        "Runge-Kutta, explicit",
        "(SIE is the paper's 'Euler semi-implicit', not that of engines, which is SYM)",
    ),
    built_in_group("symplectic", "Symplectic and Nyström"),
    built_in_group("verlet", "Velocity Verlet, by the velocity that the feedback sees"),
    NEWMARK_AND_ALPHA,
    built_in_group("velocity", "Implicit in the velocity, of physics engines and control"),
    IMPLICIT_MULTISTEP,
    built_in_group("implicit", "Runge-Kutta, implicit", others=SOLVED_FOR),
)
"""The built-in methods as they are listed."""

REGISTRY: dict[str, Callable[[], Method]] = {
    name: make for group in GROUPS for name, make in group.methods.items()
}  # fmt: skip
"""What makes each built-in method, by its name."""


FOLDED_NAMES = {folded(name): name for name in REGISTRY}
FOLDED_PARAMETRIC = {folded(name): method for name, method in PARAMETRIC.items()}


def lookup(text: str) -> Method:
    """Return the method called `text`: a built-in name or the path of a TOML file, either with @m for a step of m h.

    'RK4', 'bdf2', 'newmark(1/4,1/2)', 'hht(alpha=-0.1)', 'own.toml', 'RK4@5' and 'own.toml@1/2' are such texts, in
    upper or lower case; parameters and m are exact, m from 1e-6 to 1e6. Other names of a method work too.
    InputError, with advice or the nearest name of the same word, if there is no such method, and for what `read_method`
    refuses.
    """
    name, at, multiple = text.rpartition("@")
    if not at or text.endswith(".toml"):  # no @, or only in a file's name
        name, at = text, ""
    method = read_method(Path(name)) if name.endswith(".toml") else _built_in(name or text)
    if not at:
        return method
    try:
        return replace(method, name=f"{method.name}@{multiple}", step_multiple=rational(multiple))
    except InputError as error:
        raise InputError(f"method {text!r}: {error}") from None


def method(name: str | Method) -> Method:
    """Return the integration method of that name.

    Parameters
    ----------
    name : str or Method
        A name as `bezstab methods` lists it ("B4", "RK4"), the path of a .toml file, or a method. "RK4@5" is RK4 with
        steps of 5 h.

    Returns
    -------
    Method
        Its `source` names the book or paper.

    Raises
    ------
    InputError
        There is no such method; the nearest name is suggested.
    """
    if not isinstance(name, str | Method):
        raise InputError(f"method {shown(name)}: expected one name such as 'B4', or what bezstab.method makes of one")
    return name if isinstance(name, Method) else lookup(name)


@cache
def _built_in(name: str) -> Method:
    """Return the built-in method of that name, in any case, with or without parameters, or by an alias."""
    if folded(name) in FOLDED_NAMES:
        return REGISTRY[FOLDED_NAMES[folded(name)]]()
    if folded(name) in ALIASES:
        return lookup(ALIASES[folded(name)])
    if with_parameters := re.fullmatch(r"([^()]+)\(([^()]*)\)", name):
        name = with_parameters[1]  # of which advice may know
        called = ALIASES.get(folded(name), name).partition("(")[0]
        if method := FOLDED_PARAMETRIC.get(folded(called)):
            return _with_parameters(method, with_parameters[2].split(","))
        if folded(called) in FOLDED_NAMES:
            raise InputError(f"method {name!r} has no parameters")
    raise unknown_method(name, [*REGISTRY, *PARAMETRIC])


def _with_parameters(method: ParametricMethod, texts: Sequence[str]) -> Method:
    """Return a method with the parameters of its name, which are given in their order or each by its name."""
    names = list(method.parameters)
    if len(texts) == len(names) and not any("=" in text for text in texts):
        texts = [f"{name}={text}" for name, text in zip(names, texts, strict=True)]
    value_of: dict[str, str] = {}
    for text in texts:
        name, _, value = text.partition("=")
        value_of[folded(name.strip())] = value
    if sorted(value_of) != sorted(map(folded, names)):
        by_name = ",".join(f"{name}=..." for name in names)
        raise InputError(f"expected {method.name}({','.join(names)}) or {method.name}({by_name})")
    values = []
    for name, (least, largest) in method.parameters.items():
        text = value_of[folded(name)]
        try:
            values.append(rational(text))
        except InputError as error:
            raise InputError(f"{method.name}: {name}: {error}") from None
        if not least <= values[-1] <= largest:
            raise InputError(f"{method.name}: {name} = {text.strip()}: expected {least} to {largest}")
    return method.having(*values)
