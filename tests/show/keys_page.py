"""The table of keys, made of the kinds of rows: `python -m tests.show.keys_page` writes it."""

import csv
import io
from pathlib import Path

from bezstab.show.row_kinds import FIELDS

PAGE = Path(__file__).parents[2] / "bezstab" / "show" / "keys.csv"


def page() -> str:
    """Return the table: a line for each key, by name; what a command prints means the same in every other."""
    file = io.StringIO()
    table = csv.writer(file, lineterminator="\n")
    table.writerow(("key", "unit", "meaning", "null"))
    table.writerows((each.key, each.unit, each.meaning, each.null) for _, each in sorted(FIELDS.items()))
    return file.getvalue()


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
