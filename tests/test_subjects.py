"""A question goes with its folder: without it, and its lines in two lists, everything else runs."""

import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.imports import PACKAGE, SUBJECTS

LISTS = ("__init__.py", "cli/command_group.py")
"""Files of the package that have a line for each command, or for its function in Python."""


def without(folders: set[str], root: Path) -> Path:
    """Return a copy of the package's parent without these folders and the lines in LISTS that name them."""
    shutil.copytree(PACKAGE, root / "bezstab", ignore=shutil.ignore_patterns("__pycache__", *folders))
    for path in (root / "bezstab" / name for name in LISTS):
        named = "|".join(folders)
        lines = path.read_text(encoding="utf-8").splitlines(keepends=True)
        path.write_text("".join(line for line in lines if not re.search(rf"bezstab\.({named})\.", line)), "utf-8")
    return root


def answer(root: Path, *command: str) -> str:
    """Return what a command of the copy prints."""
    run = [sys.executable, "-c", "from bezstab.__main__ import run; run()", *command]
    return subprocess.run(run, cwd=root, capture_output=True, text=True, check=True).stdout


@pytest.mark.slow
@pytest.mark.parametrize("folder", SUBJECTS)
def test_without_its_folder_a_command_is_gone_and_the_others_answer(folder: str, tmp_path: Path) -> None:
    root = without({folder}, tmp_path)
    listed = re.findall(r"^  (\w+)  ", answer(root, "--help"), re.MULTILINE)
    assert SUBJECTS[folder] not in listed
    assert {*SUBJECTS.values(), "region", "check"} - set(listed) == {SUBJECTS[folder]}
    assert answer(root, "region", "--method", "B4", "--figure", "none").startswith("B4")
    assert ": safe at rest." in answer(root, *["check", "--method", "SYM", "--alpha", "0.5", "--beta", "0.1"])
