"""A MuJoCo model as data: its step, what pulls its constraints back, and what acts along its joints and tendons.

MuJoCo itself reads the file, so defaults, classes and angles are resolved as in a run; nothing is simulated. It opens
the file, the files that this includes, and the meshes, textures and height fields named there; plugins only if MuJoCo
has them registered already. Everything is read at the model's own configuration qpos0.
"""

import types
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from copy import copy
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cache, cached_property
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from bezstab.engines import LEAST_IMPEDANCE, MOST_IMPEDANCE
from bezstab.errors import InputError, NumericalError
from bezstab.methods import Method, lookup
from bezstab.rationals import exact
from bezstab.stability import FloatArray

LEAST_VERSION = (3, 7)
"""Before it connect and weld lacked the term of turning normals, dJ/dt v: a moving mechanism was another system.

Up to 3.8.0 the implicit integrators still move free bodies by the midpoint rule, which is stable beyond what lint says
of their constraints; 3.8.1, 3.10, 3.11 and 4.0 do as it says (measured).
"""

LEAST_SIZE = 1e-15
"""MuJoCo's mjMINVAL, its least R: neither what is less nor what is beyond the inverse is what anybody means."""

MOST_ROWS = 300
"""Of one equality, such as a flex's: eigenvalues of as many are found some two hundred times, within seconds."""

STILL = "it moves nothing at qpos0"
"""Why what pulls at bodies that cannot move, or has no moment arm there, is not judged."""

ANY_DISTANCE = 1e6
"""m and rad: farther than anything is from a limit or a contact, and float64 still resolves what is near."""

DIGITS = 12
"""Of inertias and shares: what linear algebra in float64 leaves of small matrices."""

INTEGRATORS = {"Euler": "SYM", "RK4": "RK4", "implicit": "SYM", "implicitfast": "SYM"}
"""In the order of MuJoCo's own numbers, each with the method that it is for constraints."""


@dataclass(frozen=True, eq=False)
class Constraint:
    """One constraint's solref and solimp (d0, dmax, width in m or rad), defaults of classes and mixtures resolved.

    `jacobian` (rows, dofs) is that at qpos0, `diagonal` MuJoCo's estimate of the diagonal of J M^-1 J' (1/kg, 1/(kg
    m^2)); both are empty where they depend on the configuration, as those of contacts. `positional` is False for
    friction, which has damping but no stiffness. `active` is whether it holds both ways from the start. InputError for
    numbers that mean nothing.
    """

    element: str
    kind: str
    solref: tuple[float, float]
    solimp: tuple[float, float, float]
    jacobian: FloatArray = field(default_factory=lambda: np.zeros((0, 0)))
    diagonal: FloatArray = field(default_factory=lambda: np.zeros(0))
    positional: bool = True
    active: bool = False

    def __post_init__(self) -> None:
        _require_sizes(f"{self.element}: solref", self.solref)
        _require_sizes(f"{self.element}: solimp", self.solimp)


@dataclass(frozen=True)
class Feedback:
    """A spring and damper along one direction of the joint space: a passive one, or an actuator's gains.

    `direction` (dofs,) is the moment arm, gear included; `stiffness` (N/m, N m/rad) and `damping` (N s/m, N m s/rad)
    are those along it. `implicit` is whether the integrator treats the damping implicitly. InputError for numbers that
    mean nothing.
    """

    element: str
    kind: str
    direction: FloatArray
    stiffness: float
    damping: float
    implicit: bool

    def __post_init__(self) -> None:
        _require_sizes(f"{self.element}: kp, kv", (self.stiffness, self.damping))


@dataclass(frozen=True)
class Motor:
    """An actuator whose force is what a controller outside the model sets: `gain` times the control along `direction`.

    `direction` (dofs,) is the moment arm, gear included, so that the actuator's length is direction . q. `delay` (s) is
    MuJoCo's own, of the control.
    """

    element: str
    name: str
    direction: FloatArray
    gain: float
    delay: float


@dataclass(frozen=True)
class Unjudged:
    """An element whose feedback is no constant, and why."""

    element: str
    kind: str
    reason: str


Element = TypeVar("Element", Constraint, Feedback, Motor, Unjudged)


