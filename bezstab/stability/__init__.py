"""Poles of the closed loop, the exact region, its best point, and which parameters to choose.

From a method's polynomial in float64 (its pencil) upwards; a file imports only from those above it:

    arrays            names for arrays
    exact_sums        sums that keep their rounding; the feedback's roots mu
    root_finding      all roots of many polynomials
    pencils           what float64 needs to know of a method, made once
    dominant_roots    the largest root along a row of mu, followed
    closed_loop       poles, |z_p|, the proven verdict
    searches          where a condition comes to hold; where a value is least
    locus_tracks      the branches of the curve |z| = r in mu, followed
    boundary_locus    that curve cut where it bounds the region, integrated
    line_crossings    where an arc crosses lines
    line_slices       where lines across the region are stable, by a second route
    self_checks       every answer held against a second route
    answer_checks     best points, choices and margins held against samples and proofs
    regions           the exact region in alpha_hat and beta_hat
    grid_maps         |z_p| on a grid
    best_points       the smallest |z_p|
    choices           which parameters to take
    step_families     methods by their number of steps, and their limit
"""

from bezstab.stability.arrays import EPS, BoolArray, ComplexArray, FloatArray
from bezstab.stability.best_points import BestPoint, best_point
from bezstab.stability.choices import (
    THOUSANDFOLD,
    Choice,
    Goal,
    Margins,
    choose,
    choose_at_step,
    describe_point,
    stability_margins,
)
from bezstab.stability.closed_loop import dominant_pole, poles, spectral_radius, verdict
from bezstab.stability.grid_maps import QUALITY, pole_map
from bezstab.stability.pencils import Pencil, pencil_of, roots_in_z
from bezstab.stability.regions import Extent, Region, pole_place, region, window
from bezstab.stability.searches import first_where
from bezstab.stability.step_families import FAMILIES, Limit, Member, bezier_limit, family_members
from bezstab.stability.turning import turning_sensitivity

__all__ = [
    "EPS",
    "FAMILIES",
    "QUALITY",
    "THOUSANDFOLD",
    "BestPoint",
    "BoolArray",
    "Choice",
    "ComplexArray",
    "Extent",
    "FloatArray",
    "Goal",
    "Limit",
    "Margins",
    "Member",
    "Pencil",
    "Region",
    "best_point",
    "bezier_limit",
    "choose",
    "choose_at_step",
    "describe_point",
    "dominant_pole",
    "family_members",
    "first_where",
    "pencil_of",
    "pole_map",
    "pole_place",
    "poles",
    "region",
    "roots_in_z",
    "spectral_radius",
    "stability_margins",
    "turning_sensitivity",
    "verdict",
    "window",
]
