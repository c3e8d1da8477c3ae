import compileall
import importlib
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import bezstab
from bezstab.lazy import lazy_names

load = lazy_names("bezstab.methods")


def test_a_name_is_that_of_the_module_that_defines_it() -> None:
    from bezstab.methods.orders import accuracy

    assert load("accuracy") is accuracy


def test_any_other_name_is_an_attribute_error_that_names_both() -> None:
    with pytest.raises(AttributeError, match=r"module 'bezstab\.methods' has no attribute 'rational'"):
        load("rational")


def without_sources(package: Path) -> None:
    """Leave a package compiled only, as `python -m compileall -b` and some installers do."""
    assert compileall.compile_dir(package, quiet=1, legacy=True)
    for file in package.rglob("*.py"):
        file.unlink()


def test_names_are_found_where_there_is_no_source(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (package := tmp_path / "compiled_only").mkdir()
    (package / "__init__.py").write_text(
        "from bezstab.lazy import lazy_names\nTYPE_CHECKING = False\nif TYPE_CHECKING:\n"
        "    from compiled_only import other\n    from compiled_only.part import one, two\n"
        "__getattr__ = lazy_names(__name__)\n",
        encoding="utf-8",
    )
    (package / "part.py").write_text("one, two = 1, 2", encoding="utf-8")
    (package / "other.py").write_text("three = 3", encoding="utf-8")
    without_sources(package)
    monkeypatch.syspath_prepend(tmp_path)
    found = importlib.import_module("compiled_only")
    assert (found.two, found.one, found.other.three) == (2, 1, 3)


@pytest.mark.slow
def test_the_whole_package_answers_without_sources(tmp_path: Path) -> None:
    source = Path(bezstab.__file__).parent
    package = shutil.copytree(source, tmp_path / "bezstab", ignore=shutil.ignore_patterns("__pycache__"))
    without_sources(package)
    asked = "import bezstab; print(bezstab.__file__, bezstab.verdict('SYM', alpha_hat=1, beta_hat=1))"
    done = subprocess.run([sys.executable, "-c", asked], cwd=tmp_path, capture_output=True, text=True, check=True)
    assert done.stdout.split() == [str(package / "__init__.pyc"), "converges"]
    listed = subprocess.run(
        [sys.executable, "-m", "bezstab", "methods", "--format", "csv"], cwd=tmp_path, capture_output=True, check=True
    )
    assert b"AB4" in listed.stdout
