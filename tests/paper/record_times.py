"""Measure the processor times of Table 6 anew and record them in the package: run by `make times`."""

import json
import os
from dataclasses import asdict

from bezstab.compiling import COMPILED_CHOICE
from bezstab.paper.cost import RECORDED, costs

if __name__ == "__main__":
    os.environ[COMPILED_CHOICE] = "no"  # what everybody has
    rows = [{**asdict(cost), "seconds": round(cost.seconds, 4)} for cost in costs()]
    RECORDED.write_text(json.dumps(rows, indent=2) + "\n", encoding="utf-8")
