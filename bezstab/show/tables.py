"""The tables that only the paper prints: they move into bezstab/paper, and this file goes with the merge."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING

from bezstab.paper.printed import TABLE_5
from bezstab.show.columns import PROPERTIES, Column, Row, formatted, pole_column, transposed
from bezstab.show.rows import complex_parts, formula_row, row

if TYPE_CHECKING:
    from bezstab.mechanism import Scene
    from bezstab.paper.experiments import Experiment

__all__ = ["PROPERTIES", "formula_row", "row", "transposed"]

Columns = Sequence[Column]


def _columns(text: str) -> Columns:
    """Return the columns named by `heading = key form; ...`, the form a format, one of FORMS, or none for text."""
    columns = []
    for each in text.split(";"):
        heading, _, what = each.strip().partition(" = ")
        key, _, form = what.partition(" ")
        columns.append(Column(heading, partial(_cell, key, form)))
    return columns


def _cell(key: str, form: str, row: Row) -> str:
    """Return what shows row[key], and a missing value as a dash."""
    return FORMS[form](row, key) if form in FORMS else formatted(row[key], form)


FORMS: Mapping[str, Callable[[Row, str], str]] = {"pole": lambda row, _: pole_column("").text(row)}

BEHAVIOURS = _columns(
    "case = case d; described as = described; α̂ = alpha_hat g; β̂ = beta_hat g; dominant pole = z pole; "
    "|z_p| = z_abs .4f; ∠z_p (deg) = z_angle_deg .2f; seen: |z| = rate .4f; zero crossings of c₁ = crossings d"
)
PRINTED_POLES = _columns(
    "α̂ = alpha_hat g; β̂ = beta_hat g; method = method; dominant pole = z pole; |z_p| = z_abs .4f; "
    "∠z_p (deg) = z_angle_deg .3f; as printed = printed; largest |c₁| of 6 to 8 s (m) = before .0e; "
    "of 8 to 10 s = after .0e"
)
MAPPINGS = _columns("method = method; step = recursion; s→z mapping = mapping")
CHARACTERISTIC = _columns("method = method; characteristic polynomial = characteristic_polynomial")
BODIES = _columns("body = body; length (m) = length g; mass (kg) = mass g; moment of inertia (kg m²) = inertia g")
COSTS = _columns("method = method; evaluations of f in 10 s = evaluations d")
TIMED: Columns = [*COSTS, *_columns("processor time / B4's = time_ratio .2f")]
FINDINGS = _columns("where = where; claim = claim; paper = paper; here = here; agreement = agreement")


def body_rows(scene: Scene) -> list[Row]:
    """Return each body's length between its joints, mass and moment of inertia; None where there is or enters none."""
    along = {body.name: [0.0] for body in scene.bodies}
    for name, (x, _) in scene.attachments:
        along.setdefault(name, []).append(x)
    spans = {name: max(x) - min(x) for name, x in along.items()}
    cells = ((body.name, spans[body.name] or None, body.mass or None, body.inertia or None) for body in scene.bodies)
    return [dict(zip(("body", "length", "mass", "inertia"), cell, strict=True)) for cell in cells]


def comparison_row(run: Experiment) -> Row:
    """Return a line of Table 5: a dominant pole, the paper's beside it, and how large c_1 still is, 0 if rounding."""
    left = {"before": run.left(6.0, 8.0), "after": run.left(8.0, 10.0)}
    printed = TABLE_5[str(run.alpha_hat), str(run.beta_hat)][run.run.method.name]
    return row(
        run,
        {"run", "seen"},
        method=run.run.method.name,
        printed=" ".join(printed),
        **left,
        **complex_parts("z_", run.pole),
    )
