from pathlib import Path

import pytest

from bezstab.paper.command import PARTS
from bezstab.paper.figures import FIGURES
from bezstab.paper.tables import TABLES
from tests.cli.running import run


def test_every_part_is_made() -> None:
    assert [*TABLES, *dict.fromkeys(name.rstrip("abc") for name in FIGURES)] == PARTS


@pytest.mark.parametrize(
    ("only", "files"),
    [
        ("--only table6 --only fig4", ["paper_fig4.png", "paper_table6.md"]),
        pytest.param("--only fig1", [f"paper_fig1{panel}.png" for panel in "abc"], marks=pytest.mark.slow),
    ],
)
def test_what_is_asked_for_is_written_and_nothing_is_printed(only: str, files: list[str], tmp_path: Path) -> None:
    result = run("paper", only, "-o", str(tmp_path))
    assert (result.exit_code, result.stdout) == (0, "")
    assert sorted(path.name for path in tmp_path.iterdir()) == files
