"""Figs. 5 and 6: without stabilisation the constraint error grows until the run collapses (section 5.2.1)."""

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from itertools import product
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bezstab.mechanism import Simulation, Start
from bezstab.paper.experiments import START_NAMES, experiment, largest
from bezstab.paper.printed import TABLE_3
from bezstab.paper.reports import Finding, Outcome, Progress, Report
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

Runs = Mapping[tuple[Start, str, float], Simulation]
"""Runs without feedback, by their start, method and step (s)."""


def collapse_report(progress: Progress) -> Report:
    """Return Fig. 5 and what it claims."""
    runs = unstabilized(COLLAPSE_STEPS, COLLAPSE_DURATION, "fig5", progress)
    of_collapse = (b4_collapses_later, large_steps_last_longer, collapse_is_sudden)
    return Report(figures={"fig5": partial(drift_figure, runs)}, findings=[claim(runs) for claim in of_collapse])


def growth_report(progress: Progress) -> Report:
    """Return Fig. 6 and what it claims."""
    runs = unstabilized(GROWTH_STEPS, GROWTH_DURATION, "fig6", progress)
    of_growth = (
        growth_is_linear,
        both_levels_are_violated,
        first_constraint_represents_all,
        errors_are_of_one_order,
        b4_errs_less,
        large_steps_favour_b4,
    )
    return Report(figures={"fig6": partial(drift_figure, runs)}, findings=[claim(runs) for claim in of_growth])


def unstabilized(steps: Sequence[float], duration: float, label: str, progress: Progress) -> Runs:
    """Return the runs without feedback, of both methods from both starts; steps and duration in s."""
    return {
        (start, name, h): experiment(name, h=h, duration=duration, start=start)
        for start, name, h in progress(list(product(START_NAMES, METHODS, steps)), label)
    }


def from_either_start(judged: Callable[[Start], tuple[str, bool]]) -> Outcome:
    """Return what came out of a claim from either start, given what comes out of it from one."""
    texts, holds = zip(*map(judged, START_NAMES), strict=True)
    named = zip(START_NAMES.values(), texts, strict=True)
    return "; ".join(f"{name} start: {text}" for name, text in named), holds


def b4_collapses_later(runs: Runs) -> Finding:
    """Return when both methods collapse at each step."""
    steps = ", ".join(f"{1e3 * h:g}" for h in COLLAPSE_STEPS)

    def judged(start: Start) -> tuple[str, bool]:
        ends = [[_end(runs[start, name, h]) for name in METHODS] for h in COLLAPSE_STEPS]
        shown = ", ".join(" / ".join(map(_time, pair)) for pair in ends)
        return f"B4 / AB4 after {shown} s at {steps} ms", all(b4 > ab4 for b4, ab4 in ends)

    return Finding(
        "Fig. 5",
        "B4 collapses later than AB4",
        "“for all step sizes considered, the collapse point for the Bézier method occurs later than the "
        "Adams–Bashforth method”",
        *from_either_start(judged),
    )


def large_steps_last_longer(runs: Runs) -> Finding:
    """Return whether B4 outlasts AB4 by more where steps are larger, from either start."""
    ratios = [_end(runs["euler", "B4", h]) / _end(runs["euler", "AB4", h]) for h in COLLAPSE_STEPS]
    b4, ab4 = (_end(runs["rk4", name, COLLAPSE_STEPS[-1]]) for name in METHODS)
    return Finding(
        "Fig. 5",
        "B4 is more stable in particular for large steps",
        FOR_LARGE_STEPS,
        f"explicit Euler start: one ratio at every step, B4 / AB4 = {_each(ratios)} in time; RK4 start: AB4 outlasts "
        "B4",
        [ratios[-1] > MORE * ratios[0], b4 > ab4],
    )


