"""What is left of the digits at the extremes: each check states beforehand what must come out, then looks.

References have fifty digits: roots by Newton's method in mpmath (which comes with sympy), from starts that must lead to
as many different roots as there are; multipliers by the generated code in that arithmetic.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import partial
from itertools import islice, product

import mpmath as mp
import numpy as np

from bezstab.errors import NumericalError
from bezstab.mechanism import (
    compiled_mechanism,
    constraint_errors,
    initial_state,
    load_scene,
    march,
    multipliers_function,
    observe,
    perturbed_state,
    simulate,
)
from bezstab.methods import LinearMultistep, Method, coefficient_table, feedback_matrix, lookup, steps
from bezstab.stability import EPS, describe_point, poles, region, spectral_radius, verdict
from bezstab.units import feedback_gains

DIGITS = 100  # of the arithmetic: differences of squares of two float64 cancel up to 32 of them
SAME = mp.mpf(10) ** -40  # relative: iterates nearer than this have found one and the same root
EXPECTED = "15 less those of each pole's condition number"
AT_BEST = 15.0  # digits of a pole of condition number one
UNDERFLOW = 2.3e-308  # what float64 no longer holds to all digits
SIZES = {False: (1e-300, 1e-10, 1.0, 1e300), True: (1e-300, 1e-150, 1e-10, 1.0, 1e10, 1e150, 1e300)}
METHODS = {
    False: ("B2", "B4", "B12", "AB4", "ABM4", "RK4", "SYM"),
    True: (
        *(f"B{n}" for n in range(1, 13)),
        *(f"AB{n}" for n in range(2, 9)),
        "ABM2",
        "ABM3",
        "ABM4",
        "RK4",
        "SIE",
        "SYM",
    ),
}
ON_THE_EDGE = (("SYM", "1", "2"), ("AB2", "3/2", "1/2"), ("RK1", "6/11", "6/11"))
A_TRIFLE = Fraction(1, 10**20)
H, POINT = 1e-3, (0.3, 0.04)  # s; inside every region but those of AB6 and up
STIFF = Fraction(5000)  # 1/s, alpha = beta: so strong that truncation errors stay far below the kick
KICK = 1e-6  # m
OF_THE_BOUNDARY = (0.5, 0.9, 0.99, 1.01, 1.1, 2.0, 10.0)
SPEEDS = (0, 10, 100, 300, 1000, 3000)  # rpm
RATIOS = tuple(10.0**k for k in range(-6, 7, 2))
SINGULAR_ANGLE = np.pi / 2  # of the crank, where the equal slider-crank's slider meets the pivot


@dataclass(frozen=True)
class Check:
    """A case, what must come out, stated beforehand, what came out, and whether that held."""

    group: str
    case: str
    expected: str
    seen: str
    held: bool


def extreme_checks(full: bool) -> Iterator[Callable[[], Check]]:
    """Yield every check, to be called; without `full` fewer methods and shorter runs."""
    for name in METHODS[full]:
        yield partial(_sizes, lookup(name), SIZES[full])
        yield partial(_double_mu, lookup(name))
        yield partial(_boundary, lookup(name))
        if isinstance(lookup(name).scheme, LinearMultistep) and steps(lookup(name)) > 1:
            yield partial(_double_root, lookup(name))
    yield _triple_root
    for edge in ON_THE_EDGE:
        yield partial(_edge, *edge)
    for name in ("B4", "AB4", "SYM"):
        yield partial(_long_run, name, 10**7 if full else 10**5, True)
    yield partial(_long_run, "B4", 10**7 if full else 10**5, False)
    for name, times in product(("B4", "AB4", "RK4", "SYM"), OF_THE_BOUNDARY):
        yield partial(_step, name, times)
    for h in (1e-2, 1e-3, 1e-4)[: 3 if full else 2]:
        yield partial(_passage, h)
    yield _on_the_singularity
    for rpm in SPEEDS:
        yield partial(_speed, rpm)
    for ratio in RATIOS:
        yield partial(_masses, ratio)


def _exact(value: Fraction) -> mp.mpf:
    return mp.mpf(value.numerator) / value.denominator


def _digits(method: Method, alpha_hat: float, beta_hat: float) -> tuple[float, float]:
    """Return how many digits the poles keep, at worst, and by how many, at worst, that beats their condition numbers.

    NumericalError if the references are not all the roots.

    Relative to each pole; to 1 where |z| < 1 for a one-step method, whose z = R(mu) is a difference there. Where a
    coefficient of pi underflows only the pole next to 1 counts.
    """
    found = [mp.mpc(z) for z in poles(method, alpha_hat, beta_hat).tolist()]
    with mp.workdps(DIGITS):
        (a, b), (c, d) = (map(_exact, row) for row in feedback_matrix(method))
        x, y = mp.mpf(alpha_hat), mp.mpf(beta_hat)
        half, product_of_mu = (a * x + b * y) / 2, c * x + d * y
        root = mp.sqrt(half**2 - product_of_mu)
        far = -(half + root) if half >= 0 else root - half
        table = [[_exact(entry) for entry in row] for row in coefficient_table(method)]
        found_out = []
        for mu in (far, product_of_mu / far)[: 1 if mp.im(far) else 2]:  # a conjugate pair has conjugate poles
            polynomial = [mp.polyval(row[::-1], mu) for row in table][::-1]
            if min(abs(c) * abs(mu) ** j for row in table for j, c in enumerate(row) if c) < UNDERFLOW:
                one = _polished(polynomial, mp.mpc(1)) or mp.nan
                pairs = [(min(found, key=lambda z: abs(z - one)), one)]
            else:
                pairs = [(found[k], z) for k, z in _all_roots(polynomial, found).items()]
            for seen, z in pairs:
                error = abs(seen - z) / max(abs(z), mp.mpf(len(table) == 2))
                terms = (abs(c) * abs(z) ** k * abs(mu) ** j for k, row in enumerate(table) for j, c in enumerate(row))
                slope = mp.polyval(polynomial, z, derivative=True)[1]
                lost = mp.log10(max(1 if len(table) == 2 else sum(terms) / abs(z * slope), 1))
                found_out.append((float(-mp.log10(max(error, mp.mpf(10) ** -17))), AT_BEST - float(lost)))
        return min(digits for digits, _ in found_out), min(digits - needed for digits, needed in found_out)


def _all_roots(polynomial: Sequence[mp.mpf], starts: Sequence[mp.mpc]) -> dict[int, mp.mpc]:
    """Return every root by the number of the start that is nearest to it, relative to its size."""
    reached = {k: root for k, z in enumerate(starts) if (root := _polished(polynomial, z)) is not None}
    roots: dict[int, mp.mpc] = {}
    for k in sorted(reached, key=lambda k: abs(starts[k] - reached[k]) / (abs(reached[k]) or 1)):
        if all(abs(reached[k] - other) > SAME * abs(other) for other in roots.values()):
            roots[k] = reached[k]
    if len(roots) < len(polynomial) - 1:
        raise NumericalError(f"only {len(roots)} of {len(polynomial) - 1} roots were found")
    return dict(islice(roots.items(), len(polynomial) - 1))


def _polished(polynomial: Sequence[mp.mpf], z: mp.mpc) -> mp.mpc | None:
    """Return the root that Newton's method reaches from z, at the precision in force; None from too far away."""
    for _ in range(DIGITS * 4):  # quadratic, but linear on the way out of a cluster
        value, slope = mp.polyval(polynomial, z, derivative=True)
        step = value / (slope or mp.mpc(1, 1))  # a start on a saddle is moved off it
        z -= step
        if abs(step) <= mp.mpf(10) ** (10 - DIGITS) * abs(z):
            return z
    return None


