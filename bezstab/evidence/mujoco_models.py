"""A MuJoCo model as data: its step, what pulls its constraints back, and what acts along its joints and tendons.

MuJoCo itself reads the file, so defaults, classes and angles are resolved as in a run; nothing is simulated. It opens
the file, the files that this includes, and the meshes, textures and height fields named there; plugins only if MuJoCo
has them registered already. Everything is read at the model's own configuration qpos0.
"""

import types
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import combinations_with_replacement, islice
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from bezstab.errors import InputError
from bezstab.stability import FloatArray

LEAST_VERSION = (3, 7)
"""Before it connect and weld lacked the term of turning normals, dJ/dt v: a moving mechanism was another system.

Up to 3.8.0 the implicit integrators still move free bodies by the midpoint rule, which is stable beyond what lint says
of their constraints; 3.8.1, 3.10, 3.11 and 4.0 do as it says (measured).
"""

LEAST_IMPEDANCE, MOST_IMPEDANCE = 0.0001, 0.9999
"""MuJoCo keeps d in between (mjMINIMP, mjMAXIMP)."""

LEAST_SIZE = 1e-15
"""MuJoCo's mjMINVAL, its least R: a lesser solmix counts as none, and of other numbers neither what is less nor what is
beyond the inverse is what anybody means."""

MOST_ROWS = 300
"""Of one equality, such as a flex's: beyond, its masses are left out, and it is judged as contacts are."""

IntArray = NDArray[np.int_]
Integrator = Literal["Euler", "RK4", "implicit", "implicitfast"]
INTEGRATORS: tuple[Integrator, ...] = ("Euler", "RK4", "implicit", "implicitfast")
"""In the order of MuJoCo's own numbers."""


@dataclass(frozen=True)
class Constraint:
    """One constraint's solref and solimp (d0, dmax, width in m or rad), defaults of classes and mixtures resolved.

    `jacobian` (rows, dofs) is that at qpos0, `diagonal` MuJoCo's estimate of the diagonal of J M^-1 J' (1/kg, 1/(kg
    m^2)); both are None where they depend on the configuration, as those of contacts. `positional` is False for
    friction, which has damping but no stiffness. `active` is whether it holds both ways from the start.
    """

    element: str
    kind: str
    solref: tuple[float, float]
    solimp: tuple[float, float, float]
    jacobian: FloatArray | None = None
    diagonal: FloatArray | None = None
    positional: bool = True
    active: bool = False


@dataclass(frozen=True)
class Feedback:
    """A spring and damper along one direction of the joint space: a passive one, or an actuator's gains.

    `direction` (dofs,) is the moment arm, gear included; `stiffness` (N/m, N m/rad) and `damping` (N s/m, N m s/rad)
    are those along it. `euler_implicit` is whether MuJoCo's Euler treats the damping implicitly: that of joints alone.
    """

    element: str
    kind: str
    direction: FloatArray
    stiffness: float
    damping: float
    euler_implicit: bool


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


@dataclass(frozen=True)
class ModelData:
    """What a MuJoCo model says of its feedback; h in s, mass (dofs, dofs) in kg and kg m^2 with armatures, at qpos0.

    `refsafe` raises a timeconst below 2h; `euler_damping` makes Euler implicit in the damping of joints.
    """

    h: float
    integrator: Integrator
    refsafe: bool
    euler_damping: bool
    mass: FloatArray
    constraints: tuple[Constraint, ...]
    feedbacks: tuple[Feedback, ...]
    unjudged: tuple[Unjudged, ...]
    motors: tuple[Motor, ...] = ()

    @property
    def size(self) -> int:
        """Return the number of elements."""
        return len(self.constraints) + len(self.feedbacks) + len(self.unjudged) + len(self.motors)


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
        with _silent(mujoco):
            return model_data(mujoco, mujoco.MjModel.from_xml_path(str(path)))
    except OSError as error:
        raise InputError(f"MuJoCo model {path}: {error.strerror}") from None
    except (ValueError, RuntimeError, mujoco.FatalError) as error:  # RuntimeError: what its decoders raise
        raise InputError(" ".join(f"MuJoCo model {path}: {error}".split())) from None


@contextmanager
def _silent(mujoco: types.ModuleType) -> Iterator[None]:
    """Keep MuJoCo from printing its warnings, and from writing them into a file of the current directory."""
    mujoco.set_mju_user_warning(lambda _: None)
    try:
        yield
    finally:
        mujoco.set_mju_user_warning(None)


