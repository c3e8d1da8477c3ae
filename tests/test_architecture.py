import ast
import subprocess
import sys
from pathlib import Path

import pytest

PACKAGE = Path(__file__).parent.parent / "bezstab"
MODULES = sorted(path.stem for path in PACKAGE.glob("*.py") if path.stem not in ("__init__", "__main__"))
FLOORS = {
    **dict.fromkeys(("errors",), 0),
    **dict.fromkeys(("files", "schur", "paper"), 1),
    **dict.fromkeys(("methods", "baumgarte", "scene", "chunks"), 2),
    **dict.fromkeys(("derivation", "mechanism"), 3),
    **dict.fromkeys(("formulas", "poles", "simulate"), 4),
    **dict.fromkeys(("region", "experiments"), 5),
    **dict.fromkeys(("optimum", "verify", "witness"), 6),
    **dict.fromkeys(("choose", "family", "claims"), 7),
    **dict.fromkeys(("tradeoff", "extremes"), 8),
    **dict.fromkeys(("tables", "figures"), 9),
    **dict.fromkeys(("report", "explore"), 10),
    "cli": 11,
}
ONLY_IN = {
    "sympy": {"derivation", "formulas", "mechanism"},
    "matplotlib": {"figures", "explore"},
    "click": {"cli"},
    "mujoco": {"witness"},
    "distributed": {"chunks"},
    "mpmath": {"extremes"},
}
ALLOWED_FOR_TYPES = {
    ("cli", "matplotlib"),
    ("report", "matplotlib"),
}  # imported under TYPE_CHECKING only, see test_help_is_light


def imports(module: str) -> set[str]:
    """Return every module that one imports, inside functions too."""
    names = set()
    for node in ast.walk(ast.parse((PACKAGE / f"{module}.py").read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            names |= (
                {f"{node.module}.{alias.name}" for alias in node.names} if node.module == "bezstab" else {node.module}
            )
    return names


def test_every_module_has_a_floor_and_a_test() -> None:
    assert set(FLOORS) == set(MODULES)
    assert {f"test_{module}.py" for module in MODULES} <= {path.name for path in Path(__file__).parent.glob("*.py")}


@pytest.mark.parametrize("module", MODULES)
def test_a_module_imports_only_from_lower_floors(module: str) -> None:
    own = {name.split(".")[1] for name in imports(module) if name.startswith("bezstab.")} & set(MODULES)
    assert all(FLOORS[other] < FLOORS[module] for other in own)


@pytest.mark.parametrize("module", MODULES)
def test_only_the_appointed_modules_see_a_library(module: str) -> None:
    for library in {name.split(".")[0] for name in imports(module)} & set(ONLY_IN):
        assert module in ONLY_IN[library] or (module, library) in ALLOWED_FOR_TYPES


@pytest.mark.parametrize("module", sorted(set(MODULES) - {"cli"}))
def test_computation_neither_prints_nor_exits_nor_filters_warnings(module: str) -> None:
    tree = ast.parse((PACKAGE / f"{module}.py").read_text(encoding="utf-8"))
    called = {ast.unparse(node.func) for node in ast.walk(tree) if isinstance(node, ast.Call)}
    assert not called & {"print", "exit", "sys.exit", "warnings.filterwarnings", "warnings.simplefilter", "np.seterr"}
    windows = {"explore"}  # pyplot is what opens one
    assert not imports(module) & ({"warnings"} if module in windows else {"warnings", "matplotlib.pyplot"})


@pytest.mark.parametrize("code", ["import bezstab", "from bezstab.cli import main; main(['--help'])"])
def test_import_and_help_are_light(code: str) -> None:
    heavy = "{'sympy', 'matplotlib', 'mujoco', 'distributed'}"
    probe = f"import atexit, sys; atexit.register(lambda: print('heavy:', {heavy} & set(sys.modules)))\n"
    run = subprocess.run([sys.executable, "-c", probe + code], capture_output=True, text=True, check=True)
    assert run.stdout.rstrip().endswith("heavy: set()")
