"""Table 4 with Figs. 7 and 8, and section 4: what the parameters, and so the poles, do to c and ċ."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import combinations, pairwise, product

import numpy as np
from matplotlib.figure import Figure

from bezstab.paper.experiments import STEP, Experiment, experiment
from bezstab.paper.printed import FASTER_LEVEL, TABLE_5
from bezstab.paper.reports import Finding, Progress, Report, captioned_table
from bezstab.show import Field, Row, column, column_figure, line_at, pole_cells, pole_text, styled
from bezstab.stability import FloatArray, poles

KICK = 1e-3  # m: Table 4 is about decay and growth, so there must be something that decays or grows
DURATION = 0.4  # s
DECAYED = 1e-6  # of the kick: what a run does below it is no longer counted
FALLEN = 0.01  # of the largest: when a history counts as converged, to compare how fast
APART = 0.05  # in |z_p|: poles whose speeds differ by more than what double poles lag behind
WAVES = 0.05  # Im z_p: above it a pole turns visibly in the time of a run
VISIBLE = 1e-3  # of the largest ordinate: below it a curve is its axis


@dataclass(frozen=True)
class Case:
    """A row of Table 4: what the paper says of it, and a point that fits."""

    described: str
    alpha_hat: float
    beta_hat: float


TABLE_4 = (
    Case("diverges: α̂ is negative", alpha_hat=-0.02, beta_hat=0.1),
    Case("slow, without significant oscillation", alpha_hat=0.04, beta_hat=0.0004),
    Case("slow, oscillates", alpha_hat=0.12, beta_hat=0.52),
    Case("fast, hardly oscillates", alpha_hat=0.8, beta_hat=0.16),
    Case("fast, oscillates", alpha_hat=0.6, beta_hat=0.35),
    Case("diverges: both positive, outside the region", alpha_hat=1.5, beta_hat=0.7),
)
"""The paper's six cases in its order. Its numbers are lost; these points are ours and fit what it says of each."""

BEHAVIOURS = [
    column("case", "case", "d"),
    column("described as", "described"),
    column("α̂", "alpha_hat", "g"),
    column("β̂", "beta_hat", "g"),
    Field("z_real", "", "dominant pole", text=pole_text),
    column("|z_p|", "z_abs", ".4f"),
    column("∠z_p (deg)", "z_angle_deg", ".2f"),
    column("seen: |z|", "rate", ".4f"),
    column("zero crossings of c₁", "crossings", "d"),
]


@dataclass(frozen=True)
class Seen:
    """By what a history changed per step, how often it crossed zero, and the steps it took to fall to a hundredth."""

    rate: float
    crossings: int
    fallen: int


@dataclass(frozen=True)
class Behaviour:
    """A case of Table 4: dominant pole, and what c_1 and its derivative did as long as they were followed."""

    case: Case
    pole: complex
    failure: str | None
    followed: int
    c: Seen
    cdot: Seen


def report(progress: Progress) -> Report:
    """Return Table 4 with Figs. 7 and 8, and what they claim."""
    runs = list(progress(kicked_runs(), "table4", len(TABLE_4)))
    observed = behaviours(runs)
    return Report(
        tables={"table4": behaviour_table(observed)},
        figures={
            "fig7": partial(histories_figure, runs, derivative=False),
            "fig8": partial(histories_figure, runs, derivative=True),
        },
        findings=[*findings(observed), dominant_pole_is_seen_late(), physics_decides()],
    )


def kicked_runs() -> Iterator[Experiment]:
    """Yield the six cases of B4 at 1 ms."""
    for case in TABLE_4:
        yield experiment("B4", case.alpha_hat, case.beta_hat, duration=DURATION, kick=KICK)


def behaviours(runs: Iterable[Experiment]) -> list[Behaviour]:
    """Return Table 4: prediction, and what the kicked runs did as long as c_1 was above a millionth of the kick."""
    return [_behaviour(case, run) for case, run in zip(TABLE_4, runs, strict=True)]


def _behaviour(case: Case, run: Experiment) -> Behaviour:
    followed = int(np.flatnonzero(np.abs(run.c) > DECAYED * KICK)[-1])  # there is one: it begins with the kick
    c, cdot = (_seen(history, followed) for history in (run.c, run.cdot))
    return Behaviour(case, run.pole, run.failure, followed, c, cdot)


