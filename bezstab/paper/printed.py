"""What the paper prints, as data to compare with."""

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction

PARTS = (
    ("table1", "table2"),
    ("fig1", "fig2", "fig3"),
    ("table3", "fig4"),
    ("fig5",),
    ("fig6",),
    ("table4", "fig7", "fig8"),
    ("table5", "fig9"),
    ("table6",),
)
"""Tables and figures, those together that come together. (Tables 1, 2 and 4 and the figures are lost in the scan.)"""

FASTER_LEVEL = {"B2": 0.65, "B3": 0.70, "B4": 0.75}
"""|z_p| below which Fig. 1 and section 5.1 call the region H."""

LEAST_Z_ABS = {"B2": 0.58, "B3": 0.62, "B4": 0.65}
"""The smallest |z_p| that section 5.1 found."""

TABLE_3 = {"l1": 0.2, "m1": 20.0, "J1": 45.0, "l2": 0.35, "m2": 3.5, "J2": 3.5, "m3": 2.5, "J3": 0.02}
"""Lengths in m, masses in kg, moments of inertia in kg m2."""

COMPARED = ("B4", "AB4", "RK4@5", "SIE")
"""The methods of Tables 5 and 6, all with steps of 1 ms but RK4, with 5 ms; SIE is "Euler semi-implicit"."""


PrintedPole = tuple[str, str, str, str]
"""Re z, Im z, |z| and the angle of z (degrees) as Table 5 prints them: the number of digits is part of what it says."""


@dataclass(frozen=True)
class PrintedCase:
    """A row of Table 5: the dimensionless parameters, and the dominant poles by method."""

    alpha_hat: str
    beta_hat: str
    poles: Mapping[str, PrintedPole]

    @property
    def exact(self) -> tuple[Fraction, Fraction]:
        """The parameters as they are printed."""
        return Fraction(self.alpha_hat), Fraction(self.beta_hat)

    @property
    def point(self) -> tuple[float, float]:
        """The parameters as floats."""
        return float(self.alpha_hat), float(self.beta_hat)


TABLE_5 = {
    1: PrintedCase(
        alpha_hat="0.1",
        beta_hat="0.1",
        poles={
            "B4": ("0.898", "0.299", "0.947", "18.45"),
            "AB4": ("0.906", "0.291", "0.952", "17.83"),
            "RK4@5": ("0.074", "0.740", "0.744", "84.27"),
            "SIE": ("0.855", "0.281", "0.9", "18.19"),
        },
    ),
    2: PrintedCase(
        alpha_hat="0.5",
        beta_hat="0.1",
        poles={
            "B4": ("0.763", "0.142", "0.776", "10.55"),
            "AB4": ("-0.903", "0.428", "0.999", "154.6"),
            "RK4@5": ("0.095", "0.237", "0.255", "68.15"),
            "SIE": ("0.775", "0.097", "0.781", "7.12"),
        },
    ),
    3: PrintedCase(
        alpha_hat="0.5",
        beta_hat="0.101",
        poles={
            "B4": ("0.762", "0.144", "0.776", "10.69"),
            "AB4": ("-0.903", "0.433", "1.001", "154.4"),
            "RK4@5": ("0.090", "0.241", "0.258", "69.45"),
            "SIE": ("0.774", "0.098", "0.780", "7.22"),
        },
    ),
}
"""The three cases, by the paper's numbers."""

TABLE_6 = {
    "B4": (8.34, 8.42, 8.39),
    "AB4": (8.41, 8.38, 8.42),
    "RK4@5": (8.63, 8.55, 8.60),
    "SIE": (8.52, 8.56, 8.53),
}
"""Processor times (s) of the three cases of Table 5, by method."""

LOST = (
    (
        "Table 6",
        "seconds of processor time",
        "8.34 to 8.63 s",
        "its machine and program are not here; Table 6 has ours beside them",
    ),
    ("Table 4", "the six parameters and their poles", "lost in the scan", "ours fit what the text says"),
    ("Figs 1 to 3, 5 to 9", "the curves themselves", "lost in the scan", "only sentences about them remain"),
    ("Section 5.2", "initial angle of the crank", "not stated", "45 degrees here"),
)
"""What the scan lost or the paper never said: where, the claim, what the paper says, and what is here instead."""

NOT_HERE = (
    ("other formulations of the equations of motion", "Hamilton …, Gibbs …, Dirac …, Kane … and Udwadia-Kalaba"),
    (
        "Chang and Nikravesh: parameters that adapt",
        "an adaptive method to determine the proper Baumgarte parameters and demonstrated the effectiveness",
    ),
    ("Yoon et al.: pseudo-integration", "used pseudo-integration of the constraint dynamics"),
    ("Ostermeyer: rules from control", "some rules to choose the values of the corresponding parameters"),
    (
        "Kim et al., Ascher et al., Guizhi and Rong: other choices",
        "developed different techniques to select Baumgarte parameters",
    ),
    ("Park et al.: penalty", "similar to the Baumgarte method considering a penalty formulation"),
    (
        "Bayo and Avello: augmented Lagrangian",
        "ensures better accuracy and robustness in the presence of singular configurations",
    ),
    ("Weijia et al.: automatic stabilisation", "an automatic constraint violation stabilization method"),
    ("Blajer: projection after each step", "the exact elimination of the constraint violations"),
    (
        "Hong et al.: implicit enforcement",
        "stable for large time steps and does not require problem-dependent stabilization parameters",
    ),
    (
        "Braun and Goldfarb: virtual force and impulse",
        "embedding a small virtual force and a small virtual impulse in the equation of motion",
    ),
    (
        "Nada and Bayoumi: fuzzy control",
        "a constraint stabilization method for multibody systems based on fuzzy logic control",
    ),
    (
        "Bézier curves with differential quadrature",
        "a combination of the Bézier method and the differential quadrature technique",
    ),
)
"""What the introduction names and bezstab does not have: its name, and what the paper says of it."""
