"""Which figures, tables and findings answer which part of the paper."""

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, get_args

import numpy as np

from bezstab.mechanism import compiled_mechanism as moving
from bezstab.mechanism import initial_state, load_scene
from bezstab.methods import lookup
from bezstab.paper import claims, experiments
from bezstab.paper.experiments import Experiment
from bezstab.paper.printed import FASTER_LEVEL, Agreement, Finding
from bezstab.show import columns, figures, tables
from bezstab.stability import QUALITY, best_point, region, spectral_radius, window

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Progress = Callable[[Iterator[Experiment], int], Iterable[Experiment]]


@dataclass(frozen=True)
class Report:
    """Figures and Markdown tables by the name of their part, what they say of the paper, and what is for the eye only.

    `aside` holds measured times, which no two runs share and no file keeps.
    """

    figures: Mapping[str, "Figure"] = field(default_factory=dict)
    tables: Mapping[str, str] = field(default_factory=dict)
    findings: Sequence[Finding] = ()
    aside: str = ""


def methods(_: Progress) -> Report:
    """Return Tables 1 and 2, and what the equations come to."""
    rows = [tables.formula_row(lookup(name)) for name in ("B2", "B3", "B4")]
    return Report(
        tables={
            "table1": _table("Table 1: the Bézier methods and their s→z mappings.", rows, tables.MAPPINGS),
            "table2": _table("Table 2: their characteristic polynomials.", rows, tables.CHARACTERISTIC),
        },
        findings=claims.equation_findings(),
    )


def regions(_: Progress) -> Report:
    """Return Figs. 1 (in three parts), 2 and 3."""
    drawn = {}
    for panel, name in zip("abc", FASTER_LEVEL, strict=True):
        stable, best = region(lookup(name)), best_point(lookup(name))
        alpha_hat, beta_hat = (np.linspace(low, high, QUALITY["balanced"]) for low, high in window(stable))
        z_abs = spectral_radius(stable.method, alpha_hat, beta_hat[:, np.newaxis])
        faster = [region(stable.method, FASTER_LEVEL[name])]
        drawn[f"fig1{panel}"] = figures.region_figure(stable, faster, best, alpha_hat, beta_hat, z_abs)
    compared, equal_cost = (
        [region(lookup(name)) for name in names] for names in (("B3", "B4", "AB3", "AB4"), ("B4", "AB4", "RK4@5"))
    )
    drawn["fig2"] = figures.comparison_figure(compared)
    drawn["fig3"] = figures.comparison_figure(equal_cost, h=experiments.H)
    return Report(drawn, findings=claims.region_findings())


def mechanism(_: Progress) -> Report:
    """Return Fig. 4 and Table 3."""
    scene = load_scene("slider_crank")
    caption = (
        "Table 3: the slider-crank. m1 and J3 do not enter: the crank turns about its pivot, the slider not at all."
    )
    return Report(
        {"fig4": figures.scene_figure(scene, initial_state(moving(scene))[0])},
        {"table3": _table(caption, tables.body_rows(scene), tables.BODIES)},
        [*claims.mechanism_findings(), *claims.lost_findings()],
    )


def collapse(progress: Progress) -> Report:
    """Return Fig. 5."""
    runs = list(progress(experiments.unstabilized(*experiments.COLLAPSE), 4 * len(experiments.COLLAPSE[0])))
    return Report({"fig5": figures.unstabilized_figure(runs)}, findings=experiments.collapse_findings(runs))


def growth(progress: Progress) -> Report:
    """Return Fig. 6."""
    runs = list(progress(experiments.unstabilized(*experiments.GROWTH), 4 * len(experiments.GROWTH[0])))
    return Report({"fig6": figures.unstabilized_figure(runs)}, findings=experiments.growth_findings(runs))


def influence(progress: Progress) -> Report:
    """Return Table 4 with Figs. 7 and 8."""
    runs = list(progress(experiments.influence(), len(experiments.TABLE_4)))
    behaviours = experiments.behaviours(runs)
    caption = (
        f"Table 4: B4 at h = {1e3 * experiments.H:g} ms, c₁ kicked by {1e3 * experiments.KICK:g} mm. The paper's "
        "numbers are lost; these points are ours and fit what it says of each case."
    )
    return Report(
        {
            "fig7": figures.influence_figure(runs, derivative=False),
            "fig8": figures.influence_figure(runs, derivative=True),
        },
        {
            "table4": _table(
                caption, [tables.row(case, case=n) for n, case in enumerate(behaviours, 1)], tables.BEHAVIOURS
            )
        },
        experiments.influence_findings(behaviours),
    )


def comparison(progress: Progress) -> Report:
    """Return Table 5 with Fig. 9."""
    runs = list(progress(experiments.comparison(), 3 * len(experiments.COMPARED)))
    caption = (
        "Table 5: dominant poles, with Re z, Im z, |z| and ∠z as the paper prints them, and what is left of c₁ in the "
        "simulation (h = 1 ms, RK4 at 5 ms, consistent initial state; 0: below 1e-13 m, which is rounding)."
    )
    return Report(
        {"fig9": figures.comparison_of_methods_figure(runs)},
        {"table5": _table(caption, [tables.comparison_row(run) for run in runs], tables.PRINTED_POLES)},
        experiments.comparison_findings(runs),
    )


def cost(_: Progress) -> Report:
    """Return Table 6."""
    costs = experiments.costs()
    rows = [tables.row(each) for each in costs]
    caption = "Table 6: what 10 s of simulation cost (h = 1 ms, RK4 at 5 ms)."
    return Report(
        tables={"table6": _table(caption, rows, tables.COSTS)},
        findings=experiments.cost_findings(costs),
        aside=columns.render(rows, tables.TIMED, "text"),
    )


REPORTS: Mapping[tuple[str, ...], Callable[[Progress], Report]] = {
    ("table1", "table2"): methods,
    ("fig1", "fig2", "fig3"): regions,
    ("table3", "fig4"): mechanism,
    ("fig5",): collapse,
    ("fig6",): growth,
    ("table4", "fig7", "fig8"): influence,
    ("table5", "fig9"): comparison,
    ("table6",): cost,
}
"""By the parts that come together."""


def ledger(findings: Sequence[Finding]) -> str:
    """Return every claim with what came out, as Markdown."""
    counts = Counter(finding.agreement for finding in findings)
    total = ", ".join(f"{counts[agreement]} {agreement}" for agreement in get_args(Agreement))
    rows = columns.render([tables.row(finding) for finding in findings], tables.FINDINGS, "markdown")
    return f"# What the paper claims, and what came out\n\nWritten by `bezstab paper`: {total}.\n\n{rows}\n"


def _table(caption: str, rows: Sequence[columns.Row], shown: tables.Columns) -> str:
    return f"{caption}\n\n{columns.render(rows, shown, 'markdown')}\n"
