from fractions import Fraction

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bezstab.engines.velocity_engines import (
    BOX2D,
    DRAKE_SAP,
    NEAR_RIGID,
    ODE,
)
from bezstab.methods import lookup
from bezstab.stability import poles


@settings(max_examples=20, deadline=None)
@given(st.floats(0.1, 1e4), st.floats(0.1, 100), st.floats(1e-4, 0.05))
def test_a_spring_and_damper_as_erp_and_cfm_is_implicit_euler(kp: float, kd: float, h: float) -> None:
    # ODE's manual: ERP = h kp / (h kp + kd) and CFM = 1 / (h kp + kd) are an implicit spring and damper
    values = tuple(map(Fraction, (h * kp / (h * kp + kd), 1 / (h * kp + kd), 1.0)))
    a, b = map(float, ODE.read(Fraction(h), *values))
    implicit = poles(lookup("implicit-euler"), kd * h, kp * h * h)
    ours = poles(lookup("SYM"), a, b)
    assert (ours.sum().real, ours.prod().real) == pytest.approx((implicit.sum().real, implicit.prod().real), rel=1e-9)


def test_box2d_clamps_its_joints_to_a_quarter_of_a_turn_per_step() -> None:
    h = Fraction(1, 100)
    fast = BOX2D.applied((Fraction(60), Fraction(2)), h)
    assert fast.point == BOX2D.read(h, Fraction(25), Fraction(2))
    assert fast.notes == ("hertz 60 is clamped to 0.25/h = 25",)
    assert not BOX2D.applied((Fraction(25), Fraction(2)), h).notes
    assert BOX2D.read(h, Fraction(60), Fraction(2))[1] > fast.point[1]


def test_sap_is_no_stiffer_than_near_rigid() -> None:
    h = Fraction(1, 100)
    stiff = DRAKE_SAP.applied(tuple(map(Fraction, (10**9, 0, 1))), h)
    assert stiff.point == DRAKE_SAP.read(h)
    assert stiff.notes == ("near rigid: k is lowered until w/R = 3948, and tau is h",)
    alpha_hat, beta_hat = DRAKE_SAP.read(h)
    assert (alpha_hat, beta_hat / alpha_hat) == (NEAR_RIGID / (1 + NEAR_RIGID), Fraction(1, 2))
    assert sorted(abs(poles(lookup("SYM"), float(alpha_hat), float(beta_hat)))) == pytest.approx(
        [0.0005, 0.49987], abs=1e-5
    )