def model_data(mujoco: types.ModuleType, model: Any) -> ModelData:
    """Return what a loaded model says, whose choice of Jacobian is set to dense; InputError for what means nothing."""
    model.opt.jacobian = mujoco.mjtJacobian.mjJAC_DENSE
    data = mujoco.MjData(model)
    data.eq_active[:] = 1  # to have the rows of all of them
    mujoco.mj_forward(model, data)
    units = np.eye(model.nv)
    mass = np.zeros_like(units)
    for unit, column in zip(units, mass, strict=True):  # symmetric: rows are columns
        mujoco.mj_mulM(model, data, column, unit)
    loaded = _Loaded(mujoco, model, data, units, _tendon_directions(model, data))
    actuators = list(_actuators(loaded))
    constraints = tuple(_constraints(loaded))
    feedbacks = (*_passive(loaded), *(each for each in actuators if isinstance(each, Feedback)))
    _require_sizes("timestep", (model.opt.timestep,))
    if model.opt.timestep <= 0:
        raise InputError(f"timestep = {model.opt.timestep:g}: expected a positive number")
    for constraint in constraints:
        _require_sizes(f"{constraint.element}: solref", constraint.solref)
        _require_sizes(f"{constraint.element}: solimp", constraint.solimp)
    for feedback in feedbacks:
        _require_sizes(f"{feedback.element}: kp, kv", (feedback.stiffness, feedback.damping))
    return ModelData(
        h=model.opt.timestep,
        integrator=INTEGRATORS[model.opt.integrator],
        refsafe=loaded.has("REFSAFE"),
        euler_damping=loaded.has("EULERDAMP"),
        mass=mass,
        constraints=constraints,
        feedbacks=feedbacks,
        unjudged=(*(each for each in actuators if isinstance(each, Unjudged)), *_flexes(loaded)),
        motors=tuple(each for each in actuators if isinstance(each, Motor)),
    )


def _require_sizes(name: str, values: Sequence[float]) -> None:
    """Raise InputError unless every number is zero or of a size that somebody may mean."""
    if not all(value == 0 or min(abs(value), 1 / abs(value)) >= LEAST_SIZE for value in values):
        listed = " ".join(f"{value:g}" for value in values)
        raise InputError(f"{name} = {listed}: expected 0, or sizes from {LEAST_SIZE:g} to {1 / LEAST_SIZE:g}")


@dataclass(frozen=True)
class _Loaded:
    """A model as MuJoCo has loaded it, with its data at qpos0, and the directions of its joints and tendons.

    `joints` (dofs, dofs) and `tendons` (tendons, dofs) are how their lengths change with the joints, m or rad each.
    """

    mujoco: types.ModuleType
    model: Any
    data: Any
    joints: FloatArray
    tendons: FloatArray

    def has(self, flag: str) -> bool:
        """Return whether what the flag is called by is not switched off."""
        return not self.model.opt.disableflags & getattr(self.mujoco.mjtDisableBit, f"mjDSBL_{flag}")

    def named(self, kind: str, number: int) -> str:
        """Return what an element is called: joint 'elbow', and joint 3 (from zero) where it has no name."""
        name = self.mujoco.mj_id2name(self.model, getattr(self.mujoco.mjtObj, f"mjOBJ_{kind.upper()}"), number)
        return f"{kind} {name!r}" if name else f"{kind} {number}"


# Constraints


def _constraints(loaded: _Loaded) -> Iterator[Constraint]:
    """Yield every constraint that the model can have, those whose kind is switched off left out."""
    kinds = {"EQUALITY": _equalities, "LIMIT": _limits, "FRICTIONLOSS": _friction_losses, "CONTACT": _contacts}
    for flag, of_kind in kinds.items():
        if loaded.has("CONSTRAINT") and loaded.has(flag):
            yield from of_kind(loaded)


def _solref(values: FloatArray) -> tuple[float, float]:
    return float(values[0]), float(values[1])


def _solimp(values: FloatArray) -> tuple[float, float, float]:
    first, last = np.clip(values[:2], LEAST_IMPEDANCE, MOST_IMPEDANCE).tolist()
    return first, last, max(0.0, float(values[2]))


