"""The question and its answer: is a MuJoCo model safe at its time step, where, and what makes it unsafe?"""

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from bezstab.engines import Timing
from bezstab.errors import InputError
from bezstab.mujoco.controllers import Gains, controlled, uncontrolled
from bezstab.mujoco.elements import acting, without
from bezstab.mujoco.growth import Growth, Kind, growth_at, stable_factor
from bezstab.mujoco.reading import Loaded, loaded_model, silent
from bezstab.mujoco.robots import Robot, State
from bezstab.mujoco.solrefs import METHODS, Feedback, feedbacks
from bezstab.mujoco.states import chosen_states, touching, touching_nothing
from bezstab.mujoco.steps import NUDGE, moved_by_step, step_at

MOST_DOFS = 400
"""That are judged: the eigenvalues of twice as many are found within a second, those of a robot in no time."""

SEEN = 1e-2
"""Relative: an element that changes what a growing error becomes by less is not to blame for it."""

MOST_SUSPECTS, MOST_DIRECTIONS = 12, 8
"""Elements whose part is found, and directions by which they are: enough for a robot with a leg or two at fault."""

MOST_WITH_LIMITS = 10
"""States, each with its own largest safe step; of a log's rows it is found for the worst."""

SELF_MADE = ("drive", "--pd drive", "joint spring", "joint damping", "tendon spring", "tendon damping")
"""Kinds whose gain may have the wrong sign: what falls by itself only because of one of them is unsafe."""

INTEGRATORS = tuple(METHODS)
"""In the order of MuJoCo's own numbers."""


ORDER: tuple[Kind, ...] = ("unsafe", "not smooth", "falls by itself", "decays", "neutral")
"""From what decides first."""


@dataclass(frozen=True)
class Judged:
    """A state and what errors do there: |z| of a step, None where nothing holds or it is not known.

    `rate` (1/s) is that of what falls by itself. `h_limit` (s) is the largest safe step: infinity for any, None where
    it was not looked for, or no step is small enough.
    """

    at: str
    kind: Kind
    z_abs: float | None
    rate: float | None = None
    h_limit: float | None = None


@dataclass(frozen=True)
class Suspect:
    """An element that acts on what grows: |z| with it alone, and with all but it, None where nothing holds.

    `blamed`: it grows with this element alone, or not without it.
    """

    element: str
    kind: str
    z_abs_alone: float | None
    z_abs_without: float | None
    blamed: bool


@dataclass(frozen=True)
class Linted:
    """What was found of a model: h in s; every state, the worst of them, and the suspects there if it is unsafe.

    `accuracy` is by how much |z| of the worst changes with twice the nudge. `feedbacks` are the settings of
    constraints. `status` is the exit status of the command.
    """

    name: str
    h: float
    integrator: str
    judged: tuple[Judged, ...]
    worst: Judged
    accuracy: float | None
    suspects: tuple[Suspect, ...]
    feedbacks: tuple[Feedback, ...]
    sentence: str
    status: int


Shown = Callable[[Iterable[Any], str, int], Iterable[Any]]
"""Yields some items, while it shows how many of them are done."""


def lint(
    source: Any,
    at: Sequence[Any] = (),
    gains: Sequence[Gains] = (),
    timing: Timing | None = None,
    *,
    deep: bool = False,
    shown: Shown = lambda items, _label, _length: items,
) -> Linted:
    """Return what errors do in a model at its states: an mjModel, or the path of an MJCF or URDF file.

    `at`: names of keyframes, qpos0, paths of logs, arrays (qpos, or qpos and qvel); by default qpos0 and all keyframes.
    `gains` and `timing` are those of a controller outside the model. `deep` judges constraints past solimp's width,
    too. InputError for what cannot be read or is not there.
    """
    loaded = loaded_model(source)
    mujoco, model = loaded.mujoco, loaded.model
    drives = controlled(mujoco, model, gains)
    robot = Robot(mujoco, model, drives, timing or Timing())
    states = chosen_states(mujoco, model, at)
    if model.nv > MOST_DOFS:
        raise InputError(f"{loaded.name}: {model.nv} degrees of freedom, at most {MOST_DOFS} are judged")
    with silent(mujoco):
        many = len(states) > MOST_WITH_LIMITS
        found = [each for state in shown(states, "states", len(states)) for each in _looked_at(robot, state, not many)]
        worst = min(found, key=_badness)
        if many:
            worst = replace(worst, h_factor=stable_factor(worst.robot, worst.state, worst.growth))
        suspects = _suspects(worst, shown) if worst.growth.kind in ("unsafe", "falls by itself") else []
        if worst.growth.kind == "falls by itself":
            suspects = [each for each in suspects if each.blamed and each.kind in SELF_MADE]
            if suspects:  # a gain of the wrong sign pushes away at any step
                worst = replace(worst, growth=replace(worst.growth, kind="unsafe", rate=None), h_factor=None)
        found = [worst if each.state is worst.state else each for each in found]
        accuracy = _accuracy(worst)
    settings = tuple(feedbacks(mujoco, model, deep=deep))
    rough = any(each.growth.kind == "not smooth" for each in found)
    unsafe = worst.growth.kind == "unsafe" or any(each.unsafe for each in settings)
    return Linted(
        name=loaded.name,
        h=robot.h,
        integrator=INTEGRATORS[model.opt.integrator],
        judged=tuple(each.judged() for each in found if not each.state.log or each is worst),
        worst=worst.judged(),
        accuracy=accuracy,
        suspects=tuple(suspects),
        feedbacks=settings,
        sentence=_sentence(loaded, robot, worst.judged(), settings),
        status=1 if unsafe else 3 if rough else 0,
    )


