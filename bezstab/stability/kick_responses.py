"""What becomes of a unit kick: the linear recursion with the poles of one point, step by step."""

import numpy as np

from bezstab.stability.arrays import ComplexArray, FloatArray


def kick_response(poles: ComplexArray, steps: int) -> FloatArray:
    """Return c_0 = 1, c_1, ... of the linear recursion that has these poles, float64 of shape (steps + 1,).

    `poles` has shape (degree,), complex ones in conjugate pairs. At rest before the kick. Not finite from where it
    leaves the range of float64.
    """
    polynomial = np.poly(poles).real
    degree = len(polynomial) - 1
    c = np.zeros(degree + steps + 1)  # with `degree` values of rest in front
    c[degree] = 1
    with np.errstate(over="ignore", invalid="ignore"):
        for k in range(degree + 1, len(c)):
            newest_first = c[k - 1 : k - degree - 1 : -1]
            c[k] = -polynomial[1:] @ newest_first
    return c[degree:]
