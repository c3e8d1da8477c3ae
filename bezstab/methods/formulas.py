"""A method's recursion, s->z mapping, characteristic polynomial, steady error and torque, written as text or LaTeX."""

from collections.abc import Iterable
from fractions import Fraction
from math import lcm

import sympy as sp

from bezstab.methods.added_damping import added_damping
from bezstab.methods.derivation import ALPHA_HAT, BETA_HAT, MU, PLANE, Z, closed_loop_polynomial, mapping_equation
from bezstab.methods.orders import accuracy
from bezstab.methods.registry import lookup
from bezstab.methods.rotation_torque import stage_torque
from bezstab.methods.schemes import LinearMultistep, Method, PredictorCorrector, RungeKutta
from bezstab.methods.second_order import SecondOrder
from bezstab.methods.steady_errors import LeadingTerm, Part, PlanePolynomial, leading_error
from bezstab.methods.step_equations import (
    ACCELERATION,
    POSITION,
    VELOCITY,
    Assignment,
    Combination,
    Evaluation,
    Quantity,
)

THETA = sp.Symbol(
    "_theta"
)  # i omega h, of a torque omega h; with the underscore it is written before alpha_hat and beta_hat
LATEX = {ALPHA_HAT: r"\hat{\alpha}", BETA_HAT: r"\hat{\beta}", MU: r"\mu", THETA: r"\theta"}
TEXT = {"_theta": "θ", "alpha_hat": "α̂", "beta_hat": "β̂", "**": "^", "*": " "}

SHOWN_DIGITS = 10  # of a coefficient that is shown as a decimal
LONGEST_PART = 10**12  # of a fraction that is shown as one

LONGEST = 400
"""Letters of a steady error that is written out, as text: five lines of a terminal."""

Terms = Iterable[tuple[Fraction, str]]
"""Coefficients and the names of what they multiply."""


def recursion_text(method: Method, latex: bool = False) -> str:
    """Return the step from y_k to y_{k+1} (paper Eq. 12, Table 1), f_k = f(t_k, y_k), as text or LaTeX.

    Several formulas, in the order in which they are taken, are separated by "; ". Of a second-order scheme: its
    equations for positions x, velocities v and accelerations a(x, v). Where rationals stand for irrational
    coefficients, they are shown as decimals.
    """
    multiple = method.step_multiple
    match method.scheme:
        case LinearMultistep() as scheme:
            lines = [_multistep("y_{k+1}", scheme, multiple, latex)]
        case PredictorCorrector(predictor, corrector):
            predict = _multistep("p", predictor, multiple, latex)
            correct = _multistep("y_{k+1}", corrector, multiple, latex, new_slope="f(p)")
            lines = [predict, correct]
        case SecondOrder() as scheme:
            return second_order_text(scheme, multiple, latex)
        case RungeKutta(tableau, weights):
            stages = [f"K_{i}" for i in range(1, len(weights) + 1)]
            lines = []
            for stage, row in zip(stages, tableau, strict=True):
                lines.append(f"{stage} = f(y_k{_increment(zip(row, stages, strict=True), multiple, latex)})")
            lines.append(f"y_{{k+1}} = y_k{_increment(zip(weights, stages, strict=True), multiple, latex)}")
    return "; ".join(lines)


def mapping_text(method: Method, latex: bool = False) -> str:
    """Return the s->z mapping (paper Eq. 14, Table 1); of a second-order scheme that it has none."""
    equation = mapping_equation(method)
    if equation is None:
        return "none: positions and velocities have a formula each"
    return f"{_written(_readable(equation.lhs), latex)} = {_written(_readable(equation.rhs), latex)}"


def characteristic_text(method: Method, latex: bool = False) -> str:
    """Return P(z; alpha_hat, beta_hat) = 0 with whole-number coefficients (paper Eq. 17, Table 2).

    With decimals where rationals stand for irrational coefficients.
    """
    polynomial = closed_loop_polynomial(method).inject()
    if method.digits is None:
        _, polynomial = polynomial.clear_denoms(convert=True)
    terms = []
    for (power,), coefficient in polynomial.eject(ALPHA_HAT, BETA_HAT).terms():
        terms.append(_power_term(_readable(coefficient), power, latex))
    return " + ".join(terms).replace("+ -", "- ") + " = 0"