def _sentence(loaded: Loaded, robot: Robot, worst: Judged, settings: Iterable[Feedback]) -> str:
    """Return the answer in words."""
    unsafe = [each for each in settings if each.unsafe]
    match worst.kind:
        case "unsafe":
            answer = f"is not safe: at {worst.at} each step multiplies errors by {worst.z_abs:.6g}"
        case _ if unsafe:
            answer = f"is not safe: errors grow where {unsafe[0].setting} acts ({unsafe[0].kinds})"
        case "not smooth":
            answer = f"is not smooth at {worst.at}: nothing is judged there"
        case "falls by itself":
            answer = f"is safe: at {worst.at} it falls by itself ({worst.rate:.2g} 1/s); not numerical"
        case "decays":
            answer = f"is safe: each step multiplies errors by {worst.z_abs:.6g} at most"
        case _:
            answer = "is safe: no error grows"
    step = f"timestep {robot.h:g} s, integrator {INTEGRATORS[robot.model.opt.integrator]}"
    notes = [loaded.left_out] if loaded.left_out else []
    if alone := uncontrolled(robot.mujoco, robot.model, robot.drives):
        notes.append(f"motors without a controller: {', '.join(alone)}: --pd NAME=KP,KD judges them with one")
    return " ".join([f"{loaded.name} {answer} ({step}).", *(f"{note[0].upper()}{note[1:]}." for note in notes)])


@dataclass(frozen=True, eq=False)
class _Found:
    """What was found at a state of a robot; `h_factor` as `stable_factor` has it, None where not looked for, too."""

    robot: Robot
    state: State
    growth: Growth
    h_factor: float | None = None

    def judged(self) -> Judged:
        h_limit = None if self.h_factor is None else self.h_factor * self.robot.h
        return Judged(self.state.name, self.growth.kind, self.growth.z_abs, self.growth.rate, h_limit)


def _badness(found: _Found) -> tuple[int, float]:
    return ORDER.index(found.growth.kind), -(found.growth.z_abs or 0.0)


def _looked_at(robot: Robot, state: State, with_limit: bool) -> Iterator[_Found]:
    """Yield what errors do at a state; where a contact or a limit begins just there, with it and without."""
    growth = growth_at(robot, state)
    if growth.kind != "not smooth":
        yield _with_limit(_Found(robot, state, growth), with_limit)
        return
    apart, alone = touching_nothing(robot, state)
    for there in touching(robot, state):
        growth = growth_at(robot, there)
        if growth.kind != "not smooth":
            yield _with_limit(_Found(robot, there, growth), with_limit)
            break
    else:
        yield _Found(robot, state, growth)
    yield _with_limit(_Found(apart, alone, growth_at(apart, alone)), with_limit)


def _with_limit(found: _Found, wanted: bool) -> _Found:
    if not wanted or found.growth.kind == "not smooth":
        return found
    return replace(found, h_factor=stable_factor(found.robot, found.state, found.growth))


def _accuracy(found: _Found) -> float | None:
    """Return by how much |z| changes with twice the nudge."""
    if found.growth.z_abs is None:
        return None
    moduli = step_at(found.robot, found.state, nudge=2 * NUDGE).moduli()
    return abs(float(moduli[0]) - found.growth.z_abs)


def _suspects(found: _Found, shown: Shown) -> list[Suspect]:
    """Return the elements without which growing errors change, and what each does alone; those to blame first."""
    robot, state = found.robot, found.state
    directions = step_at(robot, state).growing()[:, :MOST_DIRECTIONS]
    whole = moved_by_step(robot, state, directions)
    sizes = np.linalg.norm(whole, axis=0)
    elements = acting(robot, state)
    effects = []
    for element in elements:
        with without(robot, [element]) as rest:
            change = moved_by_step(rest, state, directions) - whole
        effects.append(float((np.linalg.norm(change, axis=0) / sizes).max(initial=0.0)))
    order = [place for place in np.argsort(effects)[::-1].tolist() if effects[place] > SEEN * max(effects)]
    chosen = [elements[place] for place in order[:MOST_SUSPECTS]]
    suspects = []
    for element in shown(chosen, "elements", len(chosen)):
        with without(robot, [element]) as rest:
            less = growth_at(rest, state)
        with without(robot, [other for other in elements if other is not element]) as alone:
            only = growth_at(alone, state)
        blamed = less.kind not in (found.growth.kind, "unsafe") or only.kind == "unsafe"
        suspects.append(Suspect(element.name, element.kind, only.z_abs, less.z_abs, blamed))
    return sorted(suspects, key=lambda each: not each.blamed)
