"""Table 5 with Fig. 9: four methods at three points (section 5.2.3)."""

from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from functools import partial

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bezstab.mechanism import constraint_motion
from bezstab.methods import lookup, steps
from bezstab.paper.experiments import DURATION, STEP, Experiment, experiment
from bezstab.paper.printed import COMPARED, TABLE_5, PrintedCase, PrintedPole
from bezstab.paper.reports import Finding, Progress, Report, captioned_table
from bezstab.rationals import bisected_integers, exact
from bezstab.show import (
    Field,
    Row,
    column,
    column_figure,
    line_at,
    pole_cells,
    pole_text,
    styled,
    with_legend,
)
from bezstab.stability import dominant_pole, feedback_cost, verdict

ROUNDED = 1e-13  # m: below, c_1 is rounding amplified by beta^2 h^2 / |1 - z|, and differs between machines
HALF_A_DIGIT = 0.5001  # of the last place: what rounding may take, and a little for the float64 that is rounded
ANGLE_ROUNDED = 1e-10  # rad: what rounding may add up to in 10 s, with room
EDGE_DIGITS = Fraction(1, 1000000)  # of β̂: how well the edge between two points is found
IRREGULAR = 0.01  # of c_1: less is left beside one wave where others have died out
FAST = 0.25  # turns a step: beyond a quarter a wave is no longer seen as one
LAST_DIGIT = 1e-3  # a pole that is this near is the printed one, rounded or cut off after three decimals

PRINTED_POLES = [
    column("α̂", "alpha_hat", "g"),
    column("β̂", "beta_hat", "g"),
    column("method", "method"),
    Field("z_real", "", "dominant pole", text=pole_text),
    column("|z_p|", "z_abs", ".4f"),
    column("∠z_p (deg)", "z_angle_deg", ".3f"),
    column("as printed (*: not ours)", "printed"),
    column("largest |c₁| of 6 to 8 s (m)", "before", ".0e"),
    column("of 8 to 10 s", "after", ".0e"),
]

CaseRuns = Mapping[str, Experiment]
"""The runs of one case of Table 5, by the name of the method."""


def report(progress: Progress) -> Report:
    """Return Table 5 with Fig. 9, and what they claim."""
    runs = list(progress(compared_runs(), "table5", len(TABLE_5) * len(COMPARED)))
    return Report(
        tables={"table5": pole_table(runs)},
        figures={"fig9": partial(panels_figure, runs)},
        findings=findings(runs),
    )


def compared_runs() -> Iterator[Experiment]:
    """Yield three points, each with four methods."""
    for case in TABLE_5:
        for name in COMPARED:
            yield experiment(name, *case.point)


def by_case(runs: Sequence[Experiment]) -> list[CaseRuns]:
    """Return the runs of each case of Table 5."""
    return [{run.method.name: run for run in runs if (run.alpha_hat, run.beta_hat) == case.point} for case in TABLE_5]


def beside_printed(runs: Sequence[Experiment]) -> list[tuple[PrintedCase, Experiment, PrintedPole]]:
    """Return every run with its case of Table 5 and the pole that the paper prints for it."""
    return [
        (case, run, case.poles[name])
        for case, case_runs in zip(TABLE_5, by_case(runs), strict=True)
        for name, run in case_runs.items()
    ]


def pole_table(runs: Sequence[Experiment]) -> str:
    """Return Table 5 as Markdown."""
    caption = (
        f"Table 5: dominant poles, with Re z, Im z, |z| and ∠z as the paper prints them ({matching_numbers(runs)}; the "
        "others are marked with *), and what is left of c₁ in the simulation (h = 1 ms, RK4 at 5 ms, consistent "
        "initial state; 0: below 1e-13 m, which is rounding)."
    )
    rows = [pole_row(run, printed) for _, run, printed in beside_printed(runs)]
    return captioned_table(caption, rows, PRINTED_POLES)


