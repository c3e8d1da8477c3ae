"""Results as rows: what a command prints in JSON and CSV, and what the columns of its table show."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from fractions import Fraction
from functools import partial
from types import SimpleNamespace
from typing import TYPE_CHECKING

from bezstab.engines import witness_of
from bezstab.errors import InputError
from bezstab.methods import Method, evaluations, implicit, steps
from bezstab.show.cells import LIMITS
from bezstab.show.fields import Row, Value, cells
from bezstab.show.row_kinds import (
    CHAINS,
    ENGINES_LISTED,
    FORCED,
    FRONTS,
    LIKE_POINT,
    LISTED_METHODS,
    MEMBERS,
    METHOD,
    POLE,
    REGIONS,
)
from bezstab.units import alpha_and_beta

EXCLUDED_SHOWN = 5
"""Methods that do not fit and are shown where people read, the nearest; rows for programs have all."""

if TYPE_CHECKING:  # so that a small row does not load what makes the large ones
    from bezstab.engines import Engine
    from bezstab.evidence import HalvedStep, LikePoint, Measurement
    from bezstab.questions import ChainMap, RegionAnswer
    from bezstab.stability import FrontPoint, Limit, Region


def pole_cells(z: complex) -> dict[str, Value]:
    """Return the cells that show a pole: its real and imaginary part, its modulus, its angle in degrees."""
    return cells(POLE, SimpleNamespace(pole=complex(z)))


def method_row(method: Method, name: str = "", group: str | None = None) -> Row:
    """Return steps, evaluations per step, order of accuracy, error constant (as number, and exact as text) and source.

    The exact one is None where rationals stand for irrational coefficients; `digits` says to how many digits they do,
    None where they do not. `order_position_forces` and `order_velocity_forces` are the orders where forces
    depend on the position alone, and on the velocity alone; `implicit` is whether a step solves equations. `name` is
    what the method is listed as, under the heading of its `group`.
    """
    from bezstab.methods import accuracy, accuracy_by_force  # loads sympy

    order, constant = accuracy(method)
    by_force = accuracy_by_force(method)
    found = {
        "method": name or method.name,
        "group": group,
        "steps": steps(method),
        "evaluations": evaluations(method),
        "order": order,
        "error_constant": constant,
        "error_constant_exact": constant if method.digits is None else None,
        "implicit": implicit(method),
        "order_position_forces": by_force.position[0],
        "order_velocity_forces": by_force.velocity[0],
    }
    return cells(LISTED_METHODS.fields if group else LISTED_METHODS.fields[:-1], method, found)


def whole_row(answer: RegionAnswer, *, latex: bool) -> Row:
    """Return all that is known of one method: method_row, its formulas (as text or LaTeX), and region_row.

    They are the recursion, s->z mapping, characteristic polynomial (paper Tables 1 and 2) and steady errors.
    NumericalError as `region_row`.
    """
    from bezstab.methods import (  # loads sympy
        characteristic_text,
        mapping_text,
        recursion_text,
        steady_error_text,
    )
    from bezstab.stability import order_left

    method = answer.region.method
    return {
        **method_row(method),
        "recursion": recursion_text(method, latex),
        "mapping": mapping_text(method, latex),
        "characteristic_polynomial": characteristic_text(method, latex),
        "steady_error": steady_error_text(method, "x", latex),
        "steady_velocity_error": steady_error_text(method, "v", latex),
        "order_left": order_left(method),
        **region_row(answer),
    }


def region_row(answer: RegionAnswer) -> Row:
    """Return area, axis limits, best point of the method and which steps are stable; all dimensionless.

    Area and limits are of |z_p| < level, None where that region is empty, or has none; `approached` names those that
    no edge attains, only comes near far out. NumericalError where a pole leaves the range of float64.
    """
    from bezstab.show.best_point_text import best_point_words

    region, inside = answer.region, answer.inside
    reason = None if inside else f"not known: {answer.trouble}" if answer.trouble else _nowhere(answer)
    where = best_point_words(inside) if inside else reason
    return REGIONS.row(answer, approached=_approached(region), best_where=where, best_reason=reason)


def _approached(region: Region) -> str | None:
    """Return the names of those limits that no edge attains, None if there is no such limit."""
    only_near = [near for ends in region.approached for near in ends]
    return ", ".join(key for key, near in zip(LIMITS, only_near, strict=True) if near) or None


def _nowhere(answer: RegionAnswer) -> str | None:
    """Return why there is no best point in a region: |z_p| is not that small, falls on, or a pole cannot be moved."""
    from bezstab.show.best_point_text import falling_words
    from bezstab.stability import pole_place

    if answer.best:
        return f"none: |z_p| is {answer.best.z_abs:.6g} at least"
    if answer.falls_towards is not None:
        return f"none: {falling_words(answer.falls_towards)}"
    if not answer.region.fixed_poles:
        return None
    return f"stable nowhere: a pole stays at {pole_place(answer.region.fixed_poles[0])} whatever α̂ and β̂"


def limit_row(limit: Limit) -> Row:
    """Return the row of the Bezier family's limit, of order two, which has no number of steps."""
    extent = {"alpha_hat_max": limit.alpha_hat_max, "beta_hat_max": limit.beta_hat_max}
    return MEMBERS.row(limit, steps=None, method="B∞", order=2, area=limit.area, **extent)


