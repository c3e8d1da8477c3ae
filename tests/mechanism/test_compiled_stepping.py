"""Machine code: when it is made, what it is kept under, and that it serves every method of a scene."""

import importlib.util
import os
import subprocess
import sys
from pathlib import Path

import pytest

from bezstab.compiling import COMPILED_CHOICE
from bezstab.errors import InputError
from bezstab.mechanism import compiled_stepping as module
from bezstab.mechanism.compiled_stepping import runs_compiled
from bezstab.methods.registry import lookup
from bezstab.stabilising import after_step


def test_runs_are_compiled_where_that_pays_or_is_asked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    for choice, expected in (("auto", [False, True]), ("no", [False, False]), ("yes", [True, True])):
        monkeypatch.setenv(COMPILED_CHOICE, choice)
        assert [runs_compiled(lookup("SYM"), count) for count in (10, 10**8)] == expected
        assert not runs_compiled(lookup("bdf2"), 10**8)
        assert not runs_compiled(lookup("SYM"), 10**8, after=after_step("projection"))
    monkeypatch.setenv(COMPILED_CHOICE, "maybe")
    with pytest.raises(InputError, match="BEZSTAB_COMPILED=maybe: expected auto, yes or no"):
        runs_compiled(lookup("SYM"), 10)
    monkeypatch.setenv(COMPILED_CHOICE, "auto")
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    assert not runs_compiled(lookup("SYM"), 10**8)


KEPT_SCENES = """
import sys
from bezstab.mechanism.equations import compiled_mechanism
from bezstab.mechanism.runner import simulate
from bezstab.mechanism.scene_files import load_scene
from bezstab.mechanism.compiled_stepping import machine_steps
from bezstab.methods.registry import lookup
hits = 0
for scene in sys.argv[1:]:
    mechanism = compiled_mechanism(load_scene(scene))
    runs = [simulate(mechanism, lookup("SYM"), 1e-3, 0.1, (20.0, 100.0), compiled=each) for each in (False, True)]
    assert abs(runs[0].q - runs[1].q).max() < 1e-12
    hits += sum(machine_steps(mechanism, 1).stats.cache_hits.values())
print(hits)
"""


@pytest.mark.slow
def test_code_is_kept_for_the_next_process_and_scenes_do_not_share_theirs(tmp_path: Path) -> None:
    """Code from disk is linked by its names, and each process numbers its functions alike."""
    environment = os.environ | {"XDG_CACHE_HOME": str(tmp_path)}
    for scenes, hits in ((["pendulum"], 0), (["driven_four_bar"], 0), (["pendulum", "driven_four_bar"], 2)):
        command = [sys.executable, "-c", KEPT_SCENES, *scenes]
        found = subprocess.run(command, env=environment, check=True, capture_output=True, timeout=300).stdout
        assert int(found) == hits


def test_code_is_kept_only_where_nobody_but_the_user_can_write(tmp_path: Path) -> None:
    file = tmp_path / "kept" / "steps.py"
    assert module._keep(file)
    file.parent.chmod(0o777)
    assert not module._keep(file)