def pole_row(run: Experiment, printed: PrintedPole) -> Row:
    """Return a line of Table 5: a dominant pole, the paper's beside it, and how large c_1 still is, 0 if rounding.

    A printed number that is not the pole's is marked.
    """
    marked = [
        text if wrong is None else f"{text}*" for text, wrong in zip(printed, misprints(printed, run.pole), strict=True)
    ]
    return {
        "alpha_hat": run.alpha_hat,
        "beta_hat": run.beta_hat,
        "method": run.method.name,
        **pole_cells(run.pole),
        "printed": " ".join(marked),
        "before": _zero_if_rounding(run.largest(6.0, 8.0)),
        "after": _zero_if_rounding(run.largest(8.0, 10.0)),
    }


def _zero_if_rounding(largest: float) -> float:
    return largest if largest > ROUNDED else 0.0


def findings(runs: Sequence[Experiment]) -> list[Finding]:
    """Return what the paper says of Table 5 and Fig. 9, held against poles and runs."""
    inside, at_the_edge, outside = by_case(runs)
    return [
        poles_as_printed(runs),
        points_lie_as_said(),
        alike_well_inside(inside),
        one_step_methods_oscillate(inside, at_the_edge, outside),
        multistep_methods_are_damped(inside),
        ab4_decreases(TABLE_5[1], at_the_edge["AB4"]),
        ab4_diverges(TABLE_5[2], outside["AB4"]),
        ab4_derivative_diverges(outside["AB4"]),
        ab4_oscillates_fast(outside["AB4"]),
        bezier_performs_better(inside),
        oscillation_is_a_disadvantage(inside),
    ]


def poles_as_printed(runs: Sequence[Experiment]) -> Finding:
    """Return which of the printed poles are not ours."""
    misprinted = []
    for case, run, printed in beside_printed(runs):
        wrong = [words for words in misprints(printed, run.pole) if words]
        if wrong:
            misprinted.append(f"{run.method.name} at ({case.alpha_hat}, {case.beta_hat}): {', '.join(wrong)}")
    return Finding(
        where="Table 5",
        claim="dominant poles of four methods at three points",
        paper="48 numbers",
        here="; ".join([matching_numbers(runs), *misprinted]),
        holds=[not misprinted, len(misprinted) < len(TABLE_5) * len(COMPARED)],
    )


def matching_numbers(runs: Sequence[Experiment]) -> str:
    """Return in words how many of the printed numbers are those of our poles, rounded to as many digits."""
    right = [wrong is None for _, run, printed in beside_printed(runs) for wrong in misprints(printed, run.pole)]
    return f"{sum(right)} of {len(right)} numbers match"


def misprints(printed: PrintedPole, pole: complex) -> list[str | None]:
    """Return for each number of a printed pole what is wrong with it; None where it is the pole's to as many digits."""
    values = pole.real, pole.imag, abs(pole), float(np.degrees(np.angle(pole)))
    return [_misprint(text, value) for text, value in zip(printed, values, strict=True)]


def _misprint(text: str, value: float) -> str | None:
    decimals = len(text.partition(".")[2])
    digit = 10.0**-decimals
    if abs(float(text) - value) <= HALF_A_DIGIT * digit:
        return None
    is_cut_off = 0 <= abs(value) - abs(float(text)) < digit
    return f"{text} should be {value:.{decimals}f}{' (cut off, not rounded)' if is_cut_off else ''}"


def points_lie_as_said() -> Finding:
    """Return at which of the printed points which method diverges, and where the edge of AB4 between the last two is.

    All proven. The edge is where bisection between the second and the third point ends.
    """
    outside = [
        f"{name} at ({case.alpha_hat}, {case.beta_hat})"
        for case in TABLE_5
        for name in COMPARED
        if verdict(lookup(name), *case.exact) == "diverges"
    ]
    (alpha_hat, inner), (_, outer) = TABLE_5[1].exact, TABLE_5[2].exact
    edge, _ = bisected_integers(
        lambda place: verdict(lookup("AB4"), alpha_hat, place * EDGE_DIGITS) != "converges",
        int(inner / EDGE_DIGITS),
        int(outer / EDGE_DIGITS),
    )
    return Finding(
        where="Table 5",
        claim="all points lie in all regions, but the third outside AB4's",
        paper="“within the stability regions of all methods … In the third case, with a slight change in the value of "
        "β̂, the parameters for the Adams–Bashforth method are located outside the region, but close to the boundary”",
        here=f"outside: {', '.join(outside)}; AB4's edge lies at β̂ = {float(edge * EDGE_DIGITS):.5f} there",
        holds=[outside == ["AB4 at (0.5, 0.101)"]],
    )


