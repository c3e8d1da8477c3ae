"""The equations of a second-order scheme as text or LaTeX, with the powers of h that h = 1 hides.

In the equations v stands for h v and a for h^2 a: each term gets the power of h by which its quantity's time
derivative is higher than that of the result. A helper has the least of the derivatives that are added up in it: a
velocity if it is a sum of velocities and accelerations.

    vh = v0 + 1/2 a0        v_h is a velocity        v_h = v_k + h/2 a_k
"""

from collections.abc import Iterable
from fractions import Fraction

from bezstab.methods.second_order import SecondOrder
from bezstab.methods.step_equations import (
    ACCELERATION,
    POSITION,
    VELOCITY,
    Assignment,
    Combination,
    Evaluation,
    Quantity,
)

SHOWN_DIGITS = 10  # of a coefficient that is shown as a decimal
LONGEST_PART = 10**12  # of a fraction that is shown as one

KNOWN_DERIVATIVES = {POSITION: 0, VELOCITY: 1, ACCELERATION: 2}


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