def forced_rows(scene: str, pair: HalvedStep) -> list[Row]:
    """Return what two runs at one point were predicted to force and did, the larger step first; SI units.

    None where there is nothing to compare; orders are between the two, and stand in the row of the smaller step.
    """
    of_pair = partial(FORCED.row, scene=scene, gain_share=pair.share)
    return [
        of_pair(pair.whole, predicted_order=None, observed_order=None),
        of_pair(pair.half, predicted_order=pair.predicted_order, observed_order=pair.observed_order),
    ]


def exact_rate_words(measurement: Measurement, no_period: str) -> str:
    """Return along which motion the exact rates of a method are; why there are none, where the motion ends.

    `no_period` is why its drivers do not begin anew, in words.
    """
    name = measurement.method.name
    if measurement.periodic:
        return (
            f"Exact rates of {name}: along the method's own motion, where there is none along the mechanism's motion."
        )
    why = no_period and f", as {no_period}"
    shown = "What is shown is how errors grow over the run."
    return f"No rate of {name} is exact: the motion does not begin anew{why}. {shown}"


def nearest_rows(likenesses: Sequence[Row]) -> list[Row]:
    """Return of each column's methods, the nearest first, those that fit and a few that do not."""
    shown: list[Row] = []
    excluded: Counter[object] = Counter()
    for row in likenesses:
        excluded[row["column"]] += not row["fits"]
        if row["fits"] or excluded[row["column"]] <= EXCLUDED_SHOWN:
            shown.append(row)
    return shown


def like_point_row(column: str, point: LikePoint, h: float | None) -> Row:
    """Return a point at which a method has the pole in a column of a log, with h (s) in 1/s too."""
    return {"column": column, **cells((METHOD, *LIKE_POINT), point, _in_seconds(point, h))}


def front_row(point: FrontPoint, h: float | None) -> Row:
    """Return a point of the front of |z_p| against forced error, with h (s) in 1/s too."""
    return FRONTS.row(point, **_in_seconds(point, h))


def _in_seconds(point: FrontPoint | LikePoint, h: float | None) -> dict[str, Value]:
    """Return a step (s), and alpha and beta (1/s) of a point with it; None without a step."""
    alpha, beta = (None, None) if h is None else alpha_and_beta(point.alpha_hat, point.beta_hat, h)
    return {"h": h, "alpha": alpha, "beta": beta}


def chain_rows(engine: Engine, found: ChainMap) -> list[Row]:
    """Return a row for each number of bodies of a map, with the engine's own number of sweeps."""
    assert engine.sweeping
    own = engine.sweeping.iterations
    of_bodies = enumerate(zip(found.z_abs[:, own - 1], found.stable_iterations, strict=True), start=1)
    return [
        CHAINS.row(found, chain_bodies=bodies, swept_iterations=own, swept_z_abs=z_abs, stable_iterations=fewest)
        for bodies, (z_abs, fewest) in of_bodies
    ]


def engine_row(engine: Engine, point: tuple[Fraction, Fraction] | None, h: Fraction) -> Row:
    """Return an engine's words, and its setting for (alpha_hat, beta_hat) at a step h (s), or why it has none."""
    setting = None
    if point:
        try:
            setting = engine.setting(point, h)
        except InputError as error:
            setting = str(error)
    return ENGINES_LISTED.row(engine, witness=witness_of(engine.name), setting=setting)
