"""Who makes errors grow: elements are switched off in turn, and all others."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np

from bezstab.mujoco.elements import Element, acting, without
from bezstab.mujoco.growth import Growth, growth_at
from bezstab.mujoco.robots import Robot, State
from bezstab.mujoco.steps import moved_by_step, step_at

SEEN = 1e-2
"""Relative: an element that changes what a growing error becomes by less is not to blame for it."""

MOST_SUSPECTS, MOST_DIRECTIONS = 12, 8
"""Elements whose part is found, and directions by which they are: enough for a robot with a leg or two at fault."""

Shown = Callable[[Iterable[Any], str, int], Iterable[Any]]
"""Yields some items, while it shows how many of them are done."""


@dataclass(frozen=True)
class Suspect:
    """An element that acts on what grows: |z| with it alone, and with all but it, None where nothing holds.

    `cures`: it does not grow without this element. `blamed`: so, or it grows with this element alone.
    """

    element: str
    kind: str
    z_abs_alone: float | None
    z_abs_without: float | None
    blamed: bool
    cures: bool


def suspects_at(robot: Robot, state: State, growth: Growth, shown: Shown) -> list[tuple[Element, Suspect]]:
    """Return the elements without which growing errors change, and what each does alone; those to blame first."""
    elements = acting(robot, state)
    chosen = _with_effect(robot, state, elements)
    found = []
    for element in shown(chosen, "elements", len(chosen)):
        with without(robot, [element]) as rest:
            less = growth_at(rest, state, growth.own)
        with without(robot, [other for other in elements if other is not element]) as alone:
            only = growth_at(alone, state, growth.own)
        cures = less.kind not in (growth.kind, "unsafe")
        blamed = cures or only.kind == "unsafe"
        found.append((element, Suspect(element.name, element.kind, only.z_abs, less.z_abs, blamed, cures)))
    return sorted(found, key=lambda each: (not each[1].cures, not each[1].blamed))


def _with_effect(robot: Robot, state: State, elements: list[Element]) -> list[Element]:
    """Return the elements that change where a step moves growing errors, from the one that does most."""
    directions = step_at(robot, state).growing()[:, :MOST_DIRECTIONS]
    whole = moved_by_step(robot, state, directions)
    sizes = np.linalg.norm(whole, axis=0)
    effects = np.zeros(len(elements))
    for place, element in enumerate(elements):
        with without(robot, [element]) as rest:
            change = moved_by_step(rest, state, directions) - whole
        effects[place] = (np.linalg.norm(change, axis=0) / sizes).max(initial=0.0)
    seen = [place for place in np.argsort(-effects).tolist() if effects[place] > SEEN * effects.max()]
    return [elements[place] for place in seen[:MOST_SUSPECTS]]