def _seen(history: FloatArray, followed: int) -> Seen:
    begin = history[: followed + 1]
    fallen = int(np.flatnonzero(np.abs(history) > FALLEN * np.abs(history).max())[-1]) + 1
    return Seen(_rate(begin), crossings=int(np.count_nonzero(np.diff(np.sign(begin)))), fallen=fallen)


def _rate(history: FloatArray) -> float:
    """Return by what the largest of a history changes per step, from its first half to its second."""
    half = len(history) // 2
    return float((np.abs(history[half:]).max() / np.abs(history[:half]).max()) ** (1 / half))


def behaviour_table(observed: Sequence[Behaviour]) -> str:
    """Return Table 4 as Markdown."""
    caption = (
        f"Table 4: B4 at h = {1e3 * STEP:g} ms, c₁ kicked by {1e3 * KICK:g} mm. The paper's "
        "numbers are lost; these points are ours and fit what it says of each case."
    )
    rows: list[Row] = [
        {
            "case": number,
            "described": behaviour.case.described,
            "alpha_hat": behaviour.case.alpha_hat,
            "beta_hat": behaviour.case.beta_hat,
            **pole_cells(behaviour.pole),
            "rate": behaviour.c.rate,
            "crossings": behaviour.c.crossings,
        }
        for number, behaviour in enumerate(observed, start=1)
    ]
    return captioned_table(caption, rows, BEHAVIOURS)


def findings(observed: Sequence[Behaviour]) -> list[Finding]:
    """Return what the paper says of the cases of Table 4, held against pole and run."""
    return [
        *descriptions(observed),
        unit_circle_decides(observed),
        smaller_poles_are_faster(observed),
        regions_h_are_faster(observed),
        angle_is_the_frequency(observed),
        derivative_behaves_alike(observed),
    ]


def descriptions(observed: Sequence[Behaviour]) -> list[Finding]:
    """Return what section 5.2.2 says of each case."""
    negative, slow, slow_waving, fast, fast_waving, outside = observed
    return [
        Finding(
            where="Table 4",
            claim="cases 1 and 6 diverge: α̂ < 0, or outside the region",
            paper="“it is expected to observe a divergent response as the parameter α̂ is negative and |z_p| is "
            "greater than one. In case 6, although the parameters are positive …, the overall result also diverges”",
            here=_shown(negative, outside),
            holds=[_diverges(negative) and _diverges(outside)],
        ),
        Finding(
            where="Table 4",
            claim="cases 2 and 3 converge slowly; 3 oscillates, 2 does not significantly",
            paper="“low convergence speeds, since the size of the dominant pole is close to one in both cases. … case "
            "3 exhibits oscillations, while case 2 does not exhibit significant oscillations”",
            here=_shown(slow, slow_waving),
            holds=[
                0.95 < slow.c.rate < 1
                and 0.95 < slow_waving.c.rate < 1
                and slow_waving.c.crossings > 10 > slow.c.crossings
            ],
        ),
        Finding(
            where="Table 4",
            claim="cases 4 and 5 converge fast; 5 oscillates, 4 hardly",
            paper="“high convergence speeds … case 5 shows oscillations, while case 4 exhibits either fewer number of "
            "oscillations or no oscillations”",
            here=_shown(fast, fast_waving),
            holds=[fast.c.rate < 0.85 and fast_waving.c.rate < 0.85 and fast_waving.c.crossings > fast.c.crossings],
        ),
    ]


def unit_circle_decides(observed: Sequence[Behaviour]) -> Finding:
    """Return in how many cases c_1 and its derivative grow if |z_p| > 1 and fall if |z_p| < 1."""
    as_said = [
        min(case.c.rate, case.cdot.rate) > 1 if abs(case.pole) > 1 else max(case.c.rate, case.cdot.rate) < 1
        for case in observed
    ]
    return Finding(
        where="Section 4",
        claim="c and ċ diverge or converge as |z_p| says",
        paper="“c and ċ diverge if |z_p| > 1 …, and converge to zero if |z_p| < 1 for all of the poles”",
        here=f"c_1 and its derivative in {sum(as_said)} of {len(observed)} cases",
        holds=[all(as_said)],
    )