def alike_well_inside(runs: CaseRuns) -> Finding:
    """Return the poles of B4 and AB4 in case 1, and how much more B4 leaves of c_1."""
    b4, ab4 = runs["B4"], runs["AB4"]
    ratio = b4.largest(8, 10) / max(ab4.largest(8, 10), ROUNDED)
    moduli = abs(b4.pole), abs(ab4.pole)
    return Finding(
        where="Fig. 9b",
        claim="well inside the region B4 and AB4 behave almost identically",
        paper="“when the Baumgarte parameters are within the stability region and far from the boundaries of the "
        "region; the Bézier and Adams–Bashforth methods show almost identical behavior”",
        here=f"|z_p| {moduli[0]:.3f} and {moduli[1]:.3f}; "
        f"but after 8 s |c_1| of B4 is at least {ratio:.0e} times AB4's",
        holds=[abs(moduli[0] - moduli[1]) < 0.01, 0.1 < ratio < 10],
    )


def one_step_methods_oscillate(*cases: CaseRuns) -> Finding:
    """Return all amplitudes in the first of the cases, and whether those of RK4 and Euler last in every one."""
    first = cases[0]
    amplitudes = ", ".join(f"{name} {_amplitude(run)}" for name, run in first.items())
    ratio = first["SIE"].largest(8, 10) / first["RK4@5"].largest(8, 10)
    constant = all(0.5 < _growth(case[name]) < 2 for case in cases for name in ("RK4@5", "SIE"))
    return Finding(
        where="Fig. 9a, c, f",
        claim="RK4 and Euler oscillate constantly about zero, Euler with a much larger amplitude",
        paper="“the Runge–Kutta and the Euler's semi-implicit methods have a constant oscillation around the value of "
        "zero, and the amplitude of the oscillation is much larger for the Euler method”",
        here=f"case 1 after 8 s, |c_1| in m: {amplitudes}; Euler / RK4 = {ratio:.1f}",
        holds=[constant, first["SIE"].largest(8, 10) > 3 * first["RK4@5"].largest(8, 10)],
    )


def multistep_methods_are_damped(runs: CaseRuns) -> Finding:
    """Return what is left of the oscillation of B4 and AB4 in case 1, and whether it is still falling."""
    b4, ab4 = runs["B4"], runs["AB4"]
    left = max(b4.largest(8, 10), ab4.largest(8, 10))
    return Finding(
        where="Fig. 9b",
        claim="the oscillation of B4 and AB4 is damped out",
        paper="“For the Bézier and Adams–Bashforth methods, the oscillation is damped out”",
        here="far below RK4's, but to the level of the truncation error, not to zero: "
        f"{_amplitude(b4)} and {_amplitude(ab4)} m",
        holds=[left < 0.01 * runs["RK4@5"].largest(8, 10), _growth(b4) < 0.5 and _growth(ab4) < 0.5],
    )


def ab4_decreases(case: PrintedCase, run: Experiment) -> Finding:
    """Return whether AB4 converges at the edge of its region: as proven, and as run."""
    proven, growth = verdict(lookup("AB4"), *case.exact), _growth(run)
    return Finding(
        where="Fig. 9d",
        claim="case 2: AB4's oscillation decreases gradually",
        paper="“the amplitude of these oscillations gradually decreases and the error of constraint converges to zero”",
        here=f"{proven}; |c_1| of 8 to 10 s {'below' if growth < 1 else 'above'} that of 6 to 8 s",
        holds=[proven == "converges", growth < 1],
    )


def ab4_diverges(case: PrintedCase, run: Experiment) -> Finding:
    """Return whether AB4 diverges just outside its region: as proven, and as run."""
    proven, growth = verdict(lookup("AB4"), *case.exact), _growth(run)
    return Finding(
        where="Fig. 9e",
        claim="case 3: AB4 diverges gradually",
        paper="“a gradual increase of the amplitude of the oscillations and therefore divergence of the error of the "
        "constraint”",
        here=f"{proven}; |c_1| of 8 to 10 s over that of 6 to 8 s: {growth:.2g}",
        holds=[proven == "diverges", growth > 1],
    )