def _sizes(method: Method, sizes: Sequence[float]) -> Check:
    group, expected = "α̂, β̂ from 1e-300 to 1e300", f"{EXPECTED}, or overflow reported"
    found, refused = [], 0
    for point in product(sizes, sizes):
        try:
            found.append((*_digits(method, *point), point))
        except NumericalError as error:
            if "leaves the range" not in str(error):
                return Check(group, method.name, expected, f"{error} at {point}", held=False)
            refused += 1
    digits, _, (a, b) = min(found)
    seen = f"{digits:.1f} digits at ({a:g}, {b:g}); {refused} of {len(sizes) ** 2} reported as overflow"
    return Check(group, method.name, expected, seen, min(margin for _, margin, _ in found) >= 0)


def _root_check(group: str, method: Method, point: tuple[float, float], least: float) -> Check:
    digits, margin = _digits(method, *point)
    case, expected = f"{method.name} at ({point[0]:.6g}, {point[1]:.6g})", f"{least:g} digits, and {EXPECTED}"
    return Check(group, case, expected, f"{digits:.1f} digits", digits >= least and margin >= 0)


def _double_mu(method: Method) -> Check:
    return _root_check("double μ: α̂² = 4β̂", method, (0.25, 0.015625), 12.0)


def _double_root(method: Method) -> Check:
    """At d mu/dz = 0, rho' sigma = rho sigma', two roots meet; rounding alpha_hat, beta_hat parts them by 1e-8."""
    assert isinstance(method.scheme, LinearMultistep)
    rho, sigma = (np.array(part, float) for part in (method.scheme.rho, method.scheme.sigma))
    branch = np.roots(np.polysub(np.polymul(np.polyder(rho), sigma), np.polymul(rho, np.polyder(sigma))))
    mu = np.polyval(rho, branch) / np.polyval(sigma, branch)
    chosen = mu[np.argmax(np.abs(mu) * np.isfinite(mu) * (np.abs(mu) < 1e3) * (np.abs(branch) > 1e-3))]
    return _root_check("double root z", method, (-2 * float(chosen.real), float(abs(chosen) ** 2)), 5.0)


