"""What is printed of regions and of methods: their columns."""

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import chain, compress
from typing import NamedTuple

from bezstab.regions.answer import MapAnswer, RegionAnswer
from bezstab.regions.methods import Formulas, MethodAnswer, WholeMethod
from bezstab.regions.sentences import best_point_words, falling_words, order_words
from bezstab.show.columns import Answer, Column, of_part
from bezstab.show.fields import MISSING, Value, formatted

LIMITS = ("alpha_hat_min", "alpha_hat_max", "beta_hat_min", "beta_hat_max")
"""The ends of a region's ranges."""

NAMES_ROOM = 22
"""Letters of the longest name in the list of methods."""


def _end(answer: RegionAnswer, axis: int, end: int) -> float | None:
    """Return an end of a region, which may be infinite; None of an empty one."""
    return answer.region.extent[axis][end] if answer.region.extent else None


def _limit(number: float) -> str:
    return "unbounded" if math.isinf(number) else format(number + 0.0, ".8g")


def _area_words(answer: RegionAnswer) -> str:
    """Return an area to the digits that it has: 0.8096847 ± 2e-8."""
    area, error = answer.region.area, answer.region.area_error
    if area is None:
        return "unbounded"
    if not area:
        return "0"
    decimals = max(0, -math.floor(math.log10(error)))
    size, exponent = f"{error:.0e}".split("e")
    return f"{area:.{decimals}f} ± {size}e{int(exponent)}"


def _best_words(answer: RegionAnswer) -> str | None:
    """Return that all poles are zero at the best point, or why there is none; None where nothing is to be said."""
    if answer.inside:
        return best_point_words(answer.inside)
    if answer.trouble:
        return f"not known: {answer.trouble}"
    if answer.best:
        return f"none: |z_p| is {answer.best.z_abs:.6g} at least"
    if answer.falls_towards is not None:
        return f"none: {falling_words(answer.falls_towards)}"
    return None


REGION: Sequence[Column[RegionAnswer]] = (
    Column("method", "method", lambda answer: answer.region.method.name, "integration method", apart=True),
    Column(
        "|z_p| up to",
        "z_abs_below",
        lambda answer: answer.region.level,
        "what |z_p| is below; 1 where the method is stable",
        apart=True,
    ),
    Column("area", "", _area_words, "", brief=True),
    Column("", "area", lambda answer: answer.region.area, "area of the region in α̂ and β̂; null where it is infinite"),
    Column(
        "",
        "area_error",
        lambda answer: None if answer.region.area is None else answer.region.area_error,
        "how far the area may be off; null where it is infinite",
    ),
    Column("α̂ from", "alpha_hat_min", lambda answer: _end(answer, 0, 0), "smallest α̂ of the region", form=_limit),
    Column("α̂ to", "alpha_hat_max", lambda answer: _end(answer, 0, 1), "largest α̂", form=_limit, brief=True),
    Column("β̂ from", "beta_hat_min", lambda answer: _end(answer, 1, 0), "smallest β̂ of the region", form=_limit),
    Column("β̂ to", "beta_hat_max", lambda answer: _end(answer, 1, 1), "largest β̂", form=_limit, brief=True),
    Column(
        "approached",
        "approached",
        lambda answer: ", ".join(compress(LIMITS, chain(*answer.region.approached))) or None,
        "those of the four limits that no edge attains: the region comes near them far out",
        brief=True,
    ),
    Column(
        "",
        "islands",
        lambda answer: ", ".join(f"({a:.4g}, {b:.4g})" for a, b in answer.region.islands) or None,
        "where else |z_p| is as small: a point of each island, (α̂, β̂)",
    ),
    Column(
        "βh to (α = β)",
        "critical_damping_limit",
        lambda answer: math.inf if answer.critical_damping_limit is None else answer.critical_damping_limit,
        "largest βh on α = β up to which all are stable; null if all are",
        form=lambda limit: "unlimited" if math.isinf(limit) else format(limit, ".6g"),
        brief=True,
    ),
    Column(
        "exactly",
        "critical_damping_limit_exact",
        lambda answer: _text(answer.critical_damping_limit_exact),
        "the same as a rational number; null if it is not known to be one",
    ),
    Column(
        "least |z_p|",
        "best_z_abs",
        lambda answer: answer.inside.z_abs if answer.inside else None,
        "smallest modulus of the dominant pole over the region; null where there is none",
        form=".8f",
        brief=True,
    ),
    Column(
        "best α̂",
        "best_alpha_hat",
        lambda answer: answer.inside.alpha_hat if answer.inside else None,
        "where that modulus is smallest, in α̂",
        form=".8f",
        brief=True,
    ),
    Column(
        "best β̂",
        "best_beta_hat",
        lambda answer: answer.inside.beta_hat if answer.inside else None,
        "where that modulus is smallest, in β̂",
        form=".8f",
        brief=True,
    ),
    Column(
        "poles there",
        "best_where",
        _best_words,
        "that all poles are zero there, and where else, or why there is no such point",
        brief=True,
    ),
    Column(
        "all α, β stable", "stable_for_all", lambda answer: answer.stable_for_all, "whether all α̂, β̂ > 0 are stable"
    ),
    Column(
        "every h stable from α/β",
        "",
        lambda answer: formatted(answer.unconditional_damping_ratio).replace(MISSING, "none"),
        "",
    ),
    Column(
        "",
        "unconditional_damping_ratio",
        lambda answer: answer.unconditional_damping_ratio,
        "damping ratio α/β above which every step is stable; null if there is none",
    ),
)


