from dataclasses import replace

import numpy as np
import pytest

from bezstab.methods import lookup
from bezstab.paper import regions
from bezstab.paper.printed import FASTER_LEVEL, LEAST_Z_ABS, TABLE_5, PrintedCase
from bezstab.stability import best_point, dominant_pole, region, spectral_radius


@pytest.mark.parametrize("name", LEAST_Z_ABS)
def test_the_papers_least_values_lie_above_the_exact_ones_like_those_of_a_grid(name: str) -> None:
    best = best_point(lookup(name))
    assert best is not None
    assert 0 < LEAST_Z_ABS[name] - best.z_abs < 0.03 < FASTER_LEVEL[name] - best.z_abs


def test_a_counterexample_is_one() -> None:
    point = regions.counterexample(stable=lookup("B4"), unstable=lookup("AB4"))
    assert point is not None
    assert spectral_radius(lookup("B4"), *point) < 1 < spectral_radius(lookup("AB4"), *point)
    assert regions.counterexample(stable=lookup("AB1"), unstable=lookup("RK1")) is None  # the same method


def test_where_all_methods_agree_the_integrator_does_not_decide(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(regions, "WHERE_METHODS_DIFFER", (0.1, 0.1))
    assert regions.integrator_decides().agreement == "not confirmed"


def test_a_false_least_modulus_is_not_confirmed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(regions, "LEAST_Z_ABS", {"B2": 0.1, "B3": 0.1, "B4": 0.1})
    assert regions.least_moduli().agreement == "not confirmed"


def table_5_with(*names: str) -> dict[int, PrintedCase]:
    """Return Table 5 as it would be if "Euler semi-implicit" were these methods, cut off after three decimals."""
    cases = {}
    for (number, case), name in zip(TABLE_5.items(), names, strict=True):
        pole = complex(dominant_pole(lookup(name), *case.point))
        printed = (f"{pole.real:.3f}", f"{pole.imag:.3f}", f"{abs(pole):.3f}", "0")
        cases[number] = replace(case, poles={**case.poles, "SIE": printed})
    return cases


def test_euler_semi_implicit_is_an_euler_step_corrected_once_and_nothing_else_would_be_taken_for_it() -> None:
    asked = regions.what_semi_implicit_euler_is
    assert (asked().agreement, asked().here.count("3 of 3")) == ("confirmed with a correction", 1)
    assert asked(table_5_with("SYM", "SYM", "SYM")).agreement == "confirmed"
    assert asked(table_5_with("AB2", "AB2", "AB2")).agreement == "not confirmed"
    assert asked(table_5_with("SYM", "AB2", "AB2")).agreement == "not confirmed"


def test_a_panel_of_fig_1_has_the_regions_s_and_h() -> None:
    axes = regions.faster_region_figure("B3").axes[0]
    lines = {str(line.get_label()): np.array(line.get_xydata()) for line in axes.lines}
    for label, level in (("$|z_p| = 1$", 1.0), ("$|z_p| = 0.7$", 0.7)):
        (boundary,) = region(lookup("B3"), level).boundary
        assert lines[label][:-1] == pytest.approx(boundary)


def test_fig_3_is_in_units_of_a_step_of_1_ms() -> None:
    axes = regions.compared_regions_figure(["B4", "RK4@5"], h=1e-3).axes[0]
    assert [line.get_label() for line in axes.lines] == ["B4", "RK4@5"]
    assert "1/s" in axes.get_xlabel()
