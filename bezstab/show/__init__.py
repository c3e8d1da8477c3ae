"""Results as rows and tables, and as figures; `plot` is the public module that draws on a user's own Axes.

What draws is not loaded before it is used.
"""

from typing import TYPE_CHECKING

from bezstab.lazy import lazy_names
from bezstab.show.cells import pole_text
from bezstab.show.columns import Column, page_of_keys, row_of
from bezstab.show.fields import MISSING, Field, Row, RowKind, cells, column, formatted, visible
from bezstab.show.file_forms import FIGURE_FORMS, TABLE_FORMS
from bezstab.show.result_sentences import (
    combined_words,
    costs_words,
    energy_words,
    exact_rate_words,
    motion_words,
    passages_words,
    spare_words,
    trade_words,
)
from bezstab.show.row_kinds import (
    CHECKED,
    CHOICES,
    ENGINES_LISTED,
    FIELDS,
    FRONTS,
    LARGEST_STEPS,
    LIKE_POINT,
    LIKENESS,
    LISTED_METHODS,
    MEASUREMENTS,
    NAMED_METHODS,
    POLES,
    PROBED,
    REGIONS,
    ROW_KINDS,
    SIMULATIONS,
    STEPS_OF_CHOICES,
    SUMMARIES,
    SWEPT,
    VERDICT_MAPS,
)
from bezstab.show.rows import (
    answer_row,
    engine_row,
    largest_step_row,
    left_out,
    map_rows,
    method_row,
    pole_cells,
    pole_rows,
    region_row,
    row_in_seconds,
    whole_row,
)
from bezstab.show.sentences import one_pole_sentence
from bezstab.show.tables import Format, block, fits, lines_below, render, shown_width, table, wrapped

if TYPE_CHECKING:
    from bezstab.show import plot
    from bezstab.show.arrays import (
        boundary_arrays,
        history_arrays,
        map_arrays,
        untimed_arrays,
        verdict_arrays,
        write_arrays,
    )
    from bezstab.show.map_figures import (
        comparison_figure,
        map_figure,
        verdict_figure,
    )
    from bezstab.show.run_figures import history_figure, trade_figures
    from bezstab.show.style import DASHES, column_figure, line_at, save, styled, with_legend
    from bezstab.show.window import show_in_window

__getattr__ = lazy_names(__name__)
