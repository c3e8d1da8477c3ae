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


@pytest.mark.slow
@pytest.mark.parametrize("folder", SUBJECTS)
def test_without_its_folder_a_command_is_gone_and_the_others_answer(folder: str, tmp_path: Path) -> None:
    shutil.copytree(PACKAGE, tmp_path / "bezstab", ignore=shutil.ignore_patterns("__pycache__", folder))
    for path in (tmp_path / "bezstab" / name for name in LISTS):
        path.write_text(re.sub(rf".*bezstab\.{folder}\..*\n", "", path.read_text("utf-8")), "utf-8")

    def answer(command: str) -> str:
        run = [sys.executable, "-m", "bezstab", *command.split()]
        return subprocess.run(run, cwd=tmp_path, capture_output=True, text=True, check=True).stdout

    listed = re.findall(r"^  (\w+)  ", answer("--help"), re.MULTILINE)
    assert {*SUBJECTS.values(), "region", "check"} - set(listed) == {SUBJECTS[folder]}
    assert answer("region --method B4 --figure none").startswith("B4")
    assert ": safe at rest." in answer("check --method SYM --alpha 0.5 --beta 0.1")