def steady_error_text(method: Method, part: Part = "x", latex: bool = False) -> str:
    """Return the leading term in theta = i omega h of the steady error of x (or of v), as a share of the motion's.

    A quotient of polynomials in alpha_hat and beta_hat, which are held as h shrinks; source: steady_errors.py. Where
    rationals stand for irrational coefficients they are shown as decimals. Text that is too long to be read says how
    long it is instead; LaTeX is written out.
    """
    error = leading_error(method, part)
    formula = THETA**error.power * _quotient(error, exact=method.digits is None)
    text = _written(formula, latex)
    if latex or len(text) <= LONGEST:
        return text
    lengths = f"{len(error.numerator)} terms over {len(error.denominator)}"
    return f"{_written(THETA**error.power, latex)} times {lengths}, too long to be read; as LaTeX it is written out"


def stage_torque_text(method: Method, latex: bool = False) -> str:
    """Return the leading term in theta = omega h of D: a step multiplies the rate of a uniform rotation by 1 + D.

    Source: rotation_torque.py. Where the coefficient is not found as a formula, or is too long to be read, the power is
    said.
    """
    torque = stage_torque(method)
    if torque.power is None:
        return f"0, up to {_written(THETA**torque.highest, latex)}"
    power = _written(THETA**torque.power, latex)
    if torque.coefficient is None:
        return f"{power} times a function of the feedback"
    text = _written(THETA**torque.power * torque.coefficient, latex)
    return text if latex or len(text) <= LONGEST else f"{power} times a quotient too long to be read"


def added_damping_text(method: Method, latex: bool = False) -> str:
    """Return the leading term in theta = omega h of the damping ratio that a method adds to an undamped oscillator.

    Source: added_damping.py. Of coefficients that stand for irrational ones as decimals.
    """
    damping = added_damping(method)
    if damping.power is None:
        return f"0, up to {_written(THETA**damping.highest, latex)}"
    exact = method.digits is None
    coefficient = sp.Rational(damping.coefficient) if exact else sp.Float(float(damping.coefficient), 6)
    return _written(THETA**damping.power * coefficient, latex)


def multiplier_law_text(method: Method, latex: bool = False) -> str:
    """Return the equation of the constraint error that a motion forces, on which the multipliers work: -lambda dc/dt.

    Of a multistep method of order p with error constant C: c'' + 2 alpha c' + beta^2 c = -2 C h^p (G' + alpha G), G =
    C_q q^(p+1); of symplectic Euler, and of what has its polynomial, by kappa = q'^T C_qq q'. To leading order of h,
    alpha and beta held; bezstab/motion/README.md. Of others no closed form is known.
    """
    left = r"\ddot{c} + 2\alpha\dot{c} + \beta^2 c = " if latex else "c'' + 2α c' + β² c = "
    if isinstance(method.scheme, LinearMultistep):
        order, constant = accuracy(method)
        factor = _written(-2 * sp.Rational(constant.numerator, constant.denominator), latex)
        if latex:
            return rf"{left}{factor} h^{order} (\dot{{G}} + \alpha G), G = C_q q^{{({order + 1})}}"
        return f"{left}{factor} h^{order} (G' + α G), G = C_q q^({order + 1})"
    if closed_loop_polynomial(method) != closed_loop_polynomial(lookup("SYM")):
        return "no closed form is known: region --motion draws it"
    if latex:
        return rf"{left}-\alpha h \kappa + \frac{{h}}{{2}} \dot{{\kappa}}_v, \kappa = \dot{{q}}^T C_{{qq}} \dot{{q}}"
    return f"{left}-α h κ + h/2 κ'ᵥ, κ = q'ᵀ C_qq q'"


def _quotient(error: LeadingTerm, exact: bool) -> sp.Expr:
    """Return numerator over denominator, with factors taken out; of rounded coefficients what all terms share."""
    if exact:
        return sp.factor(_plane_expression(error.numerator) / _plane_expression(error.denominator))
    by_alpha, by_beta = (min(powers[axis] for powers in (*error.numerator, *error.denominator)) for axis in (0, 1))
    first = error.denominator[min(error.denominator)]

    def reduced(terms: PlanePolynomial) -> sp.Expr:
        return _plane_expression({(i - by_alpha, j - by_beta): c / first for (i, j), c in terms.items()})

    return _readable(reduced(error.numerator) / reduced(error.denominator))


