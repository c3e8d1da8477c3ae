from pathlib import Path

import pytest
from click.testing import CliRunner

from bezstab.cli import main

FIGURES = Path(__file__).parent.parent.parent / "figures"


@pytest.mark.slow
def test_a_figure_is_written_with_its_panels(tmp_path: Path) -> None:
    assert CliRunner().invoke(main, ["paper", "--only", "fig1", "-o", str(tmp_path)]).exit_code == 0
    assert sorted(path.name for path in tmp_path.iterdir()) == [f"paper_fig1{panel}.png" for panel in "abc"]


def test_as_text_each_claim_stands_below_the_other(tmp_path: Path) -> None:
    result = CliRunner().invoke(main, ["paper", "--only", "table1", "-o", str(tmp_path)])
    assert result.stdout.count("\nclaim ") == result.stdout.count("\nagreement ") == 10


@pytest.mark.slow
def test_one_part_alone_is_written_without_a_ledger(tmp_path: Path) -> None:
    assert CliRunner().invoke(main, ["paper", "--only", "table6", "-o", str(tmp_path)]).exit_code == 0
    (path,) = tmp_path.iterdir()
    assert path.read_text(encoding="utf-8") == (FIGURES / "paper_table6.md").read_text(encoding="utf-8")
