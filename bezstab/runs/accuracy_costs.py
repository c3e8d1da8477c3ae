"""Speed against accuracy: what a method and a step size cost in simulation, and what they buy."""

import json
import time
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from bezstab.errors import InputError, NumericalError
from bezstab.mechanism.equations import compiled_mechanism
from bezstab.mechanism.motions import Motion, motion_over
from bezstab.mechanism.observation import energy_balance, observe
from bezstab.mechanism.runner import Trajectory, simulate
from bezstab.mechanism.scenes import Scene
from bezstab.methods.schemes import Method, steps
from bezstab.rationals import exact
from bezstab.runs.forced_runs import COMPARED, Forced, predicted_errors, settled_error, settled_work
from bezstab.stabilising import NOTHING, AfterStep, Stabilise, held_by
from bezstab.stability.choices import choose
from bezstab.stability.closed_loop import spectral_radius
from bezstab.units import feedback_gains, to_dimensionless

STEPS = ("0.0001", "0.0002", "0.0004", "0.0008", "0.0016", "0.0032", "0.005", "0.008", "0.0125", "0.02")
"""In s: doubled where accuracy is the question, closer where runs begin to fail."""

ABOVE_REFERENCE = 30.0
"""Times the reference's own error: below, an observed order is noise."""

HALVINGS = 4
"""Of the reference's step at most: each doubles its cost."""

ROUNDED = 4.0
"""RK4's error falls sixteenfold with each halving; where it falls less than this, rounding has taken over."""

Cost = Literal["evaluations", "time", "projection"]
"""What errors are held against: evaluations, processor time, or, of feedback against projection, factorizations."""

ErrorOf = Literal["trajectory", "constraint", "energy"]

NO_FEEDBACK = (0.0, 0.0)
"""The point of runs with projection, or with nothing that holds the constraints."""


@dataclass(frozen=True)
class ReferenceRun:
    """A motion without feedback from a consistent start, and how far its coordinates may be off (SI)."""

    along: Motion
    error: float


def reference_run(scene: Scene, h: float, duration: float) -> ReferenceRun:
    """Return the motion from RK4 at half of h (s) and less, until halving no longer changes it but by rounding.

    Feedback does not enter: the exact motion has c = 0. The error is the largest difference to the run at twice the
    step, its interpolation included. InputError for a scene that cannot start, NumericalError if the run fails.
    Duration in s.
    """
    halved = (
        motion_over(compiled_mechanism(scene), duration, round(duration / h * 2**halving))
        for halving in range(1, HALVINGS + 2)
    )
    best = ReferenceRun(next(halved), np.inf)
    for along in halved:
        fine = ReferenceRun(along, float(np.abs(best.along.at(along.t)[0] - along.q).max()))
        if fine.error > best.error / ROUNDED:
            return min(best, fine, key=lambda motion: motion.error)
        best = fine
    return best


@dataclass(frozen=True)
class Sweep:
    """The runs of one method: its steps and the duration (s), repeats of each timing, the motion to compare with.

    `point` holds alpha_hat and beta_hat, or with `physical` alpha and beta in 1/s; without one the goal accurate of
    `choose` finds one at each step, for a motion of rate `omega` (1/s). `compiled` says whether machine code takes the
    steps, which changes nothing but their time. Where something is done `after` each step there is no feedback.
    """

    method: Method
    scene: Scene
    steps: tuple[float, ...]
    duration: float
    point: tuple[float, float] | None
    physical: bool
    repeats: int
    reference: ReferenceRun
    omega: Fraction | None = None
    compiled: bool = False
    after: AfterStep = NOTHING

    @property
    def stabilise(self) -> Stabilise:
        """What holds the constraints."""
        return held_by(self.after, feedback=self.point != NO_FEEDBACK)


