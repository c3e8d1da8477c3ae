"""The question and its answer: is a MuJoCo model safe at its time step, where, and what makes it unsafe?"""

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from bezstab.arguments import Number, exact_number, in_keywords, real_number, whole_number
from bezstab.engines.drives import Timing
from bezstab.errors import InputError
from bezstab.mujoco.blame import Shown, Suspect, suspects_at
from bezstab.mujoco.controllers import Gains, controlled, uncontrolled
from bezstab.mujoco.elements import Element
from bezstab.mujoco.energy import Kept, energy_kept, spun
from bezstab.mujoco.growth import Growth, Kind, goes_on_growing, growth_at, stable_factor
from bezstab.mujoco.reading import Loaded, loaded_model, silent
from bezstab.mujoco.remedies import Remedy, remedies
from bezstab.mujoco.robots import Robot, State
from bezstab.mujoco.sags import SECONDS, Sag, sags
from bezstab.mujoco.solrefs import METHODS, Feedback, feedbacks
from bezstab.mujoco.states import chosen_states, touching, touching_nothing, within_limits
from bezstab.mujoco.steps import NUDGE, step_at
from bezstab.stability.choices import steps_to_settle

MOST_DOFS = 400
"""That are judged: the eigenvalues of twice as many are found within a second, those of a robot in no time."""

MOST_WITH_LIMITS = 10
"""States, each with its own largest safe step; of a log's rows it is found for the worst."""

SELF_MADE = ("drive", "--pd drive", "joint spring", "joint damping", "tendon spring", "tendon damping")
"""Kinds whose gain may have the wrong sign: what falls by itself only because of one of them is unsafe."""

INTEGRATORS = tuple(METHODS)
"""In the order of MuJoCo's own numbers."""


ORDER: tuple[Kind, ...] = ("unsafe", "not smooth", "falls by itself", "moves on", "decays", "neutral")
"""From what decides first."""


@dataclass(frozen=True)
class Judged:
    """A state and what errors do there: |z| of a step, None where nothing holds or it is not known.

    `h` is the step in s. `rate` (1/s) is that of what falls by itself. `h_limit` (s) is the largest safe step: infinity
    for any, None where it was not looked for, or no step is small enough.
    """

    at: str
    kind: Kind
    z_abs: float | None
    h: float
    rate: float | None = None
    h_limit: float | None = None

    def seconds_to(self, fall: float) -> float | None:
        """Return the time until every error is so many times smaller; None where that is never so."""
        steps = steps_to_settle(self.z_abs, fall) if self.kind == "decays" and self.z_abs is not None else None
        return None if steps is None else steps * self.h


@dataclass(frozen=True)
class Linted:
    """What was found of a model: h in s; every state, the worst of them, and the suspects there if it is unsafe.

    `accuracy` is by how much |z| of the worst changes with twice the nudge. `feedbacks` are the settings of
    constraints, `kept` what a second keeps of the energy of states that move, `sags` how far elements are off where the
    first state comes to rest: None where it does not, empty where no load was given. `status` is the exit status of
    the command.
    """

    name: str
    h: float
    integrator: str
    judged: tuple[Judged, ...]
    worst: Judged
    accuracy: float | None
    suspects: tuple[Suspect, ...]
    remedies: tuple[Remedy, ...]
    feedbacks: tuple[Feedback, ...]
    kept: tuple[Kept, ...]
    sags: tuple[Sag, ...] | None
    sentence: str
    status: int