def _plane_expression(terms: PlanePolynomial) -> sp.Expr:
    """Return a polynomial in alpha_hat and beta_hat as an expression."""
    return PLANE.ring.from_dict(terms).as_expr()


def _readable(expression: sp.Expr) -> sp.Expr:
    """Return the expression with decimals for fractions too long to be read."""
    long = [number for number in expression.atoms(sp.Rational) if is_long(Fraction(number))]
    return expression.xreplace({number: sp.Float(number, SHOWN_DIGITS) for number in long})


def _power_term(coefficient: sp.Expr, power: int, latex: bool) -> str:
    """Return coefficient z^power: a sum in parentheses, a factor 1 left out."""
    number = _written(coefficient, latex)
    if power == 0:
        return number
    power_text = _written(Z**power, latex)
    if number == "1":
        return power_text
    if isinstance(coefficient, sp.Add):
        number = f"({number})"
    return f"{number} {power_text}"


def _written(expression: sp.Expr, latex: bool) -> str:
    if latex:
        return str(sp.latex(expression, symbol_names=LATEX))
    text = sp.sstr(expression)
    for code, shown in TEXT.items():
        text = text.replace(code, shown)
    return str(text)


def _multistep(
    left: str,
    scheme: LinearMultistep,
    multiple: Fraction,
    latex: bool,
    new_slope: str = "f_{k+1}",
) -> str:
    """Return `left` = one multistep formula in y_k, y_{k-1}, ... and f_{k+1} (or `new_slope`), f_k, ..."""
    past = [(-a, f"y_{_index(j)}") for j, a in enumerate(scheme.rho[1:])]
    slopes = [(scheme.sigma[0], new_slope), *((b, f"f_{_index(j)}") for j, b in enumerate(scheme.sigma[1:]))]
    denominator, sum_of_past = _combination(past)
    if denominator > 1:
        sum_of_past = f"\\frac{{1}}{{{denominator}}}({sum_of_past})" if latex else f"({sum_of_past})/{denominator}"
    return f"{left} = {sum_of_past}{_increment(slopes, multiple, latex)}"


def _index(j: int) -> str:
    """Return the index j steps before k: k, {k-1}, ..."""
    return "k" if j == 0 else f"{{k-{j}}}"


def _combination(terms: Terms) -> tuple[int, str]:
    """Return the common denominator and the sum of whole-number multiples that it divides.

    Where a coefficient is too long to be read: one, and the sum of decimal multiples.
    """
    present = [(c, name) for c, name in terms if c]
    as_decimals = any(is_long(c) for c, _ in present)
    denominator = 1 if as_decimals else lcm(*(c.denominator for c, _ in present))
    parts = []
    for c, name in present:
        multiple = abs(c * denominator)
        number = decimal(multiple) if as_decimals else str(multiple)
        parts.append((c, name if multiple == 1 else f"{number} {name}"))
    return denominator, signed_sum(parts)


def _increment(terms: Terms, multiple: Fraction, latex: bool) -> str:
    """Return ' + m h (sum)', the denominator with the step; nothing if all coefficients are 0."""
    terms = list(terms)
    if all(c == 0 for c, _ in terms):
        return ""
    denominator, text = _combination((c * multiple.numerator, name) for c, name in terms)
    under = denominator * multiple.denominator
    step = quotient("h", "" if under == 1 else str(under), latex)
    single = " " not in text and not text.startswith("-")
    return f" + {step} {text}" if single else f" + {step} ({text})"


def is_long(number: Fraction) -> bool:
    """Return whether a number is better read as a decimal: one that stands for an irrational one, above all."""
    return number.denominator > LONGEST_PART


def decimal(number: Fraction) -> str:
    """Return a number as a decimal of ten digits."""
    return f"{float(number):.{SHOWN_DIGITS}g}"


