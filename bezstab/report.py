"""Which figures, tables and findings answer which part of the paper."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from bezstab import experiments, figures, tables
from bezstab.experiments import Experiment, Finding

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
        {"table4": _table(caption, tables.behaviour_rows(behaviours), tables.BEHAVIOURS)},
        experiments.influence_findings(behaviours),
    )


def comparison(progress: Progress) -> Report:
    """Return Table 5 with Fig. 9."""
    runs = list(progress(experiments.comparison(), 3 * len(experiments.COMPARED)))
    caption = (
        "Table 5: dominant poles, with Re z, Im z, |z| and ∠z as the paper prints them, and what is left of c₁ in the "
        "simulation (h = 1 ms, RK4 at 5 ms, consistent initial state)."
    )
    return Report(
        {"fig9": figures.comparison_of_methods_figure(runs)},
        {"table5": _table(caption, tables.comparison_rows(runs), tables.PRINTED_POLES)},
        experiments.comparison_findings(runs),
    )


def cost(_: Progress) -> Report:
    """Return Table 6."""
    costs = experiments.costs()
    rows = tables.cost_rows(costs)
    caption = "Table 6: what 10 s of simulation cost (h = 1 ms, RK4 at 5 ms)."
    return Report(
        tables={"table6": _table(caption, rows, tables.COSTS)},
        findings=experiments.cost_findings(costs),
        aside=tables.render(rows, tables.TIMED, "text"),
    )


REPORTS: Mapping[tuple[str, ...], Callable[[Progress], Report]] = {
    ("fig5",): collapse,
    ("fig6",): growth,
    ("table4", "fig7", "fig8"): influence,
    ("table5", "fig9"): comparison,
    ("table6",): cost,
}
"""By the parts that come together."""


def _table(caption: str, rows: Sequence[tables.Row], columns: tables.Columns) -> str:
    return f"{caption}\n\n{tables.render(rows, columns, 'markdown')}\n"