@dataclass(frozen=True, eq=False)
class ModelData:
    """What a MuJoCo model says of its feedback; h in s, mass (dofs, dofs) in kg and kg m^2 with armatures, at qpos0.

    `refsafe` raises a timeconst below 2h. `keyframes` are names, else numbers from zero, of
    other poses.
    """

    h: Fraction
    integrator: str
    refsafe: bool
    mass: FloatArray
    elements: tuple[Constraint | Feedback | Motor | Unjudged, ...]
    keyframes: tuple[str, ...]

    def of(self, kind: type[Element]) -> list[Element]:
        """Return the elements of one kind."""
        return [each for each in self.elements if isinstance(each, kind)]

    @property
    def method(self) -> Method:
        """The method that the integrator is for constraints."""
        return lookup(INTEGRATORS[self.integrator])

    def springs_and_dampers(self) -> FloatArray:
        """Return the matrices of stiffness, of damping, and of what is implicit of it, (3, dofs, dofs), SI units."""
        feedbacks = self.of(Feedback)
        directions = np.array([each.direction for each in feedbacks]).reshape(-1, len(self.mass))
        strengths = np.array([(each.stiffness, each.damping, each.implicit * each.damping) for each in feedbacks])
        return np.asarray(np.einsum("ks,ki,kj->sij", strengths.reshape(-1, 3), directions, directions))

    @cached_property
    def inverse_mass(self) -> Callable[[float], FloatArray]:
        """(M + h D)^-1 by h (s), shape (dofs, dofs): what divides accelerations; that of the mass alone at h = 0.

        D is the damping that the integrator treats implicitly. NumericalError where M is singular to rounding.
        """
        try:
            np.linalg.cholesky(self.mass)
        except np.linalg.LinAlgError:
            raise NumericalError("the mass matrix at qpos0 is singular to rounding") from None
        _, _, implicit_damping = self.springs_and_dampers()
        return cache(lambda h: np.linalg.inv(self.mass + h * implicit_damping))

    def inertia_along(self, direction: FloatArray) -> Fraction:
        """Return the inertia along a direction u with all else free, 1 / (u M^-1 u'), to DIGITS."""
        inertia = 1 / float(direction @ self.inverse_mass(0.0) @ direction)
        return exact(float(f"{inertia:.{DIGITS}g}"))


def mujoco_module(wanted_by: str) -> types.ModuleType:
    """Return MuJoCo; InputError, which begins with what wants it, where it is missing or older than 3.7."""
    try:
        import mujoco
    except ImportError:
        raise InputError(f"{wanted_by} needs an optional package: pip install 'bezstab[mujoco]'") from None
    version = tuple(int(part) for part in mujoco.__version__.split(".")[:2])
    if version < LEAST_VERSION:
        raise InputError(
            f"{wanted_by} needs mujoco 3.7 or later, found {mujoco.__version__}: before, connect and weld lacked the "
            "term of turning normals"
        )
    module: types.ModuleType = mujoco
    return module


def read_mujoco_model(path: Path) -> ModelData:
    """Return what a model file (MJCF or URDF, as XML) says; InputError, in one line, for what MuJoCo refuses."""
    mujoco = mujoco_module("lint")
    try:
        with path.open("rb"):  # for the system's own words on why not
            pass
        with silent(mujoco):
            return model_data(mujoco, mujoco.MjModel.from_xml_path(str(path)))
    except OSError as error:
        raise InputError(f"MuJoCo model {path}: {error.strerror}") from None
    except (ValueError, RuntimeError, mujoco.FatalError) as error:  # RuntimeError: what its decoders raise
        raise InputError(" ".join(f"MuJoCo model {path}: {error}".split())) from None


@contextmanager
def silent(mujoco: types.ModuleType) -> Iterator[None]:
    """Keep MuJoCo from printing its warnings, and from writing them into a file of the current directory."""
    mujoco.set_mju_user_warning(lambda _: None)
    try:
        yield
    finally:
        mujoco.set_mju_user_warning(None)


