"""What is left of the digits at the extremes: each check states beforehand what must come out, then looks.

References have a hundred digits: roots by Newton's method (`root_digits`), multipliers by the generated code in that
arithmetic.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import partial
from itertools import product

import mpmath as mp
import numpy as np

from bezstab.errors import NumericalError
from bezstab.evidence.kicks import kicked_fates
from bezstab.evidence.root_digits import DIGITS, PoleDigits, pole_digits
from bezstab.mechanism import (
    compiled_mechanism,
    constraint_errors,
    even_steps,
    initial_state,
    load_scene,
    march,
    observe,
    runs_compiled,
    simulate,
    state_function,
)
from bezstab.methods import LinearMultistep, Method, lookup, rho_and_sigma, steps
from bezstab.stability import critical_damping_limit, poles
from bezstab.units import feedback_gains

EXPECTED = "15 less those of each pole's condition number"

SHORT_METHODS = ("B2", "B4", "B12", "AB4", "ABM4", "RK4", "SYM")
ALL_METHODS = (
    *(f"B{n}" for n in range(1, 13)),
    *(f"AB{n}" for n in range(2, 9)),
    *("ABM2", "ABM3", "ABM4", "RK4", "SIE", "SYM"),
)

SHORT_SIZES = (1e-300, 1e-10, 1.0, 1e300)
ALL_SIZES = (1e-300, 1e-150, 1e-10, 1.0, 1e10, 1e150, 1e300)
"""Of alpha_hat and beta_hat, in every pairing: to both ends of float64's range."""

H = 1e-3
"""s"""

POINT = (0.3, 0.04)
"""alpha_hat, beta_hat: inside every region but those of AB6 and up."""

STIFF = 5000.0
"""1/s, alpha = beta: so strong that the largest steps are still small for the motion."""

OF_THE_BOUNDARY = (0.5, 0.9, 0.99, 1.01, 1.1, 2.0, 10.0)
"""Times the largest stable step."""

SPEEDS = (0, 10, 100, 300, 1000, 3000)
"""rpm"""

RATIOS = tuple(10.0**k for k in range(-6, 7, 2))
"""Of the slider's mass to the rod's."""

SINGULAR_ANGLE = np.pi / 2
"""Of the crank, where the equal slider-crank's slider meets the pivot."""

ROUNDING_OF_RUNS = 1e-14
"""m: |c| of a run that is exact but for the rounding of coordinates of half a metre, some hundred times."""

PASSAGE_STEPS = (1e-2, 1e-3, 1e-4)
"""s, of runs through the singular configuration; the last takes longest."""


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
    sizes = ALL_SIZES if full else SHORT_SIZES
    for method in map(lookup, ALL_METHODS if full else SHORT_METHODS):
        if method.scheme.mu_table:  # whose poles are judged by pi(z, mu)
            yield partial(_sizes, method, sizes)
            # there both mu are one, and so are the poles of each, pair by pair
            yield partial(_root_check, "double μ: α̂² = 4β̂", method, (0.25, 0.015625), 12.0)
        if steps(method) > 1 and (mapping := rho_and_sigma(method)):
            yield partial(_double_root, method, *mapping)
    yield _triple_root
    count = 10**7 if full else 10**5
    for name in ("B4", "AB4", "SYM"):
        yield partial(_long_run, name, count, stabilized=True)
    yield partial(_long_run, "B4", count, stabilized=False)
    for name, times in product(("B4", "AB4", "RK4", "SYM"), OF_THE_BOUNDARY):
        yield partial(_step, name, times)
    for h in PASSAGE_STEPS if full else PASSAGE_STEPS[:2]:
        yield partial(_passage, h)
    yield _on_the_singularity
    for rpm in SPEEDS:
        yield partial(_speed, rpm)
    for ratio in RATIOS:
        yield partial(_masses, ratio)


