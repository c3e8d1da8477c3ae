r"""What the motion of a mechanism does to the poles at rest, to first order in omega h: rates of growth with bands.

Along the motion each pole z of the map carries errors w_n = z^n Y(n h), where Y' = chi K(t) Y: K(t) says how the
normals of the constraints turn (`mechanism.constraint_normals`), chi how the method takes it (`stability.turning`).

    |z|   worst      - - - - - - - - -   |z| exp(h max_t max Re(chi eig K)): for moments only
          moving     ------------------  |z| exp(h Lambda): over the motion, Lambda = ln(growth of Y) / duration
          at rest    . . . . . . . . .   the map

Over a closed motion the integral of tr K is zero, so det Y = 1 and Lambda >= 0: the motion never helps.
"""

from dataclasses import dataclass
from functools import cache
from typing import Literal, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bezstab.evidence.mixing_poles import NearestPoles, nearest_poles
from bezstab.mechanism import TurningNormals
from bezstab.methods import Method
from bezstab.stability import BoolArray, ComplexArray, FloatArray, bisected

LAW_HOLDS = 0.1  # rad, kappa h: at twice that terms beside chi, too, have been seen to turn 0.94 into 1.05

LARGEST_CHI = 32.0  # of the table: ten times what is seen on a boundary; further out the law does not hold at any speed
RADII, ANGLES = LARGEST_CHI * np.linspace(0, 1, 101) ** 2, np.linspace(0, np.pi, 61)  # of the table: half the circle
AT_A_TIME = 1024  # chi whose Y stay in a core's cache through all steps, and points with the distances of their poles

Value = TypeVar("Value", bound=np.generic)

MovingVerdict = Literal["converges", "diverges", "not settled for this mechanism"]


@dataclass(frozen=True)
class MovingPole:
    """The dominant pole of a moving mechanism at one point; everything is per step of the method, dimensionless.

    `z_abs`: at rest. `chi_abs`: |chi| of the pole that grows most over the motion. `z_abs_moving`: its rate over the
    motion. `z_abs_worst`: the largest momentary rate of any pole. `kappa`: in 1/s. `double`: another pole is so near
    that the first-order law fails; then the largest rate is how far the two can come (mixing_poles), and the rate over
    the motion at most that. `settled`: all of the band, and the second-order terms that were left out, are on one side
    of one; where kappa h is beyond LAW_HOLDS nothing is settled to converge. `safe_speed`: so many times as fast the
    mechanism may move, at this step, until its rate is one or the law ends; infinite where it does not turn, nan where
    it diverges at rest.
    """

    z_abs: float
    kappa: float
    chi_abs: float
    z_abs_moving: float
    z_abs_worst: float
    double: bool
    settled: bool
    safe_speed: float

    def shift(self, method: Method, h: float) -> float:
        """By what share the motion moves the pole at most, |chi| kappa h; h is the user's step in s."""
        return self.chi_abs * self.kappa * h * float(method.step_multiple)

    @property
    def verdict(self) -> MovingVerdict:
        """What errors do over the motion, if the band settles it."""
        if not self.settled:
            return "not settled for this mechanism"
        return "converges" if self.z_abs_moving < 1 else "diverges"