def smaller_poles_are_faster(observed: Sequence[Behaviour]) -> Finding:
    """Return how many steps each case that converges takes to fall to a hundredth, by its |z_p|.

    A double pole is slower at first: its error falls like n |z_p|^n.
    """
    converging = sorted((case for case in observed if abs(case.pole) < 1), key=lambda case: abs(case.pole))
    shown = ", ".join(f"{abs(case.pole):.4f} {case.c.fallen} and {case.cdot.fallen}" for case in converging)
    in_order = all(_is_faster(first, second) for first, second in pairwise(converging))
    apart = (pair for pair in combinations(converging, 2) if abs(pair[1].pole) - abs(pair[0].pole) > APART)
    return Finding(
        where="Section 4",
        claim="the smaller |z_p|, the faster",
        paper="“the smaller the magnitude of |z_p|, the faster c and ċ converge to zero”",
        here=f"steps to 1 % of c_1 and of its derivative, by |z_p|: {shown}; a double pole (cases 2 and 4) is slower "
        "than another of its size",
        holds=[in_order, all(_is_faster(*pair) for pair in apart)],
    )


def regions_h_are_faster(observed: Sequence[Behaviour]) -> Finding:
    """Return how many steps the cases in the region H of Fig. 1 take to fall to a hundredth, beside the others."""
    converging = [case for case in observed if abs(case.pole) < 1]
    inside = [case for case in converging if abs(case.pole) < FASTER_LEVEL["B4"]]
    outside = [case for case in converging if case not in inside]

    def steps(cases: Sequence[Behaviour]) -> str:
        return ", ".join(f"{case.c.fallen} and {case.cdot.fallen}" for case in cases)

    return Finding(
        where="Section 5.1",
        claim="in the regions H errors vanish faster",
        paper="“by choosing α̂ and β̂ in these regions, the error of constraint and its derivative converge to zero "
        "more rapidly”",
        here=f"steps to 1 % of c_1 and of its derivative: in H {steps(inside)}; outside {steps(outside)}",
        holds=[all(_is_faster(fast, slow) for fast, slow in product(inside, outside))],
    )


def _is_faster(one: Behaviour, other: Behaviour) -> bool:
    """Return whether c_1 and its derivative both fall earlier in one case than in the other."""
    return one.c.fallen < other.c.fallen and one.cdot.fallen < other.cdot.fallen


def angle_is_the_frequency(observed: Sequence[Behaviour]) -> Finding:
    """Return the angle of each pole beside that by which c_1 and its derivative turn a step: half a turn a crossing."""
    waving = sorted((case for case in observed if case.pole.imag > WAVES), key=lambda case: np.angle(case.pole))
    seen = [(180 * case.c.crossings / case.followed, 180 * case.cdot.crossings / case.followed) for case in waving]
    shown = ", ".join(
        f"{np.degrees(np.angle(case.pole)):.0f} seen {c:.0f} and {cdot:.0f}"
        for case, (c, cdot) in zip(waving, seen, strict=True)
    )
    return Finding(
        where="Section 4",
        claim="the smaller the angle of z_p, the lower the frequency",
        paper="“the smaller the magnitude of ∠z_p (angle of z_p), the smaller the frequency of oscillations of c and "
        "ċ”",
        here=f"degrees a step, of c_1 and of its derivative: {shown}",
        holds=[all(lower[0] < higher[0] and lower[1] < higher[1] for lower, higher in pairwise(seen))],
    )


def derivative_behaves_alike(observed: Sequence[Behaviour]) -> Finding:
    """Return by what the derivative changes a step, and how often it crosses zero: as the cases are described?"""
    of_cdot = [replace(case, c=case.cdot) for case in observed]
    shown = ", ".join(f"{case.c.rate:.3f} ({case.c.crossings})" for case in of_cdot)
    return Finding(
        where="Figs 7, 8",
        claim="the derivative confirms Table 4 as well",
        paper="“the errors for both the first kinematic constraint and its derivative, which confirm the data listed "
        "in Table 4”",
        here=f"change a step (and zero crossings), cases 1 to 6: {shown}",
        holds=[all(described.agreement == "confirmed" for described in descriptions(of_cdot))],
    )


