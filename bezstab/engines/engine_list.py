"""All engines by name, and which of them a run has witnessed.

An engine is listed if its formula has a source or is derived from one; what is not known is not printed.
"""

from fractions import Fraction

from bezstab.engines import acceleration_engines, position_engines, velocity_engines
from bezstab.engines.conversions import Engine
from bezstab.errors import InputError, unknown_name
from bezstab.rationals import rational

ENGINES = {
    engine.name: engine
    for level in (acceleration_engines, velocity_engines, position_engines)
    for engine in vars(level).values()
    if isinstance(engine, Engine)
}
"""Every engine by name, in the order of the files that they stand in."""

ENGINE_ALIASES = {
    "bepuphysics2": "bepu",
    "cannon": "cannon-es",
    "matter-js": "matter.js",
    "p2-es": "p2",
    "pybullet": "bullet",
    "pymunk": "chipmunk",
}
"""Engines that are one of the list under another name."""

RUN_UNDERNEATH = {
    "avian": "its joints are XPBD: ask about xpbd, or about pbd=1 where the compliance is 0; h is the substep's",
    "newton": "it has several solvers: ask about kamino, mujoco (MuJoCo Warp), newton-semi-implicit or xpbd",
    "raisim": "its source is closed and its manual has no formula for erp and erp2, so what they do is not known here; "
    "ask about the PD gains of its joints with bezstab drive",
    "unity": "it runs PhysX in 3D and Box2D in 2D: ask about physx or physx-tgs (joints), about "
    "physx-drive (a drive of its joints and articulations), about box2d-v2, or about box2d (that of version 3)",
    "warp": "its simulators are Newton's now: ask about newton-semi-implicit or xpbd",
}
"""What others that are asked for run underneath, by their names."""

WITNESSES = {
    "mujoco": "tests/runs/test_mujoco_maps.py::test_an_equality_is_the_point_of_its_solref",
    "bullet": "tests/witnesses/test_sweeping_engines.py::test_one_joint_has_the_pole_of_its_row",
    "chipmunk": "tests/witnesses/test_sweeping_engines.py::test_one_joint_has_the_pole_of_its_row",
    "box2d-v2": "tests/witnesses/test_sweeping_engines.py::test_errors_of_a_chain_grow_or_shrink_as_predicted",
    "cannon-es": "tests/witnesses/test_javascript_engines.py::test_an_engine_grows_as_its_row_says",
    "matter.js": "tests/witnesses/test_javascript_engines.py::test_an_engine_grows_as_its_row_says",
    "p2": "tests/witnesses/test_javascript_engines.py::test_an_engine_grows_as_its_row_says",
}
"""The test that runs an engine itself and holds its row against that, by the engine's name; add a line for each.

The rows of others rest on their sources alone.
"""


def engine_named(name: str) -> Engine:
    """Return the engine of that name; InputError for another, with what it runs underneath or the nearest name."""
    name = ENGINE_ALIASES.get(name.lower(), name)
    if name in ENGINES:
        return ENGINES[name]
    if name.lower() in RUN_UNDERNEATH:
        raise InputError(f"{name}: {RUN_UNDERNEATH[name.lower()]}")
    raise unknown_name("engine", name, ENGINES, file="")


def engine_and_values(text: str) -> tuple[Engine, tuple[Fraction, ...]]:
    """Return an engine and values of its parameters, from text such as mujoco=0.02,1, without values its defaults.

    InputError as `engine_named`, and for values that are missing where the engine has no defaults.
    """
    name, _, numbers = text.partition("=")
    engine = engine_named(name)
    numbers = numbers or engine.defaults
    if not numbers and not engine.parameters:  # it has none, or none that it needs
        return engine, ()
    if not numbers:
        raise InputError(f"{name!r} comes without values and has no defaults: expected {name}={engine.words()}")
    try:
        return engine, tuple(rational(number) for number in numbers.split(","))
    except InputError as error:
        raise InputError(f"{error}: expected {name}={engine.words()}") from None
