"""A method's recursion, s->z mapping and characteristic polynomial, written as text or LaTeX."""

from collections.abc import Iterable
from fractions import Fraction
from math import lcm

import sympy as sp

from bezstab.methods.derivation import ALPHA_HAT, BETA_HAT, MU, Z, closed_loop_polynomial, mapping_equations
from bezstab.methods.schemes import LinearMultistep, Method, Partitioned, PredictorCorrector, RungeKutta

LATEX = {ALPHA_HAT: r"\hat{\alpha}", BETA_HAT: r"\hat{\beta}", MU: r"\mu"}
TEXT = {"alpha_hat": "α̂", "beta_hat": "β̂", "**": "^", "*": " "}

Terms = Iterable[tuple[Fraction, str]]


def recursion_text(method: Method, latex: bool = False) -> str:
    """Return the step from y_k to y_{k+1} (paper Eq. 12, Table 1), f_k = f(t_k, y_k)."""
    m = method.step_multiple
    match method.scheme:
        case LinearMultistep() as scheme:
            lines = [_multistep("y_{k+1}", scheme, "y", "f", m, latex)]
        case PredictorCorrector(predictor, corrector):
            lines = [
                _multistep("p", predictor, "y", "f", m, latex),
                _multistep("y_{k+1}", corrector, "y", "f", m, latex, new="f(p)"),
            ]
        case Partitioned(position, velocity):
            lines = [
                _multistep("v_{k+1}", velocity, "v", "a", m, latex),
                _multistep("x_{k+1}", position, "x", "v", m, latex),
            ]
        case RungeKutta(tableau, weights):
            names = [f"K_{i}" for i in range(1, len(weights) + 1)]
            lines = [
                f"{name} = f(y_k{_increment(zip(row, names, strict=True), m, latex)})"
                for name, row in zip(names, tableau, strict=True)
            ]
            lines.append(f"y_{{k+1}} = y_k{_increment(zip(weights, names, strict=True), m, latex)}")
    return "; ".join(lines)


def mapping_text(method: Method, latex: bool = False) -> str:
    """Return the s->z mapping (paper Eq. 14, Table 1)."""
    sides = [
        f"{_written(equation.lhs, latex)} = {_written(equation.rhs, latex)}" for equation in mapping_equations(method)
    ]
    if isinstance(method.scheme, Partitioned):
        sides = [f"{name}: {text}" for name, text in zip(("position", "velocity"), sides, strict=True)]
    return "; ".join(sides)


def characteristic_text(method: Method, latex: bool = False) -> str:
    """Return P(z; alpha_hat, beta_hat) = 0 with whole-number coefficients (paper Eq. 17, Table 2)."""
    polynomial = closed_loop_polynomial(method)
    _, whole = sp.Poly(polynomial.as_expr(), Z, ALPHA_HAT, BETA_HAT, domain="QQ").clear_denoms(convert=True)
    terms = []
    for (power,), coefficient in sp.Poly(whole.as_expr(), Z).terms():
        power_text = {0: "", 1: "z"}.get(power, _written(Z**power, latex))
        text = _written(coefficient, latex)
        if isinstance(coefficient, sp.Add) and power_text:
            text = f"({text})"
        terms.append("" if text == "1" and power_text else text)
        terms[-1] = f"{terms[-1]} {power_text}".strip()
    return " + ".join(terms).replace("+ -", "- ") + " = 0"


def _written(expression: sp.Expr, latex: bool) -> str:
    if latex:
        return str(sp.latex(expression, symbol_names=LATEX))
    text = sp.sstr(expression)
    for code, shown in TEXT.items():
        text = text.replace(code, shown)
    return str(text)


def _multistep(
    left: str, scheme: LinearMultistep, y: str, f: str, m: Fraction, latex: bool, new: str | None = None
) -> str:
    """Return one multistep formula; `new` is the name of f at the new point, f_{k+1} unless given."""
    past = [(-a, f"{y}_{_index(j)}") for j, a in enumerate(scheme.rho[1:])]
    slopes = [(b, f"{f}_{_index(j - 1)}" if j or new is None else new) for j, b in enumerate(scheme.sigma)]
    denominator, sum_of_past = _combination(past)
    if denominator > 1:
        sum_of_past = f"\\frac{{1}}{{{denominator}}}({sum_of_past})" if latex else f"({sum_of_past})/{denominator}"
    return f"{left} = {sum_of_past}{_increment(slopes, m, latex)}"


def _index(j: int) -> str:
    return "k" if j == 0 else f"{{k{-j:+d}}}"


def _combination(terms: Terms) -> tuple[int, str]:
    """Return the common denominator and the sum of whole-number multiples that it divides."""
    present = [(c, name) for c, name in terms if c]
    denominator = lcm(*(c.denominator for c, _ in present))
    parts = []
    for c, name in present:
        multiple = abs(c * denominator)
        parts.append(("- " if c < 0 else "+ ") + (name if multiple == 1 else f"{multiple} {name}"))
    text = " ".join(parts)
    return denominator, text[2:] if text.startswith("+ ") else text.replace("- ", "-", 1)


def _increment(terms: Terms, m: Fraction, latex: bool) -> str:
    """Return ' + m h (sum)', the denominator with the step; nothing if all coefficients are 0."""
    terms = list(terms)
    if not any(c for c, _ in terms):
        return ""
    denominator, text = _combination((c * m.numerator, name) for c, name in terms)
    denominator *= m.denominator
    step = "h" if denominator == 1 else rf"\frac{{h}}{{{denominator}}}" if latex else f"h/{denominator}"
    single = " " not in text and not text.startswith("-")
    if single:
        return f" + {step} {text}"
    return f" + {step} ({text})"