def lint(
    model: Any,
    *,
    at: Sequence[Any] = (),
    pd: Mapping[str, tuple[Number, Number]] | None = None,
    every: int = 1,
    late: Number = 0,
    deep: bool = False,
    spin: Mapping[str, Number] | None = None,
    load: Mapping[str, Sequence[Number]] | None = None,
) -> Linted:
    """Return whether a MuJoCo model is stable at its timestep: what errors do at its states, and what to write.

    Parameters
    ----------
    model : mjModel or str
        A model, which is not changed, or the path of an MJCF or URDF file.
    at : sequence
        States: names of keyframes, "qpos0", paths of CSV logs, arrays of shape (nq,) or (nq + nv,). By default
        qpos0 and all keyframes.
    pd : mapping of str to (kp, kd), optional
        Gains (SI units) of a controller outside the model, by the name of a motor or joint, or by a regular expression.
    every : int
        The controller computes its force every so many steps.
    late : int, float, str or Fraction
        The force is applied so many steps late.
    deep : bool
        Whether settings are also judged past the width of solimp.
    spin : mapping of str to number, optional
        Rates of joints (rad/s or m/s) at the first state. A run of one second from there, and from states with
        velocities, shows the share of energy that is kept.
    load : mapping of str to (x, y, z), optional
        Forces (N) on bodies, by name; {} for gravity alone. `sags` says how far the model is off at rest.

    Returns
    -------
    Linted
        `sentence` is the answer in words, `worst` the state that decides, `remedies` what to write.

    Raises
    ------
    InputError
        The model, a state or a name cannot be read or found.

    References
    ----------
    Eigenvalues of MuJoCo's own step, by centred differences.
    """
    with in_keywords():
        gains = [Gains(pattern, *(exact_number(value, "pd") for value in both)) for pattern, both in (pd or {}).items()]
        timing = Timing(whole_number(every, "every"), exact_number(late, "late"))
        rates = {joint: real_number(rate, "spin") for joint, rate in (spin or {}).items()}
        forces = None if load is None else {name: [real_number(n, "load") for n in load[name]] for name in load}
        return linted_model(model, at, gains, timing, deep=deep, spin=rates, load=forces)


def linted_model(
    source: Any,
    at: Sequence[Any],
    gains: Sequence[Gains],
    timing: Timing,
    *,
    deep: bool = False,
    spin: Mapping[str, float] | None = None,
    load: Mapping[str, Sequence[float]] | None = None,
    shown: Shown = lambda items, _label, _length: items,
) -> Linted:
    """Return the same; while it takes long, `shown` shows how far it is."""
    loaded = loaded_model(source)
    mujoco, model = loaded.mujoco, loaded.model
    drives = controlled(mujoco, model, gains)
    robot = Robot(mujoco, model, drives, timing)
    states = chosen_states(mujoco, model, at)
    if model.nv > MOST_DOFS:
        raise InputError(f"{loaded.name}: {model.nv} degrees of freedom, at most {MOST_DOFS} are judged")
    with silent(mujoco):
        moving = [spun(robot, states[0], spin)] if spin else states
        kept = tuple(shown(energy_kept(robot, moving), "energy", len(moving)))
        off = () if load is None else sags(robot, states[0], load)
        many = len(states) > MOST_WITH_LIMITS
        found = [each for state in shown(states, "states", len(states)) for each in _looked_at(robot, state, not many)]
        worst = min(found, key=_badness)
        if many:
            worst = replace(worst, h_factor=stable_factor(worst.robot, worst.state, worst.growth))
        suspects: list[tuple[Element, Suspect]] = []
        if worst.growth.kind in ("unsafe", "falls by itself"):
            suspects = suspects_at(worst.robot, worst.state, worst.growth, shown)
        if worst.growth.kind == "falls by itself":
            suspects = [each for each in suspects if each[1].blamed and each[1].kind in SELF_MADE]
            if suspects:  # a gain of the wrong sign pushes away at any step
                worst = replace(worst, growth=replace(worst.growth, kind="unsafe", rate=None), h_factor=None)
        found = [worst if each.state is worst.state else each for each in found]
        accuracy = _accuracy(worst)
        unsafe = [each for each in found if each.growth.kind == "unsafe"]
        written: list[Remedy] = []
        if unsafe:
            limits = [each.h_factor * robot.h for each in unsafe if each.h_factor is not None]
            there = [
                (each.robot, each.state, each.growth.own) for each in sorted(unsafe, key=_badness)[:MOST_WITH_LIMITS]
            ]
            written = remedies(there, suspects, min(limits, default=None), shown)
    settings = tuple(feedbacks(mujoco, model, deep=deep))
    rough = any(each.growth.kind == "not smooth" for each in found)
    is_unsafe = bool(unsafe) or any(each.unsafe for each in settings)
    return Linted(
        name=loaded.name,
        h=robot.h,
        integrator=INTEGRATORS[model.opt.integrator],
        judged=tuple(each.judged() for each in found if not each.state.log or each is worst),
        worst=worst.judged(),
        accuracy=accuracy,
        suspects=tuple(suspect for _, suspect in suspects),
        remedies=tuple(written),
        feedbacks=settings,
        kept=kept,
        sags=off,
        sentence=_sentence(loaded, robot, found, worst.judged(), settings, [*_kept_words(kept), *_sag_words(off)]),
        status=1 if is_unsafe else 3 if rough else 0,
    )


