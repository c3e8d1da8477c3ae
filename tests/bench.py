"""Speed of the |z_p| map and of the runner against the obvious ways, in one run on one core: `make bench`.

Promises are ratios of times, but for deriving and compiling a mechanism, which is in seconds.
"""

import subprocess
import sys
import time
import tracemalloc
from collections.abc import Callable
from itertools import islice

import numpy as np
import sympy as sp

from bezstab.derivation import ALPHA_HAT, BETA_HAT, closed_loop
from bezstab.mechanism import Mechanism, T, initial_state, mechanism
from bezstab.methods import LinearMultistep, Method, RungeKutta, lookup, steps
from bezstab.poles import FloatArray, roots_in_z, spectral_radius
from bezstab.region import region, window
from bezstab.scene import load
from bezstab.simulate import march, simulate

POINTS = 1000  # per axis
REPEATS = 3  # the fastest of so many: what disturbs a run only ever slows it
FASTER = 5.0  # the promised ratio
CLOSE = 1e-9  # the promised agreement, away from multiple roots
MULTIPLE = 1e-3  # roots closer than this: the 8x8 companion has lost digits there (square root of the distance)

STEP, GAINS = 1e-3, (500.0, 1e5)  # s; 2 alpha, beta^2 in 1/s, 1/s^2: alpha_hat = 0.5, beta_hat = 0.1
STEPS = 200  # of a run
RUNS = 10  # the fastest of so many: runs are short
FASTER_RUN = 8.0  # the promised ratio to the literal Eq. 9
INSTANCES = 10_000
CHEAPER_BATCH = 10.0  # the promised ratio of a step alone to an instance's step in a batch
SAME = 1e-12  # SI units: rounding; less, even 0, where h times a slope's rounding is under half a digit of the state
DERIVED = 2.0  # s: the promise for deriving and compiling the slider-crank


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


Slope = Callable[[float, FloatArray], FloatArray]


def literal_slope(mechanism: Mechanism) -> Slope:
    """Return (q, v)' at a time by the paper's Eq. 9 as it stands: its matrices evaluated, put together and solved."""
    symbolic, n, m = mechanism.equations, mechanism.size, mechanism.constraints
    parts = (symbolic.jacobian, symbolic.constraints, symbolic.constraints_t, symbolic.gamma, symbolic.forces)
    mass_of, *others = (
        sp.lambdify((T, symbolic.q, symbolic.v), part, "numpy") for part in (sp.diag(*symbolic.mass), *parts)
    )

    def slope(t: float, y: FloatArray) -> FloatArray:
        q, v = y[:n], y[n:]
        mass = mass_of(t, q, v)
        jacobian, c, c_t, gamma, forces = (part(t, q, v) for part in others)
        cdot = jacobian @ v + c_t[:, 0]
        matrix = np.block([[mass, jacobian.T], [jacobian, np.zeros((m, m))]])
        right = np.concatenate((forces[:, 0], gamma[:, 0] - GAINS[0] * cdot - GAINS[1] * c[:, 0]))
        return np.concatenate((v, np.linalg.solve(matrix, right)[:n]))

    return slope


def tuned_slope(mechanism: Mechanism) -> Slope:
    """Return the same with what helps: one function for all parts, M kept, the matrix filled in place."""
    symbolic, n, m = mechanism.equations, mechanism.size, mechanism.constraints
    columns = (symbolic.constraints, symbolic.constraints_t, symbolic.gamma, symbolic.forces)
    parts = [symbolic.jacobian, *(column.T for column in columns)]
    evaluated = sp.lambdify((T, symbolic.q, symbolic.v), parts, "numpy", cse=True)
    matrix, right = np.zeros((n + m, n + m)), np.empty(n + m)
    matrix[:n, :n] = np.diag(np.array(symbolic.mass, float))

    def slope(t: float, y: FloatArray) -> FloatArray:
        v = y[n:]
        jacobian, (c,), (c_t,), (gamma,), (forces,) = evaluated(t, y[:n].tolist(), v.tolist())
        matrix[n:, :n], matrix[:n, n:] = jacobian, jacobian.T
        right[:n], right[n:] = forces, gamma - GAINS[0] * (jacobian @ v + c_t) - GAINS[1] * c
        return np.concatenate((v, np.linalg.solve(matrix, right)[:n]))

    return slope


