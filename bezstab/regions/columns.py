"""What is printed of regions and of methods: their columns."""

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import compress

from bezstab.regions.answer import MotionPoint, MovingRegion, RegionAnswer
from bezstab.regions.methods import Formulas, MethodAnswer, WholeMethod
from bezstab.regions.sentences import (
    best_point_words,
    falling_words,
    order_words,
    region_sentence,
    whole_method_sentence,
)
from bezstab.show.cells import MISSING, between, formatted
from bezstab.show.columns import METHOD, POINT, Column, of_part
from bezstab.stability.best_points import BestPoint

NAMES_ROOM = 22
"""Letters of the longest name in the list of methods."""

ENDS = between(".8g", "unbounded")


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


def _critical_words(answer: RegionAnswer) -> str:
    """Return up to where all of α = β is stable, and the rational number that this is, if it is known to be one."""
    limit, exact = answer.critical_damping_limit, answer.critical_damping_limit_exact
    if limit is None:
        return "unlimited"
    return f"{limit:.6g}" if exact is None else f"{limit:.6g} = {exact}"


BEST: Sequence[Column[BestPoint]] = (
    Column(
        "least |z_p|",
        "z_abs",
        lambda best: best.z_abs,
        "smallest modulus of the dominant pole over the region; null where there is none",
        form=".8f",
        brief=True,
    ),
    Column("best α̂", "alpha_hat", lambda best: best.alpha_hat, "where that modulus is smallest", "", ".8f", True),
    Column("best β̂", "beta_hat", lambda best: best.beta_hat, "where that modulus is smallest", "", ".8f", True),
)

REGION: Sequence[Column[RegionAnswer]] = (
    *of_part(RegionAnswer, lambda answer: answer.region, [METHOD]),
    Column(
        "|z_p| up to",
        "z_abs_below",
        lambda answer: answer.region.level,
        "what |z_p| is below; 1 where the method is stable",
        apart=True,
    ),
    Column(
        "area",
        "area",
        lambda answer: answer.region.area,
        "area of the region in α̂ and β̂; null where it is infinite",
        brief=True,
        words=_area_words,
    ),
    Column(
        "",
        "uncertainty",
        lambda answer: None if answer.region.area is None else answer.region.area_error,
        "how far the area may be off; null where it is infinite",
    ),
    Column(
        "α̂",
        "alpha_hat_range",
        lambda answer: answer.region.extent and answer.region.extent[0],
        "from where to where the region reaches; null at an end without limit",
        form=ENDS,
        brief=True,
    ),
    Column(
        "β̂",
        "beta_hat_range",
        lambda answer: answer.region.extent and answer.region.extent[1],
        "the same in β̂",
        form=ENDS,
        brief=True,
    ),
    Column(
        "approached far out",
        "",
        lambda answer: " and ".join(compress(("the largest α̂", "the largest β̂"), answer.region.approached)),
        "",
        brief=True,
    ),
    Column(
        "βh to (α = β)",
        "critical_damping_limit",
        lambda answer: answer.critical_damping_limit,
        "largest βh on α = β up to which all are stable; null if all are",
        brief=True,
        words=_critical_words,
    ),
    *of_part(RegionAnswer, lambda answer: answer.inside, BEST),
    Column(
        "poles there",
        "remark",
        _best_words,
        "that all poles are zero there, and where else, or why there is no such point",
        brief=True,
    ),
    Column(
        "all α, β stable", "stable_for_all", lambda answer: answer.stable_for_all, "whether all α̂, β̂ > 0 are stable"
    ),
    Column(
        "every h stable from α/β",
        "unconditional_damping_ratio",
        lambda answer: answer.unconditional_damping_ratio,
        "damping ratio α/β above which every step is stable; null if there is none",
        words=lambda answer: formatted(answer.unconditional_damping_ratio).replace(MISSING, "none"),
    ),
    Column("", "sentence", region_sentence, "the answer in words"),
)