def _triple_root() -> Check:
    """pi(z, -1/2) = (z - 1/2)^3 at alpha_hat = 1, beta_hat = 1/4, exactly."""
    rho, sigma = (tuple(map(Fraction, text.split())) for text in ("1 -7/4 3/4 0", "0 1/2 0 -1/4"))
    z = poles(Method("triple", LinearMultistep(rho, sigma), "constructed"), 1.0, 0.25)
    digits = float(-np.log10(np.abs(z - 0.5).max() / 0.5))
    return Check("triple root z", "(z - 1/2)³ twice", "4.5 digits", f"{digits:.1f} digits", digits >= 4.5)


def _boundary(method: Method) -> Check:
    near = 1e-3 if method.name.startswith("ABM") else 1e-6 if steps(method) > 6 else 1e-7
    points = np.concatenate(region(method).boundary or (np.zeros((1, 2)),))[::7]
    off = float(np.abs(spectral_radius(method, *points.T) - 1).max())
    return Check("on the boundary", method.name, f"|z_p| = 1 to {near:g}", f"to {off:.0e}", off <= near)


def _edge(name: str, alpha: str, beta: str) -> Check:
    a, b, method = Fraction(alpha), Fraction(beta), lookup(name)
    seen = {verdict(method, a, b), verdict(method, a, b + A_TRIFLE), verdict(method, a, b - A_TRIFLE)}
    expected = "three verdicts at β̂, β̂ ± 1e-20, that of β̂ not converges"
    held = len(seen) >= 2 and verdict(method, a, b) != "converges"
    return Check("on the boundary", f"{name} at ({alpha}, {beta})", expected, ", ".join(sorted(seen)), held)


