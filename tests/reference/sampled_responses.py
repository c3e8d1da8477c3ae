"""Responses whose poles are known because they are written down as sums of powers, to be fitted."""

import numpy as np

from bezstab.stability.arrays import ComplexArray, FloatArray


def two_poles(count: int, modulus: float, angle: float, phase: float, ratio: float) -> FloatArray:
    """Return Re(z^k) with z = modulus exp(i angle), shifted in phase, plus a real pole at ratio times its modulus."""
    k = np.arange(count)
    response: FloatArray = modulus**k * np.cos(angle * k + phase) + (ratio * modulus) ** k
    return response


def geometric(count: int, pole: float) -> FloatArray:
    """Return pole^k."""
    response: FloatArray = pole ** np.arange(float(count))
    return response


def of_poles(z: ComplexArray, count: int, seed: int) -> FloatArray:
    """Return sum a z^k with random amplitudes a of order one, conjugate for conjugate poles; real, shape (count,)."""
    random = np.random.default_rng(seed)
    k = np.arange(count)
    response = np.zeros(count)
    for pole in z:
        if pole.imag >= 0:
            phase = random.uniform(0.3, 1.2) if pole.imag else 0.0  # no part of a pair vanishes
            response += random.uniform(0.5, 1.5) * (np.exp(1j * phase) * pole**k).real
    return response
