"""MuJoCo as a witness of the equations of motion: its model of a scene has the scene's masses and accelerations."""

from typing import Any

import numpy as np
import pytest

from bezstab.mechanism.equations import compiled_mechanism
from bezstab.mechanism.start import perturbed_state
from tests.mechanism.test_scenes import MANY, scene_of
from tests.reference.literal_equation_9 import literal_equation_9
from tests.runs.mujoco_witness import model_xml

H = 1e-3
mujoco: Any = pytest.importorskip("mujoco")


@pytest.mark.parametrize("scene", ["slider_crank", "four_bar", MANY])
def test_the_model_has_the_scenes_masses_and_accelerations(scene: str) -> None:
    mechanism = compiled_mechanism(scene_of(scene))
    built = mujoco.MjModel.from_xml_string(model_xml(scene_of(scene), "Euler", H, 0.5, 0.1))
    assert built.nq == built.nv == mechanism.size
    data = mujoco.MjData(built)
    state = perturbed_state(mechanism, 1e-4)
    data.qpos[:], data.qvel[:] = state
    mujoco.mj_forward(built, data)
    mass = np.zeros((mechanism.size, mechanism.size))
    for column, unit in zip(mass, np.eye(mechanism.size), strict=True):  # symmetric: rows are columns
        mujoco.mj_mulM(built, data, column, unit)
    assert mass == pytest.approx(np.diag(mechanism.mass), abs=1e-12)
    ours = literal_equation_9(mechanism, 0.5 / H, 0.1 / H**2)(0.0, *state).accelerations
    # what leaks: 1 - 0.9999 of the difference between constrained and unconstrained acceleration, and its coupling
    assert data.qacc == pytest.approx(ours, abs=2e-3 * np.abs(ours).max())
