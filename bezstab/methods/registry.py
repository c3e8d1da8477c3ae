"""Explicit integration methods as exact, frozen data that checks itself at birth; families, names and files."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cache, partial
from math import comb, prod
from pathlib import Path

from bezstab.errors import InputError, unknown_name
from bezstab.files import read_toml
from bezstab.methods.schur import recursion_verdict
from bezstab.rationals import rational

Coefficients = tuple[Fraction, ...]

ONE, ZERO = Fraction(1), Fraction(0)


@dataclass(frozen=True)
class LinearMultistep:
    """rho(E) y = h sigma(E) f: coefficients in descending powers of z, rho monic after construction.

    InputError unless the method is consistent (rho(1) = 0, sigma(1) = rho'(1)) and zero-stable (the roots of rho in
    the closed unit disc, those on the circle simple): Hairer, Norsett & Wanner I, section III.2-3.
    """

    rho: Coefficients
    sigma: Coefficients

    def __post_init__(self) -> None:
        if len(self.rho) != len(self.sigma) or len(self.rho) < 2:
            raise InputError("rho and sigma must have the same number of coefficients, at least two")
        if self.rho[0] == 0:
            raise InputError("the leading coefficient of rho is 0")
        if sum(self.rho) != 0:
            raise InputError(f"inconsistent: rho(1) = {sum(self.rho)}, not 0")
        slope = sum(((self.steps - i) * a for i, a in enumerate(self.rho)), ZERO)
        if sum(self.sigma) != slope:
            raise InputError(f"inconsistent: sigma(1) = {sum(self.sigma)}, but rho'(1) = {slope}")
        if recursion_verdict(self.rho) == "diverges":
            raise InputError("zero-unstable: rho has a root outside the unit circle, or a repeated one on it")
        leading = self.rho[0]
        object.__setattr__(self, "rho", tuple(a / leading for a in self.rho))
        object.__setattr__(self, "sigma", tuple(b / leading for b in self.sigma))

    @property
    def steps(self) -> int:
        """The number of past values one step uses."""
        return len(self.rho) - 1

    @property
    def implicit(self) -> bool:
        """Whether f at the new point enters the step."""
        return self.sigma[0] != 0


@dataclass(frozen=True)
class PredictorCorrector:
    """PECE: the explicit predictor's value is evaluated once for the implicit corrector, whose value is evaluated."""

    predictor: LinearMultistep
    corrector: LinearMultistep

    def __post_init__(self) -> None:
        if self.predictor.implicit or not self.corrector.implicit or self.predictor.steps != self.corrector.steps:
            raise InputError("a predictor-corrector needs an explicit predictor, an implicit corrector, equal steps")


@dataclass(frozen=True)
class RungeKutta:
    """An explicit Runge-Kutta method by its Butcher tableau (A strictly lower triangular, weights b).

    InputError unless it is explicit and consistent (the weights sum to one).
    """

    tableau: tuple[Coefficients, ...]
    weights: Coefficients

    def __post_init__(self) -> None:
        stages = len(self.weights)
        if stages == 0 or len(self.tableau) != stages or any(len(row) != stages for row in self.tableau):
            raise InputError(f"A must be square with a row for each of the {stages} weights b")
        if any(a != 0 for i, row in enumerate(self.tableau) for a in row[i:]):
            raise InputError("implicit: A has an entry on or above its diagonal")
        if sum(self.weights) != 1:
            raise InputError(f"inconsistent: the weights b sum to {sum(self.weights)}, not 1")


@dataclass(frozen=True)
class Partitioned:
    """One-step maps for velocity (explicit, taken first) and position (which may use the new velocity)."""

    position: LinearMultistep
    velocity: LinearMultistep

    def __post_init__(self) -> None:
        if self.velocity.implicit or (self.position.steps, self.velocity.steps) != (1, 1):
            raise InputError("a partitioned method needs one-step maps, that of the velocity explicit")


Scheme = LinearMultistep | PredictorCorrector | RungeKutta | Partitioned


@dataclass(frozen=True)
class Family:
    """A family of methods ("Bezier", "Adams-Bashforth") and a member's number in it."""

    name: str
    number: int


