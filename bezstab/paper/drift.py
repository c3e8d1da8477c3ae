"""Figs. 5 and 6: without stabilisation the constraint error grows until the run collapses (section 5.2.1)."""

from collections.abc import Iterator, Mapping, Sequence
from functools import partial

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bezstab.mechanism import Start
from bezstab.paper.experiments import START_NAMES, Experiment, experiment
from bezstab.paper.printed import TABLE_3
from bezstab.paper.reports import Finding, Progress, Report
from bezstab.show import DASHES, column_figure, line_at, styled, with_legend
from bezstab.stability import FloatArray

METHODS = ("B4", "AB4")
GROWTH_STEPS = (0.001, 0.002, 0.005, 0.01)  # s
GROWTH_DURATION = 100.0  # s: while the error is small
COLLAPSE_STEPS = (0.02, 0.05, 0.1)  # s
COLLAPSE_DURATION = 2000.0  # s: until the runs blow up
ROUNDING = 1e-10  # m or m/s: below, rounding has its part in 100 s without feedback
ALIKE = 10.0  # times: errors of one magnitude
MORE = 1.1  # times: what favours large steps must differ by more from the smallest to the largest
SUDDENLY = 5.0  # times within the last hundredth of a run; what grows linearly grows by 1.01 there
FOR_LARGE_STEPS = (
    "“In particular, the Bézier method provides more stable and even more accurate results for large step sizes”"
)
DRAWN = 300  # points of a long curve of one sign of slope: more than its pixels tell apart


def collapse_report(progress: Progress) -> Report:
    """Return Fig. 5 and what it claims."""
    runs = _followed(COLLAPSE_STEPS, COLLAPSE_DURATION, "fig5", progress)
    return Report(figures={"fig5": partial(drift_figure, runs)}, findings=collapse_findings(runs))


def growth_report(progress: Progress) -> Report:
    """Return Fig. 6 and what it claims."""
    runs = _followed(GROWTH_STEPS, GROWTH_DURATION, "fig6", progress)
    return Report(figures={"fig6": partial(drift_figure, runs)}, findings=growth_findings(runs))


def _followed(steps: Sequence[float], duration: float, label: str, progress: Progress) -> list[Experiment]:
    number = len(START_NAMES) * len(METHODS) * len(steps)
    return list(progress(unstabilized(steps, duration), label, number))


def unstabilized(steps: Sequence[float], duration: float) -> Iterator[Experiment]:
    """Yield the runs without feedback, of both methods from both starts; steps and duration in s."""
    for start in START_NAMES:
        for name in METHODS:
            for h in steps:
                yield experiment(name, h=h, duration=duration, start=start)


def collapse_findings(runs: Sequence[Experiment]) -> list[Finding]:
    """Return what Fig. 5 claims of the collapse: here, the time at which the run blows up."""
    return [b4_collapses_later(runs), large_steps_last_longer(runs), collapse_is_sudden(runs)]


def b4_collapses_later(runs: Sequence[Experiment]) -> Finding:
    """Return when both methods collapse at each step, from either start."""
    ends = _ends(runs)
    steps = ", ".join(f"{1e3 * h:g}" for h in COLLAPSE_STEPS)
    texts, later = {}, []
    for start in START_NAMES:
        b4_ends = [ends[start, "B4", h] for h in COLLAPSE_STEPS]
        ab4_ends = [ends[start, "AB4", h] for h in COLLAPSE_STEPS]
        pairs = [f"{_time(b4)} / {_time(ab4)}" for b4, ab4 in zip(b4_ends, ab4_ends, strict=True)]
        texts[start] = f"B4 / AB4 after {', '.join(pairs)} s at {steps} ms"
        later.append(all(b4 > ab4 for b4, ab4 in zip(b4_ends, ab4_ends, strict=True)))
    return Finding(
        where="Fig. 5",
        claim="B4 collapses later than AB4",
        paper="“for all step sizes considered, the collapse point for the Bézier method occurs later than the "
        "Adams–Bashforth method”",
        here=_by_start(texts),
        holds=later,
    )


def large_steps_last_longer(runs: Sequence[Experiment]) -> Finding:
    """Return whether B4 outlasts AB4 by more where steps are larger, from either start."""
    ends = _ends(runs)
    ratios = [ends["euler", "B4", h] / ends["euler", "AB4", h] for h in COLLAPSE_STEPS]
    largest = COLLAPSE_STEPS[-1]
    return Finding(
        where="Fig. 5",
        claim="B4 is more stable in particular for large steps",
        paper=FOR_LARGE_STEPS,
        here=f"explicit Euler start: one ratio at every step, B4 / AB4 = {_each(ratios)} in time; RK4 start: AB4 "
        "outlasts B4",
        holds=[ratios[-1] > MORE * ratios[0], ends["rk4", "B4", largest] > ends["rk4", "AB4", largest]],
    )


