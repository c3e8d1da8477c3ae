"""Poles of the closed loop, the exact region, its best point, and which parameters to choose.

What needs sympy's polynomials is loaded when first used: poles and maps do not.
"""

from typing import TYPE_CHECKING

from bezstab.goals import Goal
from bezstab.lazy import lazy_names
from bezstab.stability.accurate_points import default_rate
from bezstab.stability.arrays import EPS, SLOW, BoolArray, ComplexArray, Extent, FloatArray, plane_arrays, real_array
from bezstab.stability.best_points import BestPoint, FarLimit, best_point, best_point_or_reason, falls_towards
from bezstab.stability.choices import Choice, choose, describe_point, steps_to_settle
from bezstab.stability.closed_loop import QUALITY, Modulus, dominant_pole, pole_map, poles, spectral_radius, verdict
from bezstab.stability.drive_poles import drive_pole, drive_verdict, velocity_poles
from bezstab.stability.error_fronts import RATES, FrontPoint, error_front
from bezstab.stability.feedback_costs import FeedbackCost, feedback_cost, follows_motion, order_left
from bezstab.stability.forced_errors import (
    LARGEST_OMEGA_H,
    OMEGA_H,
    check_omega_h,
    combined_error,
    forced_error,
    forced_response,
)
from bezstab.stability.margins import Margins, largest_stable_step, stability_margins
from bezstab.stability.regions import Region, check_level, region, window
from bezstab.stability.searches import bisected, first_where
from bezstab.stability.sweeps import Growth, chain, fewest_sweeps, inverse_effective_masses, swept_growth, swept_rest
from bezstab.stability.turning import (
    LAW_HOLDS,
    MovingPole,
    MovingVerdict,
    moduli_and_shifts,
    most_moved,
    moving_modulus,
    moving_pole,
    turn_limits,
    turning_shift,
)

if TYPE_CHECKING:
    from bezstab.stability.damping_limits import (
        critical_damping_limit,
        exact_critical_damping_limit,
        stable_up_to,
        unconditional_damping_ratio,
    )
    from bezstab.stability.quadrant_proofs import StableForAll, stable_for_all

__getattr__ = lazy_names(__name__)
