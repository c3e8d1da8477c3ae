"""Results as rows and tables, and as figures; `plot` is the public module that draws on a user's own Axes.

What draws is not loaded before it is used.
"""

from typing import TYPE_CHECKING

from bezstab.lazy import lazy_names
from bezstab.show.answer_rows import (
    alone_words,
    answer_row,
    combined_words,
    costs_words,
    largest_step_row,
    left_out,
    motion_words,
    pole_rows,
    trade_words,
)
from bezstab.show.cells import pole_text
from bezstab.show.fields import Field, Row, RowKind, cells, column, formatted, visible
from bezstab.show.file_forms import FIGURE_FORMS, TABLE_FORMS
from bezstab.show.held_rows import LATE_COMMANDS, NOT_JUDGED, held_row, timing_words
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
    LIKENESS,
    LINTED,
    LISTED_METHODS,
    MEASUREMENTS,
    MEMBERS,
    NAMED_METHODS,
    POLES,
    PROBED,
    REGIONS,
    ROW_KINDS,
    SIMULATIONS,
    SUMMARIES,
    SWEPT,
    VERDICT_MAPS,
    WITNESSED,
)
from bezstab.show.rows import (
    chain_rows,
    engine_row,
    exact_rate_words,
    forced_rows,
    front_row,
    like_point_row,
    limit_row,
    method_row,
    nearest_rows,
    pole_cells,
    region_row,
    whole_row,
)
from bezstab.show.schemas import json_schema
from bezstab.show.sentences import likeness_sentence, one_pole_sentence, passages_words
from bezstab.show.tables import Format, block, fits, render, shown_width, wrapped
from bezstab.show.varying_rows import varying_words

if TYPE_CHECKING:
    from bezstab.show import plot
    from bezstab.show.accuracy_figures import error_front_figure
    from bezstab.show.arrays import (
        history_arrays,
        untimed_arrays,
        verdict_arrays,
        write_arrays,
    )
    from bezstab.show.chain_figures import chains_figure
    from bezstab.show.explorer import open_explorer
    from bezstab.show.held_figures import held_figure
    from bezstab.show.plane_figures import PlaneMap, comparison_figure, family_figure, region_figure, verdict_figure
    from bezstab.show.region_maps import compared_figure, compared_table, map_figure, map_rows, map_table
    from bezstab.show.run_figures import history_figure, trade_figures, work_precision_figure
    from bezstab.show.style import DASHES, column_figure, legend_below, line_at, save, styled

__getattr__ = lazy_names(__name__)
