"""What acts in a model at a state, and what the model is without it."""

from collections.abc import Collection, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from bezstab.mujoco.controllers import Drive, name_of
from bezstab.mujoco.robots import Robot, State
from bezstab.stability.arrays import FloatArray

DRIVE_ARRAYS = ("actuator_gainprm", "actuator_biasprm", "actuator_damping")
FLEX_ARRAYS = ("flex_edgestiffness", "flex_edgedamping", "flex_damping")


@dataclass(frozen=True, eq=False)
class Element:
    """One element of a robot: entries of the model's arrays that are zero without it; or a controller; or two geoms."""

    name: str
    kind: str
    entries: tuple[tuple[str, Any], ...] = ()
    drives: tuple[Drive, ...] = ()
    geoms: frozenset[int] = frozenset()


@contextmanager
def without(robot: Robot, elements: Collection[Element]) -> Iterator[Robot]:
    """Give the robot without some elements; its model is changed meanwhile."""
    kept = []
    for element in elements:
        for name, where in element.entries:
            if (array := _array(robot.model, name)) is not None:
                kept.append((array, where, array[where].copy()))
                array[where] = 0
    left_out = {id(drive) for element in elements for drive in element.drives}
    try:
        yield replace(
            robot,
            drives=tuple(replace(each, kp=0.0, kd=0.0) if id(each) in left_out else each for each in robot.drives),
            apart=robot.apart | {element.geoms for element in elements if element.geoms},
        )
    finally:
        for array, where, values in reversed(kept):
            array[where] = values


def element_name(robot: Robot, sort: str, number: int) -> str:
    """Return what an element is called: actuator 'servo', or equality 0 where it has no name."""
    name = name_of(robot.mujoco, robot.model, sort, number)
    return f"{sort} {name}" if name == str(number) else f"{sort} {name!r}"


def _array(model: Any, name: str) -> Any:
    """Return an array of the model; None where this version of MuJoCo has none of that name."""
    return getattr(model, name, None)


def acting(robot: Robot, state: State) -> list[Element]:
    """Return the elements that act on errors at a state, in the model's order."""
    return [*_Model(robot, robot.data_at(state)).elements(), *_controllers(robot)]


def _controllers(robot: Robot) -> Iterator[Element]:
    for name in dict.fromkeys(drive.element for drive in robot.drives):
        yield Element(name, "--pd drive", drives=tuple(drive for drive in robot.drives if drive.element == name))


@dataclass(frozen=True, eq=False)
class _Model:
    robot: Robot
    data: Any

    def elements(self) -> Iterator[Element]:
        model = self.robot.model
        joints = model.dof_jntid
        for number in self._rows("EQUALITY"):
            yield self._element("equality", "equality", number, "eq_active0")
        for number in self._drives():
            yield self._element("drive", "actuator", number, *DRIVE_ARRAYS)
        for joint in np.unique(joints[_any(model, "dof_damping")]).tolist():
            dofs = np.flatnonzero(joints == joint)
            yield self._element("joint damping", "joint", joint, "dof_damping", "dof_dampingpoly", where=dofs)
        for joint in np.unique(joints[model.dof_frictionloss != 0]).tolist():
            dofs = np.flatnonzero(joints == joint)
            yield self._element("joint friction", "joint", joint, "dof_frictionloss", where=dofs)
        for number in np.flatnonzero(_any(model, "jnt_stiffness")).tolist():
            yield self._element("joint spring", "joint", number, "jnt_stiffness", "jnt_stiffnesspoly")
        for number in self._rows("LIMIT_JOINT"):
            yield self._element("joint limit", "joint", number, "jnt_limited")
        for what in ("stiffness", "damping"):
            kind = f"tendon {'spring' if what == 'stiffness' else what}"
            for number in np.flatnonzero(_any(model, f"tendon_{what}")).tolist():
                yield self._element(kind, "tendon", number, f"tendon_{what}", f"tendon_{what}poly")
        for number in self._rows("LIMIT_TENDON"):
            yield self._element("tendon limit", "tendon", number, "tendon_limited")
        for number in self._rows("FRICTION_TENDON"):
            yield self._element("tendon friction", "tendon", number, "tendon_frictionloss")
        for number in range(model.nflex):
            yield self._flex(number)
        yield from self._contacts()

    def _element(self, kind: str, sort: str, number: int, *arrays: str, where: Any = None) -> Element:
        place = number if where is None else where
        return Element(element_name(self.robot, sort, number), kind, tuple((name, place) for name in arrays))

    def _rows(self, kind: str) -> list[int]:
        """Return the numbers of what has rows of a kind among MuJoCo's constraints."""
        of_kind = self.data.efc_type == getattr(self.robot.mujoco.mjtConstraint, f"mjCNSTR_{kind}")
        numbers: list[int] = np.unique(self.data.efc_id[of_kind]).tolist()
        return numbers

    def _drives(self) -> list[int]:
        """Return the actuators with a feedback of their own: motors have none."""
        mujoco, model = self.robot.mujoco, self.robot.model
        plain = (model.actuator_biastype == mujoco.mjtBias.mjBIAS_NONE) & (
            model.actuator_gaintype == mujoco.mjtGain.mjGAIN_FIXED
        )
        damped = _any(model, "actuator_damping") if hasattr(model, "actuator_damping") else False
        numbers: list[int] = np.flatnonzero(~plain | damped).tolist()
        return numbers

    def _flex(self, number: int) -> Element:
        model = self.robot.model
        entries: list[tuple[str, Any]] = [(name, number) for name in FLEX_ARRAYS]
        for name in ("flex_stiffness", "flex_bending"):
            if hasattr(model, f"{name}adr"):
                starts = getattr(model, f"{name}adr")
                later = starts[starts > starts[number]]
                end = later.min() if later.size else None
                entries += [(name, slice(starts[number], end))] * bool(starts[number] >= 0)
            elif _array(model, name) is not None:
                entries.append((name, number))
        return Element(element_name(self.robot, "flex", number), "flex", tuple(entries))

    def _contacts(self) -> Iterator[Element]:
        pairs = np.sort(self.data.contact.geom, axis=1)
        for pair in np.unique(pairs[pairs[:, 0] >= 0], axis=0).tolist():  # those of flexes have no two geoms
            names = " and ".join(element_name(self.robot, "geom", geom) for geom in pair)
            yield Element(names, "contact", geoms=frozenset(pair))


def _any(model: Any, name: str) -> Any:
    """Return where an array, or the coefficients of higher order beside it, is not zero."""
    own: FloatArray = np.asarray(getattr(model, name)) != 0
    higher = getattr(model, f"{name}poly", None)
    return own if higher is None else own | (higher != 0).any(axis=-1)
