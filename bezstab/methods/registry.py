"""Every method by name: those built in, those in a file, and both with a step of several h."""

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cache, partial
from pathlib import Path

from bezstab.errors import InputError
from bezstab.methods import second_order_methods as second_order
from bezstab.methods.aliases import ALIASES, folded, unknown_method
from bezstab.methods.families import adams_bashforth, adams_bashforth_moulton, bezier
from bezstab.methods.implicit_methods import (
    adams_moulton,
    bdf,
    dirk3,
    gauss4,
    implicit_euler,
    implicit_midpoint,
    radau3,
    radau5,
    sdirk2,
    trapezoid,
)
from bezstab.methods.method_files import read_method
from bezstab.methods.one_step_methods import runge_kutta, semi_implicit_euler, symplectic_euler
from bezstab.methods.runge_kutta_pairs import (
    bogacki_shampine,
    cash_karp,
    dormand_prince,
    heun,
    ralston,
    ssprk3,
    tsitouras,
)
from bezstab.methods.schemes import Method
from bezstab.rationals import ONE, ZERO, rational

HALF = Fraction(1, 2)


@dataclass(frozen=True)
class Parameter:
    """A parameter in a method's name, and the least and largest value it takes."""

    name: str
    least: Fraction
    largest: Fraction


@dataclass(frozen=True)
class ParametricMethod:
    """A method whose name has parameters; `make` takes their values and the name."""

    name: str
    parameters: tuple[Parameter, ...]
    make: Callable[..., Method]

    def having(self, *values: Fraction) -> Method:
        """Return the method with these parameters, in their order; its name says them: hht(alpha=-1/20)."""
        said = [f"{parameter.name}={value}" for parameter, value in zip(self.parameters, values, strict=True)]
        return self.make(*values, f"{self.name}({','.join(said)})")


NEWMARK = ParametricMethod(
    "newmark",
    (Parameter("beta", ZERO, Fraction(10)), Parameter("gamma", ZERO, Fraction(10))),
    second_order.newmark,
)
HHT = ParametricMethod("hht", (Parameter("alpha", Fraction(-1, 3), ZERO),), second_order.hht)
GENERALIZED_ALPHA = ParametricMethod(
    "generalized-alpha", (Parameter("rho_inf", ZERO, ONE),), second_order.generalized_alpha
)

PARAMETRIC = {method.name: method for method in (NEWMARK, HHT, GENERALIZED_ALPHA)}
"""Methods with parameters, by name: newmark(1/4,1/2) or newmark(beta=1/4,gamma=1/2)."""


@dataclass(frozen=True)
class MethodGroup:
    """Methods that are listed together: what makes each of them, by its name; a line about their names if needed."""

    heading: str
    methods: Mapping[str, Callable[[], Method]]
    note: str = ""


def _newmark(name: str, beta: Fraction) -> Callable[[], Method]:
    return partial(second_order.newmark, beta, HALF, name)


GROUPS = (
    MethodGroup("Bézier", {f"B{n}": partial(bezier, n) for n in range(1, 13)}),
    MethodGroup("Adams-Bashforth", {f"AB{n}": partial(adams_bashforth, n) for n in range(1, 9)}),
    MethodGroup(
        "Adams-Bashforth-Moulton, predicted and corrected (PECE)",
        {f"ABM{n}": partial(adams_bashforth_moulton, n) for n in range(2, 5)},
    ),
    MethodGroup(
        "Runge-Kutta, explicit",
        {
            **{f"RK{n}": partial(runge_kutta, n) for n in range(1, 5)},
            "SIE": semi_implicit_euler,
            "heun": heun,
            "ralston": ralston,
            "ssprk3": ssprk3,
            "bs3": bogacki_shampine,
            "dopri5": dormand_prince,
            "tsit5": tsitouras,
            "cash-karp": cash_karp,
        },
        note="(SIE is the paper's 'Euler semi-implicit', not that of engines, which is SYM)",
    ),
    MethodGroup(
        "Symplectic and Nyström",
        {
            "SYM": symplectic_euler,
            "ruth3": second_order.ruth3,
            "forest-ruth": second_order.forest_ruth,
            "yoshida4": second_order.yoshida4,
            "rkn4": second_order.rkn4,
        },
    ),
    MethodGroup(
        "Velocity Verlet, by the velocity that the feedback sees",
        {
            "verlet-half": second_order.verlet_half,
            "verlet-predicted": second_order.verlet_predicted,
            "verlet-old": second_order.verlet_old,
            "verlet-implicit": second_order.verlet_implicit,
            "verlet-kdk": second_order.verlet_kdk,
        },
    ),
    MethodGroup(
        "Newmark and generalised alpha",
        {
            "average-acceleration": _newmark("average-acceleration", Fraction(1, 4)),
            "linear-acceleration": _newmark("linear-acceleration", Fraction(1, 6)),
            "fox-goodwin": _newmark("fox-goodwin", Fraction(1, 12)),
            "central-difference": _newmark("central-difference", ZERO),
            "hht": partial(HHT.having, Fraction(-1, 20)),
            "generalized-alpha": partial(GENERALIZED_ALPHA.having, Fraction(4, 5)),
        },
        note="(newmark(beta,gamma), hht(alpha=-0.1), generalized-alpha(rho_inf=0.8))",
    ),
    MethodGroup(
        "Implicit in the velocity, of physics engines and control",
        {"imex-euler": second_order.imex_euler, "stable-pd": second_order.stable_pd},
    ),
    MethodGroup(
        "Implicit multistep",
        {
            "implicit-euler": implicit_euler,
            "trapezoid": trapezoid,
            **{f"bdf{n}": partial(bdf, n) for n in range(1, 7)},
            **{f"am{n}": partial(adams_moulton, n) for n in range(2, 7)},
        },
    ),
    MethodGroup(
        "Runge-Kutta, implicit",
        {
            "implicit-midpoint": implicit_midpoint,
            "sdirk2": sdirk2,
            "dirk3": dirk3,
            "radau3": radau3,
            "radau5": radau5,
            "gauss4": gauss4,
        },
    ),
)
"""The built-in methods as they are listed."""