def growth_rates(turning: TurningNormals, chi: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Return Lambda (1/s), how fast Y' = chi K(t) Y grows over the motion, and what of it is sure; shape of chi each.

    Over a revolution: of the spectral radius of Y, all of it sure. Over a run, which has no such thing: of Y's norm,
    errors measured by the displacement they stand for. That changes over a run, and even an error that stays as it is
    may seem to grow; sure is the lesser of it and of the growth of errors as they are. Runge and Kutta's rule for
    linear equations, K at every second sample in the middle of a step. From |chi| = LARGEST_CHI on both are taken to
    grow in proportion.
    """
    chi = np.asarray(chi, complex)
    beyond = np.maximum(1, np.abs(chi) / LARGEST_CHI)
    size = turning.rates.shape[1]
    unit = np.eye(size)[:, :, np.newaxis]  # chi last: K multiplies them all at once
    grown, log_scale = unit + 0 * chi.ravel(), np.zeros(chi.size)
    by_chi = 2 * turning.duration / (len(turning.rates) - 1) * (chi / beyond).ravel()
    for start, middle, end in zip(turning.rates[:-1:2], turning.rates[1::2], turning.rates[2::2], strict=True):
        first = np.tensordot(start, by_chi * grown, 1)
        second = np.tensordot(middle, by_chi * (grown + first / 2), 1)
        third = np.tensordot(middle, by_chi * (grown + second / 2), 1)
        fourth = np.tensordot(end, by_chi * (grown + third), 1)
        grown = grown + (first + 2 * second + 2 * third + fourth) / 6
        largest = np.abs(grown).max(axis=(0, 1))  # or it would run into infinity
        grown /= largest
        log_scale += np.log(largest)
    grown = grown.transpose(2, 0, 1)
    if turning.closed:
        multiplied = sure = np.abs(np.linalg.eigvals(grown)).max(axis=-1)
    else:
        before, after = (np.linalg.cholesky(metric) for metric in turning.metric)
        multiplied = np.linalg.norm(np.linalg.solve(after, grown @ before), ord=2, axis=(-2, -1))
        sure = np.minimum(multiplied, np.linalg.norm(grown, ord=2, axis=(-2, -1)))
    rates, sure = (np.log([multiplied, sure]) + log_scale).reshape(2, *chi.shape) * beyond / turning.duration
    return rates, sure


@cache
def _growth_table(turning: TurningNormals) -> FloatArray:
    """Return the table of one motion, of shape (RADII, ANGLES), which `growth_between` fills as it is asked.

    A search asks for few entries, and each takes long where there are many constraints. Others are not numbers.
    """
    return np.full((RADII.size, ANGLES.size), np.nan)


def growth_between(turning: TurningNormals, chi: ComplexArray) -> FloatArray:
    """Return Lambda (1/s) for very many chi, between the entries of a table; shape of chi, a row.

    Lambda depends on the motion and chi alone, is the same at conjugates, and grows in proportion far out. Linear
    between neighbours, which are 2 % apart in |chi| and 3 degrees in angle: good to about 1e-3 of Lambda, where the
    law itself leaves out terms of |chi| kappa h.
    """
    radius = np.abs(chi)
    beyond = np.maximum(1, radius / LARGEST_CHI)
    row = np.interp(radius / beyond, RADII, np.arange(RADII.size))
    column = np.interp(np.abs(np.angle(chi)), ANGLES, np.arange(ANGLES.size))
    i, k = np.minimum(row.astype(int), RADII.size - 2), np.minimum(column.astype(int), ANGLES.size - 2)
    u, v = row - i, column - k
    corners = np.array([i, i, i + 1, i + 1]), np.array([k, k + 1, k, k + 1])
    shares = np.array([(1 - u) * (1 - v), (1 - u) * v, u * (1 - v), u * v])
    table = _growth_table(turning)
    wanted = np.zeros(table.shape, bool)
    wanted[corners] = True
    missing = wanted & np.isnan(table)
    if missing.any():
        table[missing], _ = growth_rates(turning, np.multiply.outer(RADII, np.exp(1j * ANGLES))[missing])
    return np.asarray(beyond * (shares * table[corners]).sum(axis=0))


def momentary_rates(turning: TurningNormals, chi: ComplexArray) -> FloatArray:
    """Return the largest growth rate for a moment: of chi times an eigenvalue of K(t) along the motion (1/s).

    float64, shape of chi, which has no unit. To first order in K, for each moment by itself (evidence/README.md).
    """
    eigenvalues = np.linalg.eigvals(turning.rates).ravel()
    return np.asarray(np.multiply.outer(chi, eigenvalues).real.max(axis=-1))


@dataclass(frozen=True, eq=False)
class Law:
    """What the first-order law makes of the poles at a row of points; of shape (points, poles), the dominant one first.

    `at_rest` is ln|z| a step, `growth` h Lambda of each pole and `sure` what of it is sure (`growth_rates`),
    minus infinity of a pole that does not count: too small ever to lead, or the conjugate of one that counts. `turned`
    is kappa h of the method's own step.
    """

    nearest: NearestPoles
    turned: float
    at_rest: FloatArray
    chi: ComplexArray
    counts: BoolArray
    growth: FloatArray
    sure: FloatArray

    def mixing(self, times: FloatArray | float = 1.0) -> BoolArray:
        """Return which poles the law moves too near to their neighbours, or to no finite place, so `times` as fast."""
        turned = times * self.turned
        return self.counts & self.nearest.mix(turned) & (self.nearest.reach(turned) > 0)

    def furthest(self, times: FloatArray | float = 1.0) -> FloatArray:
        """Return ln|z| a step over the motion: by the law, and of poles that mix as far as they reach."""
        with np.errstate(divide="ignore", invalid="ignore"):
            reached = np.log(self.nearest.reach(times * self.turned))
        return np.where(self.mixing(times), reached, self.at_rest + times * self.growth)

    @property
    def rate(self) -> FloatArray:
        """ln|z| a step over the motion of the pole that grows most; shape (points,).

        That of a pole that mixes is at most what it reaches, and none is less than at rest.
        """
        of_each = np.minimum(self.at_rest + self.growth, self.furthest())
        return np.asarray(np.maximum(self.at_rest[:, 0], of_each.max(axis=1)))

    @property
    def double(self) -> BoolArray:
        """Where the pole that comes furthest is one that mixes; shape (points,)."""
        return self.leading(self.mixing())

    def leading(self, values: NDArray[Value]) -> NDArray[Value]:
        """Return what the pole that comes furthest has of values of shape (points, poles); shape (points,)."""
        return np.asarray(values[np.arange(len(values)), np.argmax(self.furthest(), axis=1)])

    def safe_speeds(self) -> FloatArray:
        """Return so many times as fast the mechanism may move until a pole comes as far as one; shape (points,).

        But not beyond LAW_HOLDS; not a number where it does so at rest.
        """
        decays = self.at_rest[:, 0] < 0
        if self.turned == 0:
            return np.where(decays, np.inf, np.nan)
        fastest = np.full(decays.shape, LAW_HOLDS / self.turned)
        speeds, _ = bisected(lambda times: self.furthest(times[:, np.newaxis]).max(axis=1) >= 0, 0 * fastest, fastest)
        return np.where(decays, speeds, np.nan)


def first_order_law(
    method: Method,
    turning: TurningNormals,
    h: float,
    alpha_hat: FloatArray,
    beta_hat: FloatArray,
    *,
    tabulated: bool = False,
) -> Law:
    """Return what a motion makes of the poles at a row of points; h in s, the rest dimensionless.

    `tabulated`: by the motion's table, for very many points. There a pole so far from one that no
    motion of this kappa could bring it there keeps its |z| at rest. NumericalError if a pole leaves the range of
    float64.
    """
    nearest = nearest_poles(method, alpha_hat, beta_hat)
    z, step = nearest.z, h * float(method.step_multiple)
    turned = turning.kappa * step
    with np.errstate(all="ignore"):
        at_rest, chi = np.log(np.abs(z)), nearest.shift / z
    counts = nearest.may_lead & (z.imag >= 0)  # of a conjugate pair both grow alike
    known = counts & np.isfinite(chi)
    growth, sure = np.where(counts, 0.0, -np.inf), np.full(z.shape, -np.inf)
    if tabulated:
        matters = known & (np.abs(at_rest) < np.abs(np.where(known, chi, 0)) * turning.largest_norm * step)
        growth[matters] = step * growth_between(turning, chi[matters])
    else:
        growth[known], sure[known] = step * np.array(growth_rates(turning, chi[known]))
    return Law(nearest, turned, at_rest, chi, counts, growth, sure)


def moving_poles(
    method: Method, turning: TurningNormals, h: float, alpha_hat: ArrayLike, beta_hat: ArrayLike
) -> list[MovingPole]:
    """Return what becomes of the poles at one point, or each of a row of them, on a mechanism that moves; h in s.

    Theory: the first-order law of the moving mechanism (docstring of this file). NumericalError if a pole leaves the
    range of float64.
    """
    law = first_order_law(method, turning, h, *(np.atleast_1d(np.asarray(each)) for each in (alpha_hat, beta_hat)))
    nearest, turned = law.nearest, law.turned
    mixing, furthest = law.mixing(), law.furthest()
    alone = law.counts & np.isfinite(law.chi) & ~mixing
    worst = np.full(law.chi.shape, -np.inf)
    worst[alone] = law.at_rest[alone] + h * float(method.step_multiple) * momentary_rates(turning, law.chi[alone])
    highest = np.maximum(worst, furthest).max(axis=1)
    with np.errstate(all="ignore"):
        of_one = (np.abs(law.chi) * turned) ** 2 if turned else np.zeros(law.chi.shape)  # at rest however large chi is
        unsure = law.leading(np.where(mixing, nearest.left_out(turned), of_one))
        highest = np.maximum(highest, law.at_rest[:, 0])
        lowest_of_pair = np.log(np.maximum(law.leading(2 * nearest.middle - nearest.reach(turned)), 0))
    lowest_alone = np.where(mixing, -np.inf, law.at_rest + law.sure).max(axis=1)
    lowest = np.where(law.double, lowest_of_pair, lowest_alone)
    settled = ((highest < -unsure) & (turned <= LAW_HOLDS)) | (lowest > unsure)
    columns = (
        *(nearest.z_abs, np.full(len(settled), turning.kappa), law.leading(np.abs(law.chi))),
        *(np.exp(law.rate), np.exp(highest), law.double, settled),
        law.safe_speeds(),
    )
    return [MovingPole(*values) for values in zip(*(column.tolist() for column in columns), strict=True)]
