"""Integration methods as exact data, and what follows from their coefficients.

What needs sympy is loaded when first used: naming a multistep or Runge-Kutta method does not.
"""

from typing import TYPE_CHECKING

from bezstab.lazy import lazy_names
from bezstab.methods.method_files import read_method
from bezstab.methods.multistep_methods import adams_bashforth, adams_bashforth_moulton, bezier
from bezstab.methods.polynomials import PlaneTable, Polynomial
from bezstab.methods.recipes import recipe
from bezstab.methods.registry import GROUPS, REGISTRY, lookup
from bezstab.methods.scheme_motions import (
    ACCELERATED,
    AT_REST,
    STEADY,
    Motions,
    evaluation_errors,
    evaluation_times,
    exact_motions,
    value_at_start,
)
from bezstab.methods.schemes import (
    Family,
    LinearMultistep,
    Method,
    MethodGroup,
    PredictorCorrector,
    RungeKutta,
    check_one_step,
    evaluations,
    implicit,
    second_order_form,
    steps,
)
from bezstab.methods.schur import Verdict, is_schur, recursion_verdict
from bezstab.methods.second_order import SecondOrder
from bezstab.methods.step_equations import Assignment, Combination, Evaluation, Quantity

if TYPE_CHECKING:
    from bezstab.methods.derivation import (
        ALPHA_HAT,
        BETA_HAT,
        MU,
        H,
        S,
        Z,
        branch_polynomial,
        characteristic_polynomial,
        closed_loop_at,
        closed_loop_polynomial,
        closed_loop_table,
        coefficient_table,
        feedback_matrix,
        mapping_equations,
    )
    from bezstab.methods.determinants import characteristic
    from bezstab.methods.formulas import characteristic_text, mapping_text, recursion_text, steady_error_text
    from bezstab.methods.orders import ForceAccuracy, accuracy, accuracy_by_force
    from bezstab.methods.path_edges import turning_factors
    from bezstab.methods.plane_edges import (
        Crossing,
        CurveTable,
        Limit,
        PlaneStrips,
        Strip,
        plane_strips,
    )
    from bezstab.methods.shared_factors import fixed_poles, reduced_table, without_shared_factor
    from bezstab.methods.steady_errors import (
        ExponentialSum,
        ForcedErrors,
        LeadingError,
        Part,
        TurningError,
        forced_errors,
        leading_error,
        turning_error,
    )
    from bezstab.methods.step_matrices import (
        StepMatrix,
        StepPolynomial,
        matrix_product,
        polynomial_determinant,
        polynomial_product,
        step_matrix,
    )

DERIVED = {
    "derivation": (
        "ALPHA_HAT",
        "BETA_HAT",
        "MU",
        "H",
        "S",
        "Z",
        "branch_polynomial",
        "characteristic_polynomial",
        "closed_loop_at",
        "closed_loop_polynomial",
        "closed_loop_table",
        "coefficient_table",
        "feedback_matrix",
        "mapping_equations",
    ),
    "determinants": ("characteristic",),
    "formulas": ("characteristic_text", "mapping_text", "recursion_text", "steady_error_text"),
    "orders": ("ForceAccuracy", "accuracy", "accuracy_by_force"),
    "path_edges": ("turning_factors",),
    "plane_edges": (
        "Crossing",
        "CurveTable",
        "Limit",
        "PlaneStrips",
        "Strip",
        "plane_strips",
    ),
    "shared_factors": ("fixed_poles", "reduced_table", "without_shared_factor"),
    "steady_errors": (
        "ExponentialSum",
        "ForcedErrors",
        "LeadingError",
        "Part",
        "TurningError",
        "forced_errors",
        "leading_error",
        "turning_error",
    ),
    "step_matrices": (
        "StepMatrix",
        "StepPolynomial",
        "matrix_product",
        "polynomial_determinant",
        "polynomial_product",
        "step_matrix",
    ),
}
"""What is loaded when first used, by module."""

__getattr__ = lazy_names(__name__, DERIVED)

__all__ = [
    "ACCELERATED",
    "ALPHA_HAT",
    "AT_REST",
    "BETA_HAT",
    "GROUPS",
    "MU",
    "REGISTRY",
    "STEADY",
    "Assignment",
    "Combination",
    "Crossing",
    "CurveTable",
    "Evaluation",
    "ExponentialSum",
    "Family",
    "ForceAccuracy",
    "ForcedErrors",
    "H",
    "LeadingError",
    "Limit",
    "LinearMultistep",
    "Method",
    "MethodGroup",
    "Motions",
    "Part",
    "PlaneStrips",
    "PlaneTable",
    "Polynomial",
    "PredictorCorrector",
    "Quantity",
    "RungeKutta",
    "S",
    "SecondOrder",
    "StepMatrix",
    "StepPolynomial",
    "Strip",
    "TurningError",
    "Verdict",
    "Z",
    "accuracy",
    "accuracy_by_force",
    "adams_bashforth",
    "adams_bashforth_moulton",
    "bezier",
    "branch_polynomial",
    "characteristic",
    "characteristic_polynomial",
    "characteristic_text",
    "check_one_step",
    "closed_loop_at",
    "closed_loop_polynomial",
    "closed_loop_table",
    "coefficient_table",
    "evaluation_errors",
    "evaluation_times",
    "evaluations",
    "exact_motions",
    "feedback_matrix",
    "fixed_poles",
    "forced_errors",
    "implicit",
    "is_schur",
    "leading_error",
    "lookup",
    "mapping_equations",
    "mapping_text",
    "matrix_product",
    "plane_strips",
    "polynomial_determinant",
    "polynomial_product",
    "read_method",
    "recipe",
    "recursion_text",
    "recursion_verdict",
    "reduced_table",
    "second_order_form",
    "steady_error_text",
    "step_matrix",
    "steps",
    "turning_error",
    "turning_factors",
    "value_at_start",
    "without_shared_factor",
]
