from dataclasses import replace

import numpy as np
import pytest

from bezstab.mechanism import constraint_errors, load_scene
from bezstab.paper import slider_crank
from bezstab.paper.printed import TABLE_3
from bezstab.paper.slider_crank import printed_equations
from tests.reference.derivatives import complex_step_jacobian

Q = np.array([0.9, 0.2, 0.1, -0.5, 0.7])  # rad, m: no configuration of the mechanism, as none is needed
V = np.array([1.0, -0.3, 0.2, -2.0, 0.4])
TERMS = slider_crank.scene_terms(Q, V)


def agreements(terms: slider_crank.Terms = TERMS) -> dict[str, str]:
    return {found.where: found.agreement for found in slider_crank.findings(terms)}


def test_eqs_21_and_22_follow_from_eq_19() -> None:
    _, jacobian, gamma = printed_equations(Q, V)
    assert jacobian == pytest.approx(complex_step_jacobian(lambda q: printed_equations(q, V)[0], Q), abs=1e-15)
    turning = complex_step_jacobian(lambda q: printed_equations(q, V)[1] @ V, Q) @ V  # (C_q v)_q v
    assert gamma == pytest.approx(-turning, abs=1e-15)  # Eq. 4: the constraints do not depend on time


def test_other_data_are_not_confirmed(monkeypatch: pytest.MonkeyPatch) -> None:
    assert {where for where, agreement in agreements().items() if agreement != "confirmed"} == {"Eq. 23"}
    monkeypatch.setattr(slider_crank, "TABLE_3", {**TABLE_3, "l2": 0.4, "J1": 44.0})
    wrong = {where for where, agreement in agreements().items() if agreement == "not confirmed"}
    assert wrong == {"Table 3", "Eq. 20", "Eq. 19", "Eq. 21", "Eq. 22"}


def test_a_wrong_gamma_would_show_in_the_constraints_accelerations() -> None:
    assert slider_crank.constraint_accelerations(TERMS).agreement == "confirmed"
    assert slider_crank.constraint_accelerations(replace(TERMS, gamma=-TERMS.gamma)).agreement == "not confirmed"


def test_differences_of_c_would_show_a_forgotten_term(monkeypatch: pytest.MonkeyPatch) -> None:
    assert slider_crank.derivatives_of_the_constraints().agreement == "confirmed"
    monkeypatch.setattr(
        slider_crank, "constraint_errors", lambda mechanism, t, q: constraint_errors(mechanism, t, q) + t**2 / 2
    )
    found = slider_crank.derivatives_of_the_constraints()
    assert found.agreement == "not confirmed"
    assert "is not 0" in found.here


def test_a_matrix_with_a_constraint_twice_has_lost_its_rank() -> None:
    assert "rank 9 of 9; with a constraint written twice 9 of 10" in slider_crank.unique_accelerations(TERMS).here
    twice = replace(TERMS, jacobian=TERMS.jacobian[[0, 1, 2, 2]])
    assert slider_crank.unique_accelerations(twice).agreement == "not confirmed"


def test_a_row_may_be_negated_but_then_in_all_three_equations() -> None:
    equations = ("Eq. 19", "Eq. 21", "Eq. 22")
    inconsistent = replace(TERMS, constraints=-TERMS.constraints)
    negated = replace(inconsistent, jacobian=-TERMS.jacobian, gamma=-TERMS.gamma)
    assert [agreements(negated)[where] for where in equations] == ["confirmed"] * 3
    assert [agreements(inconsistent)[where] for where in equations] == ["confirmed", "not confirmed", "not confirmed"]


@pytest.mark.parametrize(
    ("weight", "agreement"),
    [(34.335, "confirmed with a correction"), (-34.335, "confirmed with a correction"), (-30.0, "not confirmed")],
)
def test_the_weight_of_the_rod_has_its_sign_and_its_size(weight: float, agreement: str) -> None:
    found = slider_crank.generalised_forces(replace(TERMS, forces=np.array([0, 0, weight, 0, 0])))
    assert found.agreement == agreement
    assert ("plus" in found.here) == (weight > 0)


def test_table_3_leaves_out_what_does_not_enter() -> None:
    rows = [list(row.values()) for row in slider_crank.body_rows(load_scene("slider_crank"))]
    assert rows == [["crank", "0.2", "-", "45"], ["rod", "0.35", "3.5", "3.5"], ["slider", "-", "2.5", "-"]]