def collapse_is_sudden(runs: Sequence[Experiment]) -> Finding:
    """Return how large c_1 is shortly before the runs that blow up do."""
    collapsed = [run for run in runs if run.failure]
    shortly_before = [run.largest(0.0, 0.99 * float(run.t[-1])) for run in collapsed]
    at_the_end = [run.largest(0.99 * float(run.t[-1]), np.inf) for run in collapsed]
    sudden = [end > SUDDENLY * before for before, end in zip(shortly_before, at_the_end, strict=True)]
    return Finding(
        where="Fig. 5",
        claim="the collapse is sudden",
        paper="“after some time, either the amount of error reaches a point that causes serious problems for the "
        "system simulation or collapses where the error suddenly increases too much”",
        here=f"{len(collapsed)} runs blow up within the last 1 % of their time; before, |c_1| is at most "
        f"{min(shortly_before):.2f} to {max(shortly_before):.2f} m; the crank is {TABLE_3['l1']:g} m long",
        holds=[bool(collapsed) and all(sudden)],
    )


def _ends(runs: Sequence[Experiment]) -> dict[tuple[Start, str, float], float]:
    """Return when each run blew up (s), infinite if it did not, by its start, method and step."""
    return {(run.start, run.method.name, run.h): float(run.t[-1]) if run.failure else np.inf for run in runs}


def growth_findings(runs: Sequence[Experiment]) -> list[Finding]:
    """Return what Fig. 6 claims of the error without stabilisation, before it is large."""
    return [
        growth_is_linear(runs),
        both_levels_are_violated(runs),
        first_constraint_represents_all(runs),
        errors_are_of_one_order(runs),
        b4_errs_less(runs),
        large_steps_favour_b4(runs),
    ]


def growth_is_linear(runs: Sequence[Experiment]) -> Finding:
    """Return to which power of time the largest |c_1| so far grows, over the last nine tenths of each run.

    Runs whose |c_1| stays so small that rounding has its part in it are left out.
    """
    times = np.linspace(GROWTH_DURATION / 10, GROWTH_DURATION, 40)
    powers = []
    for run in runs:
        if run.largest(0, GROWTH_DURATION) < ROUNDING:
            continue
        largest_so_far = np.array([run.largest(0, time) for time in times.tolist()])
        powers.append(_power(times, largest_so_far))
    return Finding(
        where="Fig. 6",
        claim="without stabilisation the violation grows linearly with time",
        paper="“the constraint violation increases linearly with time”",
        here=f"|c_1| like t to the power of {min(powers):.1f} to {max(powers):.1f}",
        holds=[0.7 < power < 1.3 for power in powers],
    )


def both_levels_are_violated(runs: Sequence[Experiment]) -> Finding:
    """Return how c_1 and its derivative of B4 compare at the end of each run and over its first half.

    What grows linearly has doubled since; what stays has not grown.
    """
    half = GROWTH_DURATION / 2
    of_b4 = [run for run in runs if run.method.name == "B4"]
    growth_of_c = [run.largest(half, GROWTH_DURATION) / run.largest(0, half) for run in of_b4]
    growth_of_cdot = [run.largest(half, GROWTH_DURATION, rate=True) / run.largest(0, half, rate=True) for run in of_b4]
    least = min(run.largest(half, GROWTH_DURATION, rate=True) for run in of_b4)
    return Finding(
        where="Introduction",
        claim="positions and velocities violate the constraints",
        paper="“violation of constraints occurs at position and velocity levels due to numerical errors associated "
        "with the integration process”",
        here=f"B4, second half of the run over the first: |c_1| {min(growth_of_c):.2f} to {max(growth_of_c):.2f} "
        f"times, its derivative, of {least:.0e} m/s and more, {min(growth_of_cdot):.2f} to {max(growth_of_cdot):.2f}",
        holds=[min(growth_of_c) > 1 and least > ROUNDING],
    )


def first_constraint_represents_all(runs: Sequence[Experiment]) -> Finding:
    """Return whether c_1 is the largest of the four constraint errors in each run, and how small the others are."""
    seen = [run for run in runs if run.largest(0, GROWTH_DURATION) > ROUNDING]
    largest = np.array([np.abs(run.observation.c).max(axis=0) for run in seen])
    ratios = largest[:, 0] / largest[:, 3]
    return Finding(
        where="Section 5.2.1",
        claim="c_1 stands for all constraints",
        paper="“This constraint can be considered as representative of all of the constraints in Eq. (19)”",
        here=f"it is the largest in {np.count_nonzero(largest.argmax(axis=1) == 0)} of {len(seen)} runs, "
        f"{ratios.min():.0f} to {ratios.max():.0f} times c_4",
        holds=[bool((largest.argmax(axis=1) == 0).all()), bool(ratios.max() < ALIKE)],
    )


def errors_are_of_one_order(runs: Sequence[Experiment]) -> Finding:
    """Return to which power of h the final |c_1| of both methods grows, from either start."""
    texts, same = {}, []
    for start in START_NAMES:
        b4, ab4 = (_power(np.array(GROWTH_STEPS), _final_errors(runs, start, name)) for name in METHODS)
        texts[start] = f"B4 {b4:.0f}, AB4 {ab4:.0f}"
        same.append(abs(b4 - ab4) < 0.25)
    return Finding(
        where="Fig. 6",
        claim="both methods have the same order of error",
        paper="“both methods have the same order of error by considering the same step sizes”",
        here=_by_start(texts),
        holds=same,
    )