def ab4_derivative_diverges(run: Experiment) -> Finding:
    """Return by what the derivative of c_1 grows where AB4 is just outside its region."""
    growth = run.largest(8, 10, rate=True) / run.largest(6, 8, rate=True)
    return Finding(
        where="Section 5.2.3",
        claim="case 3: AB4's derivative diverges as well",
        paper="“a diverging behavior in the error of constraint and its time derivative for the Adams–Bashforth "
        "method, in the third case”",
        here=f"largest of 8 to 10 s over that of 6 to 8 s: {growth:.2g}",
        holds=[growth > 1],
    )


def ab4_oscillates_fast(run: Experiment) -> Finding:
    """Return how fast c_1 of AB4 turns at the end of case 3, and how nearly as its dominant poles alone do.

    A single pair of poles z makes c_{n+1} - 2 Re z c_n + |z|² c_{n-1} zero: one regular wave.
    """
    c = run.c[run.t >= 8]
    left = c[2:] - 2 * run.pole.real * c[1:-1] + abs(run.pole) ** 2 * c[:-2]
    irregular = float(np.abs(left).max() / np.abs(c).max())
    per_second = np.count_nonzero(np.diff(np.sign(c))) / 2 / (len(c) - 1) / run.h
    return Finding(
        where="Section 5.2.3",
        claim="near the edge AB4 oscillates irregularly, and very fast",
        paper="“the magnitude of ∠z_p is large; therefore, the response of this method exhibits irregular oscillations "
        "with very high frequency”",
        here=f"{per_second:.0f} turns a second, each of {1 / per_second / run.h:.2f} steps; but "
        f"{'regular' if irregular < IRREGULAR else 'irregular'}: one wave of z_p leaves {irregular:.0e} of c_1",
        holds=[bool(per_second * run.h > FAST), irregular > IRREGULAR],
    )


def bezier_performs_better(runs: CaseRuns) -> Finding:
    """Return by what the crank's angle is wrong in the end, by method, in a case in which all are stable."""
    right = experiment("RK4")
    errors = {name: abs(float(run.trajectory.q[-1, 0] - right.trajectory.q[-1, 0])) for name, run in runs.items()}
    shown = ", ".join(f"{name} {_above(error, ANGLE_ROUNDED)}" for name, error in errors.items())
    return Finding(
        where="Section 6",
        claim="Bézier performs better than Adams–Bashforth and Runge–Kutta",
        paper="“a better performance of the Bézier method compared to both Adams–Bashforth and Runge–Kutta integration "
        "techniques”",
        here=f"larger region at equal cost (Fig. 3); but error of the crank's angle after {DURATION:g} s, case 1, in "
        f"rad: {shown}",
        holds=[errors["B4"] < errors["RK4@5"], errors["B4"] < errors["AB4"]],
    )


def oscillation_is_a_disadvantage(runs: CaseRuns) -> Finding:
    """Return what RK4's oscillation is due to: the method, or feedback that was chosen for stability alone.

    By the error that each method must force at the points of Table 5, and by runs with gains chosen for accuracy.
    """
    omega = constraint_motion(runs["B4"].trajectory.mechanism, DURATION).omega
    forced, accurate = {}, {}
    for name in ("RK4@5", "B4"):
        costs = [feedback_cost(lookup(name), *case.point, exact(omega) * exact(STEP)) for case in TABLE_5]
        times = [cost.times_least or np.nan for cost in costs]
        order = f"{costs[0].order_left} of {costs[0].order}"
        forced[name] = f"{name} keeps order {order} and forces {min(times):.1g} to {max(times):.1g} times"
        accurate[name] = experiment(name, *(costs[0].least_at or (np.nan, np.nan))).largest(8, 10)
    return Finding(
        where="Section 6",
        claim="RK4's constant oscillation about zero is a disadvantage of the method",
        paper="“parameters … have been selected according to the stability regions”; “a constant oscillation about "
        "zero is observed …, which implies a clear disadvantage of these methods”",
        here=f"it is what strong feedback makes of stages: at the points of Table 5 {forced['RK4@5']} the error of "
        f"gains chosen for accuracy, {forced['B4']}; with such gains |c_1| after 8 s is {accurate['RK4@5']:.0e} and "
        f"{accurate['B4']:.0e} m, in case 1 {_amplitude(runs['RK4@5'])} and {_amplitude(runs['B4'])} m",
        holds=[accurate["RK4@5"] > accurate["B4"]],
    )


