from bezstab.paper import PARTS
from bezstab.report import REPORTS


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