def _text(value: object) -> str | None:
    return None if value is None else str(value)


class MapRow(NamedTuple):
    """A region of a method's map; of a scene that moves also at which times its own speed, and how fast it turns."""

    region: RegionAnswer
    answer: MapAnswer
    speed: float | None = None
    kappa: float | None = None


def map_rows(answer: MapAnswer) -> list[MapRow]:
    """Return a row for the stable region, or for it at each speed of the scene, and one for each level below 1."""
    stable, *faster = answer.regions
    at_speeds = [MapRow(stable, answer, speed, kappa) for speed, kappa in answer.conditions.kappas.items()]
    return [*(at_speeds or [MapRow(stable, answer)]), *(MapRow(each, answer) for each in faster)]


def _area_moving(row: MapRow) -> float | None:
    moving, h = row.answer.moving, row.answer.conditions.h
    return moving.area(row.kappa * h) if moving and row.kappa is not None and h else None


def _region_of(row: MapRow) -> RegionAnswer | None:
    return row.region


def map_columns(answer: MapAnswer) -> Sequence[Column[MapRow]]:
    """Return the columns of maps that ask what this one does."""
    asked = answer.conditions
    return [*MAP, *(ON_A_MOTION if asked.motion else ()), *(MOVING if asked.kappas else ())]


MAP: Sequence[Column[MapRow]] = of_part(_region_of, REGION)

ON_A_MOTION: Sequence[Column[MapRow]] = (
    Column(
        "",
        "omega_h",
        lambda row: float(row.answer.conditions.motion.omega_h) if row.answer.conditions.motion else None,
        "angle by which the motion turns in a step",
        "rad",
    ),
    Column(
        "accurate α̂",
        "accurate_alpha_hat",
        lambda row: row.answer.chosen.alpha_hat if row.answer.chosen else None,
        "where the goal accurate chooses to be, in α̂; null where no feedback decays so fast",
        brief=True,
    ),
    Column(
        "accurate β̂",
        "accurate_beta_hat",
        lambda row: row.answer.chosen.beta_hat if row.answer.chosen else None,
        "the same in β̂",
        brief=True,
    ),
    Column(
        "|z_p| there",
        "accurate_z_abs",
        lambda row: abs(row.answer.chosen.pole) if row.answer.chosen else None,
        "modulus of the dominant pole there",
        form=".6f",
    ),
    Column(
        "error forced there",
        "accurate_error",
        lambda row: row.answer.accurate_error,
        "error that is forced there, of position and velocity added up, shares of the motion",
        form=".2e",
        brief=True,
    ),
    Column(
        "error forced at the least |z_p|",
        "best_error",
        lambda row: row.answer.best_error,
        "the same where |z_p| is least",
        form=".2e",
        brief=True,
    ),
    Column(
        "energy gained there",
        "accurate_growth",
        lambda row: row.answer.accurate_growth,
        "growth of energy in a revolution, a share of it, where the goal accurate chooses to be; null without --motion",
        form=".2e",
        brief=True,
    ),
    Column(
        "energy gained at the least |z_p|",
        "best_growth",
        lambda row: row.answer.best_growth,
        "the same where |z_p| is least",
        form=".2e",
        brief=True,
    ),
)

MOVING: Sequence[Column[MapRow]] = (
    Column(
        "speed",
        "speed",
        lambda row: row.speed,
        "times the scene's own speed; null in the row of a level below 1",
        brief=True,
    ),
    Column(
        "κ (1/s)",
        "kappa",
        lambda row: row.kappa,
        "how fast the directions of the constraints turn, at most",
        "1/s",
        ".4g",
        True,
    ),
    Column("area moving", "area_moving", _area_moving, "area in α̂ and β̂ of the mechanism as it moves", brief=True),
)


