"""A MuJoCo model as MuJoCo reads it, MJCF or URDF, made ready for exact steps.

It opens the file, the files that this includes, and the meshes, textures and height fields named there; plugins only if
MuJoCo has them registered already.
"""

import types
from collections.abc import Iterator
from contextlib import contextmanager
from copy import copy
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from bezstab.errors import InputError

LEAST_VERSION = (3, 7)
"""Before it connect and weld lacked the term of turning normals, dJ/dt v: a moving mechanism was another system.

Up to 3.8.0 the implicit integrators still move free bodies by the midpoint rule; 3.8.1, 3.10, 3.11 and 4.0 do not.
"""

ARENAS = (2**28, 2**30)
"""Bytes: MuJoCo's memory for contacts and constraints is enlarged to these, in turn, where the model's own is full."""


@dataclass(frozen=True, eq=False)
class Loaded:
    """A model, an own copy; `left_out` says what could not be read, and so is not judged."""

    mujoco: Any
    model: Any
    name: str
    left_out: str = ""


def mujoco_module() -> types.ModuleType:
    """Return MuJoCo; InputError where it is missing or older than 3.7."""
    try:
        import mujoco
    except ImportError:
        raise InputError("lint needs an optional package: pip install 'bezstab[mujoco]'") from None
    version = tuple(int(part) for part in mujoco.__version__.split(".")[:2])
    if version < LEAST_VERSION:
        raise InputError(
            f"lint needs mujoco 3.7 or later, found {mujoco.__version__}: earlier versions leave out the rotation of "
            "normals in connect and weld"
        )
    module: types.ModuleType = mujoco
    return module


def loaded_model(source: Any) -> Loaded:
    """Return the model of a file's path, or an mjModel; InputError, in one line, for what MuJoCo refuses."""
    mujoco = mujoco_module()
    if isinstance(source, mujoco.MjModel):
        return _checked(Loaded(mujoco, copy(source), "the model"))
    path = Path(source)
    try:
        with path.open("rb"):  # for the system's own words on why not
            pass
        with silent(mujoco):
            return _checked(_read(mujoco, path))
    except OSError as error:
        raise InputError(f"MuJoCo model {path}: {error.strerror}") from None
    except (ValueError, RuntimeError, mujoco.FatalError) as error:  # RuntimeError: what its decoders raise
        raise InputError(" ".join(f"MuJoCo model {path}: {error}".split())) from None


@contextmanager
def silent(mujoco: types.ModuleType) -> Iterator[None]:
    """Keep MuJoCo from printing its warnings, and from writing them into a file of the current directory.

    Afterwards the filter of contacts, which leaves out pairs meanwhile, is the caller's own again.
    """
    own_filter = mujoco.get_mjcb_contactfilter()
    mujoco.set_mju_user_warning(lambda _: None)
    try:
        yield
    finally:
        mujoco.set_mju_user_warning(None)
        mujoco.set_mjcb_contactfilter(own_filter)


def _read(mujoco: Any, path: Path) -> Loaded:
    """Return the model of a file, with as much memory as it needs; meshes of ROS packages are left out."""
    spec = mujoco.MjSpec.from_file(str(path))
    meshes = [mesh for mesh in spec.meshes if mesh.file.startswith("package://")]
    names = {mesh.name for mesh in meshes}
    for geom in [geom for geom in spec.geoms if geom.meshname in names]:
        spec.delete(geom)
    for mesh in meshes:
        spec.delete(mesh)
    if massless := [body.name for body in spec.bodies if body.joints and not body.geoms and not body.explicitinertial]:
        raise ValueError(f"no mass and no inertia: {', '.join(massless)}")
    model = spec.compile()
    for arena in ARENAS:
        if not _memory_is_full(mujoco, model):
            break
        spec.memory = arena
        model = spec.compile()
    return Loaded(mujoco, model, path.name, "contacts not judged: meshes left out" if meshes else "")


def _memory_is_full(mujoco: Any, model: Any) -> bool:
    """Return whether contacts or constraints at qpos0 or a keyframe do not find room."""
    data = mujoco.MjData(model)
    for key in range(-1, model.nkey):
        mujoco.mj_resetData(model, data)
        if key >= 0:
            mujoco.mj_resetDataKeyframe(model, data, key)
        mujoco.mj_fwdPosition(model, data)
        if any(data.warning[each].number for each in full_warnings(mujoco)):
            return True
    return False


def full_warnings(mujoco: Any) -> tuple[int, int]:
    """Return the numbers of MuJoCo's warnings that its memory is full."""
    return mujoco.mjtWarning.mjWARN_CONTACTFULL, mujoco.mjtWarning.mjWARN_CNSTRFULL


def _checked(loaded: Loaded) -> Loaded:
    """Return a model ready for exact steps: its solver converges, nothing resets it, nobody sleeps, no sensor is read.

    ValueError for a time step that is none, InputError for memory that is too little.
    """
    mujoco, model = loaded.mujoco, loaded.model
    if not 0 < model.opt.timestep < float("inf"):
        raise InputError(f"timestep = {model.opt.timestep:g}: expected a positive number")
    if _memory_is_full(mujoco, model):
        raise InputError('too little memory for contacts and constraints: raise it, <size memory="1G"/>')
    model.opt.solver = mujoco.mjtSolver.mjSOL_NEWTON
    model.opt.iterations, model.opt.ls_iterations, model.opt.tolerance = 100, 50, 1e-12
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_AUTORESET | mujoco.mjtDisableBit.mjDSBL_SENSOR
    if hasattr(mujoco.mjtEnableBit, "mjENBL_SLEEP"):
        model.opt.enableflags &= ~int(mujoco.mjtEnableBit.mjENBL_SLEEP)
    return loaded
