"""What the robust choice makes as small as it can, by a second route: other shares of the step, other offsets."""

import numpy as np

from bezstab.methods.schemes import Method
from bezstab.stability.arrays import FloatArray
from bezstab.stability.closed_loop import spectral_radius


def worst_decay(method: Method, a: float, b: float, shares: FloatArray, spread: float) -> float:
    """Return the largest |z_p|^(1/share) over the shares of the step and over the square of the spread, corners in."""
    offsets = 1 + spread * np.linspace(-1, 1, 5)
    first, second, share = (x.ravel() for x in np.meshgrid(offsets, offsets, shares))
    z_abs = spectral_radius(method, a * first * share, b * (second * share) ** 2)
    return float((z_abs ** (1 / share)).max())