def collapse_is_sudden(runs: Runs) -> Finding:
    """Return how large c_1 is shortly before the runs that blow up do."""
    before, sudden = [], []
    for run in runs.values():
        if run.failure:
            shortly_before = 0.99 * float(run.t[-1])
            before.append(largest(run, 0.0, shortly_before))
            sudden.append(largest(run, shortly_before, np.inf) > SUDDENLY * before[-1])
    return Finding(
        "Fig. 5",
        "the collapse is sudden",
        "“after some time, either the amount of error reaches a point that causes serious problems for the system "
        "simulation or collapses where the error suddenly increases too much”",
        f"{len(sudden)} runs blow up within the last 1 % of their time; before, |c_1| is at most {min(before):.2f} to "
        f"{max(before):.2f} m; the crank is {TABLE_3['l1']:g} m long",
        [bool(sudden) and all(sudden)],
    )


def _end(run: Simulation) -> float:
    """Return when a run blew up (s), infinite if it did not."""
    return float(run.t[-1]) if run.failure else np.inf


def growth_is_linear(runs: Runs) -> Finding:
    """Return to which power of time the largest |c_1| so far grows, over the last nine tenths of each run.

    Runs whose |c_1| stays so small that rounding has its part in it are left out.
    """
    times = np.linspace(GROWTH_DURATION / 10, GROWTH_DURATION, 40)
    powers = [_power(times, [largest(run, 0, time) for time in times.tolist()]) for run in _above_rounding(runs)]
    here = f"|c_1| like t to the power of {min(powers):.1f} to {max(powers):.1f}"
    return Finding(
        "Fig. 6",
        "without stabilisation the violation grows linearly with time",
        "“the constraint violation increases linearly with time”",
        here,
        [0.7 < power < 1.3 for power in powers],
    )


def both_levels_are_violated(runs: Runs) -> Finding:
    """Return how c_1 and its derivative of B4 compare at the end of each run and over its first half.

    What grows linearly has doubled since; what stays has not grown.
    """
    half = GROWTH_DURATION / 2
    of_b4 = [run for (_, name, _), run in runs.items() if name == "B4"]
    of_c, of_cdot = (
        [largest(run, half, GROWTH_DURATION, rate) / largest(run, 0, half, rate) for run in of_b4]
        for rate in (False, True)
    )
    least = min(largest(run, half, GROWTH_DURATION, rate=True) for run in of_b4)
    return Finding(
        "Introduction",
        "positions and velocities violate the constraints",
        "“violation of constraints occurs at position and velocity levels due to numerical errors associated with the "
        "integration process”",
        f"B4, second half of the run over the first: |c_1| {min(of_c):.2f} to {max(of_c):.2f} times, its derivative, "
        f"of {least:.0e} m/s and more, {min(of_cdot):.2f} to {max(of_cdot):.2f}",
        [min(of_c) > 1 and least > ROUNDING],
    )


def first_constraint_represents_all(runs: Runs) -> Finding:
    """Return whether c_1 is the largest of the four constraint errors in each run, and how small the others are."""
    largest_of_each = np.array([np.abs(run.c).max(axis=0) for run in _above_rounding(runs)])
    is_first = largest_of_each.argmax(axis=1) == 0
    ratios = largest_of_each[:, 0] / largest_of_each[:, 3]
    return Finding(
        "Section 5.2.1",
        "c_1 stands for all constraints",
        "“This constraint can be considered as representative of all of the constraints in Eq. (19)”",
        f"it is the largest in {np.count_nonzero(is_first)} of {len(is_first)} runs, {ratios.min():.0f} to "
        f"{ratios.max():.0f} times c_4",
        [bool(is_first.all()), bool(ratios.max() < ALIKE)],
    )


def errors_are_of_one_order(runs: Runs) -> Finding:
    """Return to which power of h the final |c_1| of both methods grows."""

    def judged(start: Start) -> tuple[str, bool]:
        b4, ab4 = (_power(GROWTH_STEPS, _final_errors(runs, start, name)) for name in METHODS)
        return f"B4 {b4:.0f}, AB4 {ab4:.0f}", abs(b4 - ab4) < 0.25

    return Finding(
        "Fig. 6",
        "both methods have the same order of error",
        "“both methods have the same order of error by considering the same step sizes”",
        *from_either_start(judged),
    )


