import numpy as np
import pytest

from bezstab.methods import lookup
from bezstab.paper import regions
from bezstab.paper.reports import Agreement, Finding
from bezstab.stability import region, spectral_radius


@pytest.fixture(scope="module")
def found() -> list[Finding]:
    return regions.findings()


@pytest.mark.parametrize(
    ("words", "agreement", "number"),
    [
        ("smallest |z_p|", "confirmed with a correction", "0.57735, 0.60698, 0.62588"),
        ("shrink slightly", "confirmed with a correction", "0.822"),
        ("loses more than", "confirmed", "17 %"),
        ("RK4 costs 5 times", "confirmed with a correction", "4 and 1"),
        ("at equal cost", "confirmed", "0.8097"),
        ("RK4 at 4h", "confirmed", "0.5402"),
        ("wider region at the same cost", "confirmed with a correction", "4.000"),
        ("Adams–Moulton", "not confirmed", "B3 0.887, AM3 120.45; B4 0.810, AM4 20.10"),
        ("depends on the integrator", "confirmed", "AB4 diverges (1.456)"),
    ],
)
@pytest.mark.slow
def test_the_questions_to_settle(found: list[Finding], words: str, agreement: Agreement, number: str) -> None:
    (finding,) = (finding for finding in found if words in finding.claim)
    assert finding.agreement == agreement
    assert number in finding.here


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
