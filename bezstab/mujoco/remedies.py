"""What to write instead: each remedy is found, and checked as it is printed, by MuJoCo's own step."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from bezstab.mujoco.blame import Shown, Suspect
from bezstab.mujoco.controllers import name_of
from bezstab.mujoco.elements import Element, acting
from bezstab.mujoco.growth import growth_at, last_safe
from bezstab.mujoco.robots import Change, Robot, State
from bezstab.mujoco.solrefs import METHODS, TIME_CONSTANTS
from bezstab.rationals import rounded_down, rounded_up
from bezstab.stability.arrays import FloatArray

MARGIN = 0.9
"""Of the largest safe step: the rest is left to what differs between poses."""

QUARTERS, BISECTIONS = 6, 6
"""A value is divided by four, or an armature multiplied, until it is safe; then the limit is found to a fiftieth."""

MOST_BLAMED = 4
"""Elements for which values are looked for."""

Unsafe = Sequence[tuple[Robot, State, FloatArray | None]]
"""States that are to become safe, and at which rates (1/s) the mechanism itself falls there, if it is known."""


@dataclass(frozen=True)
class Remedy:
    """What to write for an element, or for the whole model, and |z| of a step then, None where nothing holds."""

    element: str
    write: str
    z_abs: float | None


def remedies(
    unsafe: Unsafe, suspects: Sequence[tuple[Element, Suspect]], h_limit: float | None, shown: Shown
) -> list[Remedy]:
    """Return what makes every unsafe state safe, each change alone; `h_limit` is the largest safe step in s, if any.

    Where no one element can do it, all of the kind that is to blame are changed together.
    """
    model = unsafe[0][0].model
    found: list[Remedy] = []
    if h_limit is not None:
        step = rounded_down(MARGIN * h_limit, 2)
        found += _checked(unsafe, "the model", f'timestep="{step}"', partial(_with_option, "timestep", float(step)))
    if list(METHODS)[model.opt.integrator] != "implicitfast":
        change = partial(_with_option, "integrator", list(METHODS).index("implicitfast"))
        found += _checked(unsafe, "the model", 'integrator="implicitfast"', change)
    few = [(element, suspect) for element, suspect in suspects if suspect.blamed][:MOST_BLAMED]
    for element, suspect in shown(few, "remedies", len(few)):
        found += _of_armature(unsafe, element)
        if suspect.cures:
            found += [*_of_values(unsafe, [element]), *_of_solref(unsafe, [element])]
    if few and not any(suspect.cures for _, suspect in few):
        robot, state, _ = unsafe[0]
        alike = [element for element in acting(robot, state) if element.kind == few[0][0].kind]
        found += [*_of_values(unsafe, alike), *_of_solref(unsafe, alike)]
    return found


def _of_values(unsafe: Unsafe, elements: Sequence[Element]) -> Iterator[Remedy]:
    """Yield the largest gains, stiffnesses and dampings with which elements are safe, all of a kind changed alike."""
    of_each = [_knobs(unsafe[0][0], element) for element in elements]
    for label in dict.fromkeys(knob.label for knobs in of_each for knob in knobs):
        turned = [knob for knobs in of_each for knob in knobs if knob.label == label]
        factor = _largest(partial(_safe_with, unsafe, turned))
        if factor is not None:
            if len(turned) > MOST_BLAMED:
                share = rounded_down(factor, 2)
                change = partial(_with_values, turned, [float(share) * knob.value for knob in turned])
                yield from _checked(unsafe, _names(elements), f"{label} times {share}", change)
                continue
            written = [rounded_down(factor * knob.value, 2) for knob in turned]
            text = ", ".join(f'{label}="{value}"' for value in written)
            change = partial(_with_values, turned, [float(value) for value in written])
            yield from _checked(unsafe, _names(elements), text, change)


def _of_armature(unsafe: Unsafe, element: Element) -> Iterator[Remedy]:
    """Yield the least armature of the joint that an element acts on."""
    robot = unsafe[0][0]
    joints = _joints(robot, element)
    armature = _least_armature(unsafe, joints) if joints else None
    if armature is not None:
        names = ", ".join(f"joint {name_of(robot.mujoco, robot.model, 'joint', joint)!r}" for joint in joints)
        change = partial(_with_armature, joints, armature)
        yield from _checked(unsafe, names, f'armature="{armature:.2g}"', change)


def _of_solref(unsafe: Unsafe, elements: Sequence[Element]) -> Iterator[Remedy]:
    """Yield the shortest time constant, critically damped, with which constraints are safe."""
    if all(element.kind in SOLREF_ARRAYS or element.geoms for element in elements):
        for steps in TIME_CONSTANTS:
            first = steps * unsafe[0][0].h
            change = partial(_with_solref, elements, first)
            if found := list(_checked(unsafe, _names(elements), f'solref="{first:.9g} 1"', change)):
                yield from found
                return


def _names(elements: Sequence[Element]) -> str:
    if len(elements) > MOST_BLAMED:
        return f"every {elements[0].kind}"
    return ", ".join(element.name for element in elements)


# Trying


def _checked(unsafe: Unsafe, element: str, write: str, change: Change) -> Iterator[Remedy]:
    """Yield a remedy if it is one: then no state is unsafe."""
    grown = []
    for robot, state, own in unsafe:
        growth = growth_at(robot.changed(change), state, own)
        if growth.kind in ("unsafe", "not smooth"):
            return
        grown.append(growth.z_abs)
    known = [z_abs for z_abs in grown if z_abs is not None]
    yield Remedy(element, write, max(known, default=None))


def _safe(unsafe: Unsafe, change: Change) -> bool:
    return any(_checked(unsafe, "", "", change))


def _safe_with(unsafe: Unsafe, knobs: "Sequence[_Knob]", factor: float) -> bool:
    return _safe(unsafe, partial(_with_values, knobs, [factor * knob.value for knob in knobs]))


def _largest(safe: Callable[[float], bool]) -> float | None:
    """Return the largest factor below one that is safe, to two in a hundred; None where none is found."""
    found = next((0.25**power for power in range(1, QUARTERS + 1) if safe(0.25**power)), None)
    return found and last_safe(safe, found, 4 * found, BISECTIONS)


# Changes


def _with_option(name: str, value: Any, robot: Robot) -> Robot:
    setattr(robot.model.opt, name, value)
    return robot


@dataclass(frozen=True, eq=False)
class _Knob:
    """A value of an element, as the model says it, and how to set another."""

    label: str
    value: float
    scaled: Callable[[Robot, float], Robot]


def _with_values(knobs: Sequence[_Knob], values: Sequence[float], robot: Robot) -> Robot:
    for knob, value in zip(knobs, values, strict=True):
        robot = knob.scaled(robot, value / knob.value)
    return robot


def _knobs(robot: Robot, element: Element) -> list[_Knob]:
    """Return the positive gains, stiffnesses and dampings of an element."""
    model = robot.model
    knobs = []
    if element.kind == "drive":
        number = element.entries[0][1]
        affine = model.actuator_biastype[number] == robot.mujoco.mjtBias.mjBIAS_AFFINE
        kp, kv = (-model.actuator_biasprm[number, 1:3] if affine else np.zeros(2)).tolist()
        knobs = [
            _Knob("kp", kp, partial(_scaled_gain, number, 1, alone=True)),
            _Knob("kv", kv, partial(_scaled_gain, number, 2, alone=not kp)),
        ]
    elif element.kind == "--pd drive":
        drive = element.drives[0]
        knobs = [
            _Knob(label, getattr(drive, label), partial(_scaled_drive, drive.element, label)) for label in ("kp", "kd")
        ]
    elif element.kind in ("joint damping", "joint spring", "tendon damping", "tendon spring"):
        (name, where), *_ = element.entries
        label = "damping" if "damping" in name else "stiffness"
        knobs = [_Knob(label, float(np.max(getattr(model, name)[where])), partial(_scaled_entries, element))]
    return [knob for knob in knobs if knob.value > 0]


def _scaled_gain(number: int, place: int, robot: Robot, factor: float, *, alone: bool) -> Robot:
    """Return a robot with another kp or kv of an actuator; `alone`: its target is multiplied by it, too."""
    robot.model.actuator_biasprm[number, place] *= factor
    if alone:
        robot.model.actuator_gainprm[number, 0] *= factor
    return robot


def _scaled_drive(element: str, label: str, robot: Robot, factor: float) -> Robot:
    changed = (
        replace(drive, **{label: factor * getattr(drive, label)}) if drive.element == element else drive
        for drive in robot.drives
    )
    return replace(robot, drives=tuple(changed))


def _scaled_entries(element: Element, robot: Robot, factor: float) -> Robot:
    for name, where in element.entries:
        if hasattr(robot.model, name):
            getattr(robot.model, name)[where] *= factor
    return robot


# Armature: the joint feels more inertia


def _joints(robot: Robot, element: Element) -> list[int]:
    """Return the joints that an element drives or damps directly."""
    model = robot.model
    if element.drives and not element.drives[0].motor:
        return sorted({int(model.dof_jntid[drive.number]) for drive in element.drives})
    if element.kind == "joint damping":
        return sorted({int(joint) for joint in model.dof_jntid[element.entries[0][1]]})
    if element.kind == "drive" or element.drives:
        number = element.drives[0].number if element.drives else element.entries[0][1]
        if robot.mujoco.mjtTrn(model.actuator_trntype[number]).name.startswith("mjTRN_JOINT"):
            return [int(model.actuator_trnid[number, 0])]
    return []


def _with_armature(joints: Sequence[int], armature: float, robot: Robot) -> Robot:
    """Return a robot with at least that armature at joints, and what MuJoCo derives of it at qpos0."""
    dofs = np.isin(robot.model.dof_jntid, joints)
    robot.model.dof_armature[dofs] = np.maximum(robot.model.dof_armature[dofs], armature)
    robot.mujoco.mj_setConst(robot.model, robot.mujoco.MjData(robot.model))
    return robot


def _least_armature(unsafe: Unsafe, joints: Sequence[int]) -> float | None:
    """Return the least armature that is safe, rounded up to two digits; None where none is found."""
    robot, state, _ = unsafe[0]
    dofs = np.isin(robot.model.dof_jntid, joints)
    own = float(np.diagonal(robot.mass_at(robot.data_at(state)))[dofs].max())

    def safe(armature: float) -> bool:
        return _safe(unsafe, partial(_with_armature, joints, armature))

    largest = own * 4.0**QUARTERS
    if not safe(largest):
        return None
    return float(rounded_up(last_safe(safe, largest, own / 4.0**QUARTERS, 2 * BISECTIONS), 2))


# solref


SOLREF_ARRAYS = {"equality": "eq_solref", "joint limit": "jnt_solref", "tendon limit": "tendon_solref_lim"}


def _with_solref(elements: Sequence[Element], first: float, robot: Robot) -> Robot:
    for element in elements:
        if element.geoms:
            robot.model.geom_solref[list(element.geoms)] = first, 1.0
        else:
            getattr(robot.model, SOLREF_ARRAYS[element.kind])[element.entries[0][1]] = first, 1.0
    return robot
