"""What is left of the digits at the extremes: each kind of check says beforehand what must come out, then looks.

Run by `make extremes`, it writes figures/extremes.md, what held of all cases, in minutes.

References have a hundred digits: roots by mpmath, multipliers by the generated code in that arithmetic.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import product
from pathlib import Path
from typing import Any

import mpmath as mp
import numpy as np

from bezstab.errors import NumericalError
from bezstab.mechanism.compiled_stepping import runs_compiled
from bezstab.mechanism.equations import compiled_mechanism
from bezstab.mechanism.generated_code import state_function
from bezstab.mechanism.observation import observe
from bezstab.mechanism.programs import even_steps
from bezstab.mechanism.runner import march, simulate
from bezstab.mechanism.scene_files import load_scene
from bezstab.mechanism.simulation import simulated
from bezstab.mechanism.start import constraint_errors, initial_state
from bezstab.methods.registry import lookup
from bezstab.runs.kicks import kicked_fates
from bezstab.stability.closed_loop import poles
from bezstab.stability.path_ends import critical_damping_limit
from bezstab.units import feedback_gains
from tests.reference.fifty_digit_poles import EPS, poles_with_errors

DIGITS = 100
H = 1e-3  # s
POINT = (0.3, 0.04)  # alpha_hat, beta_hat: inside every region but those of AB6 and up
STIFF = 5000.0  # 1/s, alpha = beta: so strong that the largest steps are still small for the motion
SINGULAR_ANGLE = np.pi / 2  # of the crank, where the equal slider-crank's slider meets the pivot
ROUNDINGS = 2 * np.finfo(float).eps  # of the largest coordinate: a crank that turned 2000 times leaves |c| = 2e-12 m
MULTISTEP = (*(f"B{n}" for n in range(2, 13)), *(f"AB{n}" for n in range(2, 9)))
SIZES = (1e-300, 1e-150, 1e-10, 1.0, 1e10, 1e150, 1e300)  # of alpha_hat and beta_hat: to both ends of float64's range


@dataclass(frozen=True)
class Found:
    """What came out of a case, in words, and by how much it is better than it must be: below zero it is not."""

    seen: str
    margin: float


@dataclass(frozen=True)
class Extreme:
    """A kind of check: what must come out, what looks, the cases that `make extremes` looks at, and those of tests."""

    what: str
    expected: str
    check: Callable[..., Found]
    cases: Sequence[tuple[Any, ...]]
    sample: Sequence[tuple[Any, ...]]


def sizes_of_parameters(name: str, sizes: Sequence[float] = SIZES) -> Found:
    """Poles at every pair of sizes keep what their condition numbers leave, or are reported to overflow."""
    method, refused, shares = lookup(name), 0, []
    roundings = 1e-15 / EPS / len(method.scheme.mu_table)  # of each coefficient
    for point in product(sizes, sizes):
        try:
            found = poles(method, *point).tolist()
        except NumericalError as error:
            if "leaves the range" not in str(error):
                raise
            refused += 1
            continue
        with mp.workdps(DIGITS):
            pairs = poles_with_errors(method, *point, roundings, found)
            shares += [(float(min(abs(z - each) for each in found) / (off or EPS)), point) for z, off in pairs]
    worst, (a, b) = max(shares)
    seen = f"{worst:.2f} of what is allowed at ({a:g}, {b:g}); {refused} of {len(sizes) ** 2} reported as overflow"
    return Found(seen, 1 - worst)


def long_run(name: str, count: int) -> Found:
    """With feedback c does not grow over millions of steps: the last tenth's largest |c| (m) over the first tenth's.

    What the coordinates' own rounding leaves does not count as growth: that of the crank's angle grows as it turns.
    """
    mechanism, method = compiled_mechanism(load_scene("slider_crank")), lookup(name)
    every_step = even_steps(H, count, feedback_gains(*POINT, H))
    start, compiled = np.concatenate(initial_state(mechanism)), runs_compiled(method, count)
    blocks = march(mechanism, method, every_step, start, compiled=compiled)  # whose states need not be kept
    sizes, largest = [], 0.0
    for q in (block.states[:, : mechanism.size].T for block in blocks):
        sizes.append(np.abs(constraint_errors(mechanism, 0.0, q)).max(axis=0))
        largest = max(largest, np.abs(q).max())
    c = np.concatenate(sizes)
    at_first, at_last = c[: count // 10].max(), c[-count // 10 :].max()
    growth = at_last / max(at_first, ROUNDINGS * largest)
    return Found(f"{growth:.2g} times as much, {at_last:.0e} m", 1.5 - growth)


def step(name: str, times: float) -> Found:
    """With alpha and beta in 1/s held, a kick decays below the largest stable step and grows above it."""
    method = lookup(name)
    limit = critical_damping_limit(method)
    assert limit
    h = times * limit / STIFF
    point = (np.array([2 * h * STIFF]), np.array([(h * STIFF) ** 2]))
    grows, undecided = kicked_fates(compiled_mechanism(load_scene("slider_crank")), method, h, *point, 3000)
    seen = "neither" if undecided[0] else "it grows" if grows[0] else "it decays"
    return Found(seen, 1.0 if seen == ("it grows" if times > 1 else "it decays") else -1.0)


def passage(h: float) -> Found:
    """The crank turns through the singular angle: the run names the step in which it came nearest."""
    mechanism = compiled_mechanism(load_scene("slider_crank_equal"))
    run = simulate(mechanism, lookup("B4"), h, 2.0, feedback_gains(*POINT, h))
    passed = float(np.interp(SINGULAR_ANGLE, run.q[:, 0], run.t))
    seen = f"least pivot {run.least_pivot:.0e} at t = {run.pivot_time:.4g} s (passed at {passed:.4g} s)"
    return Found(seen, min(1 - run.least_pivot / h, 2 - abs(run.pivot_time - passed) / h))


def speed(rpm: int) -> Found:
    """However fast the crank turns, c stays within what truncation errors of order three make of it."""
    h, rate = 1e-4, rpm * np.pi / 30
    mechanism = compiled_mechanism(replace(load_scene("slider_crank"), velocity={"crank.theta": rate}))
    run = simulated(mechanism, lookup("B4"), h=h, duration=0.5, alpha_hat=POINT[0], beta_hat=POINT[1])
    allowed = 100 * (h * max(rate, 10.0)) ** 3  # m: local errors of order three, amplified by 1 / beta_hat = 25
    return Found(run.failure or f"|c| at most {run.c_max:.0e} m", -1.0 if run.failure else 1 - run.c_max / allowed)


def mass_ratio(ratio: float) -> Found:
    """Multipliers in float64 against the same elimination in a hundred digits; rounding the state costs them five."""
    scene = load_scene("slider_crank")
    *others, slider = scene.bodies
    mechanism = compiled_mechanism(replace(scene, bodies=(*others, replace(slider, mass=ratio * others[-1].mass))))
    gains, m = feedback_gains(*POINT, H), len(mechanism.constraints)
    q, v = initial_state(mechanism)
    seen = observe(mechanism, np.zeros(1), q[np.newaxis], v[np.newaxis], *gains).multipliers[0]
    with mp.workdps(DIGITS):
        precise = list(map(mp.mpf, (0, *gains, *q.tolist(), *v.tolist())))
        right = state_function(mechanism, "observations", mp.mp)(precise)[2 * m : 3 * m]
        error = max(abs(a - b) for a, b in zip(seen.tolist(), right, strict=True))
        digits = float(-mp.log10(error / max(map(abs, right)) + mp.mpf(10) ** -17))
    return Found(f"{digits:.1f} digits", digits - 11)


EXTREMES = (
    Extreme(
        "α̂, β̂ from 1e-300 to 1e300, each with each",
        "15 digits less those of each pole's condition number, or overflow reported",
        sizes_of_parameters,
        cases=[(name,) for name in (*MULTISTEP, "B1", "ABM2", "ABM3", "ABM4", "RK4", "SIE")],
        sample=[("B4", (1e-300, 1.0, 1e300)), ("ABM4", (1.0,)), ("RK4", (1e-300, 1e-10, 1.0, 1e300))],
    ),
    Extreme(
        "long runs, by their steps",
        "|c| of the last tenth is at most 1.5 times that of the first, or two roundings of the crank's angle",
        long_run,
        cases=[(name, 10**7) for name in ("B4", "AB4", "SYM")],
        sample=[("B4", 10**5), ("SYM", 10**5)],
    ),
    Extreme(
        "steps, by the largest stable one",
        "a kick's error decays below one, and grows above",
        step,
        cases=list(product(("B4", "AB4", "RK4", "SYM"), (0.5, 0.9, 0.99, 1.01, 1.1, 2.0, 10.0))),
        sample=[("B4", 10.0), ("AB4", 1.01), ("RK4", 0.99), ("SYM", 0.9)],
    ),
    Extreme(
        "a singular configuration passed, by the step (s)",
        "a least pivot below it in the step of the passage",
        passage,
        cases=[(1e-2,), (1e-3,), (1e-4,)],
        sample=[(1e-2,), (1e-3,)],
    ),
    Extreme(
        "cranks, by their speed (rpm)",
        "no failure, and |c| within the truncation error",
        speed,
        cases=[(0,), (10,), (100,), (300,), (1000,), (3000,)],
        sample=[(0,), (3000,)],
    ),
    Extreme(
        "mass ratios",
        "11 digits of the multipliers",
        mass_ratio,
        cases=[(10.0**k,) for k in range(-6, 7, 2)],
        sample=[(1e-6,), (1e6,)],
    ),
)

PAGE = Path(__file__).parents[2] / "figures" / "extremes.md"
HEAD = """# What holds at the extremes

Written by `make extremes`; the slow tests look at a few of each. Each line says what must come out, in how many cases
it did, and which came nearest to failing.

"""


def row(extreme: Extreme) -> str:
    """Return the line about one kind of check, after all of its cases."""
    found = [(case, extreme.check(*case)) for case in extreme.cases]
    held = sum(each.margin >= 0 for _, each in found)
    case, nearest = min(found, key=lambda item: item[1].margin)
    named = ", ".join(str(part) if isinstance(part, str) else f"{part:g}" for part in case)
    return f"- **{extreme.what}:** {extreme.expected}. {held} of {len(found)}; nearest {named}: {nearest.seen}"


if __name__ == "__main__":
    PAGE.write_text(HEAD + "\n".join(map(row, EXTREMES)) + "\n", encoding="utf-8")
