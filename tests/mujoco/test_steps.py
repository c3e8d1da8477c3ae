"""The matrix of a step is what MuJoCo's own runs do: of random models, of controllers that are held and late."""

from fractions import Fraction
from math import ceil
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
<worldbody><body><joint name="hip" axis="0 1 0" damping=".02"/>
  <geom type="capsule" fromto="0 0 0 .3 0 0" size=".03" contype="0" conaffinity="0"/>
  <body pos=".3 0 0"><joint name="knee" axis="0 1 0"/>
    <geom type="capsule" fromto="0 0 0 .3 0 0" size=".02" contype="0" conaffinity="0"/></body></body></worldbody>
<actuator><motor name="hip_motor" joint="hip" gear="2"/><motor name="knee_motor" joint="knee" {delay}/></actuator>
</mujoco>"""


def controlled_modulus(model: Any, kp: float, kd: float, timing: Timing) -> float:
    """Return |z| a step of MuJoCo's own steps under a controller written as one would write it, by differences.

    From one computation of the controls to the next: of positions, velocities and the controls still to be applied.
    """
    data = mujoco.MjData(model)
    late, every = int(timing.late), timing.every
    pending = ceil(late / every)

    def advanced(state: Any) -> Any:
        mujoco.mj_resetData(model, data)
        data.qpos[:], data.qvel[:] = state[: model.nv], state[model.nv : 2 * model.nv]
        mujoco.mj_forward(model, data)
        now = -kp * data.actuator_length - kd * data.actuator_velocity
        computed = [now, *state[2 * model.nv :].reshape(pending, model.nu)]  # latest first
        for step in range(every):
            age = max(0, ceil((late - step) / every))  # how many computations ago
            data.ctrl[:] = computed[age]
            mujoco.mj_step(model, data)
        return np.concatenate([data.qpos, data.qvel, *computed[:pending]])

    size, small = 2 * model.nv + pending * model.nu, 1e-6
    changes = [advanced(small * unit) - advanced(-small * unit) for unit in np.eye(size)]
    z = np.linalg.eigvals(np.array(changes).T / (2 * small))
    return float(np.abs(z[np.abs(z - 1) > 1e-4]).max() ** (1 / every))


@pytest.mark.parametrize("integrator", ["Euler", "RK4", "implicitfast"])
@pytest.mark.parametrize("timing", [Timing(), Timing(4), Timing(1, Fraction(1)), Timing(4, Fraction(2))], ids=str)
def test_controllers_that_are_held_and_late_are_mujocos_own_steps_with_them(integrator: str, timing: Timing) -> None:
    model = model_of(ARM.format(integrator=integrator, delay=""))
    for kd in ("0.05", "0.2"):
        robot = robot_of(model, Gains(".*", Fraction(10), Fraction(kd)), timing=timing)
        found = step_at(robot, at_qpos0(robot)).moduli()[0]
        assert found == pytest.approx(controlled_modulus(model, 10, float(kd), timing), abs=1e-6)


def test_mujocos_own_delay_of_a_motor_adds_to_what_is_late() -> None:
    """A motor with MuJoCo's own delay of three steps is one that is three steps late."""
    if not hasattr(mujoco.MjModel, "actuator_delay"):
        pytest.skip("this version of MuJoCo knows no delay")
    gains = Gains("knee_motor", Fraction(2), Fraction("0.05"))
    moduli = []
    for delay, timing in (('delay="0.006" nsample="10"', Timing()), ("", Timing(1, Fraction(3)))):
        robot = robot_of(model_of(ARM.format(integrator="Euler", delay=delay)), gains, timing=timing)
        moduli.append(step_at(robot, at_qpos0(robot)).moduli())
    assert moduli[0] == pytest.approx(moduli[1], abs=1e-6)  # some are next to zero, and double


def test_a_joint_of_a_urdf_is_driven_by_its_name() -> None:
    """On the inertia 0.003 kg m^2 without gravity it is the held drive of `check`, exactly."""
    urdf = """<robot name="leg"><link name="hip"/><link name="shank"><inertial><origin xyz="0 0 -0.1"/>
      <mass value="0.2"/><inertia ixx="0.001" iyy="0.001" izz="0.0001" ixy="0" ixz="0" iyz="0"/></inertial></link>
      <joint name="knee" type="revolute"><parent link="hip"/><child link="shank"/><axis xyz="0 1 0"/>
      <limit lower="-2" upper="2" effort="30" velocity="20"/></joint></robot>"""
    model = model_of(urdf)
    model.opt.gravity[:] = 0
    for timing in (Timing(), Timing(3, Fraction("1.5"))):
        robot = robot_of(model, Gains("knee", Fraction(20), Fraction("0.5")), timing=timing)
        alpha_hat, beta_hat = 0.5 * 0.002 / 0.003, 20 * 0.002**2 / 0.003
        expected = float(spectral_radius(held_method("SYM", timing), alpha_hat, beta_hat))
        assert step_at(robot, at_qpos0(robot)).moduli()[0] == pytest.approx(expected, rel=1e-9)
