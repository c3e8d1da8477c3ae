"""Explicit time stepping of a mechanism with Baumgarte feedback, from a method's coefficients.

One generator is written per mechanism and method, in plain arithmetic on named variables: on floats it is the single
run, on numpy arrays a whole batch advances at once.
"""

import math
import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from itertools import islice
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from bezstab.errors import InputError
from bezstab.mechanism.equations import SINGULAR, Mechanism, compiled_source, initial_state, names
from bezstab.methods import (
    LinearMultistep,
    Method,
    Partitioned,
    PredictorCorrector,
    RungeKutta,
    adams_bashforth,
    bezier,
    evaluations,
    lookup,
    steps,
)

Start = Literal["rk4", "ramp", "euler"]
State = tuple[Any, ...]
Gains = tuple[Any, Any]  # 2 alpha (1/s) and beta^2 (1/s^2): floats or arrays
Step = tuple[State, State, Any]
Term = tuple[Fraction, str]
FloatArray = NDArray[np.float64]

BLOWN_UP = 1e9  # SI units: far beyond any mechanism, far below overflow


def stepper_code(mechanism: Mechanism, method: Method) -> str:
    """Return the source of a generator function run(start, h, two_alpha, beta_squared, state, past).

    After each step it yields the new state (q then v), the slope before it (their derivatives) and the least relative
    pivot of S met on the way. `past` holds the earlier (state, slope) pairs, newest first.
    """
    n, back = mechanism.size, range(1, steps(method))
    y, f = [*names("q", n), *names("v", n)], [*names("v", n), *names("a", n)]

    def evaluated(slope: str, at: Fraction = Fraction(0)) -> list[str]:
        """Evaluate the slope at the current q and v, at time t + at h."""
        return [
            f"t = start + (k + {float(at)!r}) * h",
            *mechanism.acceleration_code,
            *(f"{slope}{i} = {source}" for i, source in enumerate(f)),
            "worst_pivot = least(worst_pivot, worst)",
        ]

    def combined(base: Iterable[Term], slopes: Iterable[Term]) -> list[str]:
        """Set q and v to sum a base + h sum b slope."""
        past = [(float(a), name) for a, name in base if a]
        rise = [(float(b), name) for b, name in slopes if b]
        return [
            f"{name} = {' + '.join(f'{a!r} * {old}{i}' for a, old in past)}"
            f" + h * ({' + '.join(f'{b!r} * {slope}{i}' for b, slope in rise) or '0.0'})"
            for i, name in enumerate(y)
        ]

    def multistep(scheme: LinearMultistep, new: str = "") -> list[str]:
        """Take the step of a multistep scheme, the slope called `new` at its end."""
        ys, fs = ["y", *(f"y_{j}_" for j in back)], ["f", *(f"f_{j}_" for j in back)]
        return combined(
            ((-a, name) for a, name in zip(scheme.rho[1:], ys, strict=True)), zip(scheme.sigma, [new, *fs], strict=True)
        )

    lines = ["worst_pivot = 1.0", *(f"y{i} = {name}" for i, name in enumerate(y)), *evaluated("f")]
    one = [(Fraction(1), "y")]
    match method.scheme:
        case LinearMultistep() as scheme:
            lines += multistep(scheme)
        case PredictorCorrector(predictor, corrector):
            lines += [*multistep(predictor), *evaluated("p", Fraction(1)), *multistep(corrector, "p")]
        case RungeKutta(tableau, weights):
            stages = ["f", *(f"stage_{s}_" for s in range(1, len(weights)))]
            for row, stage in list(zip(tableau, stages, strict=True))[1:]:
                lines += [*combined(one, zip(row, stages, strict=True)), *evaluated(stage, sum(row, Fraction(0)))]
            lines += combined(one, zip(weights, stages, strict=True))
        case Partitioned(position, velocity):
            new, old = map(float, position.sigma)
            for i in range(n):
                lines.append(f"v{i} = y{n + i} + h * ({float(velocity.sigma[1])!r} * a{i})")
                lines.append(f"q{i} = y{i} + h * ({old!r} * y{n + i} + {new!r} * v{i})")
    body = "\n".join(lines)
    used = [kind for kind in ("y", "f") if any(f" {kind}_{j}_" in body for j in back)]  # Adams: no past y
    for j in reversed(back):
        newer = f"_{j - 1}_" if j > 1 else ""
        lines += [f"{kind}_{j}_{i} = {kind}{newer}{i}" for kind in used for i in range(2 * n)]
    lines += ["k = k + 1", f"yield {_tuple(y)}, {_tuple(names('f', 2 * n))}, worst_pivot"]
    head = ["def run(start, h, two_alpha, beta_squared, state, past):", " k = 0", f" {_tuple(y)} = state"]
    head += [f" {_tuple(names(f'y_{j}_', 2 * n))}, {_tuple(names(f'f_{j}_', 2 * n))} = past[{j - 1}]" for j in back]
    return "\n".join([*head, " while True:", *(f"  {line}" for line in lines)])


def _tuple(entries: Iterable[str]) -> str:
    return f"({', '.join(entries)},)"