@dataclass(frozen=True)
class Method:
    """A scheme with its name and source; each of its steps spans `step_multiple` of the user's h (RK4@5: five)."""

    name: str
    scheme: Scheme
    source: str
    step_multiple: Fraction = ONE
    family: Family | None = None

    def __post_init__(self) -> None:
        if isinstance(self.scheme, LinearMultistep) and self.scheme.implicit:
            raise InputError("implicit: the leading coefficient of sigma is not 0")
        if not Fraction("1e-6") <= self.step_multiple <= Fraction("1e6"):
            raise InputError(f"step multiple {float(self.step_multiple):g}: expected 1e-6 to 1e6")


def steps(method: Method) -> int:
    """Return the number of past points the method uses."""
    match method.scheme:
        case LinearMultistep() as scheme:
            return scheme.steps
        case PredictorCorrector(predictor=scheme):
            return scheme.steps
        case RungeKutta() | Partitioned():
            return 1


def evaluations(method: Method) -> int:
    """Return the number of right-hand-side evaluations per step."""
    match method.scheme:
        case LinearMultistep() | Partitioned():
            return 1
        case PredictorCorrector():
            return 2
        case RungeKutta(weights=weights):
            return len(weights)


def bezier(n: int) -> Method:
    """Return the n-step Bezier method: f is replaced by the Bernstein curve whose control points are its last n values.

    b_j = m C(m, j) int_1^{1+1/m} tau^(m-j) (1-tau)^j dtau, m = n - 1; B1 is explicit Euler
    (Aghdam et al.'s multistep method, paper Table 1; theory: the curve extended past its end over one step).
    """
    m = n - 1

    def weight(j: int) -> Fraction:
        powers = ((comb(j, i) * (-1) ** i, m - j + i + 1) for i in range(j + 1))  # of tau^(m-j) (1-tau)^j, integrated
        return m * comb(m, j) * sum((c * (Fraction(n, m) ** p - 1) / p for c, p in powers), ZERO)

    scheme = _explicit([weight(j) for j in range(n)] if m else [ONE])
    return Method(f"B{n}", scheme, "paper Table 1 (Bezier)", family=Family("Bezier", n))


def adams_bashforth(n: int) -> Method:
    """Return the n-step Adams-Bashforth method, of order n (Hairer, Norsett & Wanner I, section III.1)."""
    weights = _interpolatory_weights([-j for j in range(n)])
    source = "Hairer, Norsett & Wanner I, Eq. III.1.5 (Adams-Bashforth)"
    return Method(f"AB{n}", _explicit(weights), source, family=Family("Adams-Bashforth", n))


def adams_bashforth_moulton(n: int) -> Method:
    """Return the PECE pair of order n: AB of order n predicts, Adams-Moulton of order n corrects."""
    corrector = [*_interpolatory_weights([1 - j for j in range(n)]), ZERO]
    predictor = adams_bashforth(n).scheme
    assert isinstance(predictor, LinearMultistep)
    scheme = PredictorCorrector(predictor, LinearMultistep(predictor.rho, tuple(corrector)))
    return Method(f"ABM{n}", scheme, "Hairer, Norsett & Wanner I, section III.1 (Adams-Bashforth-Moulton, PECE)")


def _explicit(weights: Sequence[Fraction]) -> LinearMultistep:
    """Return y_{k+1} = y_k + h sum_j weights[j] f_{k-j}."""
    return LinearMultistep((ONE, -ONE, *[ZERO] * (len(weights) - 1)), (ZERO, *weights))


def _interpolatory_weights(nodes: Sequence[int]) -> list[Fraction]:
    """Return the integrals over [0, 1] of the Lagrange polynomials on `nodes`."""

    def weight(node: int) -> Fraction:
        polynomial = [ONE]  # ascending powers of prod (x - other)
        others = [other for other in nodes if other != node]
        for other in others:
            polynomial = [a - other * b for a, b in zip([ZERO, *polynomial], [*polynomial, ZERO], strict=True)]
        return sum((a / (i + 1) for i, a in enumerate(polynomial)), ZERO) / prod(node - other for other in others)

    return [weight(node) for node in nodes]


