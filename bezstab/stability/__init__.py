"""Poles of the closed loop, the exact region, its best point, and which parameters to choose."""

from bezstab.stability.best_points import BestPoint, best_point
from bezstab.stability.choices import THOUSANDFOLD, Choice, Goal, choose, describe_point, stability_margins
from bezstab.stability.closed_loop import (
    EPS,
    ComplexArray,
    FloatArray,
    branch_points,
    dominant_pole,
    float_table,
    poles,
    roots_in_z,
    spectral_radius,
    verdict,
)
from bezstab.stability.regions import QUALITY, Extent, Region, first_where, pole_map, region, scan, stable_mask, window
from bezstab.stability.step_families import FAMILIES, Limit, Member, bezier_limit, family_members

__all__ = [
    "EPS",
    "FAMILIES",
    "QUALITY",
    "THOUSANDFOLD",
    "BestPoint",
    "Choice",
    "ComplexArray",
    "Extent",
    "FloatArray",
    "Goal",
    "Limit",
    "Member",
    "Region",
    "best_point",
    "bezier_limit",
    "branch_points",
    "choose",
    "describe_point",
    "dominant_pole",
    "family_members",
    "first_where",
    "float_table",
    "pole_map",
    "poles",
    "region",
    "roots_in_z",
    "scan",
    "spectral_radius",
    "stability_margins",
    "stable_mask",
    "verdict",
    "window",
]
