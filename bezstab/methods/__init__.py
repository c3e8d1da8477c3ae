"""Integration methods as exact data, and what follows from their coefficients.

What needs sympy is loaded when first used: naming a method, or proving a verdict, does not.
"""

from typing import TYPE_CHECKING

from bezstab.lazy import lazy_names
from bezstab.methods.registry import (
    REGISTRY,
    Family,
    LinearMultistep,
    Method,
    Partitioned,
    PredictorCorrector,
    RungeKutta,
    adams_bashforth,
    adams_bashforth_moulton,
    bezier,
    evaluations,
    lookup,
    read_method,
    steps,
)
from bezstab.methods.schur import Polynomial, Verdict, is_schur, recursion_verdict

if TYPE_CHECKING:
    from bezstab.methods.derivation import (
        ALPHA_HAT,
        BETA_HAT,
        MU,
        H,
        S,
        Z,
        accuracy,
        branch_polynomial,
        characteristic_polynomial,
        closed_loop_at,
        closed_loop_polynomial,
        coefficient_table,
        feedback_matrix,
        feedback_polynomial,
        mapping_equations,
    )
    from bezstab.methods.formulas import characteristic_text, mapping_text, recursion_text

DERIVED = {
    "derivation": (
        "ALPHA_HAT",
        "BETA_HAT",
        "MU",
        "H",
        "S",
        "Z",
        "accuracy",
        "branch_polynomial",
        "characteristic_polynomial",
        "closed_loop_at",
        "closed_loop_polynomial",
        "coefficient_table",
        "feedback_matrix",
        "feedback_polynomial",
        "mapping_equations",
    ),
    "formulas": ("characteristic_text", "mapping_text", "recursion_text"),
}
"""What is loaded when first used, by module."""

__getattr__ = lazy_names(__name__, DERIVED)

__all__ = [
    "ALPHA_HAT",
    "BETA_HAT",
    "MU",
    "REGISTRY",
    "Family",
    "H",
    "LinearMultistep",
    "Method",
    "Partitioned",
    "Polynomial",
    "PredictorCorrector",
    "RungeKutta",
    "S",
    "Verdict",
    "Z",
    "accuracy",
    "adams_bashforth",
    "adams_bashforth_moulton",
    "bezier",
    "branch_polynomial",
    "characteristic_polynomial",
    "characteristic_text",
    "closed_loop_at",
    "closed_loop_polynomial",
    "coefficient_table",
    "evaluations",
    "feedback_matrix",
    "feedback_polynomial",
    "is_schur",
    "lookup",
    "mapping_equations",
    "mapping_text",
    "read_method",
    "recursion_text",
    "recursion_verdict",
    "steps",
]
