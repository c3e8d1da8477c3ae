"""How far a constraint sags under a steady load in an engine, and the least feedback with which it sags no further.

A load is given as the acceleration that it would give the error if nothing held it: J M^-1 f for a force f. Of a body
on a constraint to the world that is force over mass in m/s^2, or torque over inertia in rad/s^2; gravity is 9.81 m/s^2
whatever the mass. The effective mass 1 / (J M^-1 J') is that of the engine's values where it has one among them.

    acceleration level    multipliers hold it: c'' + 2 alpha c' + beta^2 c = 0 as without it    0
    springs, MuJoCo       load over stiffness: each engine's own `rest`                        a / k, (1 - d) a / k
    implicit springs      (1 + alpha_hat + beta_hat) v1 = h a - beta_hat c, where v1 = 0        h^2 a / beta_hat
    others                v1 = (1 - alpha_hat) h a - beta_hat c, where v1 = 0        h^2 a (1 - alpha_hat) / beta_hat
    sweeps                the fixed point of the step as it is swept: sweeps.py
"""

import math
from collections.abc import Sequence
from fractions import Fraction

import numpy as np

from bezstab.engines.conversions import Engine, Point
from bezstab.errors import InputError
from bezstab.methods.schemes import Method
from bezstab.rationals import exact, rational
from bezstab.stability.arrays import BoolArray, FloatArray
from bezstab.stability.choices import search_box
from bezstab.stability.closed_loop import converges, spectral_radius
from bezstab.stability.regions import region
from bezstab.stability.searches import first_where, least_between
from bezstab.stability.sweeps import swept_rest

ROUNDED = 1e-9
"""Of what the load moves in a step: a smaller offset is rounding of none."""


SHARES = np.geomspace(1e-9, 1, 100)
"""Of the strongest feedback, at which one that sags little enough is looked for first."""


def offset_at_rest(engine: Engine, values: Sequence[Fraction], h: Fraction, acceleration: Fraction) -> float:
    """Return the error (m, or rad) at which one constraint alone rests under a steady load, with its sign.

    `values` are the engine's, as `engine_and_values` reads them, and are clamped as the engine clamps them; h is its
    step in s. `acceleration` is the load over the effective mass, in m/s^2 (N/kg) or rad/s^2 (N m/(kg m^2)), not a
    force: see above. A hard constraint has 0. Only where errors decay is it ever reached.

    InputError for values that mean nothing, and for a feedback without stiffness. Source: derived; held against each
    engine's own step and against runs of MuJoCo, Box2D, pymunk, p2, cannon-es and matter.js.
    """
    alpha_hat, beta_hat = engine.applied(tuple(values), h).point
    fall = h**2 * acceleration
    if engine.rest:
        return float(engine.rest(h, acceleration, *values))
    if engine.level == "acceleration":
        return 0.0
    if not beta_hat:
        raise InputError(f"--engine {engine.name}: what takes no error back has no place to rest")
    if engine.level == "velocity" and engine.sweeping:
        step = engine.sweeping.step(engine.sweeping.iterations, h, *values)
        offset = float(swept_rest(np.ones((1, 1)), step, np.array([float(fall)]))[0])
        return offset if abs(offset) > ROUNDED * abs(float(fall)) else 0.0
    of_load = 1 if engine.method == "implicit-euler" else 1 - alpha_hat
    return float(fall * of_load / beta_hat)


def least_feedback(
    engine: Engine, method: Method, h: Fraction, acceleration: Fraction, sag: Fraction, spread: float = 0.0
) -> Point | None:
    """Return the weakest feedback (alpha_hat, beta_hat) with which a constraint sags by at most `sag` (m or rad).

    It is one that the engine expresses: on its curve; without a curve that of least |z_p| for its beta_hat. Proven
    stable, and so if alpha and beta are larger by the share `spread`; None where no such one sags so little. `method`
    is the one that the engine steps with, `acceleration` as in `offset_at_rest`. InputError for a sag that is not
    positive. For a hard constraint, which does not sag, it is next to no feedback.
    """
    if sag <= 0:
        raise InputError(f"--sag {float(sag):g}: expected above 0")
    alphas, betas = search_box(region(method))[0]
    curve = engine.curve or (lambda share: (2 * math.sqrt(share * betas[1]), share * betas[1]))  # critically damped

    def keeps(shares: FloatArray) -> BoolArray:
        return np.array([_sags(engine, curve(float(share)), h, acceleration) <= sag for share in shares])

    found = first_where(keeps, SHARES)
    if found is None:
        return None
    alpha_hat, beta_hat = map(float, curve(found[1]))
    if not engine.curve:
        alpha_hat = _best_damping(method, beta_hat, alphas[1])
    point = exact(alpha_hat), exact(beta_hat)
    more = exact(1 + spread)
    stable = converges(method, *point) and converges(method, more * point[0], more**2 * point[1])
    return point if stable else None


def _sags(engine: Engine, point: tuple[float, float], h: Fraction, acceleration: Fraction) -> float:
    """Return how far a constraint sags at a point, as it is pasted; infinity where the engine has no words for it."""
    try:
        values = tuple(map(rational, engine.values((exact(point[0]), exact(point[1])), h)))
        return abs(offset_at_rest(engine, values, h, acceleration))
    except InputError:
        return math.inf


def _best_damping(method: Method, beta_hat: float, most: float) -> float:
    """Return the alpha_hat of least |z_p| for a beta_hat."""
    found, _ = least_between(lambda some: spectral_radius(method, some, beta_hat), np.array(0.0), np.array(most))
    return float(found)