def _sizes(method: Method, sizes: Sequence[float]) -> Check:
    """Poles at every pair of sizes keep what their condition numbers leave, or are reported to overflow."""
    group, expected = "α̂, β̂ from 1e-300 to 1e300", f"{EXPECTED}, or overflow reported"
    found: list[tuple[PoleDigits, tuple[float, float]]] = []
    refused = 0
    for point in product(sizes, sizes):
        try:
            found.append((pole_digits(method, *point), point))
        except NumericalError as error:
            if "leaves the range" not in str(error):
                return Check(group, method.name, expected, f"{error} at {point}", held=False)
            refused += 1
    worst, (a, b) = min(found, key=lambda pair: (pair[0].digits, pair[0].margin, pair[1]))
    seen = f"{worst.digits:.1f} digits at ({a:g}, {b:g}); {refused} of {len(sizes) ** 2} reported as overflow"
    held = min(kept.margin for kept, _ in found) >= 0
    return Check(group, method.name, expected, seen, held)


def _root_check(group: str, method: Method, point: tuple[float, float], least: float) -> Check:
    """Poles at one point keep at least so many digits, and what their condition numbers leave."""
    kept = pole_digits(method, *point)
    return Check(
        group=group,
        case=f"{method.name} at ({point[0]:.6g}, {point[1]:.6g})",
        expected=f"{least:g} digits, and {EXPECTED}",
        seen=f"{kept.digits:.1f} digits",
        held=kept.digits >= least and kept.margin >= 0,
    )


def _double_root(method: Method, *mapping: Sequence[Fraction]) -> Check:
    """At d mu/dz = 0, rho' sigma = rho sigma', two roots meet; rounding alpha_hat, beta_hat parts them by 1e-8."""
    rho, sigma = (np.array(part[::-1], float) for part in mapping)
    branch = np.roots(np.polysub(np.polymul(np.polyder(rho), sigma), np.polymul(rho, np.polyder(sigma))))
    mu = np.polyval(rho, branch) / np.polyval(sigma, branch)
    # Where a branch point is a root at 0, or mu is infinite or huge, nothing is to be learnt.
    usable = (np.abs(mu) < 1e3) & (np.abs(branch) > 1e-3)
    chosen = mu[np.argmax(np.where(usable, np.abs(mu), 0))]
    point = (-2 * float(chosen.real), float(abs(chosen) ** 2))  # alpha_hat = -2 Re mu, beta_hat = |mu|^2
    return _root_check("double root z", method, point, 5.0)


def _triple_root() -> Check:
    """pi(z, -1/2) = (z - 1/2)^3 at alpha_hat = 1, beta_hat = 1/4, exactly: rounding parts the three by 1e-5."""
    rho, sigma = (tuple(map(Fraction, text.split())) for text in ("1 -7/4 3/4 0", "0 1/2 0 -1/4"))
    z = poles(Method("triple", LinearMultistep(rho, sigma), "constructed"), 1.0, 0.25)
    digits = float(-np.log10(np.abs(z - 0.5).max() / 0.5))
    return Check("triple root z", "(z - 1/2)³ twice", "4.5 digits", f"{digits:.1f} digits", digits >= 4.5)