def model_data(mujoco: types.ModuleType, model: Any) -> ModelData:
    """Return what a loaded model says; InputError for numbers that mean nothing."""
    model = copy(model)
    model.opt.jacobian = mujoco.mjtJacobian.mjJAC_DENSE
    for margins in (model.jnt_margin, model.tendon_margin):
        margins[:] = ANY_DISTANCE  # to have the row of every limit,
    data = mujoco.MjData(model)
    data.eq_active[:] = 1  # and those of every equality
    mujoco.mj_fwdPosition(model, data)
    units = np.eye(model.nv)
    mass, tendons, actuators = np.zeros_like(units), [], []
    for place, unit in enumerate(units):
        mujoco.mj_mulM(model, data, mass[place], unit)  # symmetric: rows are columns
        data.qvel[:] = unit
        mujoco.mj_fwdVelocity(model, data)
        tendons.append(data.ten_velocity.copy())
        actuators.append(data.actuator_velocity.copy())
    directions = {"joint": units, "tendon": np.transpose(tendons), "actuator": np.transpose(actuators)}
    loaded = _Loaded(mujoco, model, data, directions)
    found = [*_of_rows(loaded), *_contacts(loaded), *_passive(loaded), *_actuators(loaded), *_flexes(loaded)]
    full = (mujoco.mjtWarning.mjWARN_CONTACTFULL, mujoco.mjtWarning.mjWARN_CNSTRFULL)
    if any(data.warning[each].number for each in full):
        raise InputError('too little memory for all that can touch and be held: give it more, <size memory="1G"/>')
    _require_sizes("timestep", (model.opt.timestep,))
    if model.opt.timestep <= 0:
        raise InputError(f"timestep = {model.opt.timestep:g}: expected a positive number")
    return ModelData(
        h=exact(model.opt.timestep),
        integrator=list(INTEGRATORS)[model.opt.integrator],
        refsafe=loaded.has("REFSAFE"),
        mass=mass,
        elements=tuple(found),
        keyframes=tuple(
            mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_KEY, number) or str(number) for number in range(model.nkey)
        ),
    )


def _require_sizes(name: str, values: Sequence[float]) -> None:
    """Raise InputError unless every number is zero or of a size that somebody may mean."""
    if not all(value == 0 or min(abs(value), 1 / abs(value)) >= LEAST_SIZE for value in values):
        listed = " ".join(f"{value:g}" for value in values)
        raise InputError(f"{name} = {listed}: expected 0, or sizes from {LEAST_SIZE:g} to {1 / LEAST_SIZE:g}")


@dataclass(frozen=True)
class _Loaded:
    """A model as MuJoCo has loaded it, with its data at qpos0.

    `directions` are how fast joints, tendons and actuators lengthen with each degree of freedom: each of them has shape
    (elements, dofs), m or rad each.
    """

    mujoco: types.ModuleType
    model: Any
    data: Any
    directions: dict[str, FloatArray]

    def has(self, flag: str) -> bool:
        """Return whether what the flag is called by is not switched off."""
        return not self.model.opt.disableflags & getattr(self.mujoco.mjtDisableBit, f"mjDSBL_{flag}")

    def is_implicit(self, at_joint: bool) -> bool:
        """Return whether the integrator treats a damping implicitly: RK4 none, Euler that of joints alone."""
        integrator = list(INTEGRATORS)[self.model.opt.integrator]
        return at_joint and self.has("EULERDAMP") if integrator == "Euler" else integrator != "RK4"

    def named(self, kind: str, number: int) -> str:
        """Return what an element is called: joint 'elbow', and joint 3 (from zero) where it has no name."""
        name = self.mujoco.mj_id2name(self.model, getattr(self.mujoco.mjtObj, f"mjOBJ_{kind.upper()}"), number)
        return f"{kind} {name!r}" if name else f"{kind} {number}"


# Constraints


def _constraint(element: str, kind: str, solref: FloatArray, solimp: FloatArray, **rows: Any) -> Constraint:
    """Return a constraint with MuJoCo's own solref and solimp, and what is known of its rows."""
    first, last = np.clip(solimp[:2], float(LEAST_IMPEDANCE), float(MOST_IMPEDANCE)).tolist()
    return Constraint(element, kind, tuple(solref.tolist()), (first, last, float(solimp[2])), **rows)


