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

    InputError for an inertia that is not positive.
    """

    kp: Fraction
    kd: Fraction
    inertia: Fraction

    def __post_init__(self) -> None:
        if self.inertia <= 0:
            raise InputError(f"inertia {float(self.inertia):g}: expected above 0")

    def point(self, h: Fraction) -> Point:
        """Return (alpha_hat, beta_hat) at a step of h seconds; InputError outside float64's range."""
        alpha_hat, beta_hat = from_feedback_gains(self.kd / self.inertia, self.kp / self.inertia, h)
        return within_float64(alpha_hat, "--pd: α̂ = kd h/inertia"), within_float64(beta_hat, "--pd: β̂ = kp h²/inertia")

    def gains(self, alpha_hat: float, beta_hat: float, h: float) -> tuple[float, float]:
        """Return (kp, kd) that are the point (alpha_hat, beta_hat) on this inertia at a step of h seconds."""
        damping, stiffness = feedback_gains(alpha_hat, beta_hat, h)
        return stiffness * float(self.inertia), damping * float(self.inertia)
