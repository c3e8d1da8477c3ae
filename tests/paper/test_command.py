from pathlib import Path

import pytest
from click.testing import CliRunner

from bezstab.cli import main

FIGURES = Path(__file__).parent.parent.parent / "figures"


@pytest.mark.slow
def test_the_committed_tables_and_ledger_are_those_of_a_fresh_run(tmp_path: Path) -> None:
    assert CliRunner().invoke(main, ["paper", "--figure", "none", "-o", str(tmp_path)]).exit_code == 0
    fresh = {path.name: path.read_text(encoding="utf-8") for path in tmp_path.iterdir()}
    assert set(fresh) == {"LEDGER.md", *(f"paper_table{number}.md" for number in range(1, 7))}
    for name, text in fresh.items():
        assert (FIGURES / name).read_text(encoding="utf-8") == text, name
    rows = [line for line in fresh["LEDGER.md"].splitlines() if line.startswith("| ")][2:]
    assert len(rows) > 80


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