def _of_rows(loaded: _Loaded) -> Iterator[Constraint | Unjudged]:
    """Yield equalities, limits and frictions that are not switched off; not judged is what has no rows at qpos0."""
    mujoco, model, data = loaded.mujoco, loaded.model, loaded.data
    kinds = {
        "EQUALITY": ("equality", np.ones(model.neq), model.eq_solref, model.eq_solimp),
        "LIMIT_JOINT": ("joint limit", model.jnt_limited, model.jnt_solref, model.jnt_solimp),
        "LIMIT_TENDON": ("tendon limit", model.tendon_limited, model.tendon_solref_lim, model.tendon_solimp_lim),
        "FRICTION_DOF": ("joint friction", model.dof_frictionloss, model.dof_solref, model.dof_solimp),
        "FRICTION_TENDON": (
            "tendon friction",
            model.tendon_frictionloss,
            model.tendon_solref_fri,
            model.tendon_solimp_fri,
        ),
    }
    jacobian = data.efc_J[: data.nefc * model.nv].reshape(data.nefc, model.nv)  # room for rows that are zero follows
    impedance = data.efc_KBIP[:, 2]
    diagonal = data.efc_R * impedance / (1 - impedance)  # as R = (1 - d) / d times the diagonal
    for name, (kind, wanted, solref, solimp) in kinds.items():
        of_kind = data.efc_type == getattr(mujoco.mjtConstraint, f"mjCNSTR_{name}")
        switch = "FRICTIONLOSS" if "FRICTION" in name else name.split("_")[0]
        if not (loaded.has("CONSTRAINT") and loaded.has(switch)):
            continue
        for number in np.flatnonzero(wanted).tolist():
            own = np.flatnonzero(of_kind & (data.efc_id == number))
            element = loaded.named(kind.split()[0], model.dof_jntid[number] if name == "FRICTION_DOF" else number)
            full_kind = kind
            if name == "EQUALITY":
                full_kind = f"{mujoco.mjtEq(model.eq_type[number]).name.removeprefix('mjEQ_').lower()} {kind}"
            else:
                own = own[:1]  # of a limit's two ends one
            if not own.size:
                yield Unjudged(element, full_kind, STILL)
                continue
            if len(own) > MOST_ROWS:
                yield Unjudged(element, full_kind, f"it has {len(own)} rows, at most {MOST_ROWS} are judged")
                continue
            yield _constraint(
                element,
                full_kind,
                solref[number],
                solimp[number],
                jacobian=jacobian[own],
                diagonal=diagonal[own],
                positional="friction" not in kind,
                active=name == "EQUALITY" and bool(model.eq_active0[number]),
            )


def _contacts(loaded: _Loaded) -> Iterator[Constraint]:
    """Yield a contact for each mixture of parameters that two geoms can meet with, as MuJoCo mixes them.

    It filters and mixes as soon as two geoms are nearer than their margins, so these are made to reach anywhere.
    """
    mujoco, model, data = loaded.mujoco, loaded.model, loaded.data
    for margins in (model.geom_margin, model.pair_margin):
        margins[:] = ANY_DISTANCE
    copies = _same_geoms(model)
    model.geom_contype[copies] = model.geom_conaffinity[copies] = 0
    model.opt.o_margin = ANY_DISTANCE
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_MIDPHASE  # which goes by margins of before
    mujoco.mj_collision(model, data)
    geoms = np.sort(data.contact.geom, axis=1)
    order = np.lexsort(geoms.T[::-1])
    order = order[geoms[order, 0] >= 0]  # those of flexes have no two geoms
    solrefs, solimps = data.contact.solref[order], data.contact.solimp[order]
    _, first = np.unique(np.hstack([solrefs, solimps]), axis=0, return_index=True)
    for place in np.sort(first):
        element = " and ".join(loaded.named("geom", geom) for geom in geoms[order[place]])
        yield _constraint(element, "contact", solrefs[place], solimps[place])