def _equalities(loaded: _Loaded) -> Iterator[Constraint]:
    mujoco, model, data = loaded.mujoco, loaded.model, loaded.data
    kinds = {value: name.removeprefix("mjEQ_").lower() for name, value in mujoco.mjtEq.__members__.items()}
    jacobian = data.efc_J.reshape(-1, model.nv) if data.nefc else np.zeros((0, model.nv))
    for number in range(model.neq):
        own = (data.efc_type == mujoco.mjtConstraint.mjCNSTR_EQUALITY) & (data.efc_id == number)
        known = 0 < own.sum() <= MOST_ROWS
        impedance = data.efc_KBIP[own, 2]
        diagonal = data.efc_R[own] * impedance / (1 - impedance)  # as R = (1 - d) / d times the diagonal
        yield Constraint(
            element=loaded.named("equality", number),
            kind=f"{kinds[mujoco.mjtEq(model.eq_type[number])]} equality",
            solref=_solref(model.eq_solref[number]),
            solimp=_solimp(model.eq_solimp[number]),
            jacobian=jacobian[own].copy() if known else None,
            diagonal=diagonal if known else None,
            active=bool(model.eq_active0[number]),
        )


def _limits(loaded: _Loaded) -> Iterator[Constraint]:
    model = loaded.model
    joints, tendons = np.flatnonzero(model.jnt_limited), np.flatnonzero(model.tendon_limited)
    of_joints = model.jnt_solref[joints], model.jnt_solimp[joints]
    of_tendons = model.tendon_solref_lim[tendons], model.tendon_solimp_lim[tendons]
    yield from _along_one(loaded, "joint limit", joints, model.jnt_dofadr[joints], *of_joints)
    yield from _along_one(loaded, "tendon limit", tendons, tendons, *of_tendons)


def _friction_losses(loaded: _Loaded) -> Iterator[Constraint]:
    model = loaded.model
    dofs, tendons = np.flatnonzero(model.dof_frictionloss > 0), np.flatnonzero(model.tendon_frictionloss > 0)
    of_tendons = model.tendon_solref_fri[tendons], model.tendon_solimp_fri[tendons]
    yield from _along_one(
        loaded, "joint friction", model.dof_jntid[dofs], dofs, model.dof_solref[dofs], model.dof_solimp[dofs]
    )
    yield from _along_one(loaded, "tendon friction", tendons, tendons, *of_tendons)


def _along_one(
    loaded: _Loaded, kind: str, numbers: IntArray, places: IntArray, solrefs: FloatArray, solimps: FloatArray
) -> Iterator[Constraint]:
    """Yield limits or frictions of joints or tendons; `places` are those of their directions among all."""
    model = loaded.model
    of, what = kind.split()
    directions, weights = loaded.joints, model.dof_invweight0
    if of == "tendon":
        directions, weights = loaded.tendons, model.tendon_invweight0
    for number, place, solref, solimp in zip(numbers, places, solrefs, solimps, strict=True):
        # the axis of a ball's limit depends on the configuration
        known = kind != "joint limit" or model.jnt_type[number] != loaded.mujoco.mjtJoint.mjJNT_BALL
        yield Constraint(
            element=loaded.named(of, number),
            kind=kind,
            solref=_solref(solref),
            solimp=_solimp(solimp),
            jacobian=directions[[place]] if known else None,
            diagonal=weights[[place]] if known else None,
            positional=what == "limit",
        )


def _contacts(loaded: _Loaded) -> Iterator[Constraint]:
    """Yield the contacts of pairs that the model lists, then one for each mixture that two geoms can meet with.

    The flag `override` puts the same parameters in place of every contact's.
    """
    model = loaded.model
    overridden = model.opt.enableflags & loaded.mujoco.mjtEnableBit.mjENBL_OVERRIDE

    def contact(kind: str, geoms: tuple[int, int], solref: FloatArray, solimp: FloatArray) -> Constraint:
        return Constraint(
            element=" and ".join(loaded.named("geom", geom) for geom in geoms),
            kind=kind,
            solref=_solref(model.opt.o_solref if overridden else solref),
            solimp=_solimp(model.opt.o_solimp if overridden else solimp),
        )

    for pair in range(model.npair):
        geoms = (model.pair_geom1[pair], model.pair_geom2[pair])
        yield contact("contact pair", geoms, model.pair_solref[pair], model.pair_solimp[pair])
    seen: dict[tuple[float, ...], Constraint] = {}
    for geoms in _geoms_that_meet(loaded):
        mixed = contact("contact", geoms, *_mixed(model, *geoms))
        seen.setdefault((*mixed.solref, *mixed.solimp), mixed)
    yield from seen.values()


