"""All engines by name, and which of them a run has witnessed.

An engine is listed if its formula has a source or is derived from one; what is not known is not printed.
"""

from bezstab.engines.acceleration_engines import (
    CHRONO_EXPLICIT,
    CROCODDYL,
    DRAKE,
    MAPLESIM,
    MUJOCO,
    PINOCCHIO,
    RBDL,
    RIGID_BODY_DYNAMICS,
)
from bezstab.engines.implicit_engines import BRAX_SPRING, JOLT_SPRING, PHYSX_DRIVE, XPBD
from bezstab.engines.position_engines import BRAX_POSITIONAL, JOLT, PBD
from bezstab.engines.velocity_engines import (
    BOX2D,
    BRAX_CONTACT,
    BULLET,
    CHIPMUNK,
    CHRONO_LINEARIZED,
    DART,
    DRAKE_SAP,
    ODE,
    RAPIER,
)

ENGINES = {
    engine.name: engine
    for engine in (
        MUJOCO,
        CROCODDYL,
        PINOCCHIO,
        RBDL,
        RIGID_BODY_DYNAMICS,
        MAPLESIM,
        DRAKE,
        CHRONO_EXPLICIT,
        BRAX_SPRING,
        BULLET,
        ODE,
        DART,
        BOX2D,
        RAPIER,
        CHIPMUNK,
        CHRONO_LINEARIZED,
        DRAKE_SAP,
        BRAX_CONTACT,
        JOLT_SPRING,
        PHYSX_DRIVE,
        JOLT,
        PBD,
        XPBD,
        BRAX_POSITIONAL,
    )
}
"""Every engine by name."""

WITNESSES = {
    "mujoco": "tests/evidence/test_mujoco_witness.py::test_mujoco_settles_and_diverges_where_the_map_says",
    "bullet": "tests/witnesses/test_pybullet.py::test_bullets_pole_is_that_of_its_erp",
    "chipmunk": "tests/witnesses/test_pymunk.py::test_chipmunks_pole_is_that_of_its_error_bias",
}
"""The test that runs an engine itself and holds its row against that, by the engine's name; add a line for each."""


def witness_of(name: str) -> str | None:
    """Return the test that runs the engine itself, None where its row rests on its source alone."""
    return WITNESSES.get(name)