def dominant_pole_is_seen_late() -> Finding:
    """Return how AB4 falls from a kick where its dominant pole is hardly excited: first as another pole says."""
    alpha_hat, beta_hat = TABLE_5[1].point
    run = experiment("AB4", alpha_hat, beta_hat, duration=1.0, kick=KICK)
    moduli = np.unique(np.abs(poles(run.method, alpha_hat, beta_hat)).round(4))
    largest, next_to_it = float(moduli[-1]), float(moduli[-2])
    early = int(np.flatnonzero(np.abs(run.c) > 1e-3 * KICK)[-1]) + 1
    late = _rate(run.c[len(run.c) // 2 :])
    alone = np.log(1e-3) / np.log(abs(run.pole))
    return Finding(
        where="Section 5.1",
        claim="only the dominant pole matters",
        paper="“only the dominant eigenvalue, which has the largest |z_p|, is considered since it has the greatest "
        "effect on the constraint error”",
        here=f"AB4 at ({alpha_hat:g}, {beta_hat:g}), poles of {largest:.4f} and {next_to_it:.4f}: a kick falls to a "
        f"thousandth in {early} steps, for which the dominant pole alone would take {alone:.0f}; after half a second "
        f"c_1 changes by {late:.4f} a step",
        holds=[early > alone / 2, round(late, 4) == round(largest, 4)],
    )


def physics_decides() -> Finding:
    """Return what B4 makes of the energy, which nothing changes, with parameters of cases 4 and 6."""
    proper, improper = (
        experiment("B4", case.alpha_hat, case.beta_hat, duration=DURATION) for case in (TABLE_4[3], TABLE_4[5])
    )
    kept, left = (run.observation.energy[-1] / run.observation.energy[0] for run in (proper, improper))
    return Finding(
        where="Section 3",
        claim="wrong parameters give results against physics",
        paper="“improper selection of the Baumgarte coefficients can lead to unacceptable results in terms of the "
        "physics associated with the dynamic response”",
        here=f"B4 from a consistent start: after {DURATION:g} s the energy, which nothing changes, is {left:.0f} times "
        f"the first with case 6, {kept:.4f} times with case 4",
        holds=[left > 2 and abs(kept - 1) < 1e-3],
    )


def _diverges(behaviour: Behaviour) -> bool:
    grew = behaviour.c.rate > 1 or behaviour.failure is not None
    return abs(behaviour.pole) > 1 and grew


def _shown(*behaviours: Behaviour) -> str:
    texts = []
    for behaviour in behaviours:
        predicted = f"|z_p| {abs(behaviour.pole):.3f} at {np.degrees(np.angle(behaviour.pole)):.1f} deg"
        texts.append(f"{predicted}, seen {behaviour.c.rate:.3f}, {behaviour.c.crossings} crossings")
    return "; ".join(texts)


def histories_figure(runs: Sequence[Experiment], derivative: bool) -> Figure:
    """Return c_1, or its derivative, against time for the cases of Table 4 (paper Figs. 7 and 8)."""
    with styled():
        figure = column_figure(1.3)
        panels = figure.subplots(len(runs) // 2, 2).flat
        for number, (axes, run) in enumerate(zip(panels, runs, strict=True), start=1):
            history = run.cdot if derivative else run.c
            visible = np.flatnonzero(np.abs(history) > VISIBLE * np.abs(history).max())
            shown = slice(visible[-1] + 1)
            axes.plot(1e3 * run.t[shown], history[shown], linewidth=0.6, **line_at(0))
            axes.set_xlim(0, 1e3 * run.t[visible[-1]])
            axes.set_title(rf"{number}: $\hat\alpha = {run.alpha_hat:g}$, $\hat\beta = {run.beta_hat:g}$", fontsize=7)
        figure.supxlabel("t (ms)", fontsize=8)
        figure.supylabel(r"$\dot c_1$ (m/s)" if derivative else "$c_1$ (m)", fontsize=8)
        return figure
