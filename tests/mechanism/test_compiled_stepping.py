"""Machine code: when it is made, what it is kept under, and that it serves every method of a scene."""

import importlib.util
import os
import subprocess
import sys
from pathlib import Path

import pytest

from bezstab.compiling import COMPILED_CHOICE
from bezstab.errors import InputError
from bezstab.mechanism import compiled_mechanism, load_scene, runs_compiled
from bezstab.mechanism import compiled_stepping as module
from bezstab.methods import lookup
from bezstab.units import feedback_gains
from tests.evidence.samples import of_campaign
from tests.mechanism.test_generated_code import chain
from tests.mechanism.test_stepping import H, both


@pytest.mark.slow
@pytest.mark.parametrize("name", of_campaign(["SYM", "implicit-euler"], ["SYM"]))
def test_a_chain_compiled_by_its_shapes_is_the_same(name: str) -> None:
    assert len(both(chain(12), name, 100, feedback_gains(0.3, 0.04, H)).t) == 101


def test_runs_are_compiled_where_that_pays_or_is_asked_for(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    module._kept_file.cache_clear()
    mechanism, method = compiled_mechanism(load_scene("four_bar")), lookup("AB2")
    for choice, count, expected in (
        ("auto", 10, False),
        ("auto", 10**8, True),
        ("no", 10**8, False),
        ("yes", 10, True),
    ):
        monkeypatch.setenv(COMPILED_CHOICE, choice)
        monkeypatch.setattr(module, "_compiled", set())
        assert runs_compiled(mechanism, method, count) is expected
        assert runs_compiled(mechanism, lookup("bdf2"), count) is expected
    monkeypatch.setenv(COMPILED_CHOICE, "maybe")
    with pytest.raises(InputError, match="BEZSTAB_COMPILED=maybe: expected auto, yes or no"):
        runs_compiled(mechanism, method, 10)
    module._kept_file.cache_clear()


def test_without_numba_runs_are_pythons_unless_it_is_asked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    mechanism, method = compiled_mechanism(load_scene("four_bar")), lookup("AB2")
    monkeypatch.delenv(COMPILED_CHOICE, raising=False)
    assert not runs_compiled(mechanism, method, 10**8)
    monkeypatch.setenv(COMPILED_CHOICE, "yes")
    with pytest.raises(InputError, match=r"pip install 'bezstab\[fast\]'"):
        runs_compiled(mechanism, method, 10)


A_COMPILED_RUN = """
from bezstab.mechanism import compiled_mechanism, load_scene, simulate
from bezstab.mechanism.compiled_stepping import machine_steps
from bezstab.methods import lookup
mechanism = compiled_mechanism(load_scene("pendulum"))
assert simulate(mechanism, lookup("SYM"), 1e-3, 0.1, (20.0, 100.0), compiled=True).failure is None
dispatcher, _ = machine_steps(mechanism, False, False, 1)
print(sum(dispatcher.stats.cache_hits.values()))
"""


def hits(home: Path) -> int:
    """Return how much a new process has found in a cache folder."""
    environment = os.environ | {"XDG_CACHE_HOME": str(home)}
    command = [sys.executable, "-c", A_COMPILED_RUN]
    return int(subprocess.run(command, env=environment, check=True, capture_output=True, timeout=300).stdout)


@pytest.mark.slow
def test_code_is_kept_for_the_next_process_where_only_the_user_can_write(tmp_path: Path) -> None:
    assert hits(tmp_path) == 0
    assert hits(tmp_path) == 1
    for folder in (tmp_path / "bezstab").iterdir():
        folder.chmod(0o777)
    assert hits(tmp_path) == 0


TWO_KEPT_SCENES = """
import sys
from bezstab.mechanism import compiled_mechanism, load_scene, simulate
from bezstab.methods import lookup
for scene in sys.argv[1:]:
    mechanism = compiled_mechanism(load_scene(scene))
    runs = [simulate(mechanism, lookup("SYM"), 1e-3, 0.1, (20.0, 100.0), compiled=each) for each in (False, True)]
    assert abs(runs[0].q - runs[1].q).max() < 1e-12
"""


@pytest.mark.slow
def test_scenes_kept_by_different_processes_do_not_share_their_code(tmp_path: Path) -> None:
    """Code from disk is linked by its names, and each process numbers its functions alike."""
    environment = os.environ | {"XDG_CACHE_HOME": str(tmp_path)}
    for scenes in (["pendulum"], ["driven_four_bar"], ["pendulum", "driven_four_bar"]):
        command = [sys.executable, "-c", TWO_KEPT_SCENES, *scenes]
        subprocess.run(command, env=environment, check=True, capture_output=True, timeout=300)


def test_a_further_method_on_a_compiled_scene_compiles_nothing() -> None:
    mechanism = compiled_mechanism(load_scene("pendulum"))
    for name in ("B2", "dopri5"):
        both(mechanism, name, 20, (20.0, 100.0))
    steps, _ = module.machine_steps(mechanism, False, False, 1)
    assert len(steps.signatures) == 1  # type: ignore[attr-defined]