@dataclass(frozen=True)
class Trajectory:
    """A run: t (s, shape (steps + 1,)), q and v (shape (steps + 1, n), SI), and why it ended early, if it did.

    `evaluations` counts right-hand sides. `failure` says when and why in one line; the history ends before it.
    `least_pivot` is the least relative pivot of S = C_q M^-1 C_q^T that was met, in the step from `pivot_time` (s):
    where it is small a singular configuration is near, and multipliers have lost about that factor of their digits.
    """

    mechanism: Mechanism
    method: Method
    t: FloatArray
    q: FloatArray
    v: FloatArray
    evaluations: int
    failure: str | None
    least_pivot: float
    pivot_time: float


def simulate(
    mechanism: Mechanism,
    method: Method,
    h: float,
    duration: float,
    gains: tuple[float, float],
    state: tuple[FloatArray, FloatArray] | None = None,
    start: Start = "rk4",
) -> Trajectory:
    """Return the run from `state` (q, v; default the scene's initial one) with feedback 2 alpha, beta^2 (1/s, 1/s^2).

    A step of the method lasts h (s) times its step multiple. The first values of a multistep method come from RK4, from
    its family's members of fewer steps ("ramp") or from explicit Euler. A blow-up, a singular S or a number that is
    not finite ends the run. InputError for a start that has blown up before.
    """
    h = h * float(method.step_multiple)
    total = round(duration / h)
    q, v = initial_state(mechanism) if state is None else state
    history: list[State] = [(*q.tolist(), *v.tolist())]
    if not sum(map(abs, history[0])) < BLOWN_UP:
        raise InputError(f"the start: {_failure(1.0)}")
    failure, pivot, pivot_step = None, 1.0, 0
    try:
        for y, _, worst in islice(march(mechanism, method, h, gains, history[0], start, math), total):
            if not (sum(map(abs, y)) < BLOWN_UP and worst > SINGULAR):  # not a number included
                failure = _failure(worst)
                break
            if worst < pivot:
                pivot, pivot_step = worst, len(history) - 1
            history.append(y)
    except (OverflowError, ValueError, ZeroDivisionError) as error:
        failure = f"arithmetic broke down ({error})"
    taken = len(history) - 1
    if failure:
        failure, taken = f"at t = {len(history) * h:.6g} s: {failure}", taken + 1
    spent = [evaluations(starter) for starter, number in _starters(method, start) for _ in range(number)][:taken]
    count = sum(spent) + (taken - len(spent)) * evaluations(method)
    rows = np.array(history, dtype=np.float64)
    t = np.arange(len(rows), dtype=np.float64) * h
    q, v = rows[:, : mechanism.size], rows[:, mechanism.size :]
    return Trajectory(mechanism, method, t, q, v, count, failure, pivot, pivot_step * h)


def march(
    mechanism: Mechanism, method: Method, h: float, gains: Gains, state: State, start: Start, library: Any
) -> Iterator[Step]:
    """Yield step after step from `state` on, as `stepper_code` does; h (s) is the whole step of the method.

    With `library` math on floats; with numpy on arrays of any broadcastable shapes, gains included.
    """
    history, slopes = [state], list[State]()
    for starter, number in _starters(method, start):
        for y, slope, worst in islice(resume(mechanism, starter, h, gains, history, slopes, library), number):
            history.append(y)
            slopes.append(slope)
            yield y, slope, worst
    yield from resume(mechanism, method, h, gains, history, slopes, library)


def resume(
    mechanism: Mechanism,
    method: Method,
    h: float,
    gains: Gains,
    history: Sequence[State],
    slopes: Sequence[State],
    library: Any,
) -> Iterator[Step]:
    """Yield the steps after `history`, which starts at t = 0 and whose last state may have been tampered with."""
    past = [(history[-2 - j], slopes[-1 - j]) for j in range(steps(method) - 1)]
    stepper = _compiled_stepper(mechanism, method, library)
    return stepper((len(history) - 1) * h, h, *gains, history[-1], past)


@cache
def _compiled_stepper(mechanism: Mechanism, method: Method, library: Any) -> Callable[..., Iterator[Step]]:
    run: Callable[..., Iterator[Step]] = compiled_source(stepper_code(mechanism, method), library)["run"]
    return run


def _failure(worst: float) -> str:
    """Return why a run cannot go on: its least relative pivot of S was `worst`."""
    if worst <= SINGULAR:
        return f"singular configuration: C_q M^-1 C_q^T has lost its rank (relative pivot {worst:.2g})"
    return f"blow-up: the coordinates and velocities exceed {BLOWN_UP:g} in sum, or are not finite"


def _starters(method: Method, start: Start) -> list[tuple[Method, int]]:
    """Return the methods, each with its number of steps, that provide a multistep method's first values."""
    needed = steps(method) - 1
    if start == "ramp":
        family = bezier if re.fullmatch(r"B\d+.*", method.name) else adams_bashforth
        return [(family(n), 1) for n in range(1, needed + 1)]
    return [(lookup("RK4" if start == "rk4" else "RK1"), needed)] if needed else []
