"""The driven four-bar at a revolution a second, made when a test first asks for it."""

from functools import cache

from bezstab.mechanism import Mechanism, TurningNormals, compiled_mechanism, load_scene, turning_normals


def four_bar() -> Mechanism:
    return compiled_mechanism(load_scene("driven_four_bar"))


@cache
def turning() -> TurningNormals:
    return turning_normals(four_bar(), 1.0)
