"""Table 5 with Fig. 9: four methods at three points (section 5.2.3)."""

from collections.abc import Mapping
from fractions import Fraction
from functools import partial
from itertools import product

import numpy as np
from matplotlib.figure import Figure

from bezstab.mechanism import Simulation, constraint_motion
from bezstab.methods import lookup
from bezstab.paper.experiments import DURATION, STEP, experiment, largest, pole
from bezstab.paper.printed import COMPARED, TABLE_5, PrintedPole
from bezstab.paper.reports import Finding, Progress, Report, captioned_table
from bezstab.rationals import bisected_integers, exact
from bezstab.show import column_figure, line_at, pole_cells, pole_text, styled, with_legend
from bezstab.stability import feedback_cost, verdict

ROUNDED = 1e-13  # m: below, c_1 is rounding amplified by beta^2 h^2 / |1 - z|, and differs between machines
HALF_A_DIGIT = 0.5001  # of the last place: what rounding may take, and a little for the float64 that is rounded
ANGLE_ROUNDED = 1e-10  # rad: what rounding may add up to in 10 s, with room
EDGE_DIGITS = Fraction(1, 1000000)  # of β̂: how well the edge between two points is found
IRREGULAR = 0.01  # of c_1: less is left beside one wave where others have died out
KICKS = {1: 0.0, 2: 1e-5, 3: 1e-9}
"""m, of c_1 by case: from a consistent start AB4 leaves nothing but rounding to decay or grow, which differs between
machines; with these it stays above that for ten seconds, and below a millimetre, where the mechanism answers linearly.
"""
FAST = 0.25  # turns a step: beyond a quarter a wave is no longer seen as one

Runs = Mapping[tuple[int, str], Simulation]
"""The runs of Table 5, by the number of their case and the name of their method."""


def report(progress: Progress) -> Report:
    """Return Table 5 with Fig. 9, and what they claim."""
    runs = compared_runs(progress)
    claims = (
        poles_as_printed,
        points_lie_as_said,
        alike_well_inside,
        one_step_methods_oscillate,
        multistep_methods_are_damped,
        ab4_decreases,
        ab4_diverges,
        ab4_derivative_diverges,
        ab4_oscillates_fast,
        bezier_performs_better,
        oscillation_is_a_disadvantage,
    )
    return Report(
        tables={"table5": pole_table(runs)},
        figures={"fig9": partial(panels_figure, runs)},
        findings=[claim(runs) for claim in claims],
    )


def compared_runs(progress: Progress) -> Runs:
    """Return the runs at three points, each with four methods; where the table is about decay or growth, kicked."""
    wanted = list(product(TABLE_5, COMPARED))
    return {
        (case, name): experiment(name, *TABLE_5[case].point, kick=KICKS[case])
        for case, name in progress(wanted, "table5")
    }


def pole_table(runs: Runs) -> str:
    """Return Table 5 as Markdown."""
    caption = (
        f"Table 5: dominant poles, with Re z, Im z, |z| and ∠z as the paper prints them ({matching_numbers(runs)}; the "
        "others are marked with *), and what is left of c₁ in the simulation (h = 1 ms, RK4 at 5 ms; α̂ = 0.1 from a "
        f"consistent initial state, else c₁ kicked by {KICKS[2]:g} m, and at β̂ = 0.101 by {KICKS[3]:g} m; 0: below "
        "1e-13 m, which is rounding)."
    )
    rows = [pole_row(name, run, TABLE_5[case].poles[name]) for (case, name), run in runs.items()]
    return captioned_table(caption, rows)


def pole_row(method: str, run: Simulation, printed: PrintedPole) -> dict[str, str]:
    """Return a line of Table 5: a dominant pole, the paper's beside it, and how large c_1 still is, 0 if rounding.

    A printed number that is not the pole's is marked.
    """
    z = pole(run)
    marked = [text if wrong is None else f"{text}*" for text, wrong in zip(printed, misprints(printed, z), strict=True)]
    before, after = (left if left > ROUNDED else 0.0 for left in (largest(run, 6, 8), largest(run, 8, 10)))
    return {
        "α̂": f"{run.alpha_hat:g}",
        "β̂": f"{run.beta_hat:g}",
        "method": method,
        "dominant pole": pole_text(pole_cells(z)),
        "|z_p|": f"{abs(z):.4f}",
        "∠z_p (deg)": f"{np.degrees(np.angle(z)):.3f}",
        "as printed (*: not ours)": " ".join(marked),
        "largest |c₁| of 6 to 8 s (m)": f"{before:.0e}",
        "of 8 to 10 s": f"{after:.0e}",
    }


