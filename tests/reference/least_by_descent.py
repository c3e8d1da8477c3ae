"""The least |z_p| over alpha_hat, beta_hat >= 0 by random descent from everywhere, in a box of any size."""

import numpy as np

from bezstab.methods.schemes import Method
from bezstab.stability.arrays import FloatArray
from bezstab.stability.closed_loop import spectral_radius

SMALLEST = 1e-3
FEWEST = 12  # starts that go on to the end; in each round the worst is given up
TRIALS = 16  # random steps of every start in a round
ROUNDS = 300
WIDEST, NARROWER, WIDER = 0.5, 0.85, 1.5  # of a parameter: the first steps, and the factor after failure and success


def least_within(method: Method, furthest: float) -> float:
    """Return the least |z_p| found with alpha_hat, beta_hat <= furthest.

    By beta_hat and the damping ratio, half of the steps by beta_hat alone: along alpha_hat = 0 and the parabola of
    critical damping valleys are too steep for others.
    """
    rng = np.random.default_rng(0)
    zeta, beta_hat = np.meshgrid(
        [0, 1, *np.geomspace(SMALLEST, 1 / SMALLEST, 40)], np.geomspace(SMALLEST, furthest, 100)
    )

    def z_abs(beta_hat: FloatArray, zeta: FloatArray) -> FloatArray:
        return np.asarray(spectral_radius(method, np.minimum(2 * zeta * np.sqrt(beta_hat), furthest), beta_hat))

    best = np.argmin(z_abs(beta_hat, zeta), axis=0), np.arange(len(zeta[0]))
    place = np.stack([beta_hat[best], zeta[best]], axis=1)
    value, step = z_abs(*place.T), np.full(len(place), WIDEST)
    for _ in range(ROUNDS):
        moves = rng.normal(size=(TRIALS, *place.shape)) * step[:, np.newaxis]
        moves[::2, :, 1] = 0
        trials = np.minimum(place * np.exp(moves), furthest)
        values = z_abs(*np.moveaxis(trials, -1, 0))
        best = np.argmin(values, axis=0), np.arange(len(place))
        better = values[best] < value
        place[better], value = trials[best][better], np.where(better, values[best], value)
        step = np.minimum(step * np.where(better, WIDER, NARROWER), WIDEST)
        lowest = np.argsort(value)[: max(FEWEST, len(value) - 1)]
        place, value, step = place[lowest], value[lowest], step[lowest]
    return float(value.min())
