from bezstab.methods import evaluations, lookup
from bezstab.paper.cost import costs, findings, report
from bezstab.paper.printed import COMPARED


def test_the_four_methods_do_not_cost_the_same() -> None:
    rows = costs()
    assert [row.method for row in rows] == list(COMPARED)
    starter = 3 * (evaluations(lookup("RK4")) - 1)
    expected = {"B4": 10000 + starter, "AB4": 10000 + starter, "RK4@5": 8000, "SIE": 20000}
    assert {row.method: row.evaluations for row in rows} == expected
    assert rows[0].time_ratio == 1
    (finding,) = findings(rows)
    assert finding.agreement == "not confirmed"


def test_times_are_shown_but_kept_out_of_the_table() -> None:
    made = report(lambda runs, label, length: runs)
    assert list(made.tables) == ["table6"]
    assert "time" in made.aside
    assert "time" not in made.tables["table6"]
