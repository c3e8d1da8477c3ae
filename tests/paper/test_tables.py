from pathlib import Path

import pytest

from bezstab.paper.experiments import kicked_runs, pole
from bezstab.paper.tables import TABLES, behaviour, is_printed

FIGURES = Path(__file__).parent.parent.parent / "figures"


@pytest.mark.parametrize("name", [pytest.param(name, marks=[pytest.mark.slow] * (name == "table5")) for name in TABLES])
def test_a_table_is_the_one_that_is_kept(name: str) -> None:
    assert TABLES[name]() == (FIGURES / f"paper_{name}.md").read_text(encoding="utf-8")


def test_a_misprint_is_noticed_and_a_half_digit_is_not() -> None:
    assert is_printed("0.12", 0.1249)
    assert not is_printed("0.12", 0.1251)
    assert not is_printed("-0.12", -0.1271)
    assert is_printed("0.9", 0.9004)


def test_the_points_of_table_4_do_what_their_poles_say() -> None:
    for run in kicked_runs():
        if pole(run).imag > 0.01:  # else a double pole, where the decay is slower at first
            assert behaviour(run)[0] == pytest.approx(abs(pole(run)), abs=0.03)  # the wave's phase at the window's ends