def _long_run(name: str, count: int, stabilized: bool) -> Check:
    """Over millions of steps c does not grow with feedback, and does without."""
    mechanism, method = compiled_mechanism(load_scene("slider_crank")), lookup(name)
    gains = feedback_gains(*POINT, H) if stabilized else (0.0, 0.0)
    start, compiled = np.concatenate(initial_state(mechanism)), runs_compiled(method, count)
    every_step = even_steps(H, count, gains)
    blocks = march(mechanism, method, every_step, start, compiled=compiled)  # whose states need not be kept
    positions = (block.states[:, : mechanism.size].T for block in blocks)
    sizes = np.concatenate([np.abs(constraint_errors(mechanism, 0.0, q)).max(axis=0) for q in positions])
    at_first, at_last = sizes[: count // 10].max(), sizes[-count // 10 :].max()
    growth = at_last / max(at_first, ROUNDING_OF_RUNS)
    return Check(
        group="long runs",
        case=f"{name}, {count:.0e} steps{'' if stabilized else ', no feedback'}",
        expected="no growth of |c|: at most 1.5 times" if stabilized else "|c| grows: at least fivefold",
        seen=f"largest |c| in the last tenth {growth:.2g} times that in the first, {at_last:.0e} m",
        held=bool(growth <= 1.5 if stabilized else growth >= 5),
    )


def _step(name: str, times: float) -> Check:
    """With alpha and beta in 1/s held, a kick decays below the largest stable step and grows above it."""
    method = lookup(name)
    limit = critical_damping_limit(method)
    assert limit
    h = times * limit / STIFF
    point = (np.array([2 * h * STIFF]), np.array([(h * STIFF) ** 2]))
    grows, undecided = kicked_fates(compiled_mechanism(load_scene("slider_crank")), method, h, *point, 3000)
    expected = "a kick's error grows" if times > 1 else "a kick's error decays"
    seen = "neither" if undecided[0] else "a kick's error grows" if grows[0] else "a kick's error decays"
    return Check("steps", f"{name}, {times:g} of the largest", expected, seen, seen == expected)


def _passage(h: float) -> Check:
    """The crank turns through the singular angle: the run must name the step in which it came nearest."""
    mechanism = compiled_mechanism(load_scene("slider_crank_equal"))
    run = simulate(mechanism, lookup("B4"), h, 2.0, feedback_gains(*POINT, h))
    passed = float(np.interp(SINGULAR_ANGLE, run.q[:, 0], run.t))
    near_the_passage = run.least_pivot < h and abs(run.pivot_time - passed) <= 2 * h
    return Check(
        group="singular configuration",
        case=f"passed at h = {h:g} s",
        expected=f"failure, or a least pivot below {h:g} in the step of the passage reported",
        seen=run.failure
        or f"least pivot {run.least_pivot:.0e} at t = {run.pivot_time:.4g} s (passed at {passed:.4g} s)",
        held=run.failure is not None or near_the_passage,
    )


def _on_the_singularity() -> Check:
    """A run that starts in the singular configuration fails and says why."""
    mechanism = compiled_mechanism(load_scene("slider_crank_equal"))
    state = np.array([np.pi / 2, 0.0, 0.175, -np.pi / 2, 0.0]), np.zeros(5)
    failure = simulate(mechanism, lookup("B4"), H, 0.1, (0.0, 0.0), state).failure
    held = failure is not None and "singular configuration" in failure
    return Check("singular configuration", "started in it", "failure reported", failure or "no failure", held)


def _speed(rpm: int) -> Check:
    """However fast the crank turns, c stays within what truncation errors of order three make of it."""
    h, rate = 1e-4, rpm * np.pi / 30
    mechanism = compiled_mechanism(replace(load_scene("slider_crank"), velocity={"crank.theta": rate}))
    gains = feedback_gains(*POINT, h)
    run = simulate(mechanism, lookup("B4"), h, 0.5, gains)
    c = observe(mechanism, run.t, run.q, run.v, *gains).c_max
    allowed = 100 * (h * max(rate, 10.0)) ** 3  # m: local errors of order three, amplified by 1 / beta_hat = 25
    return Check(
        group="crank speeds",
        case=f"{rpm} rpm, h = {h:g} s",
        expected=f"no failure, |c| at most {allowed:.0e} m",
        seen=run.failure or f"|c| at most {c:.0e} m",
        held=run.failure is None and c <= allowed,
    )


def _masses(ratio: float) -> Check:
    """Multipliers in float64 against the same elimination in a hundred digits; rounding the state costs them five."""
    scene = load_scene("slider_crank")
    *others, slider = scene.bodies
    mechanism = compiled_mechanism(replace(scene, bodies=(*others, replace(slider, mass=ratio * others[-1].mass))))
    gains, m = feedback_gains(*POINT, H), len(mechanism.constraints)
    q, v = initial_state(mechanism)
    seen = observe(mechanism, np.zeros(1), q[np.newaxis], v[np.newaxis], *gains).multipliers[0]
    with mp.workdps(DIGITS):
        precise = list(map(mp.mpf, (0, *gains, *q.tolist(), *v.tolist())))
        found = state_function(mechanism, "observations", mp.mp)(precise)
        exact = found[2 * m : 3 * m]
        error = max(abs(a - b) for a, b in zip(seen.tolist(), exact, strict=True))
        digits = float(-mp.log10(error / max(map(abs, exact)) + mp.mpf(10) ** -17))
    return Check("mass ratios", f"slider {ratio:g} of the rod", "11 digits of λ", f"{digits:.1f}", digits >= 11)
