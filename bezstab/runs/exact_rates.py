r"""The exact rate of a moving mechanism: the method's step, linearised along the mechanism's motion, step after step.

The motion is that of a fine reference run. Each step starts on it and takes small changes by a matrix M_k, as a complex
step shows (`mechanism.stepper`). Over a revolution of N steps

    change after = Q change before,      Q = M_{N-1} ... M_1 M_0,      |z| = (largest |eigenvalue| of Q)^(1/N):

a Floquet multiplier, exact but for what the motion itself is computed with. Runs do not follow the motion of the
mechanism to the last digit: each step leaves an error, and by what truncation errors make of |z| their own rate
differs, up to 1e-3 at omega h = 0.1.

A run that does not begin anew has no eigenvalues; there it is the growth of the constraints' errors after a kick of the
position, by least squares over the later two thirds of the steps in which they stand out from what the free motion,
which does not decay, makes of it.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from bezstab.mechanism.equations import Mechanism
from bezstab.mechanism.generated_code import lane_function
from bezstab.mechanism.motions import Motion, regular_motion
from bezstab.mechanism.programs import program_of
from bezstab.mechanism.second_order_memory import Memory, memory
from bezstab.mechanism.start import constraint_jacobian
from bezstab.mechanism.stepper import linearized_step
from bezstab.methods.schemes import Method
from bezstab.stability.arrays import FloatArray
from bezstab.units import feedback_gains

FIRST_SHARE = 1 / 3  # of the steps in which errors stand out: there the lesser poles still count
VISIBLE = 1e-7  # of the change of the coordinates: the free motion of a method has a constraint error of this size


def exact_rates(
    mechanism: Mechanism, method: Method, h: float, alpha_hat: FloatArray, beta_hat: FloatArray, duration: float
) -> FloatArray:
    """Return |z| per step along the mechanism's motion at each of a row of points, shape (points,).

    h (s) is the user's step; over a revolution it is taken so that a whole number of steps fills it, at most half a
    step in all from h. A motion that is no revolution lasts `duration` (s). InputError and NumericalError as
    `regular_motion`.
    """
    stepped = stepped_motion(mechanism, method, h, duration)
    gains = np.array(feedback_gains(alpha_hat, beta_hat, stepped.step / float(method.step_multiple)))
    with np.errstate(all="ignore"):  # of what runs into infinity
        return _multipliers(stepped, gains) if stepped.along.closed else _growth_of_errors(stepped, gains)


@dataclass(frozen=True)
class SteppedMotion:
    """A method's steps along a motion: `steps` of `step` (s) fill it."""

    mechanism: Mechanism
    method: Method
    along: Motion
    steps: int
    step: float

    @property
    def memory(self) -> Memory:
        """What a step starts with."""
        return memory(self.method.scheme.second_order)

    def starts(self) -> FloatArray:
        """Return what each step starts with on the motion, in units of h, and the next one: (steps + 1, quantities, n).

        A revolution goes on as it began, a whole turn further.
        """
        place = np.add.outer(np.arange(self.steps + 1), self.memory.state_steps)
        turns = place // self.steps if self.along.closed else 0 * place
        times = self.step * (place - turns * self.steps)
        q, v, a = (each.reshape(*place.shape, -1) for each in self.along.at(times.ravel()))
        q = q + np.multiply.outer(turns, self.along.q[-1] - self.along.q[0])
        by_q, by_v, by_a = np.array(self.memory.shares, float).T[:, :, np.newaxis]
        return np.asarray(by_q * q + by_v * self.step * v + by_a * self.step**2 * a)


def stepped_motion(mechanism: Mechanism, method: Method, h: float, duration: float) -> SteppedMotion:
    """Return the motion in steps of about h (s) of the user's; errors as `regular_motion`."""
    along = regular_motion(mechanism, duration)
    steps = max(1, round(along.duration / (h * float(method.step_multiple))))
    return SteppedMotion(mechanism, method, along, steps, along.duration / steps)


