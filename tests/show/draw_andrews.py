"""The figures of what Andrews' mechanism costs: `python -m tests.show.draw_andrews FOLDER`.

No two runs share a processor time. So errors and times are those that `make times` recorded once beside the figures.
"""

import json
import sys
from pathlib import Path

from bezstab.evidence import ErrorOf, Run, SweptRuns
from bezstab.mechanism import load_scene
from bezstab.methods import lookup
from bezstab.show import save, work_precision_figure


def main(folder: Path) -> None:
    """Write both figures as PNG files into the folder that holds what was recorded."""
    rows = json.loads((folder / "andrews_times.json").read_text(encoding="utf-8"))
    runs = [
        Run(
            method=lookup(row.pop("method")),
            factorizations=row["run_evaluations"],
            evaluations=row.pop("run_evaluations"),
            order=row.pop("observed_order"),
            **{key: value for key, value in row.items() if key != "front"},
        )
        for row in rows
    ]
    swept = SweptRuns(runs, 0.0, "time")
    errors: tuple[ErrorOf, ...] = ("trajectory", "constraint")
    for name in errors:
        figure = work_precision_figure(swept, load_scene("andrews").name, name)
        figure.axes[0].set_xlabel("processor time of a recorded run (s)")
        with (folder / f"tradeoff_andrews_{name}.png").open("wb") as file:
            save(figure, "png", file)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
