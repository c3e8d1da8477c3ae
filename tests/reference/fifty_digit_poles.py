"""The poles to many digits, with the error that float64 cannot avoid."""

from collections.abc import Sequence
from typing import Any

import mpmath

from bezstab.methods.schemes import Method

EPS = 2.0**-52
LOST = 1e-300
"""Of a coefficient: next to the end of float64's range digits go, or all of it."""


def poles_with_errors(
    method: Method, alpha_hat: float, beta_hat: float, roundings: float = 50.0, starts: Sequence[complex] = ()
) -> list[tuple[Any, Any]]:
    """Return each pole to the digits that mpmath works with, and the error that float64 cannot avoid.

    That is so many roundings of each coefficient of pi, mu and the evaluation, times the pole's condition (Higham,
    Accuracy and Stability of Numerical Algorithms, 2nd ed., section 5.1). They move a root of multiplicity k by the
    k-th root of (rounding / |k-th derivative|). All roots of pi are found at once, from those `starts` that nearly
    solve it: simple ones of very different sizes are found from nowhere else.
    """
    multiple = mpmath.mpmathify(method.step_multiple)
    p, q = multiple * mpmath.mpf(alpha_hat), multiple**2 * mpmath.mpf(beta_hat)
    root = mpmath.sqrt(p * p / 4 - q)
    pairs = []
    larger = -p / 2 - root  # whose sum does not cancel
    for mu in (larger, q / larger) if larger and not mpmath.im(larger) else (larger, mpmath.conj(larger)):
        table = [list(map(mpmath.mpmathify, row)) for row in method.scheme.mu_table]
        coefficients = [sum(x * mu**j for j, x in enumerate(row)) for row in table]
        sizes = [sum(abs(x * mu**j) for j, x in enumerate(row)) for row in table]
        while coefficients[0] == 0:  # exact zeros, which polyroots would only approach
            pairs.append((mpmath.mpf(0), mpmath.mpf(0)))
            coefficients, sizes = coefficients[1:], sizes[1:]
        descending = coefficients[::-1]
        near = sorted(starts, key=lambda z: abs(mpmath.polyval(descending, z)) / mpmath.polyval(sizes[::-1], abs(z)))
        apart = [mpmath.mpc(z) * (1 + k * EPS**2) for k, z in enumerate(near[: len(descending) - 1])]
        for z in mpmath.polyroots(
            descending, 5000, cleanup=not starts, extraprec=1500 if starts else 200, roots_init=apart or None
        ):
            lost = LOST * sum(abs(z) ** k for k in range(len(sizes)))
            rounding = roundings * EPS * sum(size * abs(z) ** k for k, size in enumerate(sizes)) + lost
            derivative, error = coefficients, mpmath.inf
            for k in range(1, len(coefficients)):
                derivative = [i * x for i, x in enumerate(derivative)][1:]
                slope = abs(mpmath.polyval(derivative[::-1], z)) / mpmath.factorial(k)
                if slope:
                    error = min(error, (len(coefficients) * rounding / slope) ** (mpmath.mpf(1) / k))
            pairs.append((z, error + 100 * mpmath.mp.eps))  # polyroots stops there, however small a root is
    return pairs
