"""MuJoCo as a witness: it settles and diverges where the map says, and its model is the scene."""

import re
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from bezstab.engines import ENGINES
from bezstab.errors import InputError
from bezstab.evidence import TIMES, model_xml, mujoco_witnesses, witness_count
from bezstab.mechanism import Force, Revolute, compiled_mechanism, load_scene, parse_scene, perturbed_state
from bezstab.stability import spectral_radius
from tests.evidence.samples import of_campaign
from tests.mechanism.test_scenes import pendulum, small
from tests.reference.newton import newtons_accelerations

H = 1e-3
SCENES = of_campaign(["slider_crank", "slider_crank_light", "four_bar", "n_four_bar"], ["slider_crank", "four_bar"])
mujoco: Any = pytest.importorskip("mujoco")


def model(scene: str, alpha_hat: float = 0.5, beta_hat: float = 0.1) -> Any:
    return mujoco.MjModel.from_xml_string(model_xml(small(scene), "Euler", H, alpha_hat, beta_hat))


@pytest.mark.promise(
    "MuJoCo, which is not ours",
    measured=(
        "all of its runs at 0.9 of the boundary settle, all at 1.1 diverge: five rays, two integrators, four mechanisms"
    ),
)
@pytest.mark.parametrize("scene", SCENES)
@pytest.mark.slow
def test_mujoco_settles_and_diverges_where_the_map_says(
    scene: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """And leaves no file of warnings where it diverges."""
    monkeypatch.chdir(tmp_path)
    witnessed = list(mujoco_witnesses(compiled_mechanism(small(scene)), H))
    assert len(witnessed) == witness_count()
    assert {one.integrator for one in witnessed} == {"Euler", "RK4"}
    for one in witnessed:
        assert one.measured_verdict == ("converges" if one.times_boundary < 1 else "diverges")
        boundary = np.array([one.alpha_hat, one.beta_hat]) / one.times_boundary
        assert spectral_radius(one.method, *boundary) == pytest.approx(1, abs=1e-9)
        assert (one.predicted_z_abs < 1) == (one.times_boundary == TIMES[0])
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("scene", ["slider_crank", "four_bar", "n_four_bar"])
def test_the_model_has_the_scenes_masses_and_accelerations(scene: str) -> None:
    mechanism = compiled_mechanism(small(scene))
    built = model(scene)
    assert built.nq == built.nv == mechanism.size
    data = mujoco.MjData(built)
    state = perturbed_state(mechanism, 1e-4)
    data.qpos[:], data.qvel[:] = state
    mujoco.mj_forward(built, data)
    mass = np.zeros((mechanism.size, mechanism.size))
    for column, unit in zip(mass, np.eye(mechanism.size), strict=True):  # symmetric: rows are columns
        mujoco.mj_mulM(built, data, column, unit)
    assert mass == pytest.approx(np.diag(np.array(mechanism.equations.mass, float)), abs=1e-12)
    two_alpha, beta_squared = 0.5 / H, 0.1 / H**2
    ours = newtons_accelerations(mechanism, state, two_alpha, beta_squared)
    # what leaks: 1 - 0.9999 of the difference between constrained and unconstrained acceleration, and its coupling
    assert data.qacc == pytest.approx(ours, abs=2e-3 * np.abs(ours).max())


def test_names_never_reach_the_model() -> None:
    hostile = '"/><script>'
    scene = replace(load_scene("four_bar"), name=hostile)
    renamed = {body.name: f"{hostile}{body.name}" for body in scene.bodies}
    bodies = tuple(replace(body, name=renamed[body.name]) for body in scene.bodies)
    joints = tuple(
        replace(joint, bodies=(renamed.get(joint.bodies[0], "ground"), renamed.get(joint.bodies[1], "ground")))
        for joint in scene.joints
        if isinstance(joint, Revolute)
    )
    assert "script" not in model_xml(replace(scene, bodies=bodies, joints=joints), "Euler", H, 0.5, 0.1)


def test_what_the_model_cannot_hold_is_refused() -> None:
    pushed = replace(load_scene("four_bar"), forces=(Force("crank", (0.0, 0.0), (1.0, 0.0), 0.0),))
    for scene in (parse_scene(pendulum()), pushed):
        with pytest.raises(InputError, match="revolute"):
            model_xml(scene, "Euler", H, 0.5, 0.1)


@pytest.mark.parametrize("solref", ["0.02 1", "0.1 3", "-3000 -40"])
def test_solref_means_what_the_conversion_says(solref: str) -> None:
    values = tuple(map(Fraction, solref.split()))
    alpha_hat, beta_hat = map(float, ENGINES["mujoco"].point(values, Fraction(1, 1000)))
    mechanism = compiled_mechanism(load_scene("slider_crank"))
    xml = re.sub(r'solref="[^"]*"', f'solref="{solref}"', model_xml(mechanism.scene, "Euler", H, 1.0, 1.0))
    built = mujoco.MjModel.from_xml_string(xml)
    data = mujoco.MjData(built)
    data.qpos[:], _ = perturbed_state(mechanism, 1e-4)
    data.qvel[:] = np.random.default_rng(3).normal(
        0, 1e-4, mechanism.size
    )  # small: newer versions add gamma, its square
    mujoco.mj_forward(built, data)
    damping, stiffness = (alpha_hat / H) * data.efc_vel, (beta_hat / H**2) * data.efc_pos
    # MuJoCo divides by dmax = 0.9999 here, and multiplies by it in the equation that it solves
    bound = 2e-4 * (np.abs(damping) + np.abs(stiffness)) + 1e-9
    assert (np.abs(data.efc_aref + damping + stiffness) <= bound).all()
    assert np.abs(data.efc_aref).max() > 1e3 * bound.min()
