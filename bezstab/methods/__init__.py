"""Integration methods as exact data, and what follows from their coefficients.

What needs sympy is loaded when first used: naming a multistep or Runge-Kutta method does not.
"""

from typing import TYPE_CHECKING

from bezstab.lazy import lazy_names
from bezstab.methods.aliases import OTHER_NAMES
from bezstab.methods.method_files import read_method
from bezstab.methods.multistep_methods import adams_bashforth, bezier, is_bezier
from bezstab.methods.polynomials import Polynomial
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
    LinearMultistep,
    Method,
    PredictorCorrector,
    RungeKutta,
    check_one_step,
    evaluations,
    implicit,
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
        closed_loop_at,
        closed_loop_polynomial,
        closed_loop_table,
        mapping_equation,
        plane_elements,
        rational_feedback_roots,
        rho_and_sigma,
    )
    from bezstab.methods.determinants import characteristic
    from bezstab.methods.formulas import (
        characteristic_text,
        mapping_text,
        multiplier_law_text,
        recursion_text,
        stage_torque_text,
        steady_error_text,
    )
    from bezstab.methods.orders import accuracy, accuracy_by_force
    from bezstab.methods.recipes import recipe
    from bezstab.methods.rotation_torque import stage_torque
    from bezstab.methods.steady_errors import ExponentialSum, ForcedErrors, forced_errors, leading_error, turning_error
    from bezstab.methods.step_matrices import ExactArray, StepMatrix, step_matrix

__getattr__ = lazy_names(__name__)
