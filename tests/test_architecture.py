r"""The house: floors and walls.

Floors: a room imports only from rooms below, a file only from those above it in its room's own list. Walls: nobody
enters `paper`; stability and mechanism do not know each other; only appointed files see a library. Where nothing
prints, exits, filters warnings or executes text, ruff says (pyproject.toml); mypy, that each name is imported from the
module that defines it.

    paper                  an extension: the main group finds its command by name
      |
    subjects               a folder for each: catalogue, chains, drives, step_sequences, probes, mujoco
      |
    regions, runs, api     regions and methods; runs of mechanisms, and whether predictions hold; the rest in Python
      |         |
    cli         |          what they type on the command line
      |         |
    show -------+          what they see
      |         |
    questions --+          what they ask, and the answers: where stability and mechanism meet
      |      \
    stability  mechanism
      |      /
    motion   |             what the feedback does to a motion
      |      |
    methods                schemes as exact data
      |
    engines                what others call the feedback
      |
    errors, rationals, files, toml_tables, units, stopping, compiling, read_only, goals, stabilising,
    linear_equations, matrices, words, arguments
"""

import subprocess
import sys
import tomllib
from graphlib import TopologicalSorter
from pathlib import Path

from tests.imports import PACKAGE, ROOMS, SUBJECTS, imports, own_imports

FOUNDATIONS = (
    *("stopping", "errors", "rationals", "files", "toml_tables", "units", "compiling", "read_only", "goals"),
    *("stabilising", "linear_equations", "matrices", "words", "arguments"),
)
"""Beside the rooms, each importing only from those before it."""

STRANGERS = {
    "methods": {"engines"},
    "mechanism": {"engines", "motion", "stability"},
    "paper": {"engines"},
    "api": {"show", "cli", "paper"},
}
"""The rooms before a room that it does not import from all the same."""

APPOINTED = {
    "sympy": {
        *("methods/added_damping.py", "methods/determinants.py", "methods/derivation.py", "methods/formulas.py"),
        *("methods/step_matrices.py", "step_sequences/positive_polynomials.py"),
        *("methods/recipes.py", "methods/steady_errors.py", "methods/rotation_torque.py"),
        "stability/quadrant_proofs.py",
        *("mechanism/equations.py", "mechanism/generated_code.py", "mechanism/start.py", "mechanism/observation.py"),
    },
    "matplotlib": {
        *("show/style.py", "show/plot.py", "regions/figure.py", "runs/figures.py"),
        *("show/window.py", "paper/figures.py"),
        *(f"{subject}/figure.py" for subject in SUBJECTS),
    },
    "click": {
        path.relative_to(PACKAGE).as_posix()
        for path in (*(PACKAGE / "cli").glob("*.py"), *PACKAGE.glob("*/*command.py"), PACKAGE / "runs" / "options.py")
    },
    "mujoco": {"mujoco/reading.py"},
    "distributed": {"runs/parallel.py"},
    "joblib": {"runs/parallel.py"},
    "numba": {"compiling.py"},
    "mpmath": {"stability/forced_errors.py"},
}
"""The files that may import a library when they run; for types anybody may."""

FILES = sorted(path.relative_to(PACKAGE) for path in PACKAGE.rglob("*.py"))
IN_ROOMS = [path for path in FILES if len(path.parts) == 2 and path.name != "__init__.py"]


def test_a_room_imports_only_from_rooms_below() -> None:
    order = [*FOUNDATIONS, *ROOMS, "api"]
    for path in [*(Path(f"{name}.py") for name in FOUNDATIONS), *IN_ROOMS, Path("api.py")]:
        room = path.parts[0].removesuffix(".py")
        others = {module.split(".")[0] for module, _ in own_imports(path)} - {room, "__version__"}
        assert others <= set(order[: order.index(room)]) - STRANGERS.get(room, set()), path


def test_files_of_a_room_import_each_other_in_no_circle() -> None:
    for room in ROOMS:
        imported = {path.stem: _siblings(path, room) for path in IN_ROOMS if path.parts[0] == room}
        TopologicalSorter(imported).prepare()  # CycleError


def _siblings(path: Path, room: str) -> set[str]:
    """Return the names of the files of its room that a file imports, for types too."""
    return {
        name
        for module, names in own_imports(path)
        if module.split(".")[0] == room
        for name in ([module.rpartition(".")[2]] if "." in module else names)
    }


def test_only_the_appointed_files_see_a_library() -> None:
    for path in FILES:
        imported = {module.split(".")[0] for module, _ in imports(path, with_types=False)}
        for library in imported - set(sys.stdlib_module_names) - {"bezstab", "numpy"}:
            assert path.as_posix() in APPOINTED.get(library, ()), f"{path}: {library}"


def test_every_room_is_installed() -> None:
    project = tomllib.loads((PACKAGE.parent / "pyproject.toml").read_text(encoding="utf-8"))
    packages = project["tool"]["setuptools"]["packages"]
    assert set(packages) == {"bezstab", "bezstab.scenes", *(f"bezstab.{room}" for room in ROOMS)}


def test_import_and_help_are_light() -> None:
    for code in ["import bezstab", "from bezstab.cli.command_group import main; main(['--help'])"]:
        heavy = "{'numpy', 'sympy', 'matplotlib', 'mujoco', 'distributed'}"
        probe = f"import atexit, sys; atexit.register(lambda: print('heavy:', {heavy} & set(sys.modules)))\n"
        run = subprocess.run([sys.executable, "-c", probe + code], capture_output=True, text=True, check=True)
        assert run.stdout.rstrip().endswith("heavy: set()"), code