def literal_run(method: Method, slope: Slope, y: FloatArray) -> FloatArray:
    """Return the state after STEPS steps of RK4, or of a multistep method with rho = z^n - z^(n-1) that RK4 starts."""
    rk4 = lookup("RK4").scheme
    assert isinstance(rk4, RungeKutta)
    tableau, weights = np.array(rk4.tableau, float), np.array(rk4.weights, float)
    sigma = np.array(method.scheme.sigma[1:], float) if isinstance(method.scheme, LinearMultistep) else None
    slopes: list[FloatArray] = []  # newest first
    for k in range(STEPS):
        t = k * STEP
        slopes = [slope(t, y), *slopes[: steps(method) - 1]]
        if sigma is not None and len(slopes) == steps(method):
            y = y + STEP * (sigma @ np.array(slopes))
            continue
        stages = np.zeros((len(weights), len(y)))
        stages[0] = slopes[0]
        for s in range(1, len(weights)):
            stages[s] = slope(t + tableau[s].sum() * STEP, y + STEP * (tableau[s] @ stages))
        y = y + STEP * (weights @ stages)
    return y


def batch_run(method: Method, moving: Mechanism) -> FloatArray:
    """Return the states (INSTANCES, 2n) after STEPS steps of mechanisms that start alike and differ in their gains."""
    spread = np.linspace(1, 0.5, INSTANCES)  # the first has GAINS themselves
    gains = (GAINS[0] * spread, GAINS[1] * spread)
    state = tuple(np.full(INSTANCES, x) for x in np.concatenate(initial_state(moving)))
    *_, (end, _, _) = islice(march(moving, method, STEP, gains, state, "rk4", np), STEPS)
    return np.stack(end, axis=-1)


def runs() -> bool:
    """Print a line per method on the slider-crank; return whether its promises are kept."""
    print(
        f"\nslider-crank, {STEPS} steps; literal: the paper's Eq. 9 by numpy.linalg.solve; tuned: the same, no promise"
    )
    print("method  steps/s  literal  ratio  difference  tuned  ratio  difference  batch of 10^4  ratio  difference")
    moving, kept = mechanism(load("slider_crank")), True
    state = initial_state(moving)
    literal, tuned = literal_slope(moving), tuned_slope(moving)
    for name in ("B4", "RK4"):
        method = lookup(name)

        def alone(method: Method = method) -> FloatArray:
            run = simulate(moving, method, STEP, STEPS * STEP, GAINS, state)
            return np.concatenate((run.q[-1], run.v[-1]))

        def paper(slope: Slope, method: Method = method) -> FloatArray:
            return literal_run(method, slope, np.concatenate(state))

        ours, end = fastest(alone, RUNS)
        plain, plain_end = fastest(lambda: paper(literal), RUNS)
        better, better_end = fastest(lambda: paper(tuned), RUNS)
        together, ends = fastest(lambda: batch_run(method, moving), 1)  # noqa: B023
        each = together / INSTANCES
        columns = ((plain, plain / ours, plain_end), (better, better / ours, better_end), (each, ours / each, ends[0]))
        differences = [float(np.abs(other - end).max()) for _, _, other in columns]
        print(f"{name:6}  {STEPS / ours:7.0f}", end="")
        for (took, ratio, _), difference, width in zip(columns, differences, (7, 5, 13), strict=True):
            print(f"  {STEPS / took:{width}.0f}  {ratio:5.1f}  {difference:10.1e}", end="")
        print(flush=True)
        kept &= plain / ours >= FASTER_RUN and ours / each >= CHEAPER_BATCH and max(differences) < SAME
    broken = f"broken: {FASTER_RUN:g} times (batch: {CHEAPER_BATCH:g}) faster, differing by less than {SAME:g}"
    print("kept" if kept else broken)
    return kept


def derivation() -> bool:
    """Print how long a fresh process takes from a scene's name to its compiled stepper; return whether in DERIVED."""
    code = """
import math, time
from bezstab.mechanism import mechanism
from bezstab.methods import lookup
from bezstab.scene import load
from bezstab.simulate import _compiled_stepper
start = time.perf_counter()
_compiled_stepper(mechanism(load("slider_crank")), lookup("B4"), math)
print(time.perf_counter() - start)
"""
    took = min(
        float(subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout)
        for _ in range(REPEATS)
    )
    print(f"\nslider-crank derived and compiled for B4 by a fresh process, beyond its imports: {took:.2f} s")
    print("kept" if took < DERIVED else f"broken: less than {DERIVED:g} s")
    return took < DERIVED


def maps() -> bool:
    """Print a line per method; return whether the map's promises are kept."""
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
    return kept


def main() -> int:
    """Print every comparison; return 1 if a promise is broken."""
    return 0 if all([maps(), runs(), derivation()]) else 1


if __name__ == "__main__":
    sys.exit(main())
