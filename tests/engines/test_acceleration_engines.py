from collections.abc import Callable
from fractions import Fraction
from typing import Any

import numpy as np
import pytest

from bezstab.engines.acceleration_engines import MUJOCO
from bezstab.engines.engine_list import ENGINES
from tests.reference.engine_steps import STEPS, State, matrix

H = Fraction(2, 1000)


def test_rules_of_thumb_are_where_they_are_known_to_be() -> None:
    marks = {label: point for engine in ENGINES.values() for label, point in engine.marked(H).items()}
    assert marks["MuJoCo: solref = 0.02 1"] == (Fraction(1, 5), Fraction(1, 100))
    assert marks["RBDL: T_stab = 0.1"] == (Fraction(1, 25), Fraction(1, 2500))
    assert marks["RigidBodyDynamics.jl: PDGains(100, 20)"] == (Fraction(1, 25), Fraction(1, 2500))


def mujocos_step(solref: str, solimp: str, size: float) -> Callable[[float, float], State]:
    """Return what MuJoCo itself makes of (c, v) in a step, both of a given size, for a body on a line."""
    mujoco: Any = pytest.importorskip("mujoco")
    model = mujoco.MjModel.from_xml_string(f"""<mujoco><option timestep="{float(H)!r}" gravity="0 0 0" tolerance="0"/>
        <worldbody><body><joint name="x" type="slide" axis="1 0 0"/>
          <inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/></body></worldbody>
        <equality><joint joint1="x" solref="{solref}" {solimp}/></equality></mujoco>""")
    data = mujoco.MjData(model)

    def step(c: float, v: float) -> State:
        mujoco.mj_resetData(model, data)
        data.qpos[0], data.qvel[0] = c * size, v * size / float(H)
        mujoco.mj_step(model, data)
        return float(data.qpos[0]) / size, float(data.qvel[0]) * float(H) / size

    return step


@pytest.mark.parametrize("solref", ["0.02 1", "0.001 1", "0.003 0.5", "-40000 -300"])
@pytest.mark.parametrize("solimp", ["", 'solimp="0.5 0.95"', 'solimp="0.95 0.95"', 'solimp="0.95 2"'])
def test_a_run_of_mujoco_shows_the_point_that_is_applied(solref: str, solimp: str) -> None:
    values = tuple(Fraction(number) for number in f"{solref} {solimp[8:-1]}".split())
    applied = MUJOCO.applied(values, H)
    for size, point in ((1e-9, applied.point), *((1.0, point) for _, point in applied.also)):
        alpha_hat, beta_hat = map(float, point)
        ours = matrix(STEPS["pinocchio"], 1.0, beta_hat, alpha_hat)  # in units of the step
        theirs = matrix(mujocos_step(solref, solimp, size))
        # past the width 1 mm only where c is: a velocity alone meets the impedance of no error
        columns = [0] if size == 1.0 else [0, 1]
        assert theirs[:, columns] == pytest.approx(ours[:, columns], abs=1e-6 * np.abs(ours).max())