def _growth(run: Experiment) -> float:
    """Return the largest |c_1| of the last two seconds over that of the two before."""
    return run.largest(8, 10) / run.largest(6, 8)


def _amplitude(run: Experiment) -> str:
    """Return the largest |c_1| (m) of the last two seconds."""
    return _above(run.largest(8, 10), ROUNDED)


def _above(value: float, rounding: float) -> str:
    return f"{value:.0e}" if value > rounding else f"below {rounding:g}"


def what_semi_implicit_euler_is(table_5: Sequence[PrintedCase] = TABLE_5) -> Finding:
    """Return which method's poles are those that Table 5 prints for "Euler semi-implicit".

    The claim holds as it stands if they are those of symplectic Euler (SYM), which everybody else calls so; with a
    correction if they are those of an explicit Euler step, corrected once (SIE).
    """
    sie_matches, sym_matches = matching_poles("SIE", table_5), matching_poles("SYM", table_5)
    is_symplectic = sym_matches == len(table_5)
    is_corrected_once = sie_matches == len(table_5)
    return Finding(
        where="Table 5",
        claim="a method called “Euler semi-implicit”",
        paper="“Euler's semi-implicit scheme”",
        here=f"1 + μ + μ² (Euler, corrected once): {sie_matches} of 3 poles; symplectic Euler: {sym_matches} of 3",
        holds=[is_symplectic, is_symplectic or is_corrected_once],
    )


def matching_poles(name: str, table_5: Sequence[PrintedCase]) -> int:
    """Return how many of the poles printed for "Euler semi-implicit" are those of a method."""
    matches = 0
    for case in table_5:
        real, _, modulus, _ = map(float, case.poles["SIE"])
        pole = complex(dominant_pole(lookup(name), *case.point))
        matches += abs(abs(pole) - modulus) < LAST_DIGIT and abs(pole.real - real) < LAST_DIGIT
    return matches


def panels_figure(runs: Sequence[Experiment]) -> Figure:
    """Return c_1 against time for the cases of Table 5, one-step and multistep methods apart (paper Fig. 9)."""
    with styled():
        figure = column_figure(1.5)
        names = list(dict.fromkeys(run.method.name for run in runs))
        for row, case_runs in enumerate(by_case(runs)):
            for place in (0, 1):
                number = 2 * row + place
                axes = figure.add_subplot(len(TABLE_5), 2, number + 1)
                # the paper's panels a to f: on the right the multistep methods, in the last row on the left
                multistep = (place == 1) != (row == 2)
                shown = [run for run in case_runs.values() if (steps(run.method) > 1) == multistep]
                _draw_histories(axes, "abcdef"[number], shown, names)
        for axes in figure.axes[-2:]:
            axes.set_xlabel("t (s)")
        figure.supylabel("$c_1$ (m)", fontsize=8)
        lines = [line for axes in figure.axes[:2] for line in axes.lines]
        return with_legend(figure, handles=lines)


def _draw_histories(axes: Axes, letter: str, runs: Sequence[Experiment], names: Sequence[str]) -> None:
    """Draw c_1 against time of several runs at one point; `names` are all the methods of the figure."""
    for run in runs:
        line = line_at(names.index(run.method.name))
        axes.plot(run.t, run.c, label=run.method.name, linewidth=0.6, **line)
    point = rf"$\hat\alpha = {runs[0].alpha_hat:g}$, $\hat\beta = {runs[0].beta_hat:g}$"
    axes.set_title(f"{letter}: {point}", fontsize=7)
