from pathlib import Path

from click.testing import CliRunner

from bezstab.cli import main
from bezstab.paper.printed import PARTS
from bezstab.paper.report import REPORTS

FIGURES = Path(__file__).parent.parent.parent / "figures"


def test_every_part_is_made_by_one_report() -> None:
    assert sorted(part for parts in REPORTS for part in parts) == sorted(PARTS)


def test_a_report_makes_the_parts_it_promises_and_keeps_times_out_of_its_tables() -> None:
    made = REPORTS["table6",](lambda runs, _: runs)
    assert list(made.tables) == ["table6"]
    assert "time" in made.aside
    assert "time" not in made.tables["table6"]
    seen = []
    influenced = REPORTS["table4", "fig7", "fig8"](lambda runs, length: (seen.append(length), runs)[1])  # type: ignore[func-returns-value]
    assert {*influenced.tables, *influenced.figures} == {"table4", "fig7", "fig8"}
    assert seen == [6]
    assert influenced.findings


def test_the_committed_tables_and_ledger_are_those_of_a_fresh_run(tmp_path: Path) -> None:
    assert CliRunner().invoke(main, ["paper", "--figure", "none", "-o", str(tmp_path)]).exit_code == 0
    fresh = {path.name: path.read_text(encoding="utf-8") for path in tmp_path.iterdir()}
    assert set(fresh) == {"LEDGER.md", *(f"paper_table{number}.md" for number in range(1, 7))}
    for name, text in fresh.items():
        assert (FIGURES / name).read_text(encoding="utf-8") == text, name
    rows = [line for line in fresh["LEDGER.md"].splitlines() if line.startswith("| ")][2:]
    assert len(rows) > 40
