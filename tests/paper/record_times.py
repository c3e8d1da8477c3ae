"""Measure the processor times of Table 6 anew and record them in the package: run by `make times`."""

import json
import os
import time

from bezstab.compiling import COMPILED_CHOICE
from bezstab.mechanism.equations import compiled_mechanism
from bezstab.mechanism.runner import simulate
from bezstab.mechanism.scene_files import load_scene
from bezstab.methods.registry import lookup
from bezstab.paper.experiments import DURATION, STEP
from bezstab.paper.printed import COMPARED
from bezstab.paper.tables import RECORDED
from bezstab.units import feedback_gains

REPEATS = 5  # as many as the paper averages; here the fastest counts, which other programs disturb least


def costs(repeats: int = REPEATS) -> list[dict[str, str | int | float]]:
    """Return the rows of Table 6 that are measured; all in one process, interleaved, the fastest of several."""
    mechanism = compiled_mechanism(load_scene("slider_crank"))
    gains = feedback_gains(0.1, 0.1, STEP)  # case 1 of Table 5; the cost does not depend on the point
    fastest = dict.fromkeys(COMPARED, float("inf"))
    evaluations = dict.fromkeys(COMPARED, 0)
    for _ in range(repeats):
        for name in COMPARED:
            begin = time.process_time()
            evaluations[name] = simulate(mechanism, lookup(name), STEP, DURATION, gains).evaluations
            fastest[name] = min(fastest[name], time.process_time() - begin)
    return [{"method": name, "evaluations": evaluations[name], "seconds": round(fastest[name], 4)} for name in COMPARED]


if __name__ == "__main__":
    os.environ[COMPILED_CHOICE] = "no"  # what everybody has
    RECORDED.write_text(json.dumps(costs(), indent=2) + "\n", encoding="utf-8")