def _same_geoms(model: Any) -> NDArray[np.intp]:
    """Return the geoms that touch nothing otherwise than an earlier one does, such as the boxes of a terrain.

    They are of one shape and one body, or of bodies fixed to each other, and have the same parameters.
    """
    bodies = np.arange(model.nbody)
    excluded = np.isin(bodies, [model.exclude_signature >> 16, model.exclude_signature & 0xFFFF])
    what_decides = (
        np.where(excluded, bodies, -1 - model.body_weldid)[model.geom_bodyid],  # exclusions are of single bodies
        *(model.geom_type, model.geom_contype, model.geom_conaffinity, model.geom_priority, model.geom_solmix),
        *(model.geom_solref, model.geom_solimp),
    )
    _, first = np.unique(np.column_stack(what_decides), axis=0, return_index=True)
    return np.setdiff1d(np.arange(model.ngeom), first)


# Springs, dampers and drives


def _passive(loaded: _Loaded) -> Iterator[Feedback]:
    """Yield the springs and dampers of joints and tendons."""
    model, joints = loaded.model, loaded.model.dof_jntid
    of_joints = joints, model.jnt_stiffness[joints], model.dof_damping
    of_tendons = range(model.ntendon), model.tendon_stiffness, model.tendon_damping
    for kind, columns in (("joint", of_joints), ("tendon", of_tendons)):
        for number, spring, damper, direction in zip(*columns, loaded.directions[kind], strict=True):
            stiffness, damping = loaded.has("SPRING") * float(spring), loaded.has("DAMPER") * float(damper)
            if (stiffness or damping) and direction.any():
                element = loaded.named(kind, number)
                yield Feedback(element, kind, direction, stiffness, damping, loaded.is_implicit(kind == "joint"))


def _actuators(loaded: _Loaded) -> Iterator[Feedback | Motor | Unjudged]:
    """Yield the gains of actuators with an affine bias, motors, and dampings that actuators have besides.

    A motor has no gains of its own: whoever sets its control closes the loop.
    """
    mujoco, model = loaded.mujoco, loaded.model
    count = len(model.actuator_biastype)
    # What 3.7 does not know yet: several outputs of one actuator, damping, delay.
    outputs = getattr(model, "actuator_outadr", range(count))
    dampings, delays = (getattr(model, f"actuator_{name}", np.zeros(count)) for name in ("damping", "delay"))
    for number in range(count if loaded.has("ACTUATION") else 0):
        if model.opt.disableactuator >> max(0, int(model.actuator_group[number])) & 1:
            continue  # its group is switched off
        element, direction = loaded.named("actuator", number), loaded.directions["actuator"][outputs[number]]
        if not direction.any():
            yield Unjudged(element, "drive", STILL)
            continue
        bias = mujoco.mjtBias(model.actuator_biastype[number]).name
        gain = mujoco.mjtGain(model.actuator_gaintype[number]).name
        if bias not in ("mjBIAS_NONE", "mjBIAS_AFFINE") or gain != "mjGAIN_FIXED":
            yield Unjudged(element, "drive", "its force is no constant stiffness and damping")
            continue
        if bias == "mjBIAS_AFFINE":
            stiffness, damping = (-model.actuator_biasprm[number, 1:3]).tolist()
            if stiffness or damping:
                yield Feedback(element, "drive", direction, stiffness, damping, loaded.is_implicit(at_joint=False))
        elif mujoco.mjtDyn(model.actuator_dyntype[number]).name != "mjDYN_NONE":
            yield Unjudged(element, "motor", "its activation filters what a controller sets")
        else:
            name = mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_ACTUATOR, number) or str(number)
            yield Motor(element, name, direction, float(model.actuator_gainprm[number, 0]), float(delays[number]))
        if dampings[number] and loaded.has("DAMPER"):  # added to that of its joint, if it has one
            at_joint = mujoco.mjtTrn(model.actuator_trntype[number]).name.startswith("mjTRN_JOINT")
            yield Feedback(element, "drive", direction, 0.0, float(dampings[number]), loaded.is_implicit(at_joint))


def _flexes(loaded: _Loaded) -> Iterator[Unjudged]:
    """Yield what may act on a flex besides its equalities."""
    for flex in range(loaded.model.nflex):
        reason = "springs and contacts, if it has any, are of all its elements together"
        yield Unjudged(loaded.named("flex", flex), "flex", reason)
