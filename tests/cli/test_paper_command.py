from pathlib import Path

import pytest

from tests.cli.running import rows, run


@pytest.mark.slow
def test_paper_writes_the_chosen_parts_and_prints_findings(tmp_path: Path) -> None:
    found = rows("paper", "--only", "table5", "--only", "fig7", "--figure", "svg", "-o", "out")
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == ["paper_fig7.svg", "paper_table5.md"]
    assert {row["where"] for row in found} >= {"Table 4", "Table 5", "Fig. 9e"}
    assert set(found[0]) == {"where", "claim", "paper", "here", "agreement"}
    table = (tmp_path / "out" / "paper_table5.md").read_text(encoding="utf-8").splitlines()
    assert len([line for line in table if line.startswith("|")]) == 2 + 12
    assert r"\|z_p\|" in table[2]  # a bare bar would end the cell
    timed = run("paper", "--only", "table6")
    assert "processor time" in timed.stdout
    assert "\n\nNot confirmed.\n\nwhere " in timed.stdout
