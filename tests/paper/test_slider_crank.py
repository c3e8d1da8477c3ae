from dataclasses import replace

import numpy as np
import pytest

from bezstab.mechanism import constraint_errors, load_scene
from bezstab.paper import slider_crank
from bezstab.paper.printed import TABLE_3
from bezstab.paper.slider_crank import printed_constraints, printed_gamma, printed_jacobian
from tests.reference.derivatives import complex_step_jacobian

Q = np.array([0.9, 0.2, 0.1, -0.5, 0.7])  # rad, m: no configuration of the mechanism, as none is needed
V = np.array([1.0, -0.3, 0.2, -2.0, 0.4])


def test_what_the_printed_equations_come_to() -> None:
    found = slider_crank.findings()
    assert len(found) == 11
    assert [finding.where for finding in found if finding.agreement != "confirmed"] == ["Eq. 23"]
    assert any("-34.335" in finding.here for finding in found)


def test_eqs_21_and_22_follow_from_eq_19() -> None:
    assert printed_jacobian(Q) == pytest.approx(complex_step_jacobian(printed_constraints, Q), abs=1e-15)
    turning = complex_step_jacobian(lambda q: printed_jacobian(q) @ V, Q) @ V  # (C_q v)_q v
    assert printed_gamma(Q, V) == pytest.approx(-turning, abs=1e-15)  # Eq. 4: the constraints do not depend on time


def test_other_data_are_not_confirmed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(slider_crank, "TABLE_3", {**TABLE_3, "l2": 0.4, "J1": 44.0})
    wrong = {found.where for found in slider_crank.findings() if found.agreement == "not confirmed"}
    assert wrong == {"Table 3", "Eq. 20", "Eq. 19", "Eq. 21", "Eq. 22"}


def test_a_wrong_gamma_would_show_in_the_constraints_accelerations() -> None:
    terms = slider_crank.scene_terms(load_scene("slider_crank"), Q, V)
    assert slider_crank.constraint_accelerations(terms, Q, V).agreement == "confirmed"
    assert slider_crank.constraint_accelerations(replace(terms, gamma=-terms.gamma), Q, V).agreement == "not confirmed"


def test_differences_of_c_would_show_a_forgotten_term(monkeypatch: pytest.MonkeyPatch) -> None:
    exact = constraint_errors
    assert slider_crank.derivatives_of_the_constraints(load_scene("driven_four_bar")).agreement == "confirmed"
    monkeypatch.setattr(slider_crank, "constraint_errors", lambda mechanism, t, q: exact(mechanism, t, q) + t**2 / 2)
    found = slider_crank.derivatives_of_the_constraints(load_scene("driven_four_bar"))
    assert found.agreement == "not confirmed"
    assert "is not 0" in found.here


def test_a_matrix_with_a_constraint_twice_has_lost_its_rank() -> None:
    terms = slider_crank.scene_terms(load_scene("slider_crank"), Q, V)
    assert "rank 9 of 9; with a constraint written twice 9 of 10" in slider_crank.unique_accelerations(terms).here
    twice = replace(terms, jacobian=terms.jacobian[[0, 1, 2, 2]])
    assert slider_crank.unique_accelerations(twice).agreement == "not confirmed"


def test_1_mm_at_the_start_stays_without_feedback() -> None:
    found = slider_crank.inconsistent_start()
    assert found.agreement == "confirmed"
    assert "1.04 mm after 10 s" in found.here


def test_a_row_may_be_negated_but_then_in_all_three_equations() -> None:
    terms = slider_crank.scene_terms(load_scene("slider_crank"), Q, V)
    negated = replace(terms, constraints=-terms.constraints, jacobian=-terms.jacobian, gamma=-terms.gamma)
    inconsistent = replace(terms, constraints=-terms.constraints)
    assert [f.agreement for f in slider_crank.equations_up_to_row_signs(negated, Q, V)] == ["confirmed"] * 3
    assert [f.agreement for f in slider_crank.equations_up_to_row_signs(inconsistent, Q, V)] == [
        "confirmed",
        "not confirmed",
        "not confirmed",
    ]


@pytest.mark.parametrize(
    ("weight", "agreement"),
    [(34.335, "confirmed with a correction"), (-34.335, "confirmed with a correction"), (-30.0, "not confirmed")],
)
def test_the_weight_of_the_rod_has_its_sign_and_its_size(weight: float, agreement: str) -> None:
    found = slider_crank.generalised_forces(np.array([0, 0, weight, 0, 0]))
    assert found.agreement == agreement
    assert ("plus" in found.here) == (weight > 0)


def test_table_3_leaves_out_what_does_not_enter() -> None:
    crank, rod, slider = slider_crank.body_rows(load_scene("slider_crank"))
    assert crank == {"body": "crank", "length": 0.2, "mass": None, "inertia": 45.0}
    assert rod == {"body": "rod", "length": 0.35, "mass": 3.5, "inertia": 3.5}
    assert slider == {"body": "slider", "length": None, "mass": 2.5, "inertia": None}
