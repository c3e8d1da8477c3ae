"""What accuracy costs: runs of many methods and steps, compared with one reference; and the least errors, predicted.

scene, methods, steps, what holds the constraints   →   trade   →   Trade: sweeps to run   →   ranked   →   SweptRuns
methods, speeds of decay, a motion                  →   front_motion, fronts   →   a front of least errors for each
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import chain

import numpy as np
from numpy.typing import NDArray

from bezstab.arguments import Number, exact_number, exact_or_none, in_keywords, plane_point
from bezstab.engines.conversions import Point
from bezstab.errors import InputError
from bezstab.mechanism.compiled_stepping import runs_compiled
from bezstab.mechanism.equations import compiled_mechanism
from bezstab.mechanism.scene_files import scene as scene_named
from bezstab.mechanism.scenes import Scene
from bezstab.methods.registry import method as method_named
from bezstab.methods.schemes import Method
from bezstab.questions.motions import ReferenceMotion, mechanism_of, motion_of
from bezstab.rationals import exact
from bezstab.runs.accuracy_costs import (
    NO_FEEDBACK,
    STEPS,
    Cost,
    Sweep,
    SweptRuns,
    measured_runs,
    ranked_runs,
    reference_run,
    swept_runs,
)
from bezstab.stabilising import NOTHING, AfterStep, Stabilise, after_step
from bezstab.stability.error_fronts import RATES, FrontPoint, error_front

MOST_SWEPT = 10**6
"""Steps of a run: the reference takes up to 32 times as many."""

MOST_REPEATS = 100

Treatment = tuple[tuple[float, float] | None, AfterStep]
"""What holds the constraints: the point of feedback, None for the advised one; what is done after each step."""


@dataclass(frozen=True)
class Trade:
    """The runs to make, of each method with each treatment, and how they are compared.

    `scene`: the mechanism's name. `reference_error` (SI): how well the motion is known that runs are compared with.
    `omega` (1/s): of the motion for which points are advised; None where none is. A trajectory error of `tolerance`
    (m, rad) is good enough; costs are counted `against` evaluations, time or factorizations. `job`: all that results
    depend on.
    """

    scene: str
    sweeps: Sequence[Sweep]
    reference_error: float
    omega: Fraction | None
    tolerance: Fraction
    against: Cost
    job: str


def trade(
    scene: str | Scene,
    methods: Sequence[Method],
    steps: Sequence[Fraction] = (),
    *,
    duration: Fraction,
    speed: Fraction = Fraction(1),
    numbers: Point | None = None,
    physical: bool = False,
    omega: Fraction | None = None,
    stabilise: Stabilise | None = None,
    iterations: int | None = None,
    against: Cost = "evaluations",
    repeats: int = 3,
    tolerance: Fraction = Fraction("1e-6"),
) -> Trade:
    """Return which runs tell what errors methods make over a duration (s) at each of some steps (s), and their cost.

    The feedback is at `numbers` at every step, alpha_hat and beta_hat, or alpha and beta in 1/s with `physical`.
    Without numbers each step has its own point: that of the goal accurate, for a motion of rate `omega` (1/s), else for
    the scene's own. `stabilise` puts a projection of so many `iterations` at most in place of feedback, or nothing.
    Against projection each run is made with feedback and with projection. Each is timed `repeats` times.

    InputError for what does not go together, for a method whose states cannot be projected, and as `reference_run`.
    """
    if against == "projection":
        if stabilise is not None:
            raise InputError("--stabilise does not go with --against projection: it has runs with and without feedback")
    elif omega is not None and numbers:
        raise InputError("--omega does not go with --alpha and --beta: points are chosen for that motion")
    if stabilise not in (None, "baumgarte") and (numbers or omega is not None):
        raise InputError(f"--stabilise {stabilise} has no feedback: leave out --alpha and --beta, or --omega")
    if not 1 <= repeats <= MOST_REPEATS:
        raise InputError(f"--repeats {repeats}: expected 1 to {MOST_REPEATS}")
    treatments = _treatments(numbers, stabilise or "baumgarte", iterations, against)
    sizes = tuple(sorted({float(step) for step in steps or STEPS}))
    _check_duration(duration, sizes, methods)
    moving = scene_named(scene, speed)
    rate = None
    if any(point is None for point, _ in treatments):
        shortest, longest = exact(sizes[0]), exact(sizes[-1])
        rate = motion_of(omega, compiled_mechanism(moving), shortest, longest, duration).omega_h / shortest
    reference = reference_run(moving, sizes[0], float(duration))
    compiled = _all_compiled(methods, treatments, repeats * sum(float(duration) / h for h in sizes))
    sweeps = [
        Sweep(method, moving, sizes, float(duration), point, physical, repeats, reference, rate, compiled, after)
        for method in dict.fromkeys(methods)
        for point, after in treatments
    ]
    asked = (tuple(methods), sizes, duration, treatments, physical, rate, repeats, against)
    return Trade(moving.name, sweeps, reference.error, rate, tolerance, against, f"tradeoff {asked} {moving}")


@in_keywords()
def tradeoff(
    scene: str | Scene,
    methods: Sequence[str | Method],
    *,
    steps: Sequence[Number] = (),
    duration: Number = 2,
    alpha_hat: Number | None = None,
    beta_hat: Number | None = None,
    omega: Number | None = None,
    stabilise: Stabilise | None = None,
    against: Cost = "evaluations",
    tolerance: Number = "1e-6",
) -> SweptRuns:
    """Return what errors methods make on a mechanism at each of some steps, and what the runs cost.

    Parameters
    ----------
    scene : str or Scene
        The mechanism.
    methods : sequence of str or Method
        The integration methods.
    steps : sequence of number
        Steps (s); by default ten from 0.0001 to 0.02.
    duration : number
        Of each run (s).
    alpha_hat, beta_hat : number or str, optional
        The feedback, dimensionless; by default at each step the choice of the goal accurate.
    omega : number, optional
        Rate of the motion (1/s) for which points are chosen; by default the scene's own.
    stabilise : {"baumgarte", "projection", "none"}, optional
        What holds the constraints.
    against : {"evaluations", "time", "projection"}
        What costs are counted in.
    tolerance : number
        The trajectory error (m, rad) that is good enough.

    Returns
    -------
    SweptRuns
        `runs`, with errors in SI units; `fronts`, indices of runs that no other beats; `cheapest` that is good enough.

    Raises
    ------
    InputError
        What does not go together, or a duration that is no step, or too many.

    References
    ----------
    Work-precision diagrams: Hairer, Norsett & Wanner, Solving Ordinary Differential Equations I.
    """
    asked = trade(
        scene_named(scene),
        [method_named(each) for each in methods],
        [exact_number(step, "steps") for step in steps],
        duration=exact_number(duration, "duration"),
        numbers=plane_point(alpha_hat, beta_hat, None, None, None, needed=False),
        omega=exact_or_none(omega, "omega"),
        stabilise=stabilise,
        against=against,
        tolerance=exact_number(tolerance, "tolerance"),
    )
    return ranked(asked, [measured_runs(sweep) for sweep in asked.sweeps])


def ranked(asked: Trade, measured: Sequence[Mapping[str, NDArray[np.generic]]]) -> SweptRuns:
    """Return what the runs of all sweeps have measured, as `measured_runs` returns it for each, and the fronts."""
    runs = chain.from_iterable(swept_runs(*each) for each in zip(asked.sweeps, measured, strict=True))
    return ranked_runs(list(runs), asked.reference_error, float(asked.tolerance), asked.against)


def basis_words(asked: Trade) -> str:
    """Return what runs are compared with, and for which motion points are chosen."""
    said = f"The reference is known to {asked.reference_error:.0e} (m, rad)."
    if asked.omega is None:
        return said
    return f"{said} Each point is the choice of the goal accurate for a motion with ω = {float(asked.omega):.3g} 1/s."


def _treatments(numbers: Point | None, stabilise: Stabilise, iterations: int | None, against: Cost) -> list[Treatment]:
    """Return each way in which the constraints are held; InputError as `after_step`."""
    point = None if numbers is None else (float(numbers[0]), float(numbers[1]))
    if against == "projection":
        given = [(point, NOTHING)] if point else []
        return [(None, NOTHING), *given, (NO_FEEDBACK, after_step("projection", iterations))]
    return [(point if stabilise == "baumgarte" else NO_FEEDBACK, after_step(stabilise, iterations))]


def _check_duration(duration: Fraction, sizes: Sequence[float], methods: Sequence[Method]) -> None:
    """Raise InputError for a duration (s) that is no step of some method, or too many of the shortest (s)."""
    longest = sizes[-1] * float(max(method.step_multiple for method in methods))
    most = MOST_SWEPT * sizes[0]
    if not longest <= duration <= most:
        expected = f"one step ({longest:g} s) to {MOST_SWEPT:g} ({most:g} s)"
        raise InputError(f"--time {float(duration):g}: expected {expected}")


def _all_compiled(methods: Sequence[Method], treatments: Sequence[Treatment], steps: float) -> bool:
    """Return whether runs are compiled: all or none, so that their times can be compared.

    By default none are where one method's runs together, of so many steps, are not. InputError as `runs_compiled`.
    """
    return all(
        runs_compiled(method, round(steps / float(method.step_multiple)), after=after)
        for method in methods
        for _, after in treatments
    )


def front_motion(
    steps: Sequence[Fraction],
    omega: Fraction | None = None,
    scene: str | Scene | None = None,
    speed: Fraction = Fraction(1),
) -> ReferenceMotion:
    """Return the motion on which fronts are told: of a rate omega (1/s), or of a scene; both with the one of the steps.

    Without either it is the usual one. InputError for what does not go together, and as `motion_of`.
    """
    if len(steps) > 1:
        raise InputError(f"--predicted takes one --h, but {len(steps)} were given")
    if steps and scene is None and omega is None:
        needed = "they say how far the motion goes in a step"
        raise InputError(f"--predicted with --h needs --omega or --scene: {needed}")
    h = next(iter(steps), None)
    return motion_of(omega, mechanism_of(scene, speed, h), h)


def fronts(
    methods: Sequence[Method], levels: Sequence[Fraction], motion: ReferenceMotion
) -> Iterator[list[FrontPoint]]:
    """Return the front of each method: the point of least error for each |z_p| of the levels that it can reach.

    InputError for a level of one and more.
    """
    if wrong := [float(level) for level in levels if float(level) >= 1]:
        raise InputError(f"--level {wrong[0]:g}: expected a |z_p| below 1, where errors decay")
    rates = [float(level) for level in levels] or RATES
    return (error_front(method, rates, motion.omega_h) for method in dict.fromkeys(methods))
