"""Multistep methods by their number of steps, and how their weights come about.

Backward differentiation differentiates the polynomial through the values of y. All others replace f(t, y(t))
beyond t_k by a curve through or along its last n values and integrate that curve over one step, from t_k to t_{k+1};
they differ in the curve. Time is counted in steps from t_k: the known values sit at
0, -1, ..., 1 - n.

    Adams-Bashforth   the polynomial through the values
    Adams-Moulton     the polynomial through the values and the new one at 1, without the oldest
    Bezier            the Bernstein curve with the values as control points, extended past its end
"""

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from functools import partial
from math import comb

from bezstab.methods.polynomials import integrals
from bezstab.methods.schemes import LinearMultistep, Method, MethodGroup, PredictorCorrector, Scheme
from bezstab.rationals import ONE, ZERO

MOST_BDF_STEPS = 6  # with more the method is not zero-stable


def bezier(n: int) -> Method:
    """Return the n-step Bezier method, n >= 1: f is replaced by the Bernstein curve on its last n values.

    b_j = m C(m, j) int_1^{1+1/m} tau^(m-j) (1-tau)^j dtau, m = n - 1; B1 is explicit Euler
    (Aghdam et al.'s multistep method, paper Table 1; theory: the curve extended past its end over one step).
    """
    weights = [_bezier_weight(n - 1, j) for j in range(n)]
    return Method(f"B{n}", _from_one_step_back([ZERO, *weights]), "paper Table 1 (Bezier)")


def is_bezier(scheme: Scheme) -> bool:
    """Return whether this is the Bezier scheme of n > 2 steps; B1 and B2 are Adams and Bashforth's, too."""
    return scheme.steps > 2 and scheme == bezier(scheme.steps).scheme


def _bezier_weight(m: int, j: int) -> Fraction:
    """Return the weight of f_{k-j}: its Bernstein polynomial integrated over the step past the end of the curve.

    On the curve of degree m the parameter tau runs from 0 (oldest value) to 1 (newest), so s steps past its end
    tau = (m + s)/m, and the polynomial is C(m, j) (m + s)^(m-j) (-s)^j / m^m. (m + s)^(m-j) is multiplied out, so that
    only powers of s are integrated. Where m = 0 the curve is constant: all of m^0 are one.
    """
    integral = sum((Fraction(comb(m - j, i) * m ** (m - j - i), i + j + 1) for i in range(m - j + 1)), ZERO)
    return Fraction((-1) ** j * comb(m, j), m**m) * integral


def adams_bashforth(n: int) -> Method:
    """Return the n-step Adams-Bashforth method, of order n >= 1 (Hairer, Norsett & Wanner I, section III.1)."""
    return Method(f"AB{n}", _adams(n, newest=0), "Hairer, Norsett & Wanner I, Eq. III.1.5 (Adams-Bashforth)")


def _adams(n: int, newest: int) -> LinearMultistep:
    """Return the scheme of the polynomial through n values, the newest at 0 (explicit) or at 1 (implicit)."""
    nodes = [newest - j for j in range(n)]
    return _from_one_step_back([*[ZERO] * (1 - newest), *(weight for (weight,) in integrals(nodes, [ONE]))])


def _from_one_step_back(sigma: Sequence[Fraction]) -> LinearMultistep:
    """Return y_{k+1} = y_k + h sum_j sigma[j] f_{k+1-j}."""
    return LinearMultistep((ONE, -ONE, *[ZERO] * (len(sigma) - 2)), tuple(sigma))


def adams_bashforth_moulton(n: int) -> Method:
    """Return the PECE pair of order n >= 2: AB of order n predicts, Adams-Moulton of order n corrects.

    Both keep n past values; the corrector gives the oldest the weight 0, as the new value takes its place
    (Hairer, Norsett & Wanner I, section III.1).
    """
    corrector = _adams(n, newest=1)
    same_steps = LinearMultistep((*corrector.rho, ZERO), (*corrector.sigma, ZERO))
    source = "Hairer, Norsett & Wanner I, section III.1 (Adams-Bashforth-Moulton, PECE)"
    return Method(f"ABM{n}", PredictorCorrector(_adams(n, newest=0), same_steps), source)


def bdf(n: int) -> Method:
    """Return the n-step backward differentiation formula, of order n, 1 <= n <= 6; bdf1 is implicit Euler.

    The polynomial through y_{k+1}, ..., y_{k+1-n} has the slope f_{k+1} at t_{k+1}. With nabla y = (1 - 1/z) y:
    sum_{j=1}^n nabla^j y_{k+1} / j = h f_{k+1} (Hairer, Norsett & Wanner I, Eq. III.1.22'). For n > 6 it is unstable.
    """
    rho = [
        sum(((-1) ** i * Fraction(comb(j, i), j) for j in range(1, n + 1)), ZERO)  # (-1)^i C(j, i) of nabla^j
        for i in range(n + 1)  # of y_{k+1-i}
    ]
    source = "Curtiss & Hirschfelder, Proc. Natl. Acad. Sci. 38, 1952 (backward differentiation)"
    return Method(f"bdf{n}", LinearMultistep(tuple(rho), (ONE, *[ZERO] * n)), source)


def adams_moulton(n: int) -> Method:
    """Return the Adams-Moulton method of order n >= 2, of n - 1 steps; am2 is the trapezoidal rule."""
    return Method(f"am{n}", _adams(n, newest=1), "Hairer, Norsett & Wanner I, Eq. III.1.9 (Adams-Moulton)")


def implicit_euler() -> Method:
    """Return y_{k+1} = y_k + h f_{k+1}."""
    source = "Hairer & Wanner II, Eq. IV.3.3 (implicit Euler; Catto's soft constraints, Jolt's springs)"
    return replace(bdf(1), name="implicit-euler", source=source)


def trapezoid() -> Method:
    """Return y_{k+1} = y_k + h/2 (f_k + f_{k+1})."""
    source = "Crank & Nicolson, Proc. Camb. Phil. Soc. 43, 1947 (trapezoidal rule)"
    return replace(adams_moulton(2), name="trapezoid", source=source)


EXPLICIT_MULTISTEP = (
    MethodGroup("Bézier", {f"B{n}": partial(bezier, n) for n in range(1, 13)}),
    MethodGroup("Adams-Bashforth", {f"AB{n}": partial(adams_bashforth, n) for n in range(1, 9)}),
    MethodGroup(
        "Adams-Bashforth-Moulton, predicted and corrected (PECE)",
        {f"ABM{n}": partial(adams_bashforth_moulton, n) for n in range(2, 5)},
    ),
)

IMPLICIT_MULTISTEP = MethodGroup(
    "Implicit multistep",
    {
        "implicit-euler": implicit_euler,
        "trapezoid": trapezoid,
        **{f"bdf{n}": partial(bdf, n) for n in range(1, MOST_BDF_STEPS + 1)},
        **{f"am{n}": partial(adams_moulton, n) for n in range(2, 7)},
    },
)