ON_A_MOTION: Sequence[Column[MotionPoint]] = (
    METHOD,
    Column("point", "goal", lambda point: point.goal, "goal of `choose` whose point it is", brief=True),
    Column("", "omega_h", lambda point: point.omega_h, "angle by which the motion turns in a step", "rad"),
    *(replace(each, brief=True) for each in POINT),
    Column("|z_p|", "z_abs", lambda point: point.z_abs, "modulus of the dominant pole", form=".6f", brief=True),
    Column(
        "error forced",
        "combined_error",
        lambda point: point.error,
        "errors of position and velocity that are forced, added up, as shares of the motion",
        form=".2e",
        brief=True,
    ),
    Column(
        "energy gained",
        "energy_growth",
        lambda point: point.growth,
        "growth of energy in a revolution, a share of it; null without --motion",
        form=".2e",
        brief=True,
    ),
)

MOVING: Sequence[Column[MovingRegion]] = (
    METHOD,
    Column("speed", "speed", lambda moving: moving.speed, "times the scene's own speed", brief=True),
    Column(
        "κ (1/s)",
        "kappa",
        lambda moving: moving.kappa,
        "how fast the directions of the constraints turn, at most",
        "1/s",
        ".4g",
        True,
    ),
    Column("area moving", "area", lambda moving: moving.area, "area for the mechanism as it moves", brief=True),
)


def _name_and_alias(about: MethodAnswer) -> str:
    """Return a method's name, and in parentheses the shortest that it is called elsewhere, if there is room for it."""
    shortest = min(about.other_names.split(", "), key=len)
    with_alias = f"{about.name} ({shortest})"
    return with_alias if shortest and len(with_alias) <= NAMES_ROOM else about.name


def _constant_words(about: MethodAnswer) -> str:
    """Return the error constant as a rational, with ten digits where the coefficients are irrational."""
    constant = about.error_constant
    return str(constant) if about.method.digits is None else format(float(constant), ".10g")


LISTED: Sequence[Column[MethodAnswer]] = (
    Column("method", "method", lambda about: about.name, "integration method", brief=True, words=_name_and_alias),
    Column("steps", "steps", lambda about: about.steps, "number of steps of the method", brief=True),
    Column(
        "f calls",
        "evaluations",
        lambda about: about.evaluations,
        "evaluations of the right-hand side in a step, of an implicit method in an iteration",
        brief=True,
    ),
    Column(
        "order",
        "order",
        lambda about: about.order,
        "order of accuracy, computed from the coefficients",
        brief=True,
        words=order_words,
    ),
    Column(
        "error constant",
        "error_constant",
        lambda about: float(about.error_constant),
        "error constant of the method",
        brief=True,
        words=_constant_words,
    ),
    Column(
        "added damping",
        "added_damping",
        lambda about: about.added_damping,
        "damping ratio that the method adds to an oscillator without damping, negative where it drives: the first term "
        "in θ = ωh",
        brief=True,
    ),
    Column("implicit", "implicit", lambda about: about.implicit, "whether a step solves equations"),
    Column("digits", "", lambda about: about.method.digits, ""),
    Column("source", "source", lambda about: about.method.source, "where the method is from"),
    Column(
        "other names",
        "other_names",
        lambda about: about.other_names or None,
        "what else it is called; null where nothing is",
    ),
)

FORMULAS: Sequence[Column[Formulas]] = (
    Column("recursion", "recursion", lambda found: found.recursion, "the method's recursion"),
    Column("mapping", "", lambda found: found.mapping, ""),
    Column(
        "characteristic polynomial",
        "characteristic_polynomial",
        lambda found: found.characteristic_polynomial,
        "polynomial in z whose roots are the poles",
    ),
    Column(
        "steady error",
        "steady_error",
        lambda found: found.steady_error,
        "what the method forces on a constraint that moves as e^(iωt), as a share of that motion: the first term in "
        "θ = iωh where α̂ and β̂ are held",
    ),
    Column("steady velocity error", "", lambda found: found.steady_velocity_error, ""),
    Column("stage torque", "", lambda found: found.stage_torque, ""),
    Column("multiplier law", "", lambda found: found.multiplier_law, ""),
    Column(
        "order left",
        "order_left",
        lambda found: found.order_left,
        "order in h of the forced error where α̂ and β̂ are held; null where it is not known",
    ),
)


WHOLE: Sequence[Column[WholeMethod]] = [
    *of_part(WholeMethod, lambda whole: whole.about, LISTED),
    *of_part(WholeMethod, lambda whole: whole.formulas, FORMULAS),
    *of_part(WholeMethod, lambda whole: whole.region, REGION[1:-1]),
    Column("", "sentence", whole_method_sentence, "the answer in words"),
]
"""All that is known of a method that is named."""