def _sentence(
    loaded: Loaded,
    robot: Robot,
    found: "Sequence[_Found]",
    worst: Judged,
    settings: Iterable[Feedback],
    more: Sequence[str],
) -> str:
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
            everywhere = f" at all {len(found)} states" if len(found) > 1 else ""
            own = f"at {worst.at} it falls by itself ({worst.rate:.2g} 1/s): look at its controller"
            answer = f"is numerically safe{everywhere}; {own}"
        case "moves on":
            answer = f"is safe: at {worst.at} errors grow for a moment, but not in a run from there"
        case "decays":
            answer = f"is safe: each step multiplies errors by {worst.z_abs:.6g} at most"
        case _:
            answer = "is safe: no error grows"
    step = f"timestep {robot.h:g} s, integrator {INTEGRATORS[robot.model.opt.integrator]}"
    notes = [*[loaded.left_out] * bool(loaded.left_out), *more]
    if alone := uncontrolled(robot.mujoco, robot.model, robot.drives):
        notes.append(f"motors without a controller: {', '.join(alone)}: --pd NAME=KP,KD judges them with one")
    return " ".join([f"{loaded.name} {answer} ({step}).", *(f"{note[0].upper()}{note[1:]}." for note in notes)])


def _kept_words(kept: Sequence[Kept]) -> Iterator[str]:
    if kept and kept[0].kept is not None:
        yield f"a second without drives and friction keeps {100 * kept[0].kept:.4g} % of its energy"
    elif kept:
        yield f"without drives and friction it breaks down within a second at {kept[0].at}"


def _sag_words(off: Sequence[Sag] | None) -> Iterator[str]:
    """Yield the largest length and the largest angle by which something is off."""
    if off is None:
        yield f"under that load it does not come to rest within {SECONDS:g} s"
    lengths = [(each.length, each.element) for each in off or () if each.length is not None]
    angles = [(each.angle, each.element) for each in off or () if each.angle is not None]
    if lengths:
        yield f"at rest {max(lengths)[1]} is off by {1000 * max(lengths)[0]:.3g} mm"
    if angles:
        yield f"at rest {max(angles)[1]} is off by {math.degrees(max(angles)[0]):.3g}°"


@dataclass(frozen=True, eq=False)
class _Found:
    """What was found at a state of a robot; `h_factor` as `stable_factor` has it, None where not looked for, too."""

    robot: Robot
    state: State
    growth: Growth
    h_factor: float | None = None

    def judged(self) -> Judged:
        h_limit = None if self.h_factor is None else self.h_factor * self.robot.h
        growth = self.growth
        return Judged(self.state.name, growth.kind, growth.z_abs, self.robot.h, growth.rate, h_limit)


def _badness(found: _Found) -> tuple[int, float]:
    return ORDER.index(found.growth.kind), -(found.growth.z_abs or 0.0)


def _looked_at(robot: Robot, state: State, with_limit: bool) -> Iterator[_Found]:
    """Yield what errors do at a state; where a contact or a limit begins just there, with it and without."""
    state = within_limits(robot, state)
    found = _found(robot, state, with_limit)
    if found.growth.kind != "not smooth":
        yield found
        return
    tried = (_found(robot, there, with_limit) for there in touching(robot, state))
    yield next((each for each in tried if each.growth.kind != "not smooth"), found)
    yield _found(*touching_nothing(robot, state), with_limit)


def _found(robot: Robot, state: State, with_limit: bool) -> _Found:
    growth = growth_at(robot, state)
    if growth.kind in ("falls by itself", "unsafe") and not goes_on_growing(robot, state, growth.z_abs or 1.0):
        growth = replace(growth, kind="moves on", rate=None)
    if not with_limit or growth.kind == "not smooth":
        return _Found(robot, state, growth)
    return _Found(robot, state, growth, stable_factor(robot, state, growth))


def _accuracy(found: _Found) -> float | None:
    """Return by how much |z| changes with twice the nudge."""
    if found.growth.z_abs is None:
        return None
    moduli = step_at(found.robot, found.state, nudge=2 * NUDGE).moduli()
    return abs(float(moduli[0]) - found.growth.z_abs)
