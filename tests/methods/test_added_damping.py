"""The damping that a method adds to an undamped oscillator, against its poles to sixty digits."""

from fractions import Fraction

import mpmath
import pytest

from bezstab.methods.added_damping import added_damping
from bezstab.methods.derivation import closed_loop_at
from bezstab.methods.formulas import added_damping_text
from bezstab.methods.registry import REGISTRY, lookup
from bezstab.methods.schemes import Method
from tests.methods.kinds import FEW, SOLVED, sampled


def damping_ratio(method: Method, theta: Fraction) -> mpmath.mpf:
    """Return that of the pole nearest to e^(i theta), to the first digits of sixty."""
    coefficients = closed_loop_at(method, Fraction(0), theta**2)
    with mpmath.workdps(60):
        numbers = [mpmath.mpf(c.numerator) / c.denominator for c in coefficients]
        roots = mpmath.polyroots(numbers[::-1], maxsteps=2000, extraprec=400)
        exact = mpmath.expj(mpmath.mpf(theta.numerator) / theta.denominator * int(method.step_multiple))
        exponent = mpmath.log(min(roots, key=lambda z: abs(z - exact)))
        return -exponent.real / abs(exponent)


@pytest.mark.parametrize("name", sampled([*REGISTRY, "B2@2"], quick=[*FEW, *SOLVED, "B2@2"]))
def test_it_is_the_leading_term_of_the_pole_nearest_to_the_motion(name: str) -> None:
    """To twenty theta, at a thousandth of a rad; where decimals stand for irrational coefficients at a hundredth."""
    method = lookup(name)
    theta = Fraction(1, 1000 if method.digits is None else 100)
    found, ratio = added_damping(method), damping_ratio(method, theta)
    if found.power is None:
        assert abs(ratio) < float(theta) ** found.highest
    else:
        leading = float(ratio / mpmath.mpf(float(theta)) ** found.power)
        assert leading == pytest.approx(float(found.coefficient), rel=float(20 * theta))


WRITTEN = {
    "RK4": "θ^5/144",  # |z|^2 = 1 - theta^6 / 72 + theta^8 / 576
    "heun": "-θ^3/8",  # |z|^2 = 1 + theta^4 / 4
    "trapezoid": "0, up to θ^6",
    "tsit5": "4.33224e-5 θ^5",
}


def test_it_is_written_as_known_from_the_modulus() -> None:
    assert {name: added_damping_text(lookup(name)) for name in WRITTEN} == WRITTEN
