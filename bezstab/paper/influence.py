"""Table 4 with Figs. 7 and 8: what the parameters do to B4 at 1 ms (section 5.2.2)."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from matplotlib.figure import Figure

from bezstab.methods import lookup
from bezstab.paper.experiments import STEP, Experiment, experiment
from bezstab.paper.findings import Finding, finding
from bezstab.paper.reports import Progress, Report, captioned_table, pole_cells
from bezstab.show import Row, column, column_figure, history_line, line_at, pole_column, styled

KICK = 1e-3  # m: Table 4 is about decay and growth, so there must be something that decays or grows
DURATION = 0.4  # s
DECAYED = 1e-6  # of the kick: what a run does below it is no longer counted
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
    pole_column("dominant pole"),
    column("|z_p|", "z_abs", ".4f"),
    column("∠z_p (deg)", "z_angle_deg", ".2f"),
    column("seen: |z|", "rate", ".4f"),
    column("zero crossings of c₁", "crossings", "d"),
]


@dataclass(frozen=True)
class Behaviour:
    """A case of Table 4: dominant pole, and by what c_1 changed per step and how often it crossed zero in the run."""

    case: Case
    pole: complex
    rate: float
    crossings: int
    failure: str | None


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
        findings=findings(observed),
    )


def kicked_runs() -> Iterator[Experiment]:
    """Yield the six cases of B4 at 1 ms."""
    for case in TABLE_4:
        yield experiment(
            lookup("B4"), h=STEP, duration=DURATION, alpha_hat=case.alpha_hat, beta_hat=case.beta_hat, kick=KICK
        )


def behaviours(runs: Iterable[Experiment]) -> list[Behaviour]:
    """Return Table 4: prediction, and what the kicked runs did as long as c_1 was above a millionth of the kick."""
    return [_behaviour(case, run) for case, run in zip(TABLE_4, runs, strict=True)]


def _behaviour(case: Case, run: Experiment) -> Behaviour:
    above = np.flatnonzero(np.abs(run.c) > DECAYED * KICK)  # not empty: it begins with the kick
    c = run.c[: above[-1] + 1]
    half = len(c) // 2
    rate = (np.abs(c[half:]).max() / np.abs(c[:half]).max()) ** (1 / half)
    crossings = int(np.count_nonzero(np.diff(np.sign(c))))
    return Behaviour(case, pole=run.pole, rate=float(rate), crossings=crossings, failure=run.failure)


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
            "rate": behaviour.rate,
            "crossings": behaviour.crossings,
        }
        for number, behaviour in enumerate(observed, start=1)
    ]
    return captioned_table(caption, rows, BEHAVIOURS)


def findings(observed: Sequence[Behaviour]) -> list[Finding]:
    """Return what the paper says of the cases of Table 4, held against pole and run."""
    negative, slow, slow_waving, fast, fast_waving, outside = observed
    return [
        finding(
            where="Table 4",
            claim="cases 1 and 6 diverge: α̂ < 0, or outside the region",
            paper="|z_p| > 1",
            here=_shown(negative, outside),
            holds=[_diverges(negative) and _diverges(outside)],
        ),
        finding(
            where="Table 4",
            claim="cases 2 and 3 converge slowly; 3 oscillates, 2 does not significantly",
            paper="|z_p| near 1; small, large angle",
            here=_shown(slow, slow_waving),
            holds=[
                0.95 < slow.rate < 1 and 0.95 < slow_waving.rate < 1 and slow_waving.crossings > 10 > slow.crossings
            ],
        ),
        finding(
            where="Table 4",
            claim="cases 4 and 5 converge fast; 5 oscillates, 4 hardly",
            paper="|z_p| well below 1; small, large angle",
            here=_shown(fast, fast_waving),
            holds=[fast.rate < 0.85 and fast_waving.rate < 0.85 and fast_waving.crossings > fast.crossings],
        ),
    ]


def _diverges(behaviour: Behaviour) -> bool:
    grew = behaviour.rate > 1 or behaviour.failure is not None
    return abs(behaviour.pole) > 1 and grew


def _shown(*behaviours: Behaviour) -> str:
    texts = []
    for behaviour in behaviours:
        predicted = f"|z_p| {abs(behaviour.pole):.3f} at {np.degrees(np.angle(behaviour.pole)):.1f} deg"
        texts.append(f"{predicted}, seen {behaviour.rate:.3f}, {behaviour.crossings} crossings")
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
            history_line(axes, 1e3 * run.t[shown], history[shown], **line_at(0))
            axes.set_xlim(0, 1e3 * run.t[visible[-1]])
            axes.set_title(rf"{number}: $\hat\alpha = {run.alpha_hat:g}$, $\hat\beta = {run.beta_hat:g}$", fontsize=7)
            axes.ticklabel_format(axis="y", scilimits=(-2, 3))
        figure.supxlabel("t (ms)", fontsize=8)
        figure.supylabel(r"$\dot c_1$ (m/s)" if derivative else "$c_1$ (m)", fontsize=8)
        return figure