def _long_run(name: str, count: int, stabilized: bool) -> Check:
    moving, method = compiled_mechanism(load_scene("slider_crank")), lookup(name)
    feedback = feedback_gains(*POINT, H) if stabilized else (0.0, 0.0)
    q, v = initial_state(moving)
    tenth, largest = count // 10, np.zeros(10)
    run = march(moving, method, H, feedback, (*q.tolist(), *v.tolist()), "rk4", math)
    for k, (y, _, _) in enumerate(islice(run, count)):
        if k % 97 == 0:
            c = float(np.abs(constraint_errors(moving, 0.0, y[: moving.size])).max())
            largest[k // tenth] = max(largest[k // tenth], c)
    growth = float(largest[-1] / largest[0])
    case = f"{name}, {count:.0e} steps{'' if stabilized else ', no feedback'}"
    seen = f"largest |c| in the last tenth {growth:.2g} times that in the first, {largest[-1]:.0e} m"
    expected = "no growth of |c|: at most 1.5 times" if stabilized else "|c| grows: at least fivefold"
    return Check("long runs", case, expected, seen, growth <= 1.5 if stabilized else growth >= 5)


def _step(name: str, times: float) -> Check:
    method, moving = lookup(name), compiled_mechanism(load_scene("slider_crank"))
    start = Fraction(1, 10**5)
    margins = describe_point(method, "", 2 * STIFF * start, (STIFF * start) ** 2).margins
    assert margins
    h = times * margins.h * float(start)
    feedback = (2 * float(STIFF), float(STIFF) ** 2)
    run, calm = (simulate(moving, method, h, 3000 * h, feedback, perturbed_state(moving, kick)) for kick in (KICK, 0.0))
    end = min(len(run.t), len(calm.t)) - 1
    kicked, forced = (constraint_errors(moving, 0.0, each.q[end].tolist()) for each in (run, calm))
    left = float(np.abs(kicked - forced).max())
    seen = run.failure or f"what the kick of {KICK:g} m changes in c: {left:.0e} m"
    case = f"{name}, {times:g} of the largest"
    if times < 1:
        return Check("steps", case, "the kick's effect on c falls below a hundredth", seen, left < KICK / 100)
    held = run.failure is not None or left > 100 * KICK
    return Check("steps", case, "it grows a hundredfold, or failure reported", seen, held)


def _passage(h: float) -> Check:
    """The crank turns through the singular angle: the run must name the step in which it came nearest."""
    moving = compiled_mechanism(load_scene("slider_crank_equal"))
    run = simulate(moving, lookup("B4"), h, 2.0, feedback_gains(*POINT, h))
    passed = float(np.interp(SINGULAR_ANGLE, run.q[:, 0], run.t))
    seen = run.failure or f"least pivot {run.least_pivot:.0e} at t = {run.pivot_time:.4g} s (passed at {passed:.4g} s)"
    held = run.failure is not None or (run.least_pivot < h and abs(run.pivot_time - passed) <= 2 * h)
    expected = f"failure, or a least pivot below {h:g} in the step of the passage reported"
    return Check("singular configuration", f"passed at h = {h:g} s", expected, seen, held)


def _on_the_singularity() -> Check:
    moving = compiled_mechanism(load_scene("slider_crank_equal"))
    state = np.array([np.pi / 2, 0.0, 0.175, -np.pi / 2, 0.0]), np.zeros(5)
    failure = simulate(moving, lookup("B4"), H, 0.1, (0.0, 0.0), state).failure
    held = failure is not None and "singular configuration" in failure
    return Check("singular configuration", "started in it", "failure reported", failure or "no failure", held)


def _speed(rpm: int) -> Check:
    h, rate = 1e-4, rpm * np.pi / 30
    moving = compiled_mechanism(replace(load_scene("slider_crank"), velocity={"crank.theta": rate}))
    feedback = feedback_gains(*POINT, h)
    run = simulate(moving, lookup("B4"), h, 0.5, feedback)
    c = float(np.abs(observe(moving, run.t, run.q, run.v, *feedback).c).max())
    allowed = 100 * (h * max(rate, 10.0)) ** 3  # m: local errors of order three, amplified by 1 / beta_hat = 25
    expected = f"no failure, |c| at most {allowed:.0e} m"
    seen = run.failure or f"|c| at most {c:.0e} m"
    return Check("crank speeds", f"{rpm} rpm, h = {h:g} s", expected, seen, run.failure is None and c <= allowed)


def _masses(ratio: float) -> Check:
    """Multipliers in float64 against the same elimination in a hundred digits."""
    scene = load_scene("slider_crank")
    *others, slider = scene.bodies
    mechanism = compiled_mechanism(replace(scene, bodies=(*others, replace(slider, mass=ratio * others[-1].mass))))
    two_alpha, beta_squared = feedback_gains(*POINT, H)
    q, v = initial_state(mechanism)
    state = np.concatenate((q, v)).tolist()
    elimination = multipliers_function(mechanism, mp.mp)

    def precise_multipliers(entries: Sequence[mp.mpf]) -> Sequence[mp.mpf]:
        precise = [mp.mpf(entry) for entry in entries]
        return elimination(
            mp.mpf(0), mp.mpf(two_alpha), mp.mpf(beta_squared), precise[: mechanism.size], precise[mechanism.size :]
        )

    def shown_digits(relative_error: mp.mpf) -> float:
        return float(-mp.log10(max(relative_error, mp.mpf(10) ** -17)))

    with mp.workdps(DIGITS):
        exact = precise_multipliers(state)
        largest = max(abs(multiplier) for multiplier in exact)
        moved = mp.mpf(0)
        for k, value in enumerate(state):  # by one rounding
            nearby = [*state[:k], value * (1 + EPS), *state[k + 1 :]]
            other = precise_multipliers(nearby)
            moved += max(abs(a - b) for a, b in zip(other, exact, strict=True))
        seen = observe(mechanism, np.zeros(1), q[np.newaxis], v[np.newaxis], two_alpha, beta_squared)
        floats = seen.multipliers[0].tolist()
        error = max(abs(a - b) for a, b in zip(floats, exact, strict=True))
        digits = shown_digits(error / largest)
        needed = shown_digits(10 * moved / largest)
    expected = f"{needed:.1f} digits of λ: what ten roundings of the state leave"
    return Check("mass ratios", f"slider {ratio:g} of the rod", expected, f"{digits:.1f}", digits >= needed)