def _geoms_that_meet(loaded: _Loaded) -> Iterator[tuple[int, int]]:
    """Yield the first two geoms that can meet of each two classes: a model has many geoms and few parameters."""
    model = loaded.model
    classes: dict[tuple[float, ...], list[int]] = {}
    for geom in range(model.ngeom):
        filters = model.geom_contype[geom], model.geom_conaffinity[geom], model.geom_priority[geom]
        mixing = model.geom_solmix[geom], *model.geom_solref[geom].tolist(), *model.geom_solimp[geom].tolist()
        classes.setdefault((*filters, *mixing), []).append(geom)
    excluded = set(model.exclude_signature.tolist())
    parents = loaded.has("FILTERPARENT")
    for ones, others in combinations_with_replacement(classes.values(), 2):
        pairs = ((one, other) for one in ones for other in others if one != other)
        if _classes_meet(model, ones[0], others[0]):
            yield from islice((pair for pair in pairs if _bodies_meet(model, *pair, excluded, parents)), 1)


def _classes_meet(model: Any, one: int, other: int) -> bool:
    """Return whether MuJoCo would look for contacts of two geoms at all (its Collision filters)."""
    types, affinities = model.geom_contype, model.geom_conaffinity
    return bool(types[one] & affinities[other] or types[other] & affinities[one])


def _bodies_meet(model: Any, one: int, other: int, excluded: set[int], parents: bool) -> bool:
    """Return whether the bodies of two geoms can touch: not welded together, excluded, or parent and child."""
    bodies = sorted((int(model.geom_bodyid[one]), int(model.geom_bodyid[other])))
    welded = [int(model.body_weldid[body]) for body in bodies]
    if welded[0] == welded[1] or (bodies[0] << 16) + bodies[1] in excluded:
        return False
    above = [int(model.body_weldid[model.body_parentid[body]]) for body in welded]
    kin = 0 not in welded and (above[0] == welded[1] or above[1] == welded[0])
    return not (parents and kin)


def _mixed(model: Any, one: int, other: int) -> tuple[FloatArray, FloatArray]:
    """Return solref and solimp of a contact (MuJoCo documentation, Computation, Contact: parameters are mixed)."""
    solref, solimp = model.geom_solref, model.geom_solimp
    if model.geom_priority[one] != model.geom_priority[other]:
        chosen = one if model.geom_priority[one] > model.geom_priority[other] else other
        return solref[chosen], solimp[chosen]
    mix = model.geom_solmix[[one, other]]
    mix = np.where(mix < LEAST_SIZE, 0.0, mix)
    share = mix[0] / mix.sum() if mix.sum() > 0 else 0.5
    mixed_solimp = share * solimp[one] + (1 - share) * solimp[other]
    if solref[one, 0] > 0 and solref[other, 0] > 0:
        return share * solref[one] + (1 - share) * solref[other], mixed_solimp
    return np.minimum(solref[one], solref[other]), mixed_solimp


# Springs, dampers and drives


def _passive(loaded: _Loaded) -> Iterator[Feedback]:
    """Yield the springs and dampers of joints and tendons."""
    model = loaded.model
    joints, tendons = model.dof_jntid, range(model.ntendon)
    of_joints = joints, loaded.joints, model.jnt_stiffness[joints], model.dof_damping
    of_tendons = tendons, loaded.tendons, model.tendon_stiffness, model.tendon_damping
    for kind, columns in (("joint", of_joints), ("tendon", of_tendons)):
        for number, direction, spring, damper in zip(*columns, strict=True):
            stiffness, damping = loaded.has("SPRING") * float(spring), loaded.has("DAMPER") * float(damper)
            if stiffness or damping:
                element = loaded.named(kind, number)
                yield Feedback(element, kind, direction, stiffness, damping, euler_implicit=kind == "joint")


