"""A motion's energy: a closed four-bar by connect brakes with a soft solimp, hardly with a hard one under RK4."""

from typing import Any

import numpy as np
import pytest

from bezstab.errors import InputError
from bezstab.mujoco.energy import spun
from bezstab.mujoco.linting import lint
from tests.mujoco.models import WEIGHTLESS, mjcf
from tests.mujoco.test_steps import at_qpos0, model_of, robot_of

mujoco: Any = pytest.importorskip("mujoco")


def rod(name: str, end: str) -> str:
    geom = f'<geom type="capsule" fromto="0 0 0 {end}" size=".01" mass=".2" {WEIGHTLESS}/>'
    return f'<joint name="{name}" axis="0 1 0"/>{geom}'


FOUR_BAR = f"""<body name="crank">{rod("crank", "0 0 .1")}
  <body name="coupler" pos="0 0 .1">{rod("coupler", ".3 0 .1")}</body></body>
<body name="rocker" pos=".3 0 0">{rod("rocker", "0 0 .2")}</body>"""
LOOP = '<equality><connect body1="coupler" body2="rocker" anchor=".3 0 .1"/></equality>'
DRIVEN = '<actuator><velocity joint="crank" kv="9"/></actuator>'


def four_bar(integrator: str = "Euler", more: str = "") -> Any:
    return model_of(mjcf(FOUR_BAR, LOOP + more, integrator=integrator, h=0.002))


def test_what_is_not_spun_has_no_impulse() -> None:
    """Of an open arm: least energy makes M v zero at all other joints."""
    robot = robot_of(model_of(mjcf(FOUR_BAR)))
    state = spun(robot, at_qpos0(robot), {"crank": 20.0})
    momentum = robot.mass_at(robot.data_at(state)) @ np.array(state.velocities)
    assert momentum[1:] == pytest.approx([0, 0], abs=1e-9)


@pytest.mark.parametrize("integrator", ["Euler", "RK4"])
def test_a_soft_solimp_brakes_a_closed_loop_and_a_hard_one_under_rk4_keeps_its_energy(integrator: str) -> None:
    """Drives and dampers are left out; the share of the model as it is is that of a plain run.

    Both cranks stand upright: their tips move alike, 20 * 0.1 = 10 * 0.2, and the coupler does not turn.
    """
    kept = {each.setting: each.kept for each in lint(four_bar(integrator, DRIVEN), spin={"crank": 20}).kept}
    own, hard = kept["as it is"], kept['solimp="0.9999 0.9999"']
    assert own is not None
    assert hard is not None
    model = four_bar(integrator)
    data = mujoco.MjData(model)
    data.qvel[:] = 20, -20, 10
    energies = []
    for _ in range(501):
        mujoco.mj_forward(model, data)
        momentum = np.zeros(3)
        mujoco.mj_mulM(model, data, momentum, data.qvel)
        energies.append(float(momentum @ data.qvel))
        mujoco.mj_step(model, data)
    assert own == pytest.approx(1 + (energies[-1] - energies[0]) / max(energies), rel=1e-4)
    assert own < 0.95 < hard
    under_rk4 = hard if integrator == "RK4" else kept['integrator="RK4" solimp="0.9999 0.9999"']
    assert under_rk4 == pytest.approx(1, abs=1e-3)
    assert min(abs((share or np.inf) - 1) for share in kept.values()) < 1e-2


def test_what_begins_to_fall_is_measured_by_the_energy_of_its_fall() -> None:
    """A pendulum that starts slowly upright: a hundredth of its fall's energy would be half of what it starts with."""
    rod = f'<geom type="capsule" fromto="0 0 0 0 0 .5" size=".05" {WEIGHTLESS}/>'
    model = model_of(mjcf(f'<body><joint name="x" axis="0 1 0"/>{rod}</body>', gravity=-9.81, h=0.002))
    (own,) = lint(model, spin={"x": 0.5}).kept
    assert own.kept == pytest.approx(1, abs=0.01)


def test_states_that_move_are_run_and_others_are_not() -> None:
    """A free body that turns keeps its energy; a keyframe at rest has none."""
    body = '<body><freejoint/><geom type="box" size=".1 .2 .3"/></body>'
    keys = '<keyframe><key name="still"/><key name="turns" qvel="0 0 0 0 0 3"/></keyframe>'
    assert [each.at for each in lint(model_of(mjcf(body, keys))).kept] == ["turns"]
    ((turning),) = lint(model_of(mjcf(body, keys))).kept
    assert (turning.at, turning.setting) == ("turns", "as it is")
    assert turning.kept == pytest.approx(1, abs=1e-9)


def test_a_rate_that_the_loops_forbid_is_one_line() -> None:
    with pytest.raises(InputError, match="the loops do not allow this velocity at qpos0"):
        lint(four_bar(), spin={"crank": 20, "rocker": 3})
