"""MuJoCo as a witness of what its step does to the energy of a motion: a spinning body, and a closed four-bar."""

from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np
import pytest

from bezstab import check
from bezstab.mechanism.equations import compiled_mechanism
from bezstab.mechanism.scene_files import load_scene
from bezstab.mechanism.start import initial_state
from tests.runs.mujoco_witness import four_bar_xml

mujoco: Any = pytest.importorskip("mujoco")

H = Fraction(1, 60)
INERTIA = 0.5
ETA = 1 / (1 + INERTIA)
"""Of a body of 1 kg whose pin is 1 m from its centre of mass: check tells of one whose mass is all there, eta = 1."""


def rates(setting: str, impedance: float, omega: float, seconds: float) -> list[float]:
    """Return at what rate (rad/s) a body spins about its pin, from step to step."""
    connect = f'solref="{setting}" solimp="{impedance} {impedance}"'
    inertia = " ".join([str(INERTIA)] * 3)
    model = mujoco.MjModel.from_xml_string(
        f"""<mujoco><option timestep="{float(H)}" gravity="0 0 0"><flag refsafe="disable"/></option>
        <worldbody><body name="body" pos="-1 0 0"><freejoint/>
        <inertial pos="0 0 0" mass="1" diaginertia="{inertia}"/></body></worldbody>
        <equality><connect body1="body" anchor="1 0 0" {connect}/></equality></mujoco>"""
    )
    data = mujoco.MjData(model)
    data.qvel[[1, 5]] = -omega, omega
    seen = []
    for _ in range(round(seconds / H)):
        mujoco.mj_step(model, data)
        seen.append(float(data.qvel[5]))
    return seen


@pytest.mark.parametrize(
    ("a", "b", "impedance"),
    [(1, 0.8, 0.9999), (1, 0.8, 0.95), (0.2, 0.2, 0.95), (0.2, 0.2, 0.8), (0.2, 0.04, 0.9)],
)
def test_check_says_what_an_impedance_does_to_a_spinning_body(a: float, b: float, impedance: float) -> None:
    """To 5 %, once the start's own error has died. (0.2, 0.2) is neutral at d = 1 - (3a + b) / 6 = 0.87.

    Softer ones are off by more: across the arm MuJoCo's share is larger than d, which it applies to the mass alone.
    """
    seen = rates(f"{-b * 3600} {-a * 60}", impedance, 6.0, 3.0)[90:]
    gained = 2 * np.log(seen[-1] / seen[0]) / ((len(seen) - 1) * float(H))
    values = f"mujoco={-b * 3600},{-a * 60},{impedance},{impedance}"
    answer = check(engine=values, h=H, omega=float(np.mean(seen)))
    assert answer.energy_rate is not None
    assert ETA * answer.energy_rate.gained == pytest.approx(gained, rel=0.05)
    assert answer.impedance == impedance


@pytest.mark.parametrize(("a", "b"), [(0.2, 0.2), (0.4, 0.04), (1, 0.2)])
def test_check_says_what_a_closed_four_bar_gains(a: float, b: float) -> None:
    """By its own run, of hard constraints, strong and gentle: to 3 %, ten seconds at 1/240 s."""
    h, scene = Fraction(1, 240), replace(load_scene("four_bar"), gravity=(0.0, 0.0))
    mechanism = compiled_mechanism(scene)
    model = mujoco.MjModel.from_xml_string(four_bar_xml("Euler", float(h), a, b))
    data = mujoco.MjData(model)
    q, v = initial_state(mechanism)
    data.qpos[:], data.qvel[:] = q, v
    mujoco.mj_step(model, data, 2400)
    gained = float(mechanism.mass @ data.qvel**2 / (mechanism.mass @ v**2)) - 1
    values = f"mujoco={-b / float(h) ** 2},{-a / float(h)},0.9999,0.9999"
    run = check(engine=values, h=h, scene=scene).run
    assert run
    assert run.gained == pytest.approx(gained, rel=0.03)