def matching_numbers(runs: Runs) -> str:
    """Return in words how many of the printed numbers are those of our poles, rounded to as many digits."""
    right = [
        wrong is None for (case, name), run in runs.items() for wrong in misprints(TABLE_5[case].poles[name], pole(run))
    ]
    return f"{sum(right)} of {len(right)} numbers match"


def misprints(printed: PrintedPole, z: complex) -> list[str | None]:
    """Return for each number of a printed pole what is wrong with it; None where it is the pole's to as many digits."""
    values = z.real, z.imag, abs(z), float(np.degrees(np.angle(z)))
    return [_misprint(text, value) for text, value in zip(printed, values, strict=True)]


def _misprint(text: str, value: float) -> str | None:
    decimals = len(text.partition(".")[2])
    digit = 10.0**-decimals
    if abs(float(text) - value) <= HALF_A_DIGIT * digit:
        return None
    is_cut_off = 0 <= abs(value) - abs(float(text)) < digit
    return f"{text} should be {value:.{decimals}f}{' (cut off, not rounded)' if is_cut_off else ''}"


def poles_as_printed(runs: Runs) -> Finding:
    """Return which of the printed poles are not ours."""
    misprinted = []
    for (number, name), run in runs.items():
        case = TABLE_5[number]
        wrong = [words for words in misprints(case.poles[name], pole(run)) if words]
        if wrong:
            misprinted.append(f"{name} at ({case.alpha_hat}, {case.beta_hat}): {', '.join(wrong)}")
    return Finding(
        "Table 5",
        "dominant poles of four methods at three points",
        "48 numbers",
        "; ".join([matching_numbers(runs), *misprinted]),
        [not misprinted, len(misprinted) < len(runs)],
    )


def points_lie_as_said(runs: Runs) -> Finding:
    """Return at which of the printed points which method diverges, and where the edge of AB4 between the last two is.

    All proven. The edge is where bisection between the second and the third point ends.
    """
    outside = [
        f"{name} at ({TABLE_5[case].alpha_hat}, {TABLE_5[case].beta_hat})"
        for case, name in runs
        if verdict(lookup(name), *TABLE_5[case].exact) == "diverges"
    ]
    (alpha_hat, inner), (_, outer) = TABLE_5[2].exact, TABLE_5[3].exact
    edge, _ = bisected_integers(
        lambda place: verdict(lookup("AB4"), alpha_hat, place * EDGE_DIGITS) != "converges",
        int(inner / EDGE_DIGITS),
        int(outer / EDGE_DIGITS),
    )
    return Finding(
        "Table 5",
        "all points lie in all regions, but the third outside AB4's",
        "“within the stability regions of all methods … In the third case, with a slight change in the value of β̂, "
        "the parameters for the Adams–Bashforth method are located outside the region, but close to the boundary”",
        f"outside: {', '.join(outside)}; AB4's edge lies at β̂ = {float(edge * EDGE_DIGITS):.5f} there",
        [outside == ["AB4 at (0.5, 0.101)"]],
    )


def alike_well_inside(runs: Runs) -> Finding:
    """Return the poles of B4 and AB4 in case 1, and how much more B4 leaves of c_1."""
    b4, ab4 = runs[1, "B4"], runs[1, "AB4"]
    ratio = largest(b4, 8, 10) / max(largest(ab4, 8, 10), ROUNDED)
    moduli = abs(pole(b4)), abs(pole(ab4))
    return Finding(
        "Fig. 9b",
        "well inside the region B4 and AB4 behave almost identically",
        "“when the Baumgarte parameters are within the stability region and far from the boundaries of the region; the "
        "Bézier and Adams–Bashforth methods show almost identical behavior”",
        f"|z_p| {moduli[0]:.3f} and {moduli[1]:.3f}; but after 8 s |c_1| of B4 is at least {ratio:.0e} times AB4's",
        [abs(moduli[0] - moduli[1]) < 0.01, 0.1 < ratio < 10],
    )


