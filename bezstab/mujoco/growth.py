"""Whether errors grow at a state, and what makes them: the step, or the mechanism itself.

    r(h) = ln |z| / h       falls by itself    r keeps its value as h shrinks: at h/2 and h/4 it is no smaller
                            unsafe             a smaller step lessens it

Poles are compared in order, the fastest first. Where a step damps, as MuJoCo's with implicit damping, r rises to its
limit as h shrinks.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np

from bezstab.mujoco.robots import Robot, State
from bezstab.mujoco.steps import NUDGE, step_at
from bezstab.stability.arrays import FloatArray

Kind = Literal["decays", "neutral", "moves on", "falls by itself", "unsafe", "not smooth"]

ROUNDING, SLOW = 1e-6, 0.01
"""Of |z| by differences, and 1/s: what grows by less a step, or by less than a hundredth a second, is neutral."""

SAME_RATE = 0.1
"""Relative: rates that differ by less are one, and what grows so much more slowly than a robot falls is no matter."""

RESOLVED = np.exp(0.5)
"""|z|: what grows faster in a step is not resolved, and its rate no limit, whatever it does as the step shrinks."""

FOLLOWED, MOST_STEPS = 4.0, 4000
"""How often an error becomes e-fold while it is followed in a run, which has at most so many steps. What drifts grows
fivefold meanwhile."""

DOUBLINGS = 10
"""Of the step, or halvings: what is safe a thousand times as long is safe, what is not a thousand times as short is
not."""

BISECTIONS = 10
"""To a thousandth."""


@dataclass(frozen=True, eq=False)
class Growth:
    """What errors do at a state: |z| of a step, None where nothing holds; `rate` (1/s) of what falls by itself.

    `own` are the rates (1/s) at which the mechanism itself falls; None where no small step resolves them.
    """

    kind: Kind
    z_abs: float | None
    rate: float | None = None
    own: FloatArray | None = None


def growth_at(robot: Robot, state: State, own: FloatArray | None = None) -> Growth:
    """Return what errors do around a state.

    `own` are rates (1/s) at which the mechanism may fall, if they are known: what falls no faster needs no other step,
    and what no step resolves, and is faster, is unsafe.
    """
    step = step_at(robot, state)
    if not step.smooth:
        return Growth("not smooth", None)
    moduli = step.moduli()
    none = np.zeros(0)
    if not len(moduli):
        return Growth("neutral", None, own=none)
    z_abs, rates = float(moduli[0]), _rates(moduli, robot.h)
    if z_abs <= 1 or rates[0] <= _least(robot.h):
        return Growth("decays" if z_abs < 1 - ROUNDING else "neutral", z_abs, own=none)
    if own is None or (z_abs < RESOLVED and _exceeds(rates, own, robot.h)):
        own = _own_rates(robot, state, moduli)
    if own is None or _exceeds(rates, own, robot.h):
        return Growth("unsafe", z_abs, own=own)
    return Growth("falls by itself", z_abs, float(rates[0]), own)


def goes_on_growing(robot: Robot, state: State, z_abs: float) -> bool:
    """Return whether a run from a state lets an error grow as its pole says, at least half as fast.

    Where nothing rests, as where a robot falls onto its feet, the motion may soon be one that lets errors shrink. What
    grows within some steps is not run, and neither are controllers outside the model: True.
    """
    mujoco, model = robot.mujoco, robot.model
    if robot.drives or z_abs > RESOLVED:
        return True
    steps = min(MOST_STEPS, round(FOLLOWED / np.log(z_abs)))
    directions = step_at(robot, state).growing()
    if not directions.size:
        return False  # what was left out as a free motion was none to rounding
    direction = NUDGE * directions[:, 0]
    ends = []
    for nudge in (0.0, 1.0):
        data = robot.data_at(state)
        mujoco.mj_integratePos(model, data.qpos, nudge * direction[: model.nv], 1.0)
        data.qvel[:] += nudge * direction[model.nv : 2 * model.nv] / robot.h
        for _ in range(steps):
            mujoco.mj_step(model, data)
        ends.append((data.qpos.copy(), data.qvel * robot.h))
    moved = np.zeros(model.nv)
    mujoco.mj_differentiatePos(model, moved, 1.0, ends[0][0], ends[1][0])
    grown = np.linalg.norm([*moved, *(ends[1][1] - ends[0][1])]) / np.linalg.norm(direction[: 2 * model.nv])
    return bool(grown > z_abs ** (steps / 2))


def _own_rates(robot: Robot, state: State, moduli: FloatArray) -> FloatArray | None:
    """Return at which rates (1/s) the mechanism itself falls: those that are there at half and a quarter of a step.

    The step is halved until it resolves every growing pole; None where none does.
    """
    for halvings in range(DOUBLINGS):
        if not len(moduli) or moduli[0] < RESOLVED:
            break
        moduli = step_at(robot, state, 0.5 ** (halvings + 1)).moduli()
    else:
        return None
    shorter, shortest = (_rates_at(robot, state, 0.5 ** (halvings + more)) for more in (1, 2))
    both = min(len(shorter), len(shortest))
    return np.maximum(shorter[:both], shortest[:both])


def _rates_at(robot: Robot, state: State, factor: float) -> FloatArray:
    return _rates(step_at(robot, state, factor).moduli(), factor * robot.h)


def _rates(moduli: FloatArray, h: float) -> FloatArray:
    return np.asarray(np.log(moduli[moduli > 1]) / h)


def _least(h: float) -> float:
    """Return the least rate (1/s) that is growth."""
    return max(ROUNDING / h, SLOW)


def _exceeds(rates: FloatArray, own: FloatArray, h: float) -> bool:
    """Return whether some rate is larger than the mechanism's own, each compared with that of its place."""
    length = max(len(rates), len(own))
    first, second = (np.pad(each, (0, length - len(each))) for each in (rates, own))
    beside = SAME_RATE * own[:1].sum() + _least(h)
    return bool((first > (1 + SAME_RATE) * second + beside).any())


def stable_factor(robot: Robot, state: State, growth: Growth) -> float | None:
    """Return up to how many times the step is safe at a state.

    It is below one where the step is unsafe. None where no step is small enough; infinity where any is.
    """

    def unsafe(factor: float) -> bool:
        assert growth.own is not None
        return _exceeds(_rates_at(robot, state, factor), growth.own, robot.h)

    if growth.own is None:
        return None
    powers = range(1, DOUBLINGS + 1)
    if growth.kind == "unsafe":
        safe = next((0.5**power for power in powers if not unsafe(0.5**power)), None)
    else:
        lost = next((2.0**power for power in powers if unsafe(2.0**power)), None)
        safe = lost / 2 if lost else np.inf
    if safe is None or safe == np.inf:
        return safe
    return last_safe(lambda factor: not unsafe(factor), safe, 2 * safe, BISECTIONS)


def last_safe(safe: Callable[[float], bool], inside: float, outside: float, halvings: int) -> float:
    """Return the limit between a value that is safe and one that is not, on the safe side: their ratio is halved."""
    for _ in range(halvings):
        middle = float(np.sqrt(inside * outside))
        if safe(middle):
            inside = middle
        else:
            outside = middle
    return inside
