"""Results as rows and tables; figures in plane_figures, run_figures and the public module plot.

What draws, or needs sympy, is not loaded before it is used.
"""

from bezstab.show.columns import (
    MISSING,
    PROPERTIES,
    Column,
    Format,
    Row,
    Value,
    column,
    formatted,
    pole_column,
    render,
    transposed,
    yes_no_column,
)
from bezstab.show.rows import complex_parts, formula_row, row

__all__ = [
    "MISSING",
    "PROPERTIES",
    "Column",
    "Format",
    "Row",
    "Value",
    "column",
    "complex_parts",
    "formatted",
    "formula_row",
    "pole_column",
    "render",
    "row",
    "transposed",
    "yes_no_column",
]
