"""The table of keys, made of the columns: `python -m tests.show.keys_page` writes it."""

import csv
import io
from collections.abc import Iterator, Mapping, Sequence
from importlib import import_module
from pathlib import Path
from typing import Any

from bezstab.show.columns import Column

PAGE = Path(__file__).parents[2] / "bezstab" / "show" / "keys.csv"

LISTS = """
chain chains.COLUMNS
check feedback.CHECKED feedback.STEPS
choose feedback.CHOSEN feedback.STEPS
poles feedback.POLES
drive drives.COLUMNS
engines catalogue.COLUMNS
lint mujoco.STATES mujoco.SUSPECTS mujoco.REMEDIES mujoco.ENERGIES mujoco.SAGS mujoco.SETTINGS
methods regions.LISTED regions.WHOLE
probe probes.POLES probes.COMPARED probes.FOUND
region regions.REGION regions.ON_A_MOTION regions.MOVING
simulate runs.RUN
steps step_sequences.COLUMNS
tradeoff runs.COSTS runs.FRONTS
verify runs.MEASURED runs.VERDICT_MAP
"""
"""Each command, and the lists of columns that it prints."""


def _columns(path: str) -> Sequence[Column[Any]]:
    room, name = path.split(".")
    columns: Sequence[Column[Any]] = getattr(import_module(f"bezstab.{room}.columns"), name)
    return columns


COLUMNS: Mapping[str, Sequence[Sequence[Column[Any]]]] = {
    command: [_columns(path) for path in paths] for command, *paths in map(str.split, LISTS.strip().splitlines())
}


def page() -> str:
    """Return the table: a line for each key of each command, by name."""
    file = io.StringIO()
    table = csv.writer(file, lineterminator="\n")
    table.writerow(("command", "key", "unit", "meaning"))
    table.writerows(sorted(_lines()))
    return file.getvalue()


def _lines() -> Iterator[tuple[str, str, str, str]]:
    for command, tables in COLUMNS.items():
        columns = {column.key: column for table in reversed(tables) for column in table if column.key}
        yield from ((command, column.key, column.unit, column.meaning) for column in columns.values())


def untold(before: str, now: str) -> set[tuple[str, str]]:
    """Return each command and key that went from one page to another, though the table of renamed keys says nothing."""
    renamed = csv.DictReader(PAGE.with_name("renamed_keys.csv").read_text(encoding="utf-8").splitlines())
    told = {(command, key) for row in renamed for command in row["command"].split() for key in row["key"].split()}
    old, new = ({(row["command"], row["key"]) for row in csv.DictReader(it.splitlines())} for it in (before, now))
    return old - new - told


if __name__ == "__main__":
    if gone := untold(PAGE.read_text(encoding="utf-8"), page()):
        raise SystemExit(f"renamed_keys.csv does not say where these are now: {sorted(gone)}")
    PAGE.write_text(page(), encoding="utf-8")
