"""What falls by itself falls at the rate of its equation, at any step; what a smaller step mends is unsafe."""

from dataclasses import replace
from fractions import Fraction
from math import sqrt
from typing import Any

import numpy as np
import pytest

from bezstab.engines.drives import Timing
from bezstab.mujoco.controllers import Gains
from bezstab.mujoco.growth import Growth, goes_on_growing, growth_at, stable_factor
from bezstab.mujoco.robots import Robot
from tests.mujoco.models import INTEGRATORS, WEIGHTLESS, mjcf
from tests.mujoco.test_steps import at_qpos0, model_of, robot_of

mujoco: Any = pytest.importorskip("mujoco")

POLE = """<body><joint name="foot" axis="0 1 0"/><inertial pos="0 0 .5" mass="2" diaginertia=".1 .1 .1"/></body>"""
FALLS = sqrt(2 * 10 * 0.5 / (0.1 + 2 * 0.5**2))  # m g l / I
"""1/s, of the pole that stands on its foot."""


def found(text: str, *gains: Gains, timing: Timing | None = None) -> tuple[Robot, Growth]:
    robot = robot_of(model_of(text), *gains, timing=timing)
    return robot, growth_at(robot, at_qpos0(robot))


@pytest.mark.parametrize("integrator", INTEGRATORS)
@pytest.mark.parametrize("h", [0.02, 0.01, 0.005])
def test_an_inverted_pendulum_falls_by_itself(integrator: str, h: float) -> None:
    _, growth = found(mjcf(POLE, integrator=integrator, h=h, gravity=-10))
    assert growth.kind == "falls by itself"
    assert growth.rate is not None
    assert growth.rate == pytest.approx(FALLS, rel=1e-2)


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_a_run_from_there_lets_it_fall(integrator: str) -> None:
    """A pole that stands goes on falling, one that is thrown does not, though its matrix there is the same."""
    robot, growth = found(mjcf(POLE, integrator=integrator, gravity=-10))
    assert growth.z_abs is not None
    assert goes_on_growing(robot, at_qpos0(robot), growth.z_abs)
    thrown = replace(at_qpos0(robot), velocities=np.array([60.0]))
    assert not goes_on_growing(robot, thrown, growth.z_abs)


@pytest.mark.parametrize(("kd", "kind"), [(0, "unsafe"), (1, "decays")])
def test_what_grows_because_the_torque_is_late_is_unsafe_though_no_step_is_short_enough(kd: int, kind: str) -> None:
    """Without damping the rate is that of h: kp h late / 2 I."""
    gains = Gains("foot", Fraction(100), Fraction(kd))
    assert found(mjcf(POLE), gains, timing=Timing(1, Fraction(1)))[1].kind == kind


@pytest.mark.parametrize("kv", [20, 400, 4000])
def test_a_drive_beyond_its_limit_is_unsafe_and_its_largest_step_is_the_maps(kv: float) -> None:
    """2 alpha_hat + beta_hat < 4 with alpha_hat = kv h / I, also on a pole that falls besides."""
    drive = f'<actuator><position joint="foot" kp="50" kv="{kv}"/></actuator>'
    for gravity, stiffness in ((0.0, 50.0), (-10.0, 40.0)):
        robot, growth = found(mjcf(POLE, drive, h=0.02, gravity=gravity))
        assert growth.kind == ("unsafe" if kv > 60 else "decays")
        h = 0.02 * float(stable_factor(robot, at_qpos0(robot), growth) or 0)
        assert 2 * kv * h / 0.6 + stiffness * h**2 / 0.6 == pytest.approx(4, rel=2e-3)
        assert (h < 0.02) is (growth.kind == "unsafe")


PENDULUM = POLE.replace("0 0 .5", "0 0 -.5")
FREE = f'<body pos="0 0 1"><freejoint/><geom size=".1" pos=".1 0 .2" {WEIGHTLESS}/></body>'
BALL = '<geom type="plane" size="1 1 .1"/><body pos="0 0 .0999"><freejoint/><geom size=".1"/></body>'
WEAK, STRONG = (f'<actuator><position joint="foot" kp="{kp}" kv="1"/></actuator>' for kp in (5, 15))  # than m g l


@pytest.mark.parametrize(
    ("world", "drive", "kind"),
    [
        (POLE, WEAK, "falls by itself"),
        (POLE, STRONG, "decays"),
        (PENDULUM, "", "neutral"),
        (FREE, "", "neutral"),
        (BALL, "", "neutral or decays"),
        # the slower growth of the second pole is none of the mechanism's own
        (POLE + POLE.replace("foot", "second"), WEAK.replace('kv="1"', 'kv="301"'), "unsafe"),
    ],
)
def test_what_falls_decays_and_does_neither_is_told_apart(world: str, drive: str, kind: str) -> None:
    assert found(mjcf(world, drive, gravity=-10))[1].kind in kind
