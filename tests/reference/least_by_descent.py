"""The least |z_p| over alpha_hat, beta_hat >= 0 by dense sampling and local descent, in a box of any size."""

import random
from collections.abc import Callable
from fractions import Fraction

import numpy as np

from bezstab.methods.schemes import Method, RungeKutta, implicit
from bezstab.stability.arrays import FloatArray
from tests.reference.companion_poles import polynomial_at, radius

Modulus = Callable[[FloatArray, FloatArray], FloatArray]

SAMPLES = (100, 130)  # of alpha_hat and beta_hat, in even ratios but for alpha_hat = 0
SMALLEST = 1e-3
STARTS = 24  # of the samples' local minima, the lowest
TRIALS = 24  # random steps of every start in a round
ROUNDS = 160
WIDEST, NARROWER, WIDER = 0.5, 0.85, 1.5  # of a parameter: the first steps, and the factor after failure and success


def modulus_of(method: Method) -> Modulus:
    """Return |z_p|: of an implicit Runge-Kutta method by z = 1 + mu b (I - mu A)^-1 e, of any other from P.

    It is infinite where a step has no solution.
    """
    if isinstance(method.scheme, RungeKutta) and implicit(method):
        return _of_tableau(method.scheme)

    def modulus(alpha_hat: FloatArray, beta_hat: FloatArray) -> FloatArray:
        c = polynomial_at(method, alpha_hat, beta_hat)
        with np.errstate(all="ignore"):
            solvable = np.isfinite(c / c[0]).all(axis=0)
        z_abs = np.full(alpha_hat.shape, np.inf)
        z_abs[solvable] = radius(method, alpha_hat[solvable], beta_hat[solvable])
        return z_abs

    return modulus


def _of_tableau(scheme: RungeKutta) -> Modulus:
    tableau, weights = np.array(scheme.tableau, float), np.array(scheme.weights, float)
    ones = np.ones(len(weights))

    def modulus(alpha_hat: FloatArray, beta_hat: FloatArray) -> FloatArray:
        root = np.sqrt((alpha_hat / 2) ** 2 - beta_hat + 0j)
        larger = -alpha_hat / 2 - root
        mus = [larger, np.where(root.imag != 0, larger.conj(), beta_hat / np.where(larger == 0, 1, larger))]
        of_each = []
        for mu in mus:
            matrices = np.eye(len(weights)) - mu[..., np.newaxis, np.newaxis] * tableau
            stages = np.linalg.solve(matrices, np.broadcast_to(ones, (*mu.shape, len(ones)))[..., np.newaxis])[..., 0]
            of_each.append(np.abs(1 + mu * (stages @ weights)))
        return np.asarray(np.maximum(*of_each))

    return modulus


def least_within(modulus: Modulus, furthest: float, seed: int = 0) -> tuple[float, float, float]:
    """Return the least |z_p| found with alpha_hat, beta_hat <= furthest, and alpha_hat and beta_hat there."""
    generator = np.random.default_rng(seed)
    alpha_axis = np.concatenate([[0.0], np.geomspace(SMALLEST, furthest, SAMPLES[0])])
    alpha_hat, beta_hat = np.meshgrid(alpha_axis, np.geomspace(SMALLEST, furthest, SAMPLES[1]))
    sampled = modulus(alpha_hat, beta_hat)
    padded = np.pad(sampled, 1, constant_values=np.inf)
    shifts = [(i, j) for i in (-1, 0, 1) for j in (-1, 0, 1)]
    around = np.min([np.roll(padded, shift, (0, 1)) for shift in shifts], axis=0)[1:-1, 1:-1]
    rows, columns = np.nonzero(sampled <= around)
    lowest = np.argsort(sampled[rows, columns], kind="stable")[:STARTS]
    place = np.stack([alpha_hat[rows, columns], beta_hat[rows, columns]], axis=-1)[lowest]
    value = sampled[rows, columns][lowest]
    step = np.full(len(lowest), WIDEST)
    for _ in range(ROUNDS):
        moves = step[:, np.newaxis, np.newaxis] * generator.normal(size=(len(lowest), TRIALS, 2))
        trials = np.clip(place[:, np.newaxis] + moves * np.maximum(place, 0.1)[:, np.newaxis], 0, furthest)
        values = modulus(trials[..., 0], trials[..., 1])
        best = np.argmin(values, axis=1)
        found = np.take_along_axis(values, best[:, np.newaxis], axis=1)[:, 0]
        better = found < value
        place[better] = trials[better, best[better]]
        value = np.where(better, found, value)
        step = np.minimum(step * np.where(better, WIDER, NARROWER), WIDEST)
    least = int(np.argmin(value))
    by_descent = float(value[least]), float(place[least, 0]), float(place[least, 1])
    return min(by_descent, _least_on_parabola(modulus, furthest))


def _least_on_parabola(modulus: Modulus, furthest: float) -> tuple[float, float, float]:
    """Return the same on beta_hat = alpha_hat^2 / 4 alone, beside which |z_p| rises too steeply for random steps."""
    alpha_hat = np.geomspace(SMALLEST, 2 * np.sqrt(furthest), 4000)
    for _ in range(8):
        values = modulus(alpha_hat, alpha_hat**2 / 4)
        k = int(np.argmin(values))
        low, high = alpha_hat[max(k - 1, 0)], alpha_hat[min(k + 1, len(alpha_hat) - 1)]
        best = float(values[k]), float(alpha_hat[k]), float(alpha_hat[k] ** 2 / 4)
        alpha_hat = np.linspace(low, high, 101)
    return best


def random_implicit_runge_kutta(number: int) -> Method:
    """Return method number 0, 1, 2, ... of a fixed sequence: two or three stages, small rationals."""
    rng = random.Random(f"implicit Runge-Kutta {number}")

    def small() -> Fraction:
        denominator = rng.randint(1, 4)
        return Fraction(rng.randint(-2 * denominator, 2 * denominator), denominator)

    stages = 2 + number % 2
    rows = [[small() if rng.random() < 0.8 else Fraction(0) for _ in range(stages)] for _ in range(stages)]
    rows[0][stages - 1] += 1  # never explicit
    weights = [small() for _ in range(stages - 1)]
    weights.append(1 - sum(weights, Fraction(0)))
    return Method(f"implicit RK {number}", RungeKutta(tuple(map(tuple, rows)), tuple(weights)), "random")
