"""What is said of regions and of methods in words."""

from bezstab.regions.answer import RegionAnswer
from bezstab.regions.methods import MethodAnswer, WholeMethod
from bezstab.stability.best_points import BestPoint, FarLimit
from bezstab.words import counted


def region_sentence(answer: RegionAnswer) -> str:
    """Return how large the region of a method is, and where in it errors shrink fastest."""
    region, best = answer.region, answer.inside
    what = "is stable" if region.level == 1 else f"has |z_p| < {region.level:g}"
    if region.extent is None:
        return f"{region.method.name} {what} nowhere."
    size = "in a region without end" if region.area is None else f"in a region of area {region.area:.3g}"
    if region.islands:
        near = ", ".join(f"({alpha_hat:.4g}, {beta_hat:.4g})" for alpha_hat, beta_hat in region.islands)
        size += f" (and on islands, near α̂, β̂ = {near})"
    if best is None:
        return f"{region.method.name} {what} {size}."
    at = f"({best.alpha_hat:.4g}, {best.beta_hat:.4g})"
    return f"{region.method.name} {what} {size}; the least |z_p| is {best.z_abs:.3g}, at α̂, β̂ = {at}."


def whole_method_sentence(whole: WholeMethod) -> str:
    """Return what a method is, what a step of it costs, and the order that strong feedback leaves it."""
    about, left = whole.about, whole.formulas.order_left
    kind, each = ("implicit", "iteration") if about.implicit else ("explicit", "step")
    cost = counted(about.evaluations, "evaluation")
    keeps = "keep that order" if left == about.order else f"are of order {left}"
    return (
        f"{about.name} is {kind}, of order {order_words(about)}, with {cost} in each {each}. With α̂ and β̂ held as h "
        f"shrinks, constraint errors {keeps}."
    )


def order_words(about: MethodAnswer) -> str:
    """Return the order of accuracy, with that for forces of position alone in parentheses if it is another."""
    without_velocity = about.order_position_forces
    return str(about.order) if about.order == without_velocity else f"{about.order} ({without_velocity})"


def best_point_words(best: BestPoint) -> str | None:
    """Return that every pole is zero at the best point, and where else (dimensionless, as text); None if one is not."""
    if best.z_abs:
        return None
    points = " and ".join(f"({alpha_hat:.6f}, {beta_hat:.6f})" for alpha_hat, beta_hat in best.elsewhere)
    return "deadbeat: every pole is 0" + (f"; also at {points}" if points else "")


def falling_words(limit: FarLimit) -> str:
    """Return what |z_p| falls towards without a least value, and along which way of alpha_hat and beta_hat.

    The way is "β̂ grows at α̂ = 2", or "α̂ and β̂ grow, α̂² = 3 β̂".
    """
    (p, q), ratio = limit.direction, limit.ratio
    falls = f"|z_p| falls towards {limit.z_abs:.6g} as"
    if p == 0 or q == 0:
        grows, stays = ("α̂", "β̂") if q == 0 else ("β̂", "α̂")
        return f"{falls} {grows} grows" + (
            "" if ratio is None else f" at {stays} = {1 / ratio if q == 0 else ratio:.6g}"
        )
    times = "" if ratio is None or f"{ratio:.6g}" == "1" else f"{ratio:.6g} "
    equal = "like" if ratio is None else "="
    grow = "α̂ and β̂ grow" if p > 0 and q > 0 else "β̂ grows and α̂ falls" if q > 0 else "α̂ grows and β̂ falls"
    return f"{falls} {grow}, {_power('α̂', q)} {equal} {times}{_power('β̂', p)}"


def _power(name: str, exponent: int) -> str:
    return name if exponent == 1 else f"{name}^{exponent}"