def b4_errs_less(runs: Runs) -> Finding:
    """Return how the final |c_1| of B4 compares with AB4's at the same step.

    Steps at which AB4's is so small that rounding has its part in it are left out.
    """

    def judged(start: Start) -> tuple[str, bool]:
        ratios = _final_ratios(runs, start)[_final_errors(runs, start, "AB4") > ROUNDING]
        return f"B4 / AB4 = {_ratio(ratios.min())} to {_ratio(ratios.max())}", bool(ratios.max() < 1)

    return Finding(
        "Fig. 6",
        "B4's error is slightly below AB4's",
        "“the constraint error for 4th order Bézier is slightly less than 4th order Adams–Bashforth in different step "
        "sizes”",
        *from_either_start(judged),
    )


def large_steps_favour_b4(runs: Runs) -> Finding:
    """Return how the final |c_1| of B4 compares with AB4's at each step, from either start."""
    after_euler, after_rk4 = (_final_ratios(runs, start).tolist() for start in START_NAMES)
    return Finding(
        "Fig. 6",
        "B4 is more accurate in particular for large steps",
        FOR_LARGE_STEPS,
        f"explicit Euler start: one ratio at every step, B4 / AB4 = {_each(after_euler)}; RK4 start: "
        f"{_ratio(after_rk4[-1])} at {1e3 * GROWTH_STEPS[-1]:g} ms, the largest",
        [MORE * after_euler[-1] < after_euler[0], after_rk4[-1] < 1],
    )


def _above_rounding(runs: Runs) -> list[Simulation]:
    return [run for run in runs.values() if largest(run, 0, GROWTH_DURATION) > ROUNDING]


def _each(ratios: Sequence[float]) -> str:
    return ", ".join(f"{ratio:.2f}" for ratio in ratios)


def _final_errors(runs: Runs, start: Start, name: str) -> FloatArray:
    """Return the largest |c_1| (m) in the last fifth of one method's runs, step by step."""
    return np.array([largest(runs[start, name, h], 0.8 * GROWTH_DURATION, GROWTH_DURATION) for h in GROWTH_STEPS])


def _final_ratios(runs: Runs, start: Start) -> FloatArray:
    """Return that of B4 over that of AB4, step by step."""
    return _final_errors(runs, start, "B4") / _final_errors(runs, start, "AB4")


def _power(x: Sequence[float] | FloatArray, y: Sequence[float] | FloatArray) -> float:
    """Return the exponent of the power law nearest to y(x)."""
    slope, _ = np.polyfit(np.log(x), np.log(y), 1)
    return float(slope)


def _time(end: float) -> str:
    """Return the time of a collapse (s), or that it lies beyond the run."""
    return f"{end:.0f}" if end < np.inf else f"over {COLLAPSE_DURATION:.0f}"


def _ratio(value: float) -> str:
    """Return a ratio to the digits that are the same on every machine: of large ones, over rounding, only the first."""
    return f"{value:.2g}" if value < 100 else f"{value:.0e}"


def drift_figure(runs: Runs) -> Figure:
    """Return the growth of |c_1| without stabilisation, a panel for each start (paper Figs. 5 and 6)."""
    with styled():
        figure = column_figure(1.3)
        panels = dict(zip(START_NAMES, figure.subplots(len(START_NAMES), 1, sharex=True), strict=True))
        steps = sorted({h for _, _, h in runs})
        for (start, name, h), run in runs.items():
            line = {**line_at(METHODS.index(name)), "linestyle": DASHES[steps.index(h)]}
            _draw_growth(panels[start], run, f"{name}, {1e3 * h:g} ms", line)
        for start, axes in panels.items():
            axes.set(title=f"start: {START_NAMES[start]}", ylabel="largest $|c_1|$ so far (m)")
        axes.set_xlabel("t (s)")
        return with_legend(figure, handles=[line for line in axes.lines if line.get_marker() == "None"])


def _draw_growth(axes: Axes, run: Simulation, label: str, line: Mapping[str, Any]) -> None:
    """Draw the largest |c_1| so far on logarithmic axes, and a cross where the run failed."""
    largest_so_far = np.maximum.accumulate(np.abs(run.c[:, 0]))
    shown = np.unique(np.geomspace(1, len(largest_so_far) - 1, DRAWN).astype(int))
    axes.loglog(run.t[shown], largest_so_far[shown], label=label, **line)
    if run.failure:
        axes.plot(run.t[-1], largest_so_far[-1], "x", color=line["color"], markersize=4)