def b4_errs_less(runs: Sequence[Experiment]) -> Finding:
    """Return how the final |c_1| of B4 compares with AB4's at the same step, from either start.

    Steps at which AB4's is so small that rounding has its part in it are left out.
    """
    texts, less = {}, []
    for start in START_NAMES:
        of_b4, of_ab4 = _final_errors(runs, start, "B4"), _final_errors(runs, start, "AB4")
        ratios = (of_b4 / of_ab4)[of_ab4 > ROUNDING]
        texts[start] = f"B4 / AB4 = {_ratio(ratios.min())} to {_ratio(ratios.max())}"
        less.append(bool(ratios.max() < 1))
    return Finding(
        where="Fig. 6",
        claim="B4's error is slightly below AB4's",
        paper="“the constraint error for 4th order Bézier is slightly less than 4th order Adams–Bashforth in different "
        "step sizes”",
        here=_by_start(texts),
        holds=less,
    )


def large_steps_favour_b4(runs: Sequence[Experiment]) -> Finding:
    """Return how the final |c_1| of B4 compares with AB4's at each step, from either start."""
    by_start = {start: _final_errors(runs, start, "B4") / _final_errors(runs, start, "AB4") for start in START_NAMES}
    after_euler, after_rk4 = by_start["euler"], by_start["rk4"]
    return Finding(
        where="Fig. 6",
        claim="B4 is more accurate in particular for large steps",
        paper=FOR_LARGE_STEPS,
        here=f"explicit Euler start: one ratio at every step, B4 / AB4 = {_each(after_euler.tolist())}; RK4 start: "
        f"{_ratio(float(after_rk4[-1]))} at {1e3 * GROWTH_STEPS[-1]:g} ms, the largest",
        holds=[MORE * float(after_euler[-1]) < float(after_euler[0]), float(after_rk4[-1]) < 1],
    )


def _each(ratios: Sequence[float]) -> str:
    return ", ".join(f"{ratio:.2f}" for ratio in ratios)


def _final_errors(runs: Sequence[Experiment], start: Start, name: str) -> FloatArray:
    """Return the largest |c_1| (m) in the last fifth of one method's runs, step by step."""
    final = {run.h: run for run in runs if run.start == start and run.method.name == name}
    return np.array([final[h].largest(0.8 * GROWTH_DURATION, GROWTH_DURATION) for h in GROWTH_STEPS])


def _power(x: FloatArray, y: FloatArray) -> float:
    """Return the exponent of the power law nearest to y(x)."""
    slope, _ = np.polyfit(np.log(x), np.log(y), 1)
    return float(slope)


def _by_start(texts: Mapping[Start, str]) -> str:
    return "; ".join(f"{START_NAMES[start]} start: {text}" for start, text in texts.items())


def _time(end: float) -> str:
    """Return the time of a collapse (s), or that it lies beyond the run."""
    return f"{end:.0f}" if end < np.inf else f"over {COLLAPSE_DURATION:.0f}"


def _ratio(value: float) -> str:
    """Return a ratio to the digits that are the same on every machine: of large ones, over rounding, only the first."""
    return f"{value:.2g}" if value < 100 else f"{value:.0e}"


def drift_figure(runs: Sequence[Experiment]) -> Figure:
    """Return the growth of |c_1| without stabilisation, a panel for each start (paper Figs. 5 and 6)."""
    with styled():
        figure = column_figure(1.3)
        starts = list(dict.fromkeys(run.start for run in runs))
        steps = list(dict.fromkeys(run.h for run in runs))
        for axes, start in zip(figure.subplots(len(starts), 1, sharex=True), starts, strict=True):
            for run in runs:
                if run.start == start:
                    _draw_growth(axes, run, steps.index(run.h))
            axes.set(title=f"start: {START_NAMES[start]}", ylabel="largest $|c_1|$ so far (m)")
        axes.set_xlabel("t (s)")
        return with_legend(figure, handles=[line for line in axes.lines if line.get_marker() == "None"])


def _draw_growth(axes: Axes, run: Experiment, number: int) -> None:
    """Draw the largest |c_1| so far on logarithmic axes, dashed by the number of the step, a cross where it failed."""
    largest_so_far = np.maximum.accumulate(np.abs(run.c))
    shown = np.unique(np.geomspace(1, len(largest_so_far) - 1, DRAWN).astype(int))
    line = {**line_at(METHODS.index(run.method.name)), "linestyle": DASHES[number]}
    axes.loglog(run.t[shown], largest_so_far[shown], label=f"{run.method.name}, {1e3 * run.h:g} ms", **line)
    if run.failure:
        axes.plot(run.t[-1], largest_so_far[-1], "x", color=line["color"], markersize=4)
