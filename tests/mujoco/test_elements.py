"""An element that is switched off is one that the model does not have: the same matrix, whatever it is."""

from typing import Any

import numpy as np
import pytest

from bezstab.mujoco.elements import acting, without
from bezstab.mujoco.steps import step_at
from tests.mujoco.models import WEIGHTLESS, mjcf
from tests.mujoco.test_steps import at_qpos0, model_of, robot_of

mujoco: Any = pytest.importorskip("mujoco")

ELEMENTS = {
    "equality": '<equality><joint joint1="x" joint2="y" polycoef="0 1 0 0 0" solref=".03 .8"/></equality>',
    "position drive": '<actuator><position name="servo" joint="y" kp="30" kv="2"/></actuator>',
    "muscle": '<actuator><muscle joint="x" force="3" lengthrange="-1 1"/></actuator>',
    "joint damping": 'damping="0.5"',
    "joint spring": 'stiffness="7" springref=".3"',
    "joint friction": 'frictionloss=".2"',
    "joint limit": 'limited="true" range=".01 2"',
    "tendon spring": 'stiffness="20"',
    "tendon damping": 'damping="2"',
    "tendon limit": 'limited="true" range=".02 2"',
    "tendon friction": 'frictionloss="2"',
}
FLOOR = '<geom name="floor" type="plane" size="1 1 .1" pos="0 0 -.2995"/>'


def text_with(*kinds: str) -> str:
    """Return an arm with those elements, on a tendon that does nothing else."""
    joint = " ".join(ELEMENTS[kind] for kind in kinds if kind.startswith("joint "))
    tendon = " ".join(ELEMENTS[kind] for kind in kinds if kind.startswith("tendon "))
    more = "".join(ELEMENTS[kind] for kind in kinds if kind in ("equality", "position drive", "muscle"))
    world = (
        f'<body><joint name="x" type="slide" axis="1 0 0" armature=".1"/><geom size=".1" {WEIGHTLESS}/>'
        f'<body pos="0 0 -.1"><joint name="y" axis="0 1 0" {joint}/><geom name="foot" size=".1" pos="0 0 -.1"/></body>'
        f"</body>{FLOOR if 'contact' in kinds else ''}"
    )
    fixed = '<joint joint="x" coef="2"/><joint joint="y" coef="-1"/>'
    return mjcf(world, f'{more}<tendon><fixed name="t" {tendon}>{fixed}</fixed></tendon>', gravity=-5)


@pytest.mark.parametrize("kind", [*ELEMENTS, "contact"])
@pytest.mark.parametrize("beside", ["position drive", "joint spring"])
def test_an_element_that_is_switched_off_is_none(kind: str, beside: str) -> None:
    if kind == beside:
        beside = "joint damping"
    whole, rest = robot_of(model_of(text_with(kind, beside))), robot_of(model_of(text_with(beside)))
    states = at_qpos0(whole), at_qpos0(rest)
    others = {(each.name, each.kind) for each in acting(rest, states[1])}
    own = [each for each in acting(whole, states[0]) if (each.name, each.kind) not in others]
    assert own
    before = step_at(whole, states[0]).matrix
    with without(whole, own) as robot:
        less = step_at(robot, states[0]).matrix[:4, :4]
    assert less == pytest.approx(step_at(rest, states[1]).matrix, abs=1e-9)
    assert step_at(whole, states[0]).matrix == pytest.approx(before, abs=1e-12)  # it is as it was
    if kind != "muscle":  # whose own activation is a state
        assert np.abs(less - before).max() > 1e-5
