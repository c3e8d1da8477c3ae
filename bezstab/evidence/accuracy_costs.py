"""Speed against accuracy: what a method and a step size cost in simulation, and what they buy."""

import re
import time
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from bezstab.errors import NumericalError
from bezstab.mechanism import Scene, compiled_mechanism, observe, simulate
from bezstab.methods import Method, accuracy, evaluations, lookup, steps
from bezstab.stability import FloatArray, choose, region, spectral_radius
from bezstab.units import feedback_gains

METHODS = ("B2", "B3", "B4", "AB2", "AB4", "ABM4", "RK4", "SIE", "SYM")
STEPS = ("0.0001", "0.0002", "0.0004", "0.0008", "0.0016", "0.0032", "0.005", "0.008", "0.0125", "0.02")  # s
FINE = 1e-8  # m or rad: the error at which high order shows
BEYOND = 1e3  # times the evaluations of the dearest run: no power law is trusted further
HALVINGS = 4  # of the reference's step at most
ROUNDED = 4.0  # RK4's error falls sixteenfold with each; where it falls less, rounding has taken over
ABOVE = 30.0  # times the reference's own error: below, an observed order is noise
LOST = 0.5  # of an order: below the stated one by more, it has fallen
ALIKE = 1.05  # ratios nearer to one are neither won nor lost
LINE = 4000  # points on alpha = beta, where the largest stable step is looked for


@dataclass(frozen=True)
class Reference:
    """A trajectory without feedback from a consistent start: t (s), q and v (shape (times, n), SI), error of q."""

    t: FloatArray
    q: FloatArray
    v: FloatArray
    error: float

    def at(self, t: FloatArray) -> FloatArray:
        """Return q at times t (s), shape (t.size, n), by Hermite's cubic between its steps."""
        step = self.t[1] - self.t[0]
        k = np.clip((t / step).astype(int), 0, len(self.t) - 2)
        s = ((t - self.t[k]) / step)[:, np.newaxis]
        start, end = self.q[k], self.q[k + 1]
        rise, fall = step * self.v[k] - (end - start), (end - start) - step * self.v[k + 1]
        at: FloatArray = (1 - s) * start + s * end + s * (1 - s) * ((1 - s) * rise + s * fall)
        return at


def reference_motion(scene: Scene, h: float, duration: float) -> Reference:
    """Return the motion from RK4 at half of h (s) and less, until halving no longer changes it but by rounding.

    Feedback does not enter: the exact motion has c = 0. The error is the largest difference to the run at twice the
    step, its interpolation included. NumericalError if the run fails.
    """
    coarse: Reference | None = None
    for halving in range(1, HALVINGS + 2):
        run = simulate(compiled_mechanism(scene), lookup("RK4"), h / 2**halving, duration, (0.0, 0.0))
        if run.failure:
            raise NumericalError(f"the reference of {scene.name} fails {run.failure}")
        error = np.inf if coarse is None else float(np.abs(coarse.at(run.t) - run.q).max())
        fine = Reference(run.t, run.q, run.v, error)
        if coarse is not None and error > coarse.error / ROUNDED:
            return min(coarse, fine, key=lambda each: each.error)
        coarse = fine
    assert coarse
    return coarse


@dataclass(frozen=True)
class Sweep:
    """The runs of one method: steps (s), with for each the times (s) and the reference's q there, shape (times, n).

    `point` holds alpha_hat and beta_hat, or with `physical` alpha and beta in 1/s; by default `choose` finds it.
    """

    method: Method
    scene: Scene
    steps: tuple[float, ...]
    duration: float
    point: tuple[float, float] | None
    physical: bool
    repeats: int
    reference: Reference


def measured_runs(sweep: Sweep) -> dict[str, NDArray[np.generic]]:
    """Return for each step what Run has, as arrays; what a failed run lacks is nan."""
    point = sweep.point
    if point is None:
        chosen = choose(sweep.method, "robust")
        point = chosen.alpha_hat, chosen.beta_hat
    scaled = ((2 * point[0] * h, (point[1] * h) ** 2) if sweep.physical else point for h in sweep.steps)
    runs = [_measured(sweep, h, at) for h, at in zip(sweep.steps, scaled, strict=True)]
    return {key: np.array([run[key] for run in runs]) for key in runs[0]}


