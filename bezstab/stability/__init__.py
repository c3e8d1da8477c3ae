"""Poles of the closed loop, the exact region, its best point, and which parameters to choose.

From a method's polynomial in float64 (its pencil) upwards; a file imports only from those above it:

    arrays            names for arrays, how those of others are read, even points
    exact_sums        sums that keep their rounding; the feedback's roots mu
    root_finding      all roots of many polynomials
    pencils           what float64 needs to know of a method, made once
    low_degrees       roots of quadratics and cubics
    neighbourhoods    the points of a grid in blocks of neighbours
    real_factors      the largest root of real polynomials, by a quadratic factor followed among neighbours
    plane_pencils     the same of a second-order scheme, and its poles
    closed_loop       poles, |z_p|, the proven verdict
    turning           what turning constraints do to a pole, to first order
    searches          where a condition comes to hold; where a value is least
    locus_tracks      the branches of the curve |z| = r in mu, followed
    boundary_locus    that curve cut where it bounds the region, integrated
    shapes            what a region is, wherever its edges come from
    locus_shapes      the region of a method that has a mu, from that curve
    path_crossings    where a path from a point crosses the boundary
    plane_cells       that of a method that has none, from the stable cells of its plane
    region_checks     every region held against the poles
    answer_checks     best points, choices and margins held against samples and proofs
    margins           how far h, alpha and beta are from the boundary, by factors
    regions           the exact region in alpha_hat and beta_hat
    grid_maps         |z_p| on a grid
    quadrant_proofs   whether all of alpha_hat, beta_hat > 0 is stable
    positive_polynomials whether polynomials are positive on an interval, exactly
    lyapunov_quadratics  a quadratic form that every step of a range makes smaller
    lyapunov_polygons    a polygon that every step of a range maps into its inside
    growing_sequences    sequences of steps whose product grows
    step_sequences    whether feedback decays for every sequence of steps within a range
    damping_limits    up to which steps, by damping ratio
    far_limits        what |z_p| of a second-order scheme tends to far out
    least_modulus     the least of the largest |z|, from the poles that decide
    plane_best_points the smallest |z_p| of a second-order scheme
    best_points       the smallest |z_p|
    forced_errors     the error that a method forces with a feedback, over the plane
    accurate_points   where that is least
    curve_choices     the best point of a curve
    choices           which parameters to take
    error_fronts      how little error a method can force while what is there decays so fast
    feedback_costs    what accuracy a feedback costs
    gain_margins      which of two gains is used up
    held_drives       drives whose torque is held for several steps, or applied late
    step_families     methods by their number of steps, and their limit
    sweeps            by what a step multiplies the errors of constraints that are solved in sweeps

What needs sympy's polynomials is loaded when first used: poles and maps do not.
"""

from typing import TYPE_CHECKING

from bezstab.lazy import lazy_names
from bezstab.stability.accurate_points import default_rate
from bezstab.stability.answer_checks import Modulus
from bezstab.stability.arrays import EPS, BoolArray, ComplexArray, Extent, FloatArray, real_array
from bezstab.stability.best_points import BestPoint, best_point, best_point_or_reason, falls_towards
from bezstab.stability.choices import (
    THOUSANDFOLD,
    Choice,
    Goal,
    choose,
    choose_at_step,
    describe_point,
)
from bezstab.stability.closed_loop import dominant_pole, poles, spectral_radius, verdict
from bezstab.stability.error_fronts import RATES, FrontPoint, error_front
from bezstab.stability.far_limits import FarLimit
from bezstab.stability.feedback_costs import FeedbackCost, feedback_cost
from bezstab.stability.forced_errors import (
    LARGEST_OMEGA_H,
    OMEGA_H,
    ForcedError,
    check_omega_h,
    combined_error,
    forced_error,
    forced_response,
    turning_response,
)
from bezstab.stability.gain_margins import GainLimits, gain_limits
from bezstab.stability.grid_maps import QUALITY, pole_map
from bezstab.stability.margins import Margins, largest_stable_step, stability_margins, stable_up_to
from bezstab.stability.pencils import Pencil, pencil_of, roots_in_z
from bezstab.stability.regions import Region, pole_place, region, useful_window, window
from bezstab.stability.searches import bisected, first_where
from bezstab.stability.step_families import FAMILIES, Limit, Member, bezier_limit, family_members
from bezstab.stability.step_sequences import VaryingSteps, varying_steps
from bezstab.stability.sweeps import (
    LARGEST_RATIO,
    MOST_BODIES,
    Growth,
    chain,
    fewest_sweeps,
    inverse_effective_masses,
    swept_growth,
)
from bezstab.stability.turning import own_feedback_root, turning_sensitivity, turning_shift

if TYPE_CHECKING:
    from bezstab.stability.damping_limits import (
        critical_damping_limit,
        exact_critical_damping_limit,
        unconditional_damping_ratio,
    )
    from bezstab.stability.held_drives import (
        HeldLimits,
        Timing,
        held_limits,
        held_spectral_radius,
        held_verdict,
    )
    from bezstab.stability.quadrant_proofs import StableForAll, stable_for_all

PROVEN = {
    "damping_limits": ("critical_damping_limit", "exact_critical_damping_limit", "unconditional_damping_ratio"),
    "held_drives": ("HeldLimits", "Timing", "held_limits", "held_spectral_radius", "held_verdict"),
    "quadrant_proofs": ("StableForAll", "stable_for_all"),
}
"""What is loaded when first used, by module."""

__getattr__ = lazy_names(__name__, PROVEN)

__all__ = [
    "EPS",
    "FAMILIES",
    "LARGEST_OMEGA_H",
    "LARGEST_RATIO",
    "MOST_BODIES",
    "OMEGA_H",
    "QUALITY",
    "RATES",
    "THOUSANDFOLD",
    "BestPoint",
    "BoolArray",
    "Choice",
    "ComplexArray",
    "Extent",
    "FarLimit",
    "FeedbackCost",
    "FloatArray",
    "ForcedError",
    "FrontPoint",
    "GainLimits",
    "Goal",
    "Growth",
    "HeldLimits",
    "Limit",
    "Margins",
    "Member",
    "Modulus",
    "Pencil",
    "Region",
    "StableForAll",
    "Timing",
    "VaryingSteps",
    "best_point",
    "best_point_or_reason",
    "bezier_limit",
    "bisected",
    "chain",
    "check_omega_h",
    "choose",
    "choose_at_step",
    "combined_error",
    "critical_damping_limit",
    "default_rate",
    "describe_point",
    "dominant_pole",
    "error_front",
    "exact_critical_damping_limit",
    "falls_towards",
    "family_members",
    "feedback_cost",
    "fewest_sweeps",
    "first_where",
    "forced_error",
    "forced_response",
    "gain_limits",
    "held_limits",
    "held_spectral_radius",
    "held_verdict",
    "inverse_effective_masses",
    "largest_stable_step",
    "own_feedback_root",
    "pencil_of",
    "pole_map",
    "pole_place",
    "poles",
    "real_array",
    "region",
    "roots_in_z",
    "spectral_radius",
    "stability_margins",
    "stable_for_all",
    "stable_up_to",
    "swept_growth",
    "turning_response",
    "turning_sensitivity",
    "turning_shift",
    "unconditional_damping_ratio",
    "useful_window",
    "varying_steps",
    "verdict",
    "window",
]
