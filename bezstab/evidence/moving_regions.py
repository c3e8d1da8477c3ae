r"""The region of a moving mechanism: where errors decay over its motion, inside the region at rest.

      beta_hat
        |        .-----.         outer curve: |z_p| = 1, the map's
        |      .' .--.  '.       inner curve: |z| = exp(-h Lambda(chi(z))), this mechanism's: there the decay of a
        |    .'  /    \   |      step is just what the motion takes back. It is found on lines of constant beta_hat,
        |---/---x------x--/--    by bisecting between a point that decays and one that does not
        |  /___/________\/
        +----------------- alpha_hat

To first order Lambda >= 0 over a closed motion, so that the inner curve is inside. The law does not hold where the pole
that decides mixes with another, its conjugate as a rule (`mixing_poles`). There it counts with what it reaches, if that
is less than what the law says, and such points are marked.
"""

from dataclasses import dataclass

import numpy as np

from bezstab.evidence.moving_mechanisms import AT_A_TIME, first_order_law
from bezstab.mechanism import TurningNormals
from bezstab.methods import Method
from bezstab.read_only import ReadOnlyArrays
from bezstab.stability import (
    BoolArray,
    FloatArray,
    Modulus,
    bisected,
    region,
    useful_window,
)

LINES = 160  # of constant beta_hat, at Gauss and Legendre's nodes: the length of a line has kinks, so 1e-4 of the area
SAMPLES = 241  # along a line; what is narrower than 1/240 of the window is not seen
HALVINGS = 20  # of a sample's width: 1e-6 of it, well below what the lines make of the area
HOPELESS = 10.0  # of ln|z| a step: nothing is chosen there, and `choose` can still raise |z| to a power


@dataclass(frozen=True, eq=False, repr=False)
class MovingRegion(ReadOnlyArrays):
    """The region of the moving mechanism, dimensionless; `h` (s) is the step.

    `area`: over the quadrant that the window shows. `alpha_hat` and `beta_hat` are the axes of a grid, `growth` ln|z| a
    step on it over the motion, `excluded` where the law does not hold; both of shape (beta_hat.size, alpha_hat.size).
    """

    method: Method
    h: float
    area: float
    alpha_hat: FloatArray
    beta_hat: FloatArray
    growth: FloatArray
    excluded: BoolArray

    @property
    def outside_the_law(self) -> BoolArray:
        """Where errors decay by a law that does not hold there; shape of `growth`."""
        return self.excluded & (self.growth < 0)

    def __repr__(self) -> str:
        return f"MovingRegion({self.method.name}: area {self.area:.6g} at h = {self.h:g} s)"


def moving_growth(
    method: Method, turning: TurningNormals, h: float, alpha_hat: FloatArray, beta_hat: FloatArray
) -> tuple[FloatArray, BoolArray]:
    """Return ln|z| a step over the motion of the pole that grows most, and where two poles mix (`Law.double`).

    Both have the shape of alpha_hat and beta_hat broadcast; h in s, the rest dimensionless. Where a pole at rest is so
    far from one that no motion of this kappa could matter its value is that at rest. To first order in kappa h
    (evidence/README.md). NumericalError where a pole leaves the range of float64.
    """
    alpha_hat, beta_hat = np.broadcast_arrays(alpha_hat, beta_hat)
    rates, doubles = np.empty(alpha_hat.size), np.empty(alpha_hat.size, bool)
    for first in range(0, alpha_hat.size, AT_A_TIME):
        some = slice(first, first + AT_A_TIME)
        law = first_order_law(method, turning, h, alpha_hat.ravel()[some], beta_hat.ravel()[some], tabulated=True)
        rates[some], doubles[some] = law.rate, law.double
    return rates.reshape(alpha_hat.shape), doubles.reshape(alpha_hat.shape)


def moving_modulus(method: Method, turning: TurningNormals, h: float) -> Modulus:
    """Return the function that gives |z| a step over the motion for arrays of alpha_hat and beta_hat; h in s.

    Where the first-order law makes it larger than exp(HOPELESS) that number stands for it. NumericalError, when called,
    as `moving_growth`; dimensionless, shape of the two broadcast.
    """

    def modulus(alpha_hat: FloatArray, beta_hat: FloatArray) -> FloatArray:
        growth, _ = moving_growth(method, turning, h, alpha_hat, beta_hat)
        return np.exp(np.minimum(growth, HOPELESS))

    return modulus


def moving_region(method: Method, turning: TurningNormals, h: float, points: int = SAMPLES) -> MovingRegion:
    """Return the region of a mechanism that moves, by the first-order law; h in s, `points` per axis of its grid.

    The area is that of the region at rest whose decay outlasts the motion, over the window that shows it.
    NumericalError if a pole leaves the range of float64.
    """
    at_rest = region(method)
    (alpha_low, alpha_high), (beta_low, beta_high) = useful_window(at_rest)
    nodes, weights = np.polynomial.legendre.leggauss(LINES)
    lines = beta_low + (beta_high - beta_low) * (nodes + 1) / 2
    lengths = _stable_lengths(method, turning, h, np.linspace(alpha_low, alpha_high, SAMPLES), lines)
    alpha_hat = np.linspace(alpha_low, alpha_high, points)
    beta_hat = np.linspace(beta_low, beta_high, points)
    growth, excluded = moving_growth(method, turning, h, alpha_hat, beta_hat[:, np.newaxis])
    return MovingRegion(
        method=method,
        h=h,
        area=float((beta_high - beta_low) / 2 * weights @ lengths),
        alpha_hat=alpha_hat,
        beta_hat=beta_hat,
        growth=growth,
        excluded=excluded,
    )


def _stable_lengths(
    method: Method, turning: TurningNormals, h: float, samples: FloatArray, lines: FloatArray
) -> FloatArray:
    """Return the length that decays on each line of constant beta_hat, between changes that are bisected."""

    def decays(alpha_hat: FloatArray, beta_hat: FloatArray) -> BoolArray:
        growth, _ = moving_growth(method, turning, h, alpha_hat, beta_hat)
        return growth < 0

    held = decays(samples, lines[:, np.newaxis])
    row, step = np.nonzero(held[:, 1:] != held[:, :-1])
    after = held[row, step + 1]
    _, changed = bisected(
        lambda middle: decays(middle, lines[row]) == after, samples[step], samples[step + 1], halvings=HALVINGS
    )
    lengths = np.where(held[:, -1], samples[-1], 0.0) - np.where(held[:, 0], samples[0], 0.0)
    np.add.at(lengths, row, np.where(after, -changed, changed))
    return lengths