def one_step_methods_oscillate(runs: Runs) -> Finding:
    """Return all amplitudes in case 1, and whether those of RK4 and Euler last in every case."""
    amplitudes = ", ".join(f"{name} {_amplitude(runs[1, name])}" for name in COMPARED)
    ratio = largest(runs[1, "SIE"], 8, 10) / largest(runs[1, "RK4@5"], 8, 10)
    constant = all(0.5 < _growth(runs[key]) < 2 for key in product(TABLE_5, ("RK4@5", "SIE")))
    return Finding(
        "Fig. 9a, c, f",
        "RK4 and Euler oscillate constantly about zero, Euler with a much larger amplitude",
        "“the Runge–Kutta and the Euler's semi-implicit methods have a constant oscillation around the value of zero, "
        "and the amplitude of the oscillation is much larger for the Euler method”",
        f"case 1 after 8 s, |c_1| in m: {amplitudes}; Euler / RK4 = {ratio:.1f}",
        [constant, ratio > 3],
    )


def multistep_methods_are_damped(runs: Runs) -> Finding:
    """Return what is left of the oscillation of B4 and AB4 in case 1, and whether it is still falling."""
    b4, ab4 = runs[1, "B4"], runs[1, "AB4"]
    left = max(largest(b4, 8, 10), largest(ab4, 8, 10))
    return Finding(
        "Fig. 9b",
        "the oscillation of B4 and AB4 is damped out",
        "“For the Bézier and Adams–Bashforth methods, the oscillation is damped out”",
        "far below RK4's, but to the level of the truncation error, not to zero: "
        f"{_amplitude(b4)} and {_amplitude(ab4)} m",
        [left < 0.01 * largest(runs[1, "RK4@5"], 8, 10), _growth(b4) < 0.5 and _growth(ab4) < 0.5],
    )


def ab4_decreases(runs: Runs) -> Finding:
    """Return whether AB4 converges at the edge of its region: as proven, and as run."""
    proven, growth = verdict(lookup("AB4"), *TABLE_5[2].exact), _growth(runs[2, "AB4"])
    return Finding(
        "Fig. 9d",
        "case 2: AB4's oscillation decreases gradually",
        "“the amplitude of these oscillations gradually decreases and the error of constraint converges to zero”",
        f"{proven}; after a kick of {KICKS[2]:g} m |c_1| of 8 to 10 s over that of 6 to 8 s: {growth:.2g}",
        [proven == "converges", growth < 1],
    )


def ab4_diverges(runs: Runs) -> Finding:
    """Return whether AB4 diverges just outside its region: as proven, and as run."""
    proven, growth = verdict(lookup("AB4"), *TABLE_5[3].exact), _growth(runs[3, "AB4"])
    return Finding(
        "Fig. 9e",
        "case 3: AB4 diverges gradually",
        "“a gradual increase of the amplitude of the oscillations and therefore divergence of the error of the "
        "constraint”",
        f"{proven}; after a kick of {KICKS[3]:g} m |c_1| of 8 to 10 s over that of 6 to 8 s: {growth:.2g}",
        [proven == "diverges", growth > 1],
    )


def ab4_derivative_diverges(runs: Runs) -> Finding:
    """Return by what the derivative of c_1 grows where AB4 is just outside its region."""
    growth = _growth(runs[3, "AB4"], rate=True)
    return Finding(
        "Section 5.2.3",
        "case 3: AB4's derivative diverges as well",
        "“a diverging behavior in the error of constraint and its time derivative for the Adams–Bashforth method, in "
        "the third case”",
        f"largest of 8 to 10 s over that of 6 to 8 s: {growth:.2g}",
        [growth > 1],
    )


def ab4_oscillates_fast(runs: Runs) -> Finding:
    """Return how fast c_1 of AB4 turns at the end of case 3, and how nearly as its dominant poles alone do.

    A single pair of poles z makes c_{n+1} - 2 Re z c_n + |z|² c_{n-1} zero: one regular wave.
    """
    run = runs[3, "AB4"]
    z, c = pole(run), run.c[run.t >= 8, 0]
    left = c[2:] - 2 * z.real * c[1:-1] + abs(z) ** 2 * c[:-2]
    irregular = float(np.abs(left).max() / np.abs(c).max())
    per_second = np.count_nonzero(np.diff(np.sign(c))) / 2 / (len(c) - 1) / run.h
    return Finding(
        "Section 5.2.3",
        "near the edge AB4 oscillates irregularly, and very fast",
        "“the magnitude of ∠z_p is large; therefore, the response of this method exhibits irregular oscillations with "
        "very high frequency”",
        f"{per_second:.0f} turns a second, each of {1 / per_second / run.h:.2f} steps; but "
        f"{'regular' if irregular < IRREGULAR else 'irregular'}: one wave of z_p leaves {irregular:.0e} of c_1",
        [bool(per_second * run.h > FAST), irregular > IRREGULAR],
    )