def _changed(stepped: SteppedMotion, gains: FloatArray, changes: FloatArray) -> Iterator[tuple[FloatArray, FloatArray]]:
    """Yield after each step what has become of `changes`, (quantities, n, points, columns): exp(log_scale) of those.

    None of the changes at a point is larger than one; log_scale (points,). gains (2, points).
    """
    program, points = program_of(stepped.method.scheme.second_order), gains.shape[1]
    function, log_scale = lane_function(stepped.mechanism, "accelerations"), np.zeros(points)
    for k, start in enumerate(stepped.starts()[:-1]):
        carried = np.repeat(start[:, :, np.newaxis], points, axis=2)
        changes = linearized_step(program, function, k * stepped.step, stepped.step, gains, carried, changes)
        largest = np.abs(changes).max(axis=(0, 1, 3))
        largest[largest == 0] = 1
        changes = changes / largest[:, np.newaxis]
        log_scale = log_scale + np.log(largest)
        yield changes, log_scale


def _multipliers(stepped: SteppedMotion, gains: FloatArray) -> FloatArray:
    """Return |z| per step of a revolution by the leading multiplier; gains (2, points), shape (points,).

    Not a number where the equations of a step have no solution, or none that float64 can hold.
    """
    rows, n, points = len(stepped.memory.carried), stepped.mechanism.size, gains.shape[1]
    unit = np.repeat(np.eye(rows * n).reshape(rows, n, 1, -1), points, axis=2)
    for after in _changed(stepped, gains, unit):
        changes, log_scale = after
    products = changes.reshape(rows * n, points, -1).swapaxes(0, 1)
    finite = np.asarray(np.isfinite(products).all(axis=(1, 2)))
    multipliers = np.abs(np.linalg.eigvals(np.where(finite[:, np.newaxis, np.newaxis], products, 0.0))).max(axis=1)
    return np.where(finite, np.exp((log_scale + np.log(multipliers)) / stepped.steps), np.nan)


def _growth_of_errors(stepped: SteppedMotion, gains: FloatArray) -> FloatArray:
    """Return |z| per step at points with these gains by constraint errors after a kick; shape (points,).

    All positions that are carried are kicked, by unit errors. An error w has the size of the displacement
    M^-1 C_q^T S^-1 w that it stands for, in the metric of the masses: that of L^-1 w with S = C_q M^-1 C_q^T = L L^T.
    """
    mechanism, carried = stepped.mechanism, stepped.memory.carried
    mass = mechanism.mass
    *older, newest = [place for place, quantity in enumerate(carried) if quantity.name == "x"]
    t = stepped.step * np.arange(carried[newest].step, carried[newest].step + stepped.steps + 1, dtype=np.float64)
    sizes = []
    for time, q in zip(t, stepped.along.at(t)[0], strict=True):
        jacobian = constraint_jacobian(mechanism, float(time), q)
        sizes.append(np.linalg.solve(np.linalg.cholesky((jacobian / mass) @ jacobian.T), jacobian))
    kicked = np.zeros((len(carried), mechanism.size, gains.shape[1], len(mechanism.constraints)))
    kicked[[*older, newest]] = (sizes[0] / mass).T[:, np.newaxis]
    log_errors, visible = [], []
    for size, (changes, log_scale) in zip(sizes[1:], _changed(stepped, gains, kicked), strict=True):
        moved = np.moveaxis(changes[newest], 0, 1)
        error = np.sqrt(((size @ moved) ** 2).sum(axis=(1, 2)))
        log_errors.append(np.log(error) + log_scale)
        visible.append(error > VISIBLE * np.sqrt((mass @ moved**2).sum(axis=1)))
    growth = []
    for of_point, steps in zip(np.transpose(log_errors), np.logical_and.accumulate(visible).sum(axis=0), strict=True):
        end = max(steps, 2)
        first = int(FIRST_SHARE * end)
        growth.append(np.polyfit(np.arange(first, end), of_point[first:end], 1)[0])
    return np.exp(growth)
