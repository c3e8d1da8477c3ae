import math
from fractions import Fraction

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bezstab.engines.acceleration_engines import BRAX_SPRING
from bezstab.engines.position_engines import XPBD
from bezstab.engines.velocity_engines import (
    BOX2D,
    BULLET,
    CHIPMUNK,
    DRAKE_SAP,
    JOLT_SPRING,
    NEAR_RIGID,
    ODE,
    PHYSX_DRIVE,
    RAPIER,
)
from bezstab.methods import lookup
from bezstab.stability import poles


@settings(max_examples=20, deadline=None)
@given(st.floats(0.01, 1.99))
def test_an_erp_is_symplectic_euler_at_alpha_hat_one(erp: float) -> None:
    a, b = map(float, BULLET.point((Fraction(erp),), Fraction(1, 60)))
    assert sorted(abs(poles(lookup("SYM"), a, b))) == pytest.approx([0, abs(1 - erp)], abs=1e-12)


@settings(max_examples=20, deadline=None)
@given(st.floats(0.1, 1e4), st.floats(0.1, 100), st.floats(1e-4, 0.05))
def test_a_spring_and_damper_as_erp_and_cfm_is_implicit_euler(kp: float, kd: float, h: float) -> None:
    # ODE's manual: ERP = h kp / (h kp + kd) and CFM = 1 / (h kp + kd) are an implicit spring and damper
    values = tuple(map(Fraction, (h * kp / (h * kp + kd), 1 / (h * kp + kd), 1.0)))
    a, b = map(float, ODE.point(values, Fraction(h)))
    implicit = poles(lookup("implicit-euler"), kd * h, kp * h * h)
    ours = poles(lookup("SYM"), a, b)
    assert (ours.sum().real, ours.prod().real) == pytest.approx((implicit.sum().real, implicit.prod().real), rel=1e-9)


def test_box2d_clamps_its_joints_to_a_quarter_of_a_turn_per_step() -> None:
    h = Fraction(1, 100)
    fast = BOX2D.applied((Fraction(60), Fraction(2)), h)
    assert fast.point == BOX2D.point((Fraction(25), Fraction(2)), h)
    assert fast.notes == ("hertz 60 is clamped to 0.25/h = 25",)
    assert not BOX2D.applied((Fraction(25), Fraction(2)), h).notes
    assert BOX2D.point((Fraction(60), Fraction(2)), h)[1] > fast.point[1]


def test_box2ds_default_joint_is_where_it_was_measured() -> None:
    alpha_hat, beta_hat = BOX2D.applied((Fraction(60), Fraction(2)), Fraction(1, 240)).point
    assert alpha_hat == 1
    assert 1 - float(beta_hat) == pytest.approx(0.746948, abs=1e-6)  # a compiled Box2D, per substep


@settings(max_examples=20, deadline=None)
@given(st.floats(0.5, 500), st.floats(0.05, 10))
def test_rapiers_softness_stays_when_it_relaxes_and_box2ds_does_not(hertz: float, zeta: float) -> None:
    h, values = Fraction(1, 240), (Fraction(hertz), Fraction(zeta))
    turn = 2 * math.pi * hertz / 240
    kept = 1 / (1 + turn * (2 * zeta + turn))  # of a velocity, by one soft solve
    soft, hard = (sorted(poles(lookup("SYM"), *map(float, each.point(values, h))).real) for each in (RAPIER, BOX2D))
    assert hard[0] == pytest.approx(0, abs=1e-12)
    assert sorted([kept, hard[1]]) == pytest.approx(soft, abs=1e-7)  # next to each other: half the digits


def test_chipmunk_leaves_its_share_whatever_the_step() -> None:
    for h in (Fraction(1, 60), Fraction(1, 240)):
        _, beta_hat = CHIPMUNK.point((Fraction("0.9") ** 60,), h)
        assert (1 - float(beta_hat)) ** float(1 / h) == pytest.approx(0.9**60)


def test_sap_is_no_stiffer_than_near_rigid() -> None:
    h = Fraction(1, 100)
    stiff = DRAKE_SAP.applied(tuple(map(Fraction, (10**9, 0, 1))), h)
    assert stiff.point == DRAKE_SAP.point((), h)
    assert stiff.notes == ("near rigid: k is lowered until w/R = 3948, and tau is h",)
    alpha_hat, beta_hat = DRAKE_SAP.point((), h)
    assert (alpha_hat, beta_hat / alpha_hat) == (NEAR_RIGID / (1 + NEAR_RIGID), Fraction(1, 2))
    assert sorted(abs(poles(lookup("SYM"), float(alpha_hat), float(beta_hat)))) == pytest.approx(
        [0.0005, 0.49987], abs=1e-5
    )


def test_a_frequency_and_a_damping_ratio_are_a_stiffness_and_a_damping() -> None:
    omega = 2 * math.pi * 3
    by_frequency = JOLT_SPRING.point((Fraction(3), Fraction(1, 2)), Fraction(1, 100))
    by_stiffness = PHYSX_DRIVE.point((Fraction(omega**2), Fraction(omega)), Fraction(1, 100))
    assert tuple(map(float, by_frequency)) == pytest.approx(tuple(map(float, by_stiffness)), rel=1e-12)


def test_a_compliance_is_the_inverse_of_a_stiffness() -> None:
    assert XPBD.point((Fraction(1, 400), Fraction(3), Fraction(2)), Fraction(1, 100)) == PHYSX_DRIVE.point(
        (Fraction(800), Fraction(6)), Fraction(1, 100)
    )


def test_brax_divides_by_the_mass() -> None:
    stiff, damped = Fraction(2000), Fraction(30)
    assert BRAX_SPRING.point((stiff, damped, Fraction(5)), Fraction(1, 100)) == BRAX_SPRING.point(
        (stiff / 5, damped / 5), Fraction(1, 100)
    )