def _runge_kutta(name: str, source: str, tableau: str, weights: str) -> Method:
    """Return the method with the sub-diagonal rows of A separated by semicolons, as in '1/2; 0 1/2'."""
    b = tuple(map(Fraction, weights.split()))
    rows = [[], *([Fraction(a) for a in row.split()] for row in tableau.split(";"))] if tableau else [[]]
    square = tuple((*row, *[ZERO] * (len(b) - len(row))) for row in rows)
    return Method(name, RungeKutta(square, b), source)


def _symplectic_euler() -> Method:
    backward = LinearMultistep((ONE, -ONE), (ONE, ZERO))
    forward = LinearMultistep((ONE, -ONE), (ZERO, ONE))
    return Method("SYM", Partitioned(position=backward, velocity=forward), "Hairer, Lubich & Wanner, Eq. I.1.9")


_KUTTA = "Kutta, Z. Math. Phys. 46, 1901"

REGISTRY: dict[str, Callable[[], Method]] = {
    **{f"B{n}": partial(bezier, n) for n in range(1, 13)},
    **{f"AB{n}": partial(adams_bashforth, n) for n in range(1, 9)},
    **{f"ABM{n}": partial(adams_bashforth_moulton, n) for n in range(2, 5)},
    "RK1": partial(_runge_kutta, "RK1", "Euler, Institutionum calculi integralis I, 1768", "", "1"),
    "RK2": partial(_runge_kutta, "RK2", "Runge, Math. Ann. 46, 1895 (midpoint)", "1/2", "0 1"),
    "RK3": partial(_runge_kutta, "RK3", _KUTTA, "1/2; -1 2", "1/6 2/3 1/6"),
    "RK4": partial(_runge_kutta, "RK4", _KUTTA, "1/2; 0 1/2; 0 0 1", "1/6 1/3 1/3 1/6"),
    "SIE": partial(_runge_kutta, "SIE", "paper Table 5 ('Euler semi-implicit'; Matsuno, 1966)", "1", "0 1"),
    "SYM": _symplectic_euler,
}
"""Every built-in method by name."""


@cache
def lookup(text: str) -> Method:
    """Return the method called `text`: a built-in name or the path of a TOML file, either with @m for a step of m h.

    InputError, with the nearest name, if there is none.
    """
    name, at, multiple = text.rpartition("@") if not text.endswith(".toml") and "@" in text else (text, "", "")
    if name.endswith(".toml"):
        method = read_method(Path(name))
    elif name in REGISTRY:
        method = REGISTRY[name]()
    else:
        raise unknown_name("method", name or text, REGISTRY)
    if not at:
        return method
    try:
        return replace(method, name=f"{method.name}@{multiple}", step_multiple=rational(multiple))
    except InputError as error:
        raise InputError(f"method {text!r}: {error}") from None


def read_method(path: Path) -> Method:
    """Return the method in a TOML file: rho and sigma, or A and b, as rational strings; name and source if given.

    Nothing in the file is executed. InputError, naming the file and the key, for anything else.
    """

    def parse(data: dict[str, object]) -> Method:
        keys = set(data) - {"name", "source"}
        name, source = (_text(data, key, default) for key, default in (("name", path.stem), ("source", str(path))))
        if keys == {"rho", "sigma"}:
            return Method(name, LinearMultistep(_vector(data, "rho"), _vector(data, "sigma")), source)
        if keys == {"A", "b"}:
            rows = data["A"] if isinstance(data["A"], list) else [data["A"]]
            tableau = tuple(_vector({"A": row}, "A") for row in rows)
            return Method(name, RungeKutta(tableau, _vector(data, "b")), source)
        raise InputError(f"expected the keys rho and sigma, or A and b, but found {', '.join(sorted(keys)) or 'none'}")

    return read_toml("method file", path, parse)


def _text(data: dict[str, object], key: str, default: str) -> str:
    value = data.get(key, default)
    if not isinstance(value, str) or not value.strip() or not value.isprintable():
        raise InputError(f"{key} = {value!r}: expected one line of text")
    return value


def _vector(data: dict[str, object], key: str) -> Coefficients:
    value = data[key]
    if not isinstance(value, list) or not all(isinstance(entry, str) for entry in value):
        raise InputError(f'{key} = {value!r}: expected a list of rational strings like "175/108"')
    try:
        return tuple(map(rational, value))
    except InputError as error:
        raise InputError(f"{key}: {error}") from None
