"""The table of keys, made of the columns: `python -m tests.show.keys_page` writes it."""

import csv
import io
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from bezstab.catalogue import columns as catalogue
from bezstab.chains import columns as chains
from bezstab.drives import columns as drives
from bezstab.feedback import columns as feedback
from bezstab.mujoco import columns as mujoco
from bezstab.probes import columns as probes
from bezstab.regions import columns as regions
from bezstab.runs import columns as runs
from bezstab.show.columns import Column
from bezstab.step_sequences import columns as step_sequences

PAGE = Path(__file__).parents[2] / "bezstab" / "show" / "keys.csv"

COLUMNS: Mapping[str, Sequence[Sequence[Column[Any]]]] = {
    "chain": [chains.COLUMNS],
    "check": [feedback.CHECKED, feedback.STEPS],
    "choose": [feedback.CHOSEN, feedback.STEPS],
    "poles": [feedback.POLES],
    "drive": [drives.COLUMNS],
    "engines": [catalogue.COLUMNS],
    "lint": [mujoco.STATES, mujoco.SUSPECTS, mujoco.REMEDIES, mujoco.ENERGIES, mujoco.SAGS, mujoco.SETTINGS],
    "methods": [regions.LISTED, regions.WHOLE],
    "probe": [probes.POLES, probes.COMPARED, probes.FOUND],
    "region": [regions.REGION, regions.ON_A_MOTION, regions.MOVING],
    "simulate": [runs.RUN],
    "steps": [step_sequences.COLUMNS],
    "tradeoff": [runs.COSTS, runs.FRONTS],
    "verify": [runs.MEASURED, runs.VERDICT_MAP],
}
"""The columns that each command prints."""


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


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
