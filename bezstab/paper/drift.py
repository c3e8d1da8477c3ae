"""Figs. 5 and 6: without stabilisation the constraint error grows until the run collapses (section 5.2.1)."""

from collections.abc import Iterator, Mapping, Sequence
from functools import partial

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bezstab.mechanism import Start
from bezstab.methods import lookup
from bezstab.paper.experiments import START_NAMES, Experiment, experiment
from bezstab.paper.findings import Finding, finding
from bezstab.paper.reports import Progress, Report
from bezstab.show import DASHES, column_figure, legend_below, line_at, styled
from bezstab.stability import FloatArray

METHODS = ("B4", "AB4")
GROWTH_STEPS = (0.001, 0.002, 0.005, 0.01)  # s
GROWTH_DURATION = 100.0  # s: while the error is small
COLLAPSE_STEPS = (0.02, 0.05, 0.1)  # s
COLLAPSE_DURATION = 2000.0  # s: until the runs blow up
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
                yield experiment(lookup(name), h=h, duration=duration, alpha_hat=0.0, beta_hat=0.0, start=start)


def collapse_findings(runs: Sequence[Experiment]) -> list[Finding]:
    """Return what Fig. 5 claims of the collapse: here, the time at which the run blows up."""
    ends = {}
    for run in runs:
        ends[run.start, run.method.name, run.h] = float(run.t[-1]) if run.failure else np.inf
    steps = ", ".join(f"{1e3 * h:g}" for h in COLLAPSE_STEPS)
    texts, later = {}, []
    for start in START_NAMES:
        b4_ends = [ends[start, "B4", h] for h in COLLAPSE_STEPS]
        ab4_ends = [ends[start, "AB4", h] for h in COLLAPSE_STEPS]
        pairs = [f"{_time(b4)} / {_time(ab4)}" for b4, ab4 in zip(b4_ends, ab4_ends, strict=True)]
        texts[start] = f"B4 / AB4 after {', '.join(pairs)} s at {steps} ms"
        later.append(all(b4 > ab4 for b4, ab4 in zip(b4_ends, ab4_ends, strict=True)))
    return [
        finding(
            where="Fig. 5",
            claim="B4 collapses later than AB4",
            paper="for all steps",
            here=_by_start(texts),
            holds=later,
        )
    ]


def growth_findings(runs: Sequence[Experiment]) -> list[Finding]:
    """Return what Fig. 6 claims of the error without stabilisation, before it is large."""
    return [growth_is_linear(runs), errors_are_of_one_order(runs), b4_errs_less(runs)]


def growth_is_linear(runs: Sequence[Experiment]) -> Finding:
    """Return to which power of time the largest |c_1| so far grows, over the last nine tenths of each run."""
    times = np.linspace(GROWTH_DURATION / 10, GROWTH_DURATION, 40)
    powers = []
    for run in runs:
        largest_so_far = np.array([run.largest(0, time) for time in times.tolist()])
        powers.append(_power(times, largest_so_far))
    return finding(
        where="Fig. 6",
        claim="without stabilisation the violation grows linearly with time",
        paper="linear",
        here=f"|c_1| like t to the power of {min(powers):.1f} to {max(powers):.1f}",
        holds=[0.7 < power < 1.3 for power in powers],
    )


def errors_are_of_one_order(runs: Sequence[Experiment]) -> Finding:
    """Return to which power of h the final |c_1| of both methods grows, from either start."""
    texts, same = {}, []
    for start in START_NAMES:
        b4, ab4 = (_power(np.array(GROWTH_STEPS), _final_errors(runs, start, name)) for name in METHODS)
        texts[start] = f"B4 {b4:.0f}, AB4 {ab4:.0f}"
        same.append(abs(b4 - ab4) < 0.25)
    return finding(
        where="Fig. 6",
        claim="both methods have the same order of error",
        paper="same order",
        here=_by_start(texts),
        holds=same,
    )


def b4_errs_less(runs: Sequence[Experiment]) -> Finding:
    """Return how the final |c_1| of B4 compares with AB4's at the same step, from either start."""
    texts, less = {}, []
    for start in START_NAMES:
        ratios = _final_errors(runs, start, "B4") / _final_errors(runs, start, "AB4")
        texts[start] = f"B4 / AB4 = {_ratio(ratios.min())} to {_ratio(ratios.max())}"
        less.append(bool(ratios.max() < 1))
    return finding(
        where="Fig. 6",
        claim="B4's error is slightly below AB4's",
        paper="slightly less",
        here=_by_start(texts),
        holds=less,
    )


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
        legend_below(figure, handles=[line for line in axes.lines if line.get_marker() == "None"])
        return figure


def _draw_growth(axes: Axes, run: Experiment, number: int) -> None:
    """Draw the largest |c_1| so far on logarithmic axes, dashed by the number of the step, a cross where it failed."""
    largest_so_far = np.maximum.accumulate(np.abs(run.c))
    shown = np.unique(np.geomspace(1, len(largest_so_far) - 1, DRAWN).astype(int))
    line = {**line_at(METHODS.index(run.method.name)), "linestyle": DASHES[number]}
    axes.loglog(run.t[shown], largest_so_far[shown], label=f"{run.method.name}, {1e3 * run.h:g} ms", **line)
    if run.failure:
        axes.plot(run.t[-1], largest_so_far[-1], "x", color=line["color"], markersize=4)
