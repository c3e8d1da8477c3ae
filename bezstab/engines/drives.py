"""A joint's drive: torque = -kp (q - target) - kd q' on an inertia is the feedback of a constraint q = target.

    alpha_hat = kd h / inertia          beta_hat = kp h^2 / inertia

What decides is when the torque is evaluated. With a = alpha_hat and b = beta_hat:

    explicit, from the old state                            SYM               stable for 2 a + b < 4
    implicit in the velocity, old position                  imex-euler        b < 4 + 2 a: only kp has a limit
    stable PD, both where they would be without it          stable-pd         b < (4 + 2 a) / 3: only kp has a limit
    fully implicit                                          implicit-euler    all
"""

from dataclasses import dataclass
from fractions import Fraction
from math import ceil, floor

from bezstab.engines.conversions import Point
from bezstab.errors import InputError
from bezstab.rationals import within_float64
from bezstab.units import feedback_gains, from_feedback_gains

DRIVE_METHODS = {
    "SYM": "explicit",
    "imex-euler": "implicit in velocity",
    "stable-pd": "stable PD",
    "implicit-euler": "fully implicit",
}
"""What a way of applying a drive is called, by the method that it is: what engines do."""


@dataclass(frozen=True)
class Drive:
    """A joint's gains and the inertia that they act on, in units that go together (N m/rad, N m s/rad, kg m^2).

    With `ki` (N m/(rad s)) the torque has an integral part. InputError for an inertia that is not positive, and for ki
    without kp.
    """

    kp: Fraction
    kd: Fraction
    inertia: Fraction
    ki: Fraction = Fraction(0)

    def __post_init__(self) -> None:
        if self.inertia <= 0:
            raise InputError(f"inertia {float(self.inertia):g}: expected above 0")
        if self.ki and not self.kp:
            raise InputError("--ki needs --kp: without it the integral alone drives the joint, and it never settles")

    def point(self, h: Fraction) -> Point:
        """Return (alpha_hat, beta_hat) at a step of h seconds; InputError outside float64's range."""
        alpha_hat, beta_hat = from_feedback_gains(self.kd / self.inertia, self.kp / self.inertia, h)
        return within_float64(alpha_hat, "--kd: α̂ = kd h/inertia"), within_float64(beta_hat, "--kp: β̂ = kp h²/inertia")

    def gains(self, alpha_hat: float, beta_hat: float, h: float) -> tuple[float, float]:
        """Return (kp, kd) that are the point (alpha_hat, beta_hat) on this inertia at a step of h seconds."""
        damping, stiffness = feedback_gains(alpha_hat, beta_hat, h)
        return stiffness * float(self.inertia), damping * float(self.inertia)


MOST_STEPS = 100
"""Of `every` and of `late`: the polynomial's degree is theirs, and nobody's controller is slower."""


@dataclass(frozen=True)
class Timing:
    """When a controller computes the torque and when it is applied, in steps of the physics.

    `every`: steps from one computation to the next. `late`: steps from a computation until its torque is applied; of a
    step that begins with a fraction of it left, the torque before keeps that share. `filter_steps`: the time constant
    of a first-order filter through which the controller sees the velocity, over h; 0 for none. It is stepped with the
    controller, by the implicit Euler method: y' = y + (v - y) / (1 + filter_steps / every).

    InputError where one is out of its range.
    """

    every: int = 1
    late: Fraction = Fraction(0)
    filter_steps: Fraction = Fraction(0)

    def __post_init__(self) -> None:
        if not 1 <= self.every <= MOST_STEPS:
            raise InputError(f"--every {self.every}: expected a whole number of steps from 1 to {MOST_STEPS}")
        if not 0 <= self.late <= MOST_STEPS:
            raise InputError(f"--late {float(self.late):g}: expected from 0 to {MOST_STEPS} steps")

    def applied(self, step: int) -> list[tuple[int, Fraction]]:
        """Return what acts in a step after the latest computation: how far back it was computed, and its share.

        What was computed i times `every` steps ago is applied from the step whole - i every on; in that very step the
        one before it keeps the share of `late` beyond whole steps.
        """
        whole = floor(self.late)
        left = self.late - whole
        begun = max(0, ceil(Fraction(whole - step, self.every)))
        if left and step == whole - begun * self.every:
            return [(begun, 1 - left), (begun + 1, left)]
        return [(begun, Fraction(1))]


FRESH = Timing()
"""The torque is computed in every step and applied at once."""


def timing_of(
    h: Fraction, every: int = 1, late: Fraction = Fraction(0), filter_seconds: Fraction = Fraction(0)
) -> Timing:
    """Return the timing of a controller with steps of h (s), its filter in s; InputError as `Timing`."""
    if filter_seconds < 0:
        raise InputError(f"--filter {float(filter_seconds):g}: expected 0 s or more")
    return Timing(every, late, filter_seconds / h)
