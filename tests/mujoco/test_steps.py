"""The matrix of a step is what MuJoCo's own runs do: of random models, of controllers that are held and late."""

from fractions import Fraction
from typing import Any

import numpy as np
import pytest

from bezstab.drives.held_torque import held_method, spectral_radius
from bezstab.engines.drives import Timing
from bezstab.mujoco.controllers import Gains, controlled
from bezstab.mujoco.growth import growth_at
from bezstab.mujoco.reading import loaded_model
from bezstab.mujoco.robots import Robot, State
from bezstab.mujoco.steps import step_at
from tests.mujoco.models import random_model
from tests.reference.mujoco_steps import grown, step_moduli

mujoco: Any = pytest.importorskip("mujoco")


@pytest.fixture(autouse=True)
def _away_from_here(tmp_path: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """MuJoCo writes its warnings, of what diverges, into a file of the current directory."""
    monkeypatch.chdir(tmp_path)


def model_of(text: str) -> Any:
    return mujoco.MjModel.from_xml_string(text)


def robot_of(model: Any, *gains: Gains, timing: Timing | None = None) -> Robot:
    loaded = loaded_model(model)
    return Robot(mujoco, loaded.model, controlled(mujoco, loaded.model, gains), timing or Timing())


def at_qpos0(robot: Robot) -> State:
    return State("qpos0", np.array(robot.model.qpos0))


def agrees(model: Any) -> str:
    """Hold a model's |z| against other differences, of another nudge and other states, and its verdict against a run.

    Those have the free motions, too, which are one to 1e-4.
    """
    robot = robot_of(model)
    found = growth_at(robot, at_qpos0(robot))
    data = mujoco.MjData(model)
    moduli = step_moduli(mujoco, model, data)
    assert found.z_abs is not None
    assert np.abs(moduli / found.z_abs - 1).min() < 1e-6
    assert moduli[np.abs(moduli - 1) > 1e-4].max() < found.z_abs * (1 + 1e-6)
    if abs(found.z_abs - 1) > 0.05:
        growth = grown(mujoco, model, data, kick=1e-9, steps=100)
        assert (not growth < 10) is (found.kind == "unsafe"), growth  # which is no number where it overflows
    return found.kind


def test_forty_five_random_models() -> None:
    """Free bodies, balls and arms, of every integrator, connected and welded."""
    rng = np.random.default_rng(45)
    assert {agrees(model_of(random_model(rng))) for _ in range(45)} == {"decays", "unsafe"}


ARM = """<mujoco><option timestep="0.002" integrator="{integrator}" gravity="0 0 0"/><compiler angle="radian"/>
<worldbody><body><joint name="hip" axis="0 1 0"/>
  <geom type="capsule" fromto="0 0 0 .3 0 0" size=".03" contype="0" conaffinity="0"/>
  <body pos=".3 0 0"><joint name="knee" axis="0 1 0"/>
    <geom type="capsule" fromto="0 0 0 .3 0 0" size=".02" contype="0" conaffinity="0"/></body></body>
</worldbody>{drives}</mujoco>"""
MOTORS = """<actuator><motor name="hip_motor" joint="hip" gear="2"/><motor name="knee_motor" joint="knee" {}/>
</actuator>"""


@pytest.mark.parametrize(("integrator", "way"), [("Euler", "SYM"), ("RK4", "RK4"), ("implicitfast", "SYM")])
@pytest.mark.parametrize(
    "timing", [Timing(), Timing(4), Timing(1, Fraction(1)), Timing(4, Fraction(2)), Timing(3, Fraction("1.5"))], ids=str
)
@pytest.mark.parametrize(("drives", "gears"), [(MOTORS.format(""), (2, 1)), ("", (1, 1))], ids=["motors", "joints"])
def test_controllers_that_are_held_and_late_are_the_held_drives_of_check(
    integrator: str, way: str, timing: Timing, drives: str, gears: tuple[int, int]
) -> None:
    """Of an arm without gravity, one drive on each eigenvalue of its inertia over the squares of its gears."""
    model, kp = model_of(ARM.format(integrator=integrator, drives=drives)), 10
    h = model.opt.timestep
    for kd in ("0.05", "0.2"):
        robot = robot_of(model, Gains(".*", Fraction(kp), Fraction(kd)), timing=timing)
        state = at_qpos0(robot)
        mass = robot.mass_at(robot.data_at(state))
        per_torque = np.linalg.eigvals(np.diag(np.square(gears)) @ np.linalg.inv(mass)).real
        held = spectral_radius(held_method(way, timing), float(kd) * h * per_torque, kp * h**2 * per_torque)
        assert step_at(robot, state).moduli()[0] == pytest.approx(held.max(), rel=1e-9)


def test_mujocos_own_delay_of_a_motor_adds_to_what_is_late() -> None:
    """A motor with MuJoCo's own delay of three steps is one that is three steps late."""
    if not hasattr(mujoco.MjModel, "actuator_delay"):
        pytest.skip("this version of MuJoCo knows no delay")
    gains = Gains("knee_motor", Fraction(2), Fraction("0.05"))
    moduli = []
    for delay, timing in (('delay="0.006" nsample="10"', Timing()), ("", Timing(1, Fraction(3)))):
        robot = robot_of(model_of(ARM.format(integrator="Euler", drives=MOTORS.format(delay))), gains, timing=timing)
        moduli.append(step_at(robot, at_qpos0(robot)).moduli())
    assert moduli[0] == pytest.approx(moduli[1], abs=1e-6)  # some are next to zero, and double
