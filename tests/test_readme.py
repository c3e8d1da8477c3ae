import re
import shutil
from pathlib import Path
from typing import Any

import click
import numpy as np
import pytest

from bezstab.cli.command_group import main
from bezstab.methods.registry import lookup
from bezstab.stability.closed_loop import poles
from tests.cli.running import DATA, run
from tests.imports import PACKAGE
from tests.reference.sampled_responses import of_poles

ROOT = Path(__file__).parent.parent
FOLDERS = ("", "bezstab", "bezstab/*", "configs/*", "tests")
READMES = sorted(path for folder in FOLDERS for path in ROOT.glob(f"{folder}/README.md".lstrip("/")))
PAGES = [*(path.relative_to(ROOT).as_posix() for path in READMES), "tests/cli/sentences.md"]
"""The pages whose commands are run."""

UNSAFE = ("check", "chain", "choose", "drive", "lint", "steps")
"""Commands whose exit status is 1 where what they judge is unsafe."""
PLACEHOLDER = re.compile(r"\b(COMMAND|LOG|MODEL|NAME|PATH|FILE)\b")
"""Words that stand for something else: what holds one is no command to type."""


def sessions(page: str) -> list[str]:
    """Return the console sessions of a page: a command after a prompt, and what it prints."""
    return re.findall(r"```console\n(.*?)```", (ROOT / page).read_text(encoding="utf-8"), re.DOTALL)


def commands(page: str) -> list[str]:
    """Return the commands in the text of a page and in its indented lines, without comments; a name alone is none."""
    text = re.sub(r"```.*?```", "", (ROOT / page).read_text(encoding="utf-8"), flags=re.DOTALL)
    inline = re.findall(r"`bezstab ([^`|…]*)`", text)
    indented = re.findall(r"^    bezstab ([^#\n]*)", text, re.MULTILINE)
    return [found.strip() for found in (*inline, *indented) if " " in found.strip() and not PLACEHOLDER.search(found)]


def prompted(session: str) -> str:
    """Return the command that a session begins with."""
    return session.partition("\n")[0].removeprefix("$ bezstab ")


QUICK = ("check --method SYM", "check --engine bullet", "choose --method SYM", "methods own", "poles", "lint")
SESSIONS = [session for page in PAGES for session in sessions(page)]
INLINE = sorted({command for page in PAGES for command in commands(page)} - {"paper -o figures"})  # tests/paper


def all_but_a_few_slow(commands: list[str]) -> list[Any]:
    """Return each command as a case of a test, slow unless it begins as one of the quick ones."""
    return [
        pytest.param(each, marks=() if prompted(each).startswith(QUICK) else pytest.mark.slow, id=prompted(each))
        for each in commands
    ]


@pytest.fixture
def _with_the_files_of_the_pages(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Work in a directory with files called as on the pages."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("COLUMNS", raising=False)  # as on a pipe
    response = of_poles(poles(lookup("B4"), 0.5, 0.1), 300, seed=2)  # at the point that the page asks about
    np.savetxt("log.csv", response, "%.9g", header="c", comments="")
    (logging,) = re.findall(r"```python\n(.*?)```", (ROOT / "bezstab/probes/README.md").read_text("utf-8"), re.DOTALL)
    exec(logging, {})  # writes the logs of that page
    shutil.copy(DATA / "two_joints.xml", "robot.xml")
    Path("run.csv").write_text("time,shoulder,elbow\n0,0,0\n0.1,0.2,0.3\n", encoding="utf-8")
    shutil.copy(DATA / "arm.urdf", "robot.urdf")
    shutil.copy(DATA / "legs.xml", "legs.xml")


@pytest.mark.usefixtures("_with_the_files_of_the_pages")
@pytest.mark.parametrize("session", all_but_a_few_slow(SESSIONS))
def test_a_session_prints_what_the_page_shows(session: str) -> None:
    """Three dots stand for whatever is printed there."""
    command, shown = prompted(session), session.partition("\n")[2]
    result = run(command)
    given = shown.partition("What `choose` gives instead:")[0]
    assert result.exit_code == bool(command.startswith(UNSAFE) and re.search("[nN]ot safe|diverges|: refuted", given))
    pieces = map(re.escape, shown.strip().split("…"))
    assert re.fullmatch("(?s:.*)".join(pieces), result.stdout.strip()), result.stdout


@pytest.mark.usefixtures("_with_the_files_of_the_pages")
@pytest.mark.parametrize("command", all_but_a_few_slow(INLINE))
def test_a_command_in_the_text_runs(command: str) -> None:
    if "own.toml" in command:
        shutil.copy(own_file(command), "own.toml")
    result = run(command.replace("--points 300", "--points 40"))
    may_end = (0, 1) if command.startswith(UNSAFE) else (0, 3) if command.startswith("probe") else (0,)
    assert result.exit_code in may_end, result.stderr  # 3: of another method's log nothing fits


def own_file(command: str) -> Path:
    """Return a shipped file of the kind that a command names own.toml: a scene, or a method."""
    return ROOT / "configs" / ("scenes/pendulum.toml" if "--scene own.toml" in command else "methods/ebdf2.toml")


@pytest.mark.parametrize("page", PAGES)
def test_every_picture_and_link_is_there(page: str) -> None:
    for target in re.findall(r"\]\(([^)#]+)\)", (ROOT / page).read_text(encoding="utf-8")):
        if not target.startswith("https://"):
            assert ((ROOT / page).parent / target).exists(), target


def test_every_kind_of_figure_is_shown_or_named_on_a_page() -> None:
    """The docstring of what returns a Figure says where: "On a page: figures/region_SYM.png"."""
    told = "".join((ROOT / page).read_text(encoding="utf-8") for page in PAGES if not page.startswith("tests"))
    for path in {*PACKAGE.glob("*/*.py")} - {PACKAGE / "show/style.py"}:
        for function in path.read_text(encoding="utf-8").split("\n\n\n"):
            head, _, body = function.partition("-> Figure:\n")
            where = re.search("On a page: (.*)", body)
            assert not body or (where and where[1] in told), f"{path}: {head}"


def test_the_readme_names_every_command() -> None:
    named = re.findall(r"`(?:bezstab )?(\w+)", (ROOT / "README.md").read_text(encoding="utf-8"))
    assert set(main.list_commands(click.Context(main))) <= set(named)


def test_every_promise_names_a_test_that_is_there() -> None:
    promises = (ROOT / "tests/README.md").read_text("utf-8").partition("## What is promised")[2]
    for file, name in re.findall(r"`([a-z_/]+\.py)(?:::(\w+))?`", promises):
        assert f"def {name}" in (ROOT / "tests" / file).read_text("utf-8"), f"{file}::{name}"
