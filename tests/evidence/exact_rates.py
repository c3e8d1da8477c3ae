"""Exact rates of moving mechanisms as tests ask for them: by method, step and points."""

from bezstab.evidence.exact_rates import rates_on_the_motion, stepped_motion
from bezstab.mechanism import Mechanism
from bezstab.methods import Method
from bezstab.stability import FloatArray


def floquet_rates(
    mechanism: Mechanism, method: Method, h: float, alpha_hat: FloatArray, beta_hat: FloatArray, duration: float
) -> FloatArray:
    """Return |z| per step over the motion of the mechanism, shape (points,); h and the duration of a run in s."""
    stepped = stepped_motion(mechanism, method, h, duration)
    return rates_on_the_motion(stepped, stepped.gains(alpha_hat, beta_hat))