@dataclass(frozen=True)
class Run:
    """One run: errors (SI; the trajectory's None if it failed), cost, and order against the next larger step.

    measured_error is the largest |c| in the later half, where the start has died away, None of a run that failed;
    predicted_error what the feedback forces there (forced_runs.py), None where errors do not decay, or the motion
    cannot be followed for longer than the run. measured_work and predicted_work (J) are what the multipliers do there
    on those errors: what the energy gains by the feedback, but for the torque of stages. measured_trajectory and
    predicted_trajectory: the largest error of the coordinates there (forced_runs.py). Processor time in s: the
    median of the repeats, the least and the largest. `stabilise` is what holds the constraints, `advised` whether the
    point is the choice of the goal accurate; z_abs is None where there is no feedback. `factorizations` counts those of
    S = C_q M^-1 C_q^T, one for each evaluation, and those of projections.
    """

    method: Method
    h: float
    alpha_hat: float
    beta_hat: float
    z_abs: float | None
    trajectory_error: float | None
    c_max: float
    measured_error: float | None
    predicted_error: float | None
    measured_work: float | None
    predicted_work: float | None
    measured_trajectory: float | None
    predicted_trajectory: float | None
    c_rms: float
    cdot_max: float
    cdot_rms: float
    energy_drift: float
    evaluations: int
    factorizations: int
    seconds: float
    seconds_min: float
    seconds_max: float
    failure: str | None
    order: float | None
    stabilise: Stabilise
    advised: bool

    def cost(self, against: Cost) -> float:
        """Return its evaluations, its processor time (s), or its factorizations."""
        return {"evaluations": self.evaluations, "time": self.seconds, "projection": self.factorizations}[against]

    def error(self, of: ErrorOf) -> float | None:
        """Return the trajectory's error, the largest |c|, or the energy's drift, unsigned (SI); None if it failed."""
        if self.failure:
            return None
        return {"trajectory": self.trajectory_error, "constraint": self.c_max, "energy": abs(self.energy_drift)}[of]


def pareto_front(points: Iterable[tuple[float, float | None]]) -> list[int]:
    """Return the indices of the Pareto front by (cost, error), ascending in cost: none is cheaper and as accurate.

    An error of None is a point that does not compete. Of equal points the first is taken.
    """
    ranked = sorted((cost, error, index) for index, (cost, error) in enumerate(points) if error is not None)
    least_error = np.inf
    front: list[int] = []
    for _, error, index in ranked:
        if error < least_error:
            least_error = error
            front.append(index)
    return front


@dataclass(frozen=True)
class SweptRuns:
    """All runs of a sweep over methods and steps, each method's with the largest step first.

    `reference_error` (SI) is how well the true motion is known, `tolerance` (m, rad) the trajectory error that is good
    enough. Costs are `against` what they are counted in. `fronts`: of each error the indices of runs, ascending in
    cost, that no other run beats. `cheapest`: the run of least cost among those within the tolerance; None where none
    is.
    """

    runs: Sequence[Run]
    reference_error: float
    tolerance: float
    against: Cost
    fronts: Mapping[ErrorOf, Sequence[int]]
    cheapest: Run | None


def ranked_runs(
    runs: Sequence[Run], reference_error: float, tolerance: float, against: Cost = "evaluations"
) -> SweptRuns:
    """Return runs with their fronts, and the cheapest that is good enough."""
    fronts = {of: pareto_front((run.cost(against), run.error(of)) for run in runs) for of in get_args(ErrorOf)}
    within = [run for run in runs if not run.failure and (run.trajectory_error or 0.0) <= tolerance]
    cheapest = min(within, key=lambda run: run.cost(against), default=None)
    return SweptRuns(runs, reference_error, tolerance, against, fronts, cheapest)


def measured_runs(sweep: Sweep) -> dict[str, NDArray[np.generic]]:
    """Return for each step, the largest first, what Run has, as a JSON text that can be stored like arrays.

    InputError where alpha and beta in 1/s leave the range of float64 at a step; errors of `choose`.
    """
    runs: list[Run] = []
    for h in sorted(sweep.steps, reverse=True):
        runs.append(_measured_run(sweep, h, *runs[-1:]))
    return {"runs": np.array(json.dumps([vars(run) | {"method": None} for run in runs]))}


def swept_runs(sweep: Sweep, measured: Mapping[str, NDArray[np.generic]]) -> list[Run]:
    """Return the runs of one method, the largest step first, from what `measured_runs` gave."""
    return [Run(**values | {"method": sweep.method}) for values in json.loads(str(measured["runs"]))]


