"""MuJoCo as a witness: it settles and diverges where the map says, and its model is the scene."""

import tomllib
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from bezstab.errors import InputError
from bezstab.mechanism.equations import compiled_mechanism
from bezstab.mechanism.scene_files import load_scene, parse_scene, shipped_scenes
from bezstab.mechanism.scenes import Force
from bezstab.mechanism.start import perturbed_state
from bezstab.stability.closed_loop import spectral_radius
from tests.mechanism.test_scenes import MANY, pendulum, scene_of
from tests.reference.literal_equation_9 import literal_equation_9
from tests.runs.mujoco_witness import RAYS, RUN_WITH, TIMES, model_xml, mujoco_witnesses
from tests.runs.samples import of_campaign

H = 1e-3
SCENES = of_campaign(["slider_crank", "slider_crank_light", "four_bar", MANY], ["slider_crank", "four_bar"])
mujoco: Any = pytest.importorskip("mujoco")


@pytest.mark.parametrize("scene", SCENES)
@pytest.mark.slow
def test_mujoco_settles_and_diverges_where_the_map_says(
    scene: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """And leaves no file of warnings where it diverges."""
    monkeypatch.chdir(tmp_path)
    witnessed = list(mujoco_witnesses(compiled_mechanism(scene_of(scene)), H))
    assert len(witnessed) == len(RUN_WITH) * len(RAYS) * len(TIMES)
    for one in witnessed:
        assert one.outcome == ("converges" if one.times_boundary < 1 else "diverges")
        boundary = np.array([one.alpha_hat, one.beta_hat]) / one.times_boundary
        assert spectral_radius(one.method, *boundary) == pytest.approx(1, abs=1e-9)
        assert (one.predicted_z_abs < 1) == (one.times_boundary == TIMES[0])
    assert not list(tmp_path.iterdir())


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


def test_names_never_reach_the_model() -> None:
    hostile = '"/><script>'
    text = shipped_scenes()["four_bar"].read_text(encoding="utf-8")
    for name in ("four-bar", "crank", "coupler", "rocker"):
        text = text.replace(name, f"{hostile}{name}".replace('"', r"\""))
    assert "script" not in model_xml(parse_scene(tomllib.loads(text)), "Euler", H, 0.5, 0.1)


def test_what_the_model_cannot_hold_is_refused() -> None:
    pushed = replace(load_scene("four_bar"), forces=(Force("crank", (0.0, 0.0), (1.0, 0.0), 0.0),))
    for scene in (parse_scene(pendulum()), pushed):
        with pytest.raises(InputError, match="revolute"):
            model_xml(scene, "Euler", H, 0.5, 0.1)
