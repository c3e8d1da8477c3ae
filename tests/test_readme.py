import importlib
import re
import shlex
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner

from bezstab.cli import main
from bezstab.methods import read_method

ROOT = Path(__file__).parent.parent
README = (ROOT / "README.md").read_text(encoding="utf-8")
LAYOUT = (ROOT / "bezstab" / "README.md").read_text(encoding="utf-8")
SESSIONS = re.findall(r"```console\n(.*?)```", README, re.DOTALL)
INLINE = sorted(
    set(
        re.findall(
            r"`bezstab ((?:poles|region|methods|simulate|verify|paper|choose|check\s|engines|tradeoff)[^`|…]*)`", README
        )
    )
)
ON_A_PIPE = {"COLUMNS": None}
"""Environment in which nothing says how wide a line may be."""

LONG = (
    "paper",
    "tradeoff",
    "region --quality",
    "verify --map",
    "verify --witness",
    "choose --method B4 --method AB4 --method SYM",
)
"""Beginnings of commands that take more than a few seconds; `make test-slow` runs these."""


def by_length(texts: list[str], command_of: Callable[[str], str]) -> list[Any]:
    """Return the texts as parameters, those of long commands marked as slow."""
    slow = pytest.mark.slow
    return [pytest.param(text, marks=[slow] if command_of(text).startswith(LONG) else []) for text in texts]


def prompted(session: str) -> str:
    """Return the command that a session begins with."""
    return session.partition("\n")[0].removeprefix("$ bezstab ")


@pytest.mark.parametrize("session", by_length(SESSIONS, prompted))
def test_a_session_prints_what_the_readme_shows(session: str) -> None:
    command, shown = prompted(session), session.partition("\n")[2]
    result = CliRunner(env=ON_A_PIPE).invoke(main, shlex.split(command))
    assert result.exit_code == ("check" in command and "diverges" in shown)  # 1 for an unsafe choice
    assert result.stdout.strip() == shown.strip()


@pytest.mark.parametrize("command", by_length(INLINE, str))
def test_a_command_in_the_text_runs(command: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    result = CliRunner().invoke(main, shlex.split(command))
    assert result.exit_code == 0, result.stderr


def test_there_is_something_to_check() -> None:
    assert SESSIONS
    assert INLINE


def test_the_samples_in_the_readme_are_methods(tmp_path: Path) -> None:
    samples = re.findall(r"```toml\n(.*?)```", README, re.DOTALL)
    shipped = [read_method(path).scheme for path in (ROOT / "configs" / "methods").glob("*.toml")]
    assert len(samples) == 2
    for sample in samples:
        (path := tmp_path / "sample.toml").write_text(sample, encoding="utf-8")
        assert read_method(path).scheme in shipped


@pytest.mark.parametrize("path", sorted((ROOT / "configs" / "methods").glob("*.toml")), ids=lambda path: path.name)
def test_every_shipped_method_is_accepted(path: Path) -> None:
    assert read_method(path).name == tomllib.loads(path.read_text(encoding="utf-8"))["name"]


def test_every_picture_and_link_is_there() -> None:
    for target in re.findall(r"\]\(([^)#]+)\)", README):
        assert (ROOT / target).exists(), target


@pytest.mark.parametrize("room", ["methods", "stability", "mechanism", "evidence", "show", "cli", "paper"])
def test_the_layout_says_of_each_file_what_the_door_of_its_room_says(room: str) -> None:
    door = importlib.import_module(f"bezstab.{room}").__doc__ or ""
    listed = [line.strip() for line in door.split("above it")[1].splitlines() if line.startswith("    ")]
    section = LAYOUT[LAYOUT.index(f"### {room}/") :].partition("\n#")[0]
    shown = [line for line in section.splitlines() if line.startswith("| `")]
    assert shown == ["| `{}` | {} |".format(*re.split(r"\s+", line, maxsplit=1)) for line in listed]