def _measured(sweep: Sweep, h: float, point: tuple[float, float]) -> dict[str, float | str]:
    moving, method = compiled_mechanism(sweep.scene), sweep.method
    feedback, seconds = feedback_gains(*point, h), []
    first = (steps(method) + 1) * h * float(method.step_multiple)
    simulate(moving, method, h, first, feedback)  # compiles all it needs
    for _ in range(sweep.repeats):
        begin = time.process_time()
        run = simulate(moving, method, h, sweep.duration, feedback)
        seconds.append(time.process_time() - begin)
    seen = observe(moving, run.t, run.q, run.v, *feedback)
    return {
        "alpha_hat": point[0],
        "beta_hat": point[1],
        "z_abs": float(spectral_radius(method, *point)),
        "trajectory_error": np.nan if run.failure else float(np.abs(run.q - sweep.reference.at(run.t)).max()),
        "c_max": float(np.abs(seen.c).max()),
        "c_rms": float(np.sqrt((seen.c**2).mean())),
        "cdot_max": float(np.abs(seen.cdot).max()),
        "cdot_rms": float(np.sqrt((seen.cdot**2).mean())),
        "energy_drift": float(seen.energy[-1] - seen.energy[0]),
        "evaluations": run.evaluations,
        "seconds": float(np.median(seconds)),
        "seconds_min": min(seconds),
        "seconds_max": max(seconds),
        "failure": run.failure or "",
    }


@dataclass(frozen=True)
class Run:
    """One run: errors (SI; the trajectory's None if it failed), cost, and order against the next larger step.

    Processor time in s: the median of the repeats, the least and the largest.
    """

    method: Method
    h: float
    alpha_hat: float
    beta_hat: float
    z_abs: float
    trajectory_error: float | None
    c_max: float
    c_rms: float
    cdot_max: float
    cdot_rms: float
    energy_drift: float
    evaluations: int
    seconds: float
    seconds_min: float
    seconds_max: float
    failure: str | None
    order: float | None


def swept_runs(sweep: Sweep, found: Mapping[str, NDArray[np.generic]]) -> list[Run]:
    """Return the runs of one method, the largest step first, with the order observed from each to the next."""
    made: list[Run] = []
    for k in np.argsort(sweep.steps)[::-1].tolist():
        values = {key: column[k].item() for key, column in found.items()}
        error = None if np.isnan(values["trajectory_error"]) else values["trajectory_error"]
        order, h, failure = None, sweep.steps[k], values["failure"] or None
        if made and error and (before := made[-1].trajectory_error) and error > ABOVE * sweep.reference.error:
            order = float(np.log(before / error) / np.log(made[-1].h / h))
        values |= {"trajectory_error": error, "failure": failure}
        made.append(Run(sweep.method, h, order=order, **values))
    return made


def pareto_front(points: Iterable[tuple[float, float | None]]) -> list[int]:
    """Return the indices of the Pareto front by (cost, error), ascending in cost: none is cheaper and as accurate."""
    ranked = sorted((cost, error, k) for k, (cost, error) in enumerate(points) if error is not None)
    best, on_it = np.inf, []
    for _, error, k in ranked:
        if error < best:
            best = error
            on_it.append(k)
    return on_it


def pareto_fronts(swept: Sequence[Run]) -> list[str]:
    """Return for each run on which fronts it is: T by trajectory error, c by constraint error, over evaluations."""
    by_trajectory = pareto_front((run.evaluations, run.trajectory_error) for run in swept)
    by_constraint = pareto_front((run.evaluations, None if run.failure else run.c_max) for run in swept)
    return [" ".join(["T"] * (k in by_trajectory) + ["c"] * (k in by_constraint)) for k in range(len(swept))]


@dataclass(frozen=True)
class Summary:
    """What a sweep says of one method; None where it says nothing.

    order: between the two smallest steps whose error is well above the reference's. alpha_step: the largest alpha h
    per evaluation with alpha = beta that is stable. needed: evaluations for an error of FINE, interpolated or
    extrapolated. coarsest: the largest step (s) whose run did not fail.
    """

    method: Method
    stated_order: int
    order: float | None
    area: float
    alpha_step: float
    needed: float | None
    coarsest: float | None