REGISTRY: dict[str, Callable[[], Method]] = {
    name: make for group in GROUPS for name, make in group.methods.items()
}  # fmt: skip
"""What makes each built-in method, by its name."""


FOLDED_NAMES = {folded(name): name for name in REGISTRY}


@cache
def lookup(text: str) -> Method:
    """Return the method called `text`: a built-in name or the path of a TOML file, either with @m for a step of m h.

    'RK4', 'bdf2', 'newmark(1/4,1/2)', 'hht(alpha=-0.1)', 'own.toml', 'RK4@5' and 'own.toml@1/2' are such texts, in
    upper or lower case; parameters and m are exact, m from 1e-6 to 1e6. Other names of a method work too.
    InputError, with advice or the nearest name of the same word, if there is no such method, and for what `read_method`
    refuses.
    """
    name, multiple = _split_at_multiple(text)
    method = read_method(Path(name)) if name.endswith(".toml") else _built_in(name or text)
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


def _built_in(name: str) -> Method:
    """Return the built-in method of that name, in any case, with or without parameters, or by an alias."""
    if folded(name) in FOLDED_NAMES:
        return REGISTRY[FOLDED_NAMES[folded(name)]]()
    with_parameters = re.fullmatch(r"([^()]+)\(([^()]*)\)", name)
    if with_parameters:
        word = folded(with_parameters[1])
        word = folded(ALIASES.get(word, word)).partition("(")[0]
        if word in PARAMETRIC:
            return _with_parameters(name, word, with_parameters[2].split(","))
        if word in FOLDED_NAMES:
            raise InputError(f"method {name!r}: {FOLDED_NAMES[word]} has no parameters")
        name = with_parameters[1]  # of which advice may know
    elif folded(name) in ALIASES:
        return lookup(ALIASES[folded(name)])
    raise unknown_method(name, [*REGISTRY, *PARAMETRIC])


def _with_parameters(typed: str, word: str, texts: list[str]) -> Method:
    """Return a method with the parameters of its name, which are given in their order or each by its name."""
    method = PARAMETRIC[word]
    names = ",".join(parameter.name for parameter in method.parameters)
    given = len([text for text in texts if text.strip()])
    if given != len(method.parameters):
        raise InputError(f"method {typed!r}: {given} parameters given, expected {word}({names})")
    if any("=" in text for text in texts):
        texts = _in_order(typed, method, texts)
    values = []
    for parameter, text in zip(method.parameters, texts, strict=True):
        try:
            value = rational(text)
        except InputError as error:
            raise InputError(f"method {typed!r}: {parameter.name}: {error}") from None
        if not parameter.least <= value <= parameter.largest:
            range_text = f"{parameter.least} to {parameter.largest}"
            raise InputError(f"method {typed!r}: {parameter.name} = {text.strip()}: expected {range_text}")
        values.append(value)
    return method.having(*values)


def _in_order(typed: str, method: ParametricMethod, texts: Sequence[str]) -> list[str]:
    """Return the values of texts such as 'alpha=-0.1', each of another parameter, in the order of the parameters."""
    value_of: dict[str, str] = {}
    for text in texts:
        name, _, value = text.partition("=")
        value_of[folded(name.strip())] = value
    if sorted(value_of) != sorted(folded(parameter.name) for parameter in method.parameters):
        expected = ",".join(f"{parameter.name}=..." for parameter in method.parameters)
        raise InputError(f"method {typed!r}: expected {method.name}({expected}), or the values alone")
    return [value_of[folded(parameter.name)] for parameter in method.parameters]
