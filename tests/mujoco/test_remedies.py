"""Every remedy, written into the model's text, makes it safe; a little more than the largest value does not."""

import re
from typing import Any

import pytest

from bezstab.mujoco.linting import lint
from tests.mujoco.models import FLAT, UNSAFE, WEIGHTLESS, mjcf
from tests.mujoco.test_steps import model_of

mujoco: Any = pytest.importorskip("mujoco")

LINK = f'<body><joint name="x" axis="0 1 0" {{}}/><geom size=".1" mass="1" pos="0 0 .2" {WEIGHTLESS}/></body>'
UNSAFE_MODELS = {
    "drive": mjcf(LINK.format('armature="0"'), '<actuator><position joint="x" kp="300" kv="60"/></actuator>'),
    "stiff drive": mjcf(LINK.format('armature="0"'), '<actuator><position joint="x" kp="90000" kv="1"/></actuator>'),
    "damped": mjcf(LINK.format('damping="60" armature="0"'), integrator="RK4"),
    "sprung": mjcf(LINK.format('stiffness="90000"')),
    "held": mjcf(LINK.format(""), f'<equality><joint joint1="x" solref="0.003 1" {FLAT}/></equality>', flags=UNSAFE),
}


def written(text: str, write: str) -> str:
    """Return a model's text with another value of an attribute, wherever it has that."""
    name = write.partition("=")[0]
    changed = re.sub(rf'\b{name}="[^"]*"', write, text)
    assert changed != text
    return changed


@pytest.mark.parametrize("name", UNSAFE_MODELS)
def test_every_remedy_makes_the_model_safe(name: str) -> None:
    text = UNSAFE_MODELS[name]
    found = lint(model_of(text))
    assert found.status == 1
    assert found.remedies
    for remedy in found.remedies:
        after = lint(model_of(written(text, remedy.write)))
        assert after.worst.kind != "unsafe", remedy
        assert after.worst.z_abs == pytest.approx(remedy.z_abs, rel=1e-6)


@pytest.mark.parametrize(
    ("name", "label", "limit"),
    [
        # 2 a + b < 4 with a = kv h / I, b = kp h^2 / I, I = 0.044
        ("drive", "kv", (4 * 0.044 / 0.004 - 300 * 0.004) / 2),
        ("drive", "armature", (2 * 60 * 0.004 + 300 * 0.004**2) / 4 - 0.044),
        ("stiff drive", "kp", (4 * 0.044 - 2 * 0.004) / 0.004**2),
        ("sprung", "stiffness", 4 * 0.044 / 0.004**2),
    ],
)
def test_largest_gains_and_the_least_armature_are_those_of_the_map(name: str, label: str, limit: float) -> None:
    writes = dict(remedy.write.split("=") for remedy in lint(model_of(UNSAFE_MODELS[name])).remedies)
    value = float(writes[label].strip('"'))
    assert value == pytest.approx(limit, rel=0.1)  # two digits
    assert value > limit if label == "armature" else value < limit


def test_where_only_a_change_of_all_that_are_to_blame_helps_they_are_changed_together() -> None:
    """Two legs, each with a drive beyond its limit; implicitfast alone helps, too, and no armature of one."""
    other = LINK.format("").replace('name="x"', 'name="y"')
    drives = "".join(f'<velocity name="{joint}" joint="{joint}" kv="60"/>' for joint in "xy")
    found = lint(model_of(mjcf(LINK.format("") + other, f"<actuator>{drives}</actuator>")))
    together = [remedy for remedy in found.remedies if remedy.element == "actuator 'x', actuator 'y'"]
    assert [remedy.write for remedy in together] == ['kv="21", kv="21"']


def test_a_gain_of_the_wrong_sign_pushes_away_at_any_step() -> None:
    drive = '<actuator><general joint="x" gainprm="1" biastype="affine" biasprm="0 9 -1"/></actuator>'
    found = lint(model_of(mjcf(LINK.format(""), drive)))
    assert (found.worst.kind, found.worst.h_limit, found.status) == ("unsafe", None, 1)
    (suspect,) = found.suspects
    assert suspect.blamed
