"""The driven four-bar at a revolution a second, made when a test first asks for it."""

from dataclasses import replace
from functools import cache

from bezstab.mechanism.constraint_normals import TurningNormals, turning_normals
from bezstab.mechanism.equations import Mechanism, compiled_mechanism
from bezstab.mechanism.scene_files import load_scene
from bezstab.mechanism.scenes import Driver


def four_bar() -> Mechanism:
    return compiled_mechanism(load_scene("driven_four_bar"))


def swinging_four_bar(rate: float, frequency: float) -> Mechanism:
    """Return the four-bar whose crank turns at a rate (rad/s) and swings by 0.2 rad at a frequency (rad/s)."""
    scene = load_scene("driven_four_bar")
    joints = tuple(
        replace(joint, rate=rate, amplitude=0.2, frequency=frequency) if isinstance(joint, Driver) else joint
        for joint in scene.joints
    )
    return compiled_mechanism(replace(scene, joints=joints))


@cache
def turning() -> TurningNormals:
    return turning_normals(four_bar(), 1.0)