def _name_and_alias(about: MethodAnswer) -> str:
    """Return a method's name, and in parentheses the shortest that it is called elsewhere, if there is room for it."""
    shortest = min(about.other_names.split(", "), key=len)
    with_alias = f"{about.name} ({shortest})"
    return with_alias if shortest and len(with_alias) <= NAMES_ROOM else about.name


def _exact(about: MethodAnswer) -> str | None:
    """Return the error constant as a rational; None where the coefficients are irrational."""
    return str(about.error_constant) if about.method.digits is None else None


LISTED: Sequence[Column[MethodAnswer]] = (
    Column("method", "", _name_and_alias, ""),
    Column("", "method", lambda about: about.name, "integration method"),
    Column("steps", "steps", lambda about: about.steps, "number of steps of the method"),
    Column(
        "f calls",
        "evaluations",
        lambda about: about.evaluations,
        "evaluations of the right-hand side in a step, of an implicit method in an iteration",
    ),
    Column("order", "", order_words, ""),
    Column("", "order", lambda about: about.order, "order of accuracy, computed from the coefficients"),
    Column(
        "",
        "order_position_forces",
        lambda about: about.order_position_forces,
        "order of accuracy where forces depend on positions alone",
    ),
    Column(
        "",
        "order_velocity_forces",
        lambda about: about.order_velocity_forces,
        "order of accuracy where forces depend on velocities alone",
    ),
    Column("error constant", "", lambda about: _exact(about) or format(float(about.error_constant), ".10g"), ""),
    Column("", "error_constant", lambda about: float(about.error_constant), "error constant of the method"),
    Column(
        "",
        "error_constant_exact",
        _exact,
        "the error constant as a rational; null where the coefficients are irrational",
    ),
    Column(
        "added damping",
        "added_damping",
        lambda about: about.added_damping,
        "damping ratio that the method adds to an oscillator without damping, negative where it drives: the first term "
        "in θ = ωh",
    ),
    Column("", "source", lambda about: about.method.source, "where the method is from"),
    Column("", "implicit", lambda about: about.implicit, "whether a step solves equations"),
    Column(
        "",
        "digits",
        lambda about: about.method.digits,
        "digits to which rationals stand for irrational coefficients; null where none do",
    ),
    Column("", "other_names", lambda about: about.other_names or None, "what else it is called; null where nothing is"),
    Column("", "group", lambda about: about.group or None, "heading under which the method is listed"),
)

FORMULAS: Sequence[Column[Formulas]] = (
    Column("", "recursion", lambda found: found.recursion, "the method's recursion"),
    Column("", "mapping", lambda found: found.mapping, "the method's mapping from s to z"),
    Column(
        "",
        "characteristic_polynomial",
        lambda found: found.characteristic_polynomial,
        "polynomial in z whose roots are the poles",
    ),
    Column(
        "",
        "steady_error",
        lambda found: found.steady_error,
        "what the method forces on a constraint that moves as e^(iωt), as a share of that motion: the first term in "
        "θ = iωh where α̂ and β̂ are held",
    ),
    Column(
        "",
        "steady_velocity_error",
        lambda found: found.steady_velocity_error,
        "the same of the velocity, as a share of that of the motion",
    ),
    Column(
        "",
        "stage_torque",
        lambda found: found.stage_torque,
        "D, where a step multiplies the rate of a uniform rotation by 1 + D: the first term in θ = ωh",
    ),
    Column(
        "",
        "multiplier_law",
        lambda found: found.multiplier_law,
        "the constraint error c that a motion forces, on which the multipliers do the work -λ dc/dt",
    ),
    Column(
        "",
        "order_left",
        lambda found: found.order_left,
        "order in h of the forced error where α̂ and β̂ are held; null where it is not known",
    ),
)


def _about(whole: WholeMethod) -> MethodAnswer | None:
    return whole.about


def _formulas(whole: WholeMethod) -> Formulas | None:
    return whole.formulas


def _region(whole: WholeMethod) -> RegionAnswer | None:
    return whole.region


def _by_key(columns: Sequence[Column[Answer]]) -> list[Column[Answer]]:
    """Return the columns that have a key, each headed by it, with ten digits."""
    return [
        replace(each, heading=each.key.replace("_", " "), form=_ten_digits)
        for each in columns
        if each.key not in ("", "group")
    ]


def _ten_digits(value: Value) -> str:
    return formatted(value, ".10g" if isinstance(value, float) and math.isfinite(value) else "")


WHOLE: Sequence[Column[WholeMethod]] = [
    *of_part(_about, _by_key(LISTED)),
    *of_part(_formulas, _by_key(FORMULAS)),
    *of_part(_region, _by_key(REGION[1:])),
]
"""All that is known of a method that is named, each below its key."""