def summary(swept: Sequence[Run]) -> Summary:
    """Return the summary of one method's runs, the largest step first."""
    method = swept[0].method
    stable = [run for run in swept if run.failure is None]
    along = np.linspace(0, 4, LINE)[1:]
    within = spectral_radius(method, 2 * along, along**2) < 1
    return Summary(
        method,
        accuracy(method)[0],
        next((run.order for run in reversed(swept) if run.order is not None), None),
        region(method).area,
        float(along[within].max(initial=0.0)) / evaluations(method),
        _evaluations_for(FINE, stable),
        stable[0].h if stable else None,
    )


def _evaluations_for(error: float, swept: Sequence[Run]) -> float | None:
    """Return the evaluations at which the error falls to `error`, by the power law between (beyond) its neighbours."""
    usable = [run for run in swept if run.trajectory_error and (run.order is not None or run is swept[0])]
    if len(usable) < 2:
        return None
    pairs = list(pairwise(usable))
    first, second = next((pair for pair in pairs if (pair[1].trajectory_error or 0) <= error), pairs[-1])
    (x, y), (u, w) = (np.log([run.evaluations, run.trajectory_error or np.nan]) for run in (first, second))
    needed = float(np.exp(x + (u - x) * (np.log(error) - y) / (w - y)))
    return needed if needed < BEYOND * swept[-1].evaluations else None


def words(swept: Sequence[Run], tolerance: float, physical: bool) -> list[str]:
    """Return the answers: the cheapest run within the tolerance, lost orders, where Bezier methods win and lose."""
    names = dict.fromkeys(run.method.name for run in swept)
    found = [summary([run for run in swept if run.method.name == name]) for name in names]
    known = [(each, each.order) for each in found if each.order is not None]
    held, said = "α and β" if physical else "α̂ and β̂", [_cheapest(swept, tolerance)]
    orders = {True: "lost", False: "kept"}
    for lost, how in orders.items():
        names_of = [
            f"{each.method.name} {order:.1f} (of {each.stated_order})"
            for each, order in known
            if (order < each.stated_order - LOST) is lost
        ]
        if names_of:
            said.append(f"Order of accuracy with {held} held while h shrinks, {how}: {', '.join(names_of)}.")
    bezier = [each for each in found if re.fullmatch(r"B\d+", each.method.name)]
    if bezier:
        most = max(bezier, key=lambda each: steps(each.method))
        said += [_against(most, other) for other in found if other not in bezier]
    return said


def _cheapest(swept: Sequence[Run], tolerance: float) -> str:
    within = [run for run in swept if run.trajectory_error is not None and run.trajectory_error <= tolerance]
    if not within:
        least = min((run.trajectory_error for run in swept if run.trajectory_error is not None), default=None)
        known = "-" if least is None else f"{least:.1e}"
        return f"No run meets the tolerance {tolerance:g}; the least error is {known}."
    best = min(within, key=lambda run: run.evaluations)
    return (
        f"Cheapest for a trajectory error of {tolerance:g}: {best.method.name} at h = {best.h:g} s, error "
        f"{best.trajectory_error:.1e}, {best.evaluations} evaluations, {best.seconds:.2g} s."
    )


def _against(bezier: Summary, other: Summary) -> str:
    """Return where a Bezier method wins and where it loses against another, with the numbers."""
    points = []  # how many times better, and what is said
    ratio = bezier.area / other.area
    points.append((ratio, f"region {ratio:.2g} times as large"))
    if other.alpha_step:
        ratio = other.alpha_step / bezier.alpha_step
        points.append((1 / ratio, f"stable at one α = β with {ratio:.2g} times the evaluations"))
    if bezier.coarsest and other.coarsest:
        ends = f"runs through up to h = {bezier.coarsest:g} s, the other up to {other.coarsest:g} s"
        points.append((bezier.coarsest / other.coarsest, ends))
    if bezier.needed and other.needed:
        ratio = bezier.needed / other.needed
        points.append((1 / ratio, f"a trajectory error of {FINE:g} with {ratio:.2g} times the evaluations"))
    said = []
    for verb, of in (("wins", 1), ("loses", -1)):
        found = [text for better, text in points if of * np.log(better) > np.log(ALIKE)]
        said += [f"{verb}: {', '.join(found)}"] * bool(found)
    return f"{bezier.method.name} against {other.method.name} {'; '.join(said) or 'does as well'}."