def _actuators(loaded: _Loaded) -> Iterator[Feedback | Motor | Unjudged]:
    """Yield the gains of actuators with an affine bias, dampings of their own, and motors."""
    mujoco, model, data = loaded.mujoco, loaded.model, loaded.data
    if not loaded.has("ACTUATION"):
        return
    directions = _rows(model, data.actuator_moment, data.moment_rownnz, data.moment_rowadr, data.moment_colind)
    of_joints = (mujoco.mjtTrn.mjTRN_JOINT, mujoco.mjtTrn.mjTRN_JOINTINPARENT)
    count = getattr(model, "nactuator", model.nu)  # later versions have actuators of several controls and outputs
    outputs = getattr(model, "actuator_outadr", np.arange(count))
    own_damping = getattr(model, "actuator_damping", np.zeros(count)) * loaded.has("DAMPER")
    for actuator in range(count):
        if model.opt.disableactuator >> max(0, int(model.actuator_group[actuator])) & 1:
            continue  # its group is switched off
        direction = directions[outputs[actuator]]
        found = _force(loaded, actuator, direction)
        if found:
            yield found
        judged = not (isinstance(found, Unjudged) and found.kind == "drive")
        if judged and own_damping[actuator]:  # added to that of its joint, if it has one
            at_joint = mujoco.mjtTrn(model.actuator_trntype[actuator]) in of_joints
            element, damping = loaded.named("actuator", actuator), float(own_damping[actuator])
            yield Feedback(element, "drive", direction, 0.0, damping, euler_implicit=at_joint)


def _force(loaded: _Loaded, actuator: int, direction: FloatArray) -> Feedback | Motor | Unjudged | None:
    """Return what an actuator does along a direction; None for a bias without gains.

    A motor has no gains of its own: whoever sets its control closes the loop.
    """
    mujoco, model = loaded.mujoco, loaded.model
    element = loaded.named("actuator", actuator)
    bias = mujoco.mjtBias(model.actuator_biastype[actuator])
    gain = mujoco.mjtGain(model.actuator_gaintype[actuator])
    affine = bias == mujoco.mjtBias.mjBIAS_AFFINE
    gain_affine = gain == mujoco.mjtGain.mjGAIN_AFFINE
    if not (affine or bias == mujoco.mjtBias.mjBIAS_NONE) or not (gain_affine or gain == mujoco.mjtGain.mjGAIN_FIXED):
        return Unjudged(element, "drive", "its force is no constant stiffness and damping")
    if gain_affine and model.actuator_gainprm[actuator, 1:3].any():
        return Unjudged(element, "drive", "its gain depends on the control")
    if affine:
        stiffness, damping = (-model.actuator_biasprm[actuator, 1:3]).tolist()
        own = Feedback(element, "drive", direction, stiffness, damping, euler_implicit=False)
        return own if stiffness or damping else None
    if mujoco.mjtDyn(model.actuator_dyntype[actuator]) != mujoco.mjtDyn.mjDYN_NONE:
        return Unjudged(element, "motor", "its activation filters what a controller sets")
    delays = getattr(model, "actuator_delay", np.zeros(actuator + 1))  # until 3.8 there were none
    return Motor(
        element=element,
        name=mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_ACTUATOR, actuator) or str(actuator),
        direction=direction,
        gain=float(model.actuator_gainprm[actuator, 0]),
        delay=float(delays[actuator]),
    )


def _flexes(loaded: _Loaded) -> Iterator[Unjudged]:
    """Yield what may act on a flex besides its equalities."""
    for flex in range(loaded.model.nflex):
        reason = "springs and contacts, if it has any, are of all its elements together"
        yield Unjudged(loaded.named("flex", flex), "flex", reason)


def _tendon_directions(model: Any, data: Any) -> FloatArray:
    """Return how the lengths of tendons change with the joints; shape (tendons, dofs), m or rad each."""
    holder = model if hasattr(model, "ten_J_rownnz") else data  # until 3.7 it was data's
    return _rows(model, data.ten_J, holder.ten_J_rownnz, holder.ten_J_rowadr, holder.ten_J_colind)


def _rows(model: Any, values: FloatArray, counts: Any, starts: Any, columns: Any) -> FloatArray:
    """Return a matrix that MuJoCo keeps by rows of entries that are not zero; shape (rows, dofs)."""
    values, columns = np.ravel(values), np.ravel(columns)
    dense = np.zeros((len(counts), model.nv))
    if values.size == dense.size and not columns.size:  # kept whole
        return values.reshape(dense.shape).copy()
    for row, start, count in zip(dense, starts, counts, strict=True):
        row[columns[start : start + count]] = values[start : start + count]
    return dense