def _point(sweep: Sweep, h: float) -> tuple[float, float]:
    """Return alpha_hat and beta_hat at a step of h (s)."""
    if sweep.point is None:
        assert sweep.omega is not None
        chosen = choose(sweep.method, "accurate", omega_h=sweep.omega * exact(h))
        return chosen.alpha_hat, chosen.beta_hat
    if not sweep.physical:
        return sweep.point
    alpha, beta = map(exact, sweep.point)
    alpha_hat, beta_hat = to_dimensionless(alpha, beta, exact(h))
    return float(alpha_hat), float(beta_hat)


def _measured_run(sweep: Sweep, h: float, larger: Run | None = None) -> Run:
    """Return a run, repeated as often as it is timed, with steps of h (s); `larger` is that of the next larger step."""
    mechanism, method, point = compiled_mechanism(sweep.scene), sweep.method, _point(sweep, h)
    gains = feedback_gains(*point, h)
    run, seconds = _timed_run(sweep, h, gains)
    seen = observe(mechanism, run.t, run.q, run.v, *gains)
    *_, energy_drift = energy_balance(seen, h * float(method.step_multiple))
    z_abs = float(spectral_radius(method, *point)) if sweep.stabilise == "baumgarte" else None
    whole = not run.failure
    forced = _predicted(sweep, h, point) if z_abs is not None and z_abs < 1 else None
    off = np.abs(run.q - sweep.reference.along.at(run.t)[0]).max(axis=1)
    trajectory_error = float(off.max()) if whole else None
    return Run(
        method=method,
        h=h,
        alpha_hat=point[0],
        beta_hat=point[1],
        z_abs=z_abs,
        trajectory_error=trajectory_error,
        c_max=seen.c_max,
        measured_error=settled_error(seen, run.t) if whole else None,
        predicted_error=forced and forced.error,
        measured_work=settled_work(seen, run.t) if whole else None,
        predicted_work=forced and forced.work,
        measured_trajectory=float(off[run.t >= COMPARED * run.t[-1]].max()) if whole else None,
        predicted_trajectory=forced and forced.trajectory,
        c_rms=float(np.sqrt((seen.c**2).mean())),
        cdot_max=seen.cdot_max,
        cdot_rms=float(np.sqrt((seen.cdot**2).mean())),
        energy_drift=float(energy_drift[-1]),
        evaluations=run.evaluations,
        factorizations=run.factorizations,
        seconds=float(np.median(seconds)),
        seconds_min=min(seconds),
        seconds_max=max(seconds),
        failure=run.failure,
        order=_observed_order(larger, h, trajectory_error, sweep.reference.error),
        stabilise=sweep.stabilise,
        advised=sweep.point is None,
    )


def _observed_order(larger: Run | None, h: float, error: float | None, reference_error: float) -> float | None:
    """Return the order of accuracy from a larger step's run to a step of h (s) with that error; None if unknown."""
    if not larger or not larger.trajectory_error or not error or error <= ABOVE_REFERENCE * reference_error:
        return None
    return float(np.log(larger.trajectory_error / error) / np.log(larger.h / h))


def _predicted(sweep: Sweep, h: float, point: tuple[float, float]) -> Forced | None:
    """Return what is predicted of the later half of a run; None where it is not known."""
    try:
        (forced,) = predicted_errors(compiled_mechanism(sweep.scene), sweep.method, h, [point], sweep.duration)
    except (InputError, NumericalError):  # the motion is followed for longer than the run
        return None
    return forced


def _timed_run(sweep: Sweep, h: float, gains: tuple[float, float]) -> tuple[Trajectory, list[float]]:
    """Return a run and the processor time (s) of each of its repeats, without what has to be compiled first."""
    method = sweep.method

    def taken(duration: float) -> Trajectory:
        mechanism = compiled_mechanism(sweep.scene)
        return simulate(mechanism, method, h, duration, gains, compiled=sweep.compiled, after=sweep.after)

    taken((steps(method) + 1) * h * float(method.step_multiple))  # compiles the method and what starts it
    seconds = []
    for _ in range(sweep.repeats):
        begin = time.process_time()
        run = taken(sweep.duration)
        seconds.append(time.process_time() - begin)
    return run, seconds
