"""Parallel four-bars in a row: the N-four-bar benchmark of Gonzalez et al., IFToMM's A02.

  o---coupler0---o---coupler1---o
  |              |              |
rod0           rod1           rod2        all of 1 m and 1 kg
  |              |              |
--o--------------o--------------o--       the pivots 1 m apart on the ground
"""

import math
from collections.abc import Sequence
from typing import Any

from bezstab.mechanism.scene_files import parse_scene
from bezstab.mechanism.scenes import Scene

HALF = 0.5  # m


UPRIGHT: dict[str, Any] = {"position": {"rod0.theta": math.pi / 2}, "velocity": {"rod0.theta": -1}}
"""As the benchmark starts: the tips move at 1 m/s."""


def four_bars(count: int, initial: dict[str, Any] = UPRIGHT, joints: Sequence[dict[str, Any]] = ()) -> Scene:
    """Return a chain of so many four-bars that starts so, held by more joints if some are given."""
    rods = [
        {"name": f"rod{i}", "free": ["theta"], "mass": 1, "inertia": 1 / 3, "locked": {"x": i}, "center": [HALF, 0]}
        for i in range(count + 1)
    ]
    couplers = [
        {"name": f"coupler{i}", "free": ["x", "y", "theta"], "mass": 1, "inertia": 1 / 12} for i in range(count)
    ]
    pins = [
        {"type": "revolute", "bodies": bodies, "points": points}
        for i in range(count)
        for bodies, points in (
            ([f"rod{i}", f"coupler{i}"], [[1, 0], [-HALF, 0]]),
            ([f"coupler{i}", f"rod{i + 1}"], [[HALF, 0], [1, 0]]),
        )
    ]
    upright = {f"rod{i}.theta": math.pi / 2 for i in range(count + 1)}
    across = {f"coupler{i}.{axis}": place for i in range(count) for axis, place in (("x", i + HALF), ("y", 1))}
    of_chain = {"name": f"{count} four-bars", "gravity": [0, -9.81], "body": rods + couplers, "joint": [*pins, *joints]}
    return parse_scene({**of_chain, "initial": {**initial, "guess": upright | across}})