def signed_sum(terms: Iterable[tuple[Fraction, str]]) -> str:
    """Return the sum of terms, each given by a number that has its sign and by its text without; 0 for none."""
    text = " ".join(f"{'-' if number < 0 else '+'} {size}" for number, size in terms)
    return text.removeprefix("+ ") if text.startswith("+ ") else text.replace("- ", "-", 1) or "0"


def quotient(over: str, under: str, latex: bool) -> str:
    """Return over / under; what is over alone where nothing is under it."""
    if not under:
        return over
    if latex:
        return rf"\frac{{{over}}}{{{under}}}"
    return f"{over}/({under})" if " " in under else f"{over}/{under}"


# The equations of a second-order scheme, with the powers of h that h = 1 hides. In the equations v stands for h v and a
# for h^2 a: each term gets the power of h by which its quantity's time derivative is higher than that of the result. A
# helper has the least of the derivatives that are added up in it: a velocity if it is a sum of velocities and
# accelerations.
#
#     vh = v0 + 1/2 a0        v_h is a velocity        v_h = v_k + h/2 a_k

KNOWN_DERIVATIVES = {POSITION: 0, VELOCITY: 1, ACCELERATION: 2}


def second_order_text(scheme: SecondOrder, multiple: Fraction, latex: bool) -> str:
    """Return the equations in the order in which they are taken, separated by "; ", for steps of `multiple` h."""
    derivatives = _derivatives(scheme)
    carried = {
        quantity.name for equation in scheme.equations for quantity in (equation.result, *equation.used)
        if quantity.step != 1
    }  # fmt: skip

    def name(quantity: Quantity) -> str:
        return _name(quantity, quantity.name in carried, latex)

    def terms(combination: Combination, derivative: int) -> str:
        parts = []
        for coefficient, quantity in combination:
            power = derivatives[quantity.name] - derivative
            parts.append((coefficient, _term(abs(coefficient) * multiple**power, power, name(quantity), latex)))
        return signed_sum(parts)

    lines = []
    for equation in (equation for group in scheme.groups for equation in group):
        match equation:
            case Assignment(result, value):
                lines.append(f"{name(result)} = {terms(value, derivatives[result.name])}")
            case Evaluation(result, position, velocity):
                lines.append(f"{name(result)} = a({terms(position, 0)}, {terms(velocity, 1)})")
    return "; ".join(lines)


def _derivatives(scheme: SecondOrder) -> dict[str, int]:
    """Return how often each quantity is differentiated with respect to time: 0 a position, 2 an acceleration."""
    derivatives = dict(KNOWN_DERIVATIVES)
    for equation in scheme.equations:
        derivatives.setdefault(equation.result.name, KNOWN_DERIVATIVES[ACCELERATION])
    for _ in scheme.equations:  # a sum may have a helper in it whose own sum comes later: so often at most
        for equation in scheme.equations:
            result = equation.result.name
            if result not in KNOWN_DERIVATIVES and isinstance(equation, Assignment):
                added_up = (derivatives[quantity.name] for _, quantity in equation.value)
                derivatives[result] = min(added_up, default=KNOWN_DERIVATIVES[ACCELERATION])
    return derivatives


def _name(quantity: Quantity, carried: bool, latex: bool) -> str:
    """Return x_{k+1} for x1, and so for a helper that is carried to another step; the name alone for others."""
    name = quantity.name
    if latex and name not in KNOWN_DERIVATIVES:
        escaped = name.replace("_", r"\_")
        name = rf"\mathrm{{{escaped}}}"
    if quantity.name not in KNOWN_DERIVATIVES and not carried:
        return name
    return f"{name}_k" if quantity.step == 0 else f"{name}_{{k{quantity.step:+d}}}"


def _term(size: Fraction, power: int, name: str, latex: bool) -> str:
    """Return a positive number with a power of h times a quantity: `3 h^2/2 a_k`, `x_k/h`."""
    above, below = ([decimal(size)], []) if is_long(size) else ([str(size.numerator)], [str(size.denominator)])
    if power:
        (above if power > 0 else below).append("h" if abs(power) == 1 else f"h^{abs(power)}")
    over, under = (" ".join(part for part in parts if part != "1") for parts in (above, below))
    factor = quotient(over or "1", under, latex)
    return name if factor == "1" else f"{factor} {name}"
