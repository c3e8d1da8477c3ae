"""Results as rows and tables, and as figures; `plot` is the public module that draws on a user's own Axes.

A file imports only from those above it; what draws is not loaded before it is used:

    columns             typed columns, and rows as text, Markdown, CSV or JSON
    blocks              rows as blocks of lines, and text that wraps
    words               numbers as sentences have them
    cells               what a cell of a table shows where it takes more than a format
    fields              a field of a row, from which rows, tables and schemas derive
    row_kinds           every field of every row, and which fields the rows of each command have
    schemas             the rows that each command prints, as a JSON Schema
    best_point_text     a best point in words
    rows                results as rows
    varying_rows        what steps that vary do, as keys of a row and in a sentence
    answer_rows         answers to a question as rows, and in words
    held_rows           drives that are held or late as rows, and in words
    arrays              histories and maps as arrays for files
    style               what all figures share
    histories           a history as a line, or as its envelope
    plot                one result on one Axes
    plane_figures       figures of the alpha_hat-beta_hat plane
    accuracy_figures    the error that feedback forces over the plane, and against decay
    run_figures         figures of simulations
    chain_figures       figures of chains in engines that sweep
    explorer            the window
"""

from typing import TYPE_CHECKING

from bezstab.lazy import lazy_names
from bezstab.show.answer_rows import (
    added_cells,
    answer_row,
    answer_sentence,
    costs_words,
    engine_cells,
    growing_run,
    largest_step_row,
    motion_words,
    trade_words,
)
from bezstab.show.blocks import block, fits, wrapped
from bezstab.show.cells import diverged_text, order_text, pole_text, safe_step_text, stable_steps_text, with_unbounded
from bezstab.show.columns import (
    MISSING,
    PROPERTIES,
    Column,
    Format,
    Row,
    Value,
    column,
    finite,
    formatted,
    render,
    shown_width,
    transposed,
)
from bezstab.show.fields import Field, RowKind, cells
from bezstab.show.held_rows import LATE_COMMANDS, NOT_JUDGED, held_row, held_sentence, timing_words
from bezstab.show.row_kinds import (
    CHAINS,
    CHECKED,
    CHOICES,
    CLAIMS,
    ENGINES_LISTED,
    EXTREMES,
    FIELDS,
    FORCED,
    FRONTS,
    HELD,
    LARGEST_STEPS,
    LINTED,
    LISTED_METHODS,
    MEASUREMENTS,
    MEMBERS,
    POLES,
    PROBED,
    REGIONS,
    ROW_KINDS,
    SIMULATIONS,
    SWEPT,
    VERDICT_MAPS,
    WITNESSED,
)
from bezstab.show.rows import (
    NOT_KNOWN,
    chain_rows,
    complex_parts,
    engine_row,
    family_row,
    forced_rows,
    formula_row,
    front_row,
    like_point_row,
    likeness_row,
    limit_row,
    linted_row,
    measurement_row,
    method_row,
    pole_rows,
    probed_pole_row,
    region_row,
    run_row,
    simulation_row,
    summary_row,
    verdict_map_row,
    whole_row,
    witness_row,
)
from bezstab.show.schemas import json_schema
from bezstab.show.varying_rows import repeated, sequence_text, varying_row, varying_words
from bezstab.show.words import chain_sentence, change_words, growth_words, safety_words, seconds_words, times_words

if TYPE_CHECKING:
    from bezstab.show import plot
    from bezstab.show.accuracy_figures import accuracy_map_figure, error_front_figure
    from bezstab.show.arrays import (
        boundary_arrays,
        history_arrays,
        map_arrays,
        untimed_arrays,
        verdict_arrays,
        write_arrays,
    )
    from bezstab.show.chain_figures import chains_figure
    from bezstab.show.explorer import open_explorer
    from bezstab.show.histories import history_line
    from bezstab.show.plane_figures import comparison_figure, family_figure, region_figure, verdict_figure
    from bezstab.show.run_figures import history_figure, scene_figure, work_precision_figure
    from bezstab.show.style import DASHES, column_figure, legend_below, line_at, save, styled

LOADED_LATE = {
    "accuracy_figures": ("accuracy_map_figure", "error_front_figure"),
    "arrays": (
        "boundary_arrays",
        "history_arrays",
        "map_arrays",
        "untimed_arrays",
        "verdict_arrays",
        "write_arrays",
    ),
    "chain_figures": ("chains_figure",),
    "explorer": ("open_explorer",),
    "histories": ("history_line",),
    "plane_figures": (
        "comparison_figure",
        "family_figure",
        "region_figure",
        "verdict_figure",
    ),
    "run_figures": (
        "history_figure",
        "scene_figure",
        "work_precision_figure",
    ),
    "style": (
        "DASHES",
        "column_figure",
        "legend_below",
        "line_at",
        "save",
        "styled",
    ),
}
"""What is loaded when first used, by module."""

__getattr__ = lazy_names(__name__, LOADED_LATE, modules=("plot",))

__all__ = [
    "CHAINS",
    "CHECKED",
    "CHOICES",
    "CLAIMS",
    "DASHES",
    "ENGINES_LISTED",
    "EXTREMES",
    "FIELDS",
    "FORCED",
    "FRONTS",
    "HELD",
    "LARGEST_STEPS",
    "LATE_COMMANDS",
    "LINTED",
    "LISTED_METHODS",
    "MEASUREMENTS",
    "MEMBERS",
    "MISSING",
    "NOT_JUDGED",
    "NOT_KNOWN",
    "POLES",
    "PROBED",
    "PROPERTIES",
    "REGIONS",
    "ROW_KINDS",
    "SIMULATIONS",
    "SWEPT",
    "VERDICT_MAPS",
    "WITNESSED",
    "Column",
    "Field",
    "Format",
    "Row",
    "RowKind",
    "Value",
    "accuracy_map_figure",
    "added_cells",
    "answer_row",
    "answer_sentence",
    "block",
    "boundary_arrays",
    "cells",
    "chain_rows",
    "chain_sentence",
    "chains_figure",
    "change_words",
    "column",
    "column_figure",
    "comparison_figure",
    "complex_parts",
    "costs_words",
    "diverged_text",
    "engine_cells",
    "engine_row",
    "error_front_figure",
    "family_figure",
    "family_row",
    "finite",
    "fits",
    "forced_rows",
    "formatted",
    "formula_row",
    "front_row",
    "growing_run",
    "growth_words",
    "held_row",
    "held_sentence",
    "history_arrays",
    "history_figure",
    "history_line",
    "json_schema",
    "largest_step_row",
    "legend_below",
    "like_point_row",
    "likeness_row",
    "limit_row",
    "line_at",
    "linted_row",
    "map_arrays",
    "measurement_row",
    "method_row",
    "motion_words",
    "open_explorer",
    "order_text",
    "plot",
    "pole_rows",
    "pole_text",
    "probed_pole_row",
    "region_figure",
    "region_row",
    "render",
    "repeated",
    "run_row",
    "safe_step_text",
    "safety_words",
    "save",
    "scene_figure",
    "seconds_words",
    "sequence_text",
    "shown_width",
    "simulation_row",
    "stable_steps_text",
    "styled",
    "summary_row",
    "times_words",
    "timing_words",
    "trade_words",
    "transposed",
    "untimed_arrays",
    "varying_row",
    "varying_words",
    "verdict_arrays",
    "verdict_figure",
    "verdict_map_row",
    "whole_row",
    "with_unbounded",
    "witness_row",
    "work_precision_figure",
    "wrapped",
    "write_arrays",
]
