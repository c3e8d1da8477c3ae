"""What the paper prints, as data to compare with, and what can come of a comparison."""

from dataclasses import dataclass
from typing import Literal

Agreement = Literal["confirmed", "confirmed with a correction", "not confirmed", "cannot be tested"]


@dataclass(frozen=True)
class Finding:
    """A sentence of the paper, what it says, what came out here, and whether they agree."""

    where: str
    claim: str
    paper: str
    here: str
    agreement: Agreement


def finding(sentence: str, here: str, *holds: bool) -> Finding:
    """Return what came of `where | claim | what the paper says`, which holds under every, some or none of conditions.

    Under every one it is confirmed, under some with a correction; without a condition it cannot be tested.
    """
    where, claim, paper = sentence.split(" | ")
    agreement: Agreement = (
        "confirmed" if all(holds) else "confirmed with a correction" if any(holds) else "not confirmed"
    )
    return Finding(where, claim, paper, here, agreement if holds else "cannot be tested")


PARTS = (
    "table1",
    "table2",
    "fig1",
    "fig2",
    "fig3",
    "fig4",
    "table3",
    "fig5",
    "fig6",
    "table4",
    "fig7",
    "fig8",
    "table5",
    "fig9",
    "table6",
)
"""Every table and figure."""

FASTER_LEVEL = {"B2": 0.65, "B3": 0.70, "B4": 0.75}
"""|z_p| below which Fig. 1 and section 5.1 call the region H."""

LEAST_Z_ABS = {"B2": 0.58, "B3": 0.62, "B4": 0.65}
"""The smallest |z_p| that section 5.1 found."""

TABLE_3 = {"l1": 0.2, "m1": 20.0, "J1": 45.0, "l2": 0.35, "m2": 3.5, "J2": 3.5, "m3": 2.5, "J3": 0.02}
"""Lengths in m, masses in kg, moments of inertia in kg m2."""

TABLE_5 = {
    ("0.1", "0.1"): {
        "B4": ("0.898", "0.299", "0.947", "18.45"),
        "AB4": ("0.906", "0.291", "0.952", "17.83"),
        "RK4@5": ("0.074", "0.740", "0.744", "84.27"),
        "SIE": ("0.855", "0.281", "0.9", "18.19"),
    },
    ("0.5", "0.1"): {
        "B4": ("0.763", "0.142", "0.776", "10.55"),
        "AB4": ("-0.903", "0.428", "0.999", "154.6"),
        "RK4@5": ("0.095", "0.237", "0.255", "68.15"),
        "SIE": ("0.775", "0.097", "0.781", "7.12"),
    },
    ("0.5", "0.101"): {
        "B4": ("0.762", "0.144", "0.776", "10.69"),
        "AB4": ("-0.903", "0.433", "1.001", "154.4"),
        "RK4@5": ("0.090", "0.241", "0.258", "69.45"),
        "SIE": ("0.774", "0.098", "0.780", "7.22"),
    },
}
"""By (alpha_hat, beta_hat) and method: Re z, Im z, |z| and angle (degrees) of the dominant pole, as printed."""
