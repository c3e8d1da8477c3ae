import pytest

from bezstab.methods import evaluations, lookup
from bezstab.paper import cost
from bezstab.paper.cost import Cost, one_step_methods_take_longer, recorded_costs, same_times
from bezstab.paper.printed import COMPARED, TABLE_6
from tests.paper.record_times import costs


@pytest.mark.slow
def test_the_four_methods_do_not_cost_the_same() -> None:
    starter = 3 * (evaluations(lookup("RK4")) - 1)
    expected = {"B4": 10000 + starter, "AB4": 10000 + starter, "RK4@5": 8000, "SIE": 20000}
    for found in (costs(repeats=1), recorded_costs()):
        assert [(row.method, row.evaluations) for row in found] == list(expected.items())


def test_equal_times_would_be_confirmed() -> None:
    assert same_times([Cost(name, 1, 0.1) for name in COMPARED]).agreement == "confirmed"


def test_other_programs_would_not_favour_the_same_methods_in_each_case(monkeypatch: pytest.MonkeyPatch) -> None:
    found = one_step_methods_take_longer()
    assert "up to 3.5%" in found.here
    assert "in 3 of 3 cases" in found.here
    monkeypatch.setattr(cost, "TABLE_6", {**TABLE_6, "B4": (8.64, 8.42, 8.39)})
    assert one_step_methods_take_longer().agreement == "confirmed"
