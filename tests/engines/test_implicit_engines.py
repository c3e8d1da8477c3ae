import math
from fractions import Fraction

import pytest

from bezstab.engines.implicit_engines import BRAX_SPRING, JOLT_SPRING, PHYSX_DRIVE, XPBD

H = Fraction(1, 100)


def test_a_frequency_and_a_damping_ratio_are_a_stiffness_and_a_damping() -> None:
    omega = 2 * math.pi * 3
    by_frequency = JOLT_SPRING.point((Fraction(3), Fraction(1, 2)), H)
    by_stiffness = PHYSX_DRIVE.point((Fraction(omega**2), Fraction(omega)), H)
    assert tuple(map(float, by_frequency)) == pytest.approx(tuple(map(float, by_stiffness)), rel=1e-12)


def test_a_compliance_is_the_inverse_of_a_stiffness() -> None:
    assert XPBD.point((Fraction(1, 400), Fraction(3), Fraction(2)), H) == PHYSX_DRIVE.point(
        (Fraction(800), Fraction(6)), H
    )


def test_brax_divides_by_the_mass() -> None:
    stiff, damped = Fraction(2000), Fraction(30)
    assert BRAX_SPRING.point((stiff, damped, Fraction(5)), H) == BRAX_SPRING.point((stiff / 5, damped / 5), H)
