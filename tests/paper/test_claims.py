from collections import Counter
from typing import get_args

import pytest

from bezstab.methods import lookup
from bezstab.paper import claims
from bezstab.paper.claims import FINDINGS
from bezstab.paper.printed import TABLE_3, Agreement, Finding
from bezstab.stability import spectral_radius

FOUND = [finding for find in FINDINGS for finding in find()]


def those(words: str) -> list[Finding]:
    return [finding for finding in FOUND if words in finding.claim]


def test_every_row_says_what_the_paper_says_and_what_came_out() -> None:
    assert all(f.where and f.claim and f.paper and f.here and f.agreement in get_args(Agreement) for f in FOUND)
    assert len({(f.where, f.claim) for f in FOUND}) == len(FOUND) > 25


@pytest.mark.parametrize(
    ("words", "agreement", "number"),
    [
        ("characteristic polynomial of B2", "confirmed", "25 of 25"),
        ("of order n", "confirmed with a correction", "B4: 2"),
        ("smallest |z_p|", "confirmed with a correction", "0.57735, 0.60698, 0.62588"),
        ("shrink slightly", "confirmed with a correction", "0.822"),
        ("loses more than", "confirmed", "17 %"),
        ("RK4 costs 5 times", "confirmed with a correction", "4 and 1"),
        ("at equal cost", "confirmed", "0.8097"),
        ("RK4 at 4h", "confirmed", "0.5402"),
        ("semi-implicit", "confirmed with a correction", "3 of 3"),
        ("g = [0 0 m2 g 0 0]", "confirmed with a correction", "-34.335"),
        ("processor time", "cannot be tested", "not known"),
    ],
)
def test_the_questions_to_settle(words: str, agreement: Agreement, number: str) -> None:
    (finding,) = those(words)
    assert finding.agreement == agreement
    assert number in finding.here


def test_a_counterexample_is_one() -> None:
    point = claims._counterexample(lookup("B4"), lookup("AB4"))
    assert point is not None
    assert spectral_radius(lookup("B4"), *point) < 1 < spectral_radius(lookup("AB4"), *point)
    assert claims._counterexample(lookup("AB1"), lookup("RK1")) is None  # the same method


def test_a_false_claim_is_not_confirmed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(claims, "LEAST_Z_ABS", {"B2": 0.1, "B3": 0.1, "B4": 0.1})
    monkeypatch.setattr(claims, "TABLE_3", {**TABLE_3, "l2": 0.4, "J1": 44.0})
    agreements = Counter(f.agreement for f in [*claims.region_findings(), *claims.mechanism_findings()])
    assert agreements["not confirmed"] == 6  # least |z_p|, Table 3, and Eqs 19 to 22