def bezier_performs_better(runs: Runs) -> Finding:
    """Return by what the crank's angle is wrong in the end, by method, in case 1, in which all are stable."""
    right = experiment("RK4").q[-1, 0]
    errors = {name: abs(float(runs[1, name].q[-1, 0] - right)) for name in COMPARED}
    shown = ", ".join(f"{name} {_above(error, ANGLE_ROUNDED)}" for name, error in errors.items())
    return Finding(
        "Section 6",
        "Bézier performs better than Adams–Bashforth and Runge–Kutta",
        "“a better performance of the Bézier method compared to both Adams–Bashforth and Runge–Kutta integration "
        "techniques”",
        f"larger region at equal cost (Fig. 3); but error of the crank's angle after {DURATION:g} s, case 1, in rad: "
        f"{shown}",
        [errors["B4"] < errors["RK4@5"], errors["B4"] < errors["AB4"]],
    )


def oscillation_is_a_disadvantage(runs: Runs) -> Finding:
    """Return what RK4's oscillation is due to: the method, or feedback that was chosen for stability alone.

    By the error that each method must force at the points of Table 5, and by runs with gains chosen for accuracy.
    """
    omega = constraint_motion(runs[1, "B4"].mechanism, DURATION).omega
    forced, accurate = {}, {}
    for name in ("RK4@5", "B4"):
        costs = [feedback_cost(lookup(name), *case.point, exact(omega) * exact(STEP)) for case in TABLE_5.values()]
        times = [cost.times_least or np.nan for cost in costs]
        order = f"{costs[0].order_left} of {costs[0].order}"
        forced[name] = f"{name} keeps order {order} and forces {min(times):.1g} to {max(times):.1g} times"
        accurate[name] = largest(experiment(name, *(costs[0].least_at or (np.nan, np.nan))), 8, 10)
    return Finding(
        "Section 6",
        "RK4's constant oscillation about zero is a disadvantage of the method",
        "“parameters … have been selected according to the stability regions”; “a constant oscillation about zero is "
        "observed …, which implies a clear disadvantage of these methods”",
        f"it is what strong feedback makes of stages: at the points of Table 5 {forced['RK4@5']} the error of gains "
        f"chosen for accuracy, {forced['B4']}; with such gains |c_1| after 8 s is {accurate['RK4@5']:.0e} and "
        f"{accurate['B4']:.0e} m, in case 1 {_amplitude(runs[1, 'RK4@5'])} and {_amplitude(runs[1, 'B4'])} m",
        [accurate["RK4@5"] > accurate["B4"]],
    )


def _growth(run: Simulation, rate: bool = False) -> float:
    """Return the largest |c_1|, or with `rate` |d c_1 / dt|, of the last two seconds over that of the two before."""
    return largest(run, 8, 10, rate) / largest(run, 6, 8, rate)


def _amplitude(run: Simulation) -> str:
    """Return the largest |c_1| (m) of the last two seconds."""
    return _above(largest(run, 8, 10), ROUNDED)


def _above(value: float, rounding: float) -> str:
    return f"{value:.0e}" if value > rounding else f"below {rounding:g}"


def panels_figure(runs: Runs) -> Figure:
    """Return c_1 against time for the cases of Table 5, one-step and multistep methods apart (paper Fig. 9)."""
    with styled():
        figure = column_figure(1.5)
        for place, axes in enumerate(figure.subplots(len(TABLE_5), 2).flat):
            case = 1 + place // 2
            # the paper's panels a to f: on the right the multistep methods, in the last row on the left
            for name in ("B4", "AB4") if place in (1, 3, 4) else ("RK4@5", "SIE"):
                run = runs[case, name]
                axes.plot(run.t, run.c[:, 0], label=name, linewidth=0.6, **line_at(COMPARED.index(name)))
            alpha_hat, beta_hat = TABLE_5[case].point
            axes.set_title(rf"{'abcdef'[place]}: $\hat\alpha = {alpha_hat:g}$, $\hat\beta = {beta_hat:g}$", fontsize=7)
        for axes in figure.axes[-2:]:
            axes.set_xlabel("t (s)")
        figure.supylabel("$c_1$ (m)", fontsize=8)
        return with_legend(figure, handles=[line for axes in figure.axes[:2] for line in axes.lines])
