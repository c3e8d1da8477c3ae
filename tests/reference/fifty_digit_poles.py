"""The poles to 50 digits, with the error that float64 cannot avoid."""

from typing import Any

import mpmath

from bezstab.methods.schemes import Method

EPS = 2.0**-52


def poles_with_errors(method: Method, alpha_hat: float, beta_hat: float) -> list[tuple[Any, Any]]:
    """Return each pole to 50 digits with the error that float64 cannot avoid: rounding times its condition.

    Rounding the coefficients of pi, mu and the evaluation by a few eps moves a root of multiplicity k by the k-th
    root of (rounding / |k-th derivative|).
    """
    multiple = mpmath.mpmathify(method.step_multiple)
    p, q = multiple * mpmath.mpf(alpha_hat), multiple**2 * mpmath.mpf(beta_hat)
    root = mpmath.sqrt(p * p / 4 - q)
    pairs = []
    for mu in (-p / 2 + root, -p / 2 - root):
        table = [list(map(mpmath.mpmathify, row)) for row in method.scheme.mu_table]
        coefficients = [sum(x * mu**j for j, x in enumerate(row)) for row in table]
        sizes = [sum(abs(x * mu**j) for j, x in enumerate(row)) for row in table]
        while coefficients[0] == 0:  # exact zeros, which polyroots would only approach
            pairs.append((mpmath.mpf(0), mpmath.mpf(0)))
            coefficients, sizes = coefficients[1:], sizes[1:]
        for z in mpmath.polyroots(coefficients[::-1], maxsteps=5000, extraprec=200):
            rounding = 50 * EPS * sum(size * abs(z) ** k for k, size in enumerate(sizes))
            derivative, error = coefficients, mpmath.inf
            for k in range(1, len(coefficients)):
                derivative = [i * x for i, x in enumerate(derivative)][1:]
                slope = abs(mpmath.polyval(derivative[::-1], z)) / mpmath.factorial(k)
                if slope:
                    error = min(error, (len(coefficients) * rounding / slope) ** (mpmath.mpf(1) / k))
            pairs.append((z, error))
    return pairs
