from collections.abc import Callable
from fractions import Fraction
from typing import Any

import numpy as np
import pytest

from bezstab.methods.registry import lookup
from bezstab.methods.schemes import Method
from bezstab.rationals import exact
from bezstab.stability.best_points import FarLimit, best_point, falls_towards
from bezstab.stability.closed_loop import converges, spectral_radius
from tests.methods.kinds import SAMPLE
from tests.reference.least_by_evolution import least_within
from tests.reference.made_methods import multistep
from tests.reference.random_methods import other_random_method, random_implicit_runge_kutta, random_method

P = 3**-0.5
KINK = (66 + 5056**0.5) / 350
KNOWN: list[Any] = [
    # two opposite real roots meet at a zero of the even part of (p - 1) |sigma|(p): for B4 of 350p^4 - 132p^2 - 2
    ("B4", KINK**0.5, []),
    # along an arc, alpha_hat from 4/9 to 4/3, the most damped end is taken
    ("B2", P, [(4 / 3, 4 / 9)]),
    # a double root of pi
    ("ABM2", 1 / 3, [(4 / 3, 4 / 9)]),
    # 2 z^3 + (a + 2b - 4) z^2 + 2 z - a = 2 (z - p)^3 asks for 3 p^2 = 1, a = 2 p^3, 2 b = 4 - a - 6 p
    pytest.param("verlet-old", P, [(2 * P**3, 2 - P**3 - 3 * P)], marks=pytest.mark.slow),
    # every pole is zero
    ("radau3", 0, [(6, 9)]),  # R has a numerator of lower degree
    ("RK4@5", 0, [(3.45888846213 / 5, 3.78125278982 / 25), (0.541111537865 / 5, 6.34710275518 / 25)]),
    ("verlet-kdk", 0, [(2, 2)]),  # (1 - alpha / 2)^2 = 0, of which rounding leaves half the digits
]


@pytest.mark.parametrize(("name", "z_abs", "points"), KNOWN)
def test_the_least_is_where_it_is_by_hand(name: str, z_abs: float, points: list[tuple[float, float]]) -> None:
    found = best_point(lookup(name))
    assert found
    assert found.z_abs == pytest.approx(z_abs, rel=1e-7)
    if points:
        places = [(found.alpha_hat, found.beta_hat), *found.elsewhere]
        assert np.array(places) == pytest.approx(np.array(points), rel=1e-6)


def test_a_sharp_valley_is_narrowed_to_its_floor() -> None:
    """Of a recipe, beside whose best point |z_p| rises like a root: a stretch of 4e-10 is 7e-7 above it."""
    method, least = other_random_method(25), Fraction("0.4568747")
    found = best_point(method)
    assert converges(method, Fraction("0.22893125215410917"), Fraction("0.13500461107509398"), least)
    assert found
    assert found.z_abs < least


LIMITS: list[tuple[Method, float, tuple[int, int], float | None]] = [
    (lookup("implicit-euler"), 0, (0, 1), None),
    # damping implicit, spring explicit: (1 + a) z^2 - (2 + a - b) z + 1, which tends to z^2 - (1 - b / a) z
    (lookup("imex-euler"), 0, (1, 1), 1),
    # z = (1 + 9/11 x) / (1 + 20/11 x) at mu = -x
    (multistep("theta", "1 -1", "20/11 -9/11"), 0.45, (0, 1), None),
]


@pytest.mark.parametrize(("method", "z_abs", "direction", "ratio"), LIMITS, ids=str)
def test_some_have_no_best_point_but_fall_on_towards_a_limit(
    method: Method, z_abs: float, direction: tuple[int, int], ratio: float | None
) -> None:
    assert best_point(method) is None
    limit = falls_towards(method)
    assert limit
    assert limit.z_abs == pytest.approx(z_abs, rel=1e-12)
    assert limit.direction == direction
    assert limit.ratio == (ratio and pytest.approx(ratio))


DRAWN = [
    *(pytest.param(lookup, name, marks=pytest.mark.slow) for name in (*SAMPLE, "ABM2", "B4@2")),
    *(pytest.param(random_implicit_runge_kutta, k, marks=[] if k < 2 else pytest.mark.slow) for k in range(24)),
    *(pytest.param(other_random_method, k, marks=pytest.mark.slow) for k in range(1, 48, 4)),
    # |z_p| is least at alpha_hat = -0.06 and -3.1; a grid of points misses the curved valley of the others
    *(pytest.param(random_method, k, marks=pytest.mark.slow) for k in (134, 250, 205, 220)),
]


def on_way(limit: FarLimit, t: float) -> tuple[float, float]:
    """Return alpha_hat and beta_hat at t > 0 of the way to a limit."""
    (p, q), ratio = limit.direction, limit.ratio or 1.0
    return (t**p, 1 / ratio) if q == 0 else (ratio ** (1 / q) * t**p, t**q)


@pytest.mark.parametrize(("draw", "number"), DRAWN)
def test_nothing_in_the_plane_is_faster(draw: Callable[[Any], Method], number: int | str) -> None:
    """It is attained where it is said to be, or approached and not attained; nothing found elsewhere is lower."""
    method = draw(number)
    (near, there), (far, out_there) = (least_within(method, furthest) for furthest in (1e4, 1e12))
    found, limit = best_point(method), falls_towards(method)
    if found:
        assert min(found.alpha_hat, found.beta_hat) >= 0
        assert limit is None
        level = exact((found.z_abs - 1e-9) / (1 + 1e-6))
        for place in (there, out_there):  # proven, as next to a multiple pole |z_p| is lower by rounding
            assert level < 0 or not converges(method, *map(exact, place.tolist()), level)
        # a double pole at the rounded point is known to the root of rounding, a quadruple one to its fourth root
        allowed = 1e-6 if draw is lookup and number != "ABM2" else 1e-3
        assert float(spectral_radius(method, found.alpha_hat, found.beta_hat)) - found.z_abs < allowed
    elif limit:
        assert limit.z_abs * (1 - 1e-5) - 1e-9 <= far < near
        on_the_way = [float(spectral_radius(method, *on_way(limit, t))) for t in (1e4, 1e8)]
        assert on_the_way[1] == pytest.approx(limit.z_abs, abs=1e-3)
        assert abs(on_the_way[1] - limit.z_abs) < abs(on_the_way[0] - limit.z_abs)
    else:
        assert min(near, far) > 1 - 1e-6
