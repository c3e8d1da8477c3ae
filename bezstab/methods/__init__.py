"""Integration methods as exact data, and what follows from their coefficients.

From exact numbers upwards; a file imports only from those above it:

    schur               where a polynomial's roots lie, proven in exact arithmetic
    plane_polynomials   polynomials in z, alpha_hat and beta_hat, and their determinants
    second_order        schemes for x'' = a(x, x') as a list of linear equations
    algebraic_numbers   irrational coefficients as rationals good to 40 digits
    square_roots        numbers with square roots, exactly, from text
    recipes             such equations as text
    schemes             the kinds of methods as frozen data that checks itself
    second_order_forms  every scheme written as a second-order one
    scheme_motions      motions that every scheme follows exactly, and so when it evaluates
    steady_errors       the error that a method makes anew in each step, as a function of the feedback
    families            Bezier, Adams-Bashforth and their predictor-corrector pairs, by number of steps
    one_step_methods    Runge-Kutta methods and symplectic Euler
    runge_kutta_pairs   explicit Runge-Kutta methods that people run, most of them in pairs
    implicit_methods    BDF, Adams-Moulton, implicit Runge-Kutta
    second_order_methods  Verlet, Newmark, symplectic compositions and such
    method_files        a user's method, from TOML
    aliases             what else they are called, and advice
    registry            every built-in method by name
    derivation          by sympy: s->z mapping, characteristic polynomial, closed loop
    first_order_forms   second-order schemes that spell out a multistep method or a PECE
    shared_factors      poles that no feedback moves
    plane_edges         where a second-order scheme's plane turns from stable to unstable, exactly
    path_edges          where a path through any method's plane may turn so, exactly
    orders              order of accuracy and error constant
    step_matrices       one step of a one-step method as an exact matrix, for steps that differ in length
    second_order_formulas  the equations of a second-order scheme as text or LaTeX
    formulas            all that as text or LaTeX

What needs sympy is loaded when first used: naming a method, or proving a verdict, does not.
"""

from typing import TYPE_CHECKING

from bezstab.lazy import lazy_names
from bezstab.methods.families import adams_bashforth, adams_bashforth_moulton, bezier
from bezstab.methods.method_files import read_method
from bezstab.methods.recipes import recipe
from bezstab.methods.registry import GROUPS, REGISTRY, MethodGroup, lookup
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
    PredictorCorrector,
    RungeKutta,
    evaluations,
    implicit,
    steps,
)
from bezstab.methods.schur import Polynomial, Verdict, is_schur, recursion_verdict
from bezstab.methods.second_order import Assignment, Combination, Evaluation, PlaneTable, Quantity, SecondOrder
from bezstab.methods.second_order_forms import second_order_form
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
    characteristic,
    check_one_step,
    matrix_product,
    polynomial_determinant,
    polynomial_product,
    step_matrix,
)

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
    from bezstab.methods.first_order_forms import first_order_form
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
        points_between_edges,
    )
    from bezstab.methods.shared_factors import fixed_poles, reduced_table, without_shared_factor

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
    "first_order_forms": ("first_order_form",),
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
        "path_edges",
        "points_between_edges",
    ),
    "shared_factors": ("fixed_poles", "reduced_table", "without_shared_factor"),
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
    "first_order_form",
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
    "points_between_edges",
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
