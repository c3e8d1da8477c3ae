"""The forms of what is written: figures and tables, each named here alone."""

from collections.abc import Mapping

FIGURE_FORMS: Mapping[str, Mapping[str, None]] = {
    "png": {"Software": None},
    "svg": {"Date": None},
    "pdf": {"CreationDate": None, "Producer": None},
}
"""Each with what matplotlib would write that differs from day to day, or from version to version: left out."""

TABLE_FORMS = ("csv", "npz")
