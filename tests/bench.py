"""Speed of the |z_p| map against the obvious way, as ratios of times measured in one run: `make bench`."""

import sys
import time
import tracemalloc
from collections.abc import Callable

import numpy as np
import sympy as sp

from bezstab.derivation import ALPHA_HAT, BETA_HAT, closed_loop
from bezstab.methods import Method, lookup
from bezstab.poles import FloatArray, roots_in_z, spectral_radius
from bezstab.region import region, window

POINTS = 1000  # per axis
REPEATS = 3  # the fastest of so many: what disturbs a run only ever slows it
FASTER = 5.0  # the promised ratio
CLOSE = 1e-9  # the promised agreement, away from multiple roots
MULTIPLE = 1e-3  # roots closer than this: the 8x8 companion has lost digits there (square root of the distance)


def by_eigenvalues(method: Method, alpha_hat: FloatArray, beta_hat: FloatArray) -> FloatArray:
    """Return |z_p| by numpy's batched eigenvalues of the companion matrices of P."""
    leading, *rest = (sp.lambdify((ALPHA_HAT, BETA_HAT), c) for c in closed_loop(method).all_coeffs())
    companion = np.zeros((*alpha_hat.shape, len(rest), len(rest)))
    for column, coefficient in enumerate(rest):
        companion[..., 0, column] = -coefficient(alpha_hat, beta_hat) / leading(alpha_hat, beta_hat)
    companion[..., range(1, len(rest)), range(len(rest) - 1)] = 1
    largest: FloatArray = np.abs(np.linalg.eigvals(companion)).max(axis=-1)
    return largest


def away_from_multiple_roots(method: Method, alpha_hat: FloatArray, beta_hat: FloatArray) -> FloatArray:
    """Return where no two poles of P lie within MULTIPLE of each other; boolean."""
    discriminant = np.emath.sqrt(alpha_hat**2 / 4 - beta_hat)
    mus = (-alpha_hat / 2 + discriminant, -alpha_hat / 2 - discriminant)
    z = np.concatenate([roots_in_z(method, mu.ravel().astype(complex)) for mu in mus])
    gaps = [np.abs(z[i] - z[j]) for i in range(len(z)) for j in range(i)]
    return np.asarray(np.min(gaps, axis=0) > MULTIPLE).reshape(alpha_hat.shape)


def fastest(call: Callable[[], FloatArray], repeats: int) -> tuple[float, FloatArray]:
    """Return the shortest time of several calls (s) and the result."""
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        result = call()
        times.append(time.perf_counter() - start)
    return min(times), result


def main() -> int:
    """Print one line per method; return 1 if a promise is broken."""
    print(f"{POINTS} x {POINTS} map of |z_p|, one core, everything included; eigvals: batched companions of P")
    print("method  poles (s)  eigvals (s)  ratio  largest difference  memory beyond the result (MB)")
    kept = True
    for name in ("B4", "AB4", "B8", "AB8"):
        method = lookup(name)
        axes = (np.linspace(low, high, POINTS) for low, high in window(region(method)))
        alpha_hat, beta_hat = np.meshgrid(*axes)
        ours, z_abs = fastest(lambda: spectral_radius(method, alpha_hat, beta_hat), REPEATS)  # noqa: B023
        theirs, reference = fastest(lambda: by_eigenvalues(method, alpha_hat, beta_hat), 1)  # noqa: B023
        ordinary = away_from_multiple_roots(method, alpha_hat, beta_hat)
        difference = float(np.abs(z_abs - reference)[ordinary].max())
        tracemalloc.start()
        result = spectral_radius(method, alpha_hat, beta_hat)
        memory = (tracemalloc.get_traced_memory()[1] - result.nbytes) / 1e6
        tracemalloc.stop()
        ratio = theirs / ours
        print(f"{name:6}  {ours:9.2f}  {theirs:11.2f}  {ratio:5.1f}  {difference:18.1e}  {memory:29.0f}", flush=True)
        kept &= ratio >= FASTER and difference < CLOSE
    print("kept" if kept else f"broken: at least {FASTER:g} times faster, differing by less than {CLOSE:g}")
    return 0 if kept else 1


if __name__ == "__main__":
    sys.exit(main())
