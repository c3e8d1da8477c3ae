"""The smallest |z_p| of a multistep method by a second route: one polynomial in z."""

import numpy as np

from bezstab.methods import LinearMultistep, lookup


def least_modulus(name: str) -> float:
    """Return p in (0, 1) with rho(p)/sigma(p) = rho(-p)/sigma(-p): a corner with z = p and z = -p both double."""
    scheme = lookup(name).scheme
    assert isinstance(scheme, LinearMultistep)
    rho, sigma = (np.array(c, float) for c in (scheme.rho, scheme.sigma))
    signs = (-1.0) ** np.arange(len(rho))
    roots = np.roots(np.trim_zeros(np.polymul(rho, sigma * signs) - np.polymul(rho * signs, sigma)))
    return float(max(root.real for root in roots if abs(root.imag) < 1e-9 and 0 < root.real < 0.99))
