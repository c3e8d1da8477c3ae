"""Results as rows, tables and figures; what draws is loaded when first used."""

from bezstab.show.columns import Column, Format, Row, Value, column, formatted, pole_column, render, yes_no_column

__all__ = ["Column", "Format", "Row", "Value", "column", "formatted", "pole_column", "render", "yes_no_column"]
