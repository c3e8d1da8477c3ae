"""A map of verdicts counted cell by cell, as one would by hand."""

from dataclasses import dataclass

from bezstab.evidence import VerdictMap


@dataclass(frozen=True)
class Count:
    """Runs with a verdict, those whose verdict is the predicted one, and | |z_p| - 1 | of each that is not."""

    judged: int
    agreeing: int
    distances_of_the_others: tuple[float, ...]


def count_cell_by_cell(verdicts: VerdictMap) -> Count:
    """Return what a walk over all cells finds."""
    judged, agreeing, distances = 0, 0, []
    rows, columns = verdicts.z_abs.shape
    for row in range(rows):
        for column in range(columns):
            if verdicts.undecided[row, column]:
                continue
            judged += 1
            z_abs = float(verdicts.z_abs[row, column])
            if bool(verdicts.diverges[row, column]) == (z_abs >= 1):
                agreeing += 1
            else:
                distances.append(abs(z_abs - 1))
    return Count(judged, agreeing, tuple(distances))
