"""matter.js, cannon-es and p2, run by node: a row of bodies on links, along its own line.

`make witnesses` installs the three packages into .venv/javascript; without them, or without node, all is skipped.
"""

import json
import os
import shutil
import subprocess
import sys
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from bezstab.chains.answer import chain as judge
from bezstab.engines.engine_list import ENGINES, engine_and_values
from bezstab.methods.registry import lookup
from bezstab.motion.spinning_bodies import spin_change
from bezstab.stability.closed_loop import spectral_radius
from bezstab.stability.rest_offsets import offset_at_rest
from tests.witnesses.growths import growth, largest_pole

SCRIPT = Path(__file__).with_name("javascript_runs.js")
PACKAGES = os.environ.get("NODE_PATH") or str(Path(sys.prefix) / "javascript" / "node_modules")
PACKAGE = {"matter.js": "matter-js", "cannon-es": "cannon-es", "p2": "p2"}
SETTINGS = {
    "p2": ("stiffness", "relaxation"),
    "cannon-es": ("stiffness", "relaxation", "timeStep"),
    "matter.js": ("stiffness", "iterations"),
}
"""What the script calls an engine's values, in their order."""

ROUNDED, TOO_FAR = 1e-11, 0.5
"""Of errors of a link of 1 m: below, rounding shows; above, its other end may come between."""


def links(typed: str, steps: int, h: str = "1/60", **more: Any) -> np.ndarray:
    """Return by how much each link is too long before and after each of so many steps; shape (steps + 1, bodies).

    An engine without values has its own.
    """
    engine, values = engine_and_values(typed)
    node = shutil.which("node")
    if node is None or not (Path(PACKAGES) / PACKAGE[engine.name]).exists():
        pytest.skip(f"no node with {PACKAGE[engine.name]}")
    settings = dict(zip(SETTINGS[engine.name], map(float, values), strict=False)) if "=" in typed else {}
    asked = {"engine": engine.name, "steps": steps, "h": float(Fraction(h)), "iterations": 10, "timeStep": 1 / 60}
    environment = {**os.environ, "NODE_PATH": PACKAGES}
    run = subprocess.run(
        [node, SCRIPT],
        input=json.dumps(asked | settings | more),
        capture_output=True,
        text=True,
        check=True,
        env=environment,
    )
    return np.array(json.loads(run.stdout))


def row(bodies: int, ratio: float = 1) -> dict[str, Any]:
    """Return masses, places and velocities of a straight row, the last body heavier."""
    return {"masses": [1] * (bodies - 1) + [ratio], "places": [*range(1, bodies + 1)], "velocities": [0] * bodies}


@pytest.mark.parametrize(
    ("typed", "h", "grows"),
    [
        *((typed, h, False) for typed in ("p2", "p2=1e7,1", "p2=1e5,0.1", "p2=200,2") for h in ("1/240", "1/20")),
        ("cannon-es", "1/60", False),
        ("cannon-es", "1/5", True),  # made for steps of 1/60 s: its numbers stay what they were
        ("cannon-es=1e5,2,1/120", "1/240", False),
        ("cannon-es=1e5,2,1/120", "1/20", True),
        ("cannon-es=200,1,1/5", "1/5", False),
        *((f"matter.js={values}", h, False) for values in ("0.05,2", "0.7,2", "0.4,4") for h in ("1/60", "1/100")),
        ("matter.js=1.3,1", "1/60", False),
        ("matter.js=1.7,1", "1/60", True),
        ("matter.js=1.7,1", "1/100", False),
    ],
)
def test_an_engine_grows_as_its_row_says(typed: str, h: str, grows: bool) -> None:
    engine, values = engine_and_values(typed)
    point = engine.applied(values, Fraction(h)).point
    expected = float(spectral_radius(lookup("SYM"), *map(float, point)))
    run = links(typed, 14, h, **row(1) | {"places": [1 + 1e-4], "velocities": [5e-4]})[:, 0]
    size = np.abs(run)
    found = largest_pole(run[(size > ROUNDED) & (size < TOO_FAR)], 3 if engine.name == "matter.js" else 2)
    assert abs(found) == pytest.approx(expected, abs=1e-4)
    assert (expected > 1) is grows


def test_matter_js_brakes_what_goes_round_as_its_class_of_energy_says() -> None:
    """To a hundredth of what is left of the rate, from the tenth step on: ten seconds at 6 rad/s lose 88 % of it."""
    h, start, steps = 1 / 60, 10, 600
    run = links("matter.js=1,2", steps, places=[1], spin=6)
    rates = np.diff(np.unwrap(run[:, 0]))[start:] / h
    expected = rates[0]
    for _ in rates[1:]:
        expected *= 1 + spin_change("projected", 1, 1, expected * h)
    assert rates[-1] == pytest.approx(expected, rel=0.01)
    assert (rates[-1] / rates[0]) ** 2 < 0.15
    assert ENGINES["matter.js"].energy_class == "projected"


@pytest.mark.parametrize("engine", ["p2", "cannon-es"])
@pytest.mark.parametrize(("bodies", "ratio", "sweeps", "values"), [(10, 10, 4, "=1e7,1"), (10, 100, 10, "")])
def test_chains_in_spook_engines_settle_as_predicted(
    engine: str, bodies: int, ratio: float, sweeps: int, values: str
) -> None:
    """To 2e-3 of the factor a step."""
    answer = judge(engine + values, h="1/60", bodies=bodies, mass_ratio=ratio, iterations=sweeps)
    kicks = list(0.1 * np.random.default_rng(1).standard_normal(bodies))
    run = links(engine + values, 2000, **row(bodies, ratio) | {"velocities": kicks, "iterations": sweeps})
    errors = np.abs(run).max(axis=1)[1:]
    assert growth(list(errors[errors > 1e-12]), 10) == pytest.approx(answer.z_abs, abs=2e-3)


@pytest.mark.parametrize("typed", ["p2=1e4,4", "cannon-es=1e4,4", "matter.js=0.05,4", "matter.js=1,2"])
def test_one_body_sags_as_predicted(typed: str) -> None:
    """To a hundredth, after half a minute; with a stiffness of one not at all."""
    offset = offset_at_rest(*engine_and_values(typed), Fraction(1, 60), Fraction("9.81"))
    assert links(typed, 2000, **row(1), gravity=9.81)[-1, 0] == pytest.approx(offset, rel=0.01, abs=1e-12)


@pytest.mark.parametrize(
    ("typed", "bodies", "ratio", "balls"),
    [("p2=1e7,4", 10, 4, False), ("cannon-es=1e7,4", 5, 1, False), ("cannon-es=1e7,3", 10, 10, True)],
)
def test_what_hangs_sags_as_predicted(typed: str, bodies: int, ratio: float, balls: bool) -> None:
    """To a hundredth, after half a minute.

    Balls that stand on each other sag as a chain: cannon-es' contacts are its constraints, with a relaxation of 3.
    """
    run = links("cannon-es" if balls else typed, 3000, **row(bodies, ratio), gravity=9.81, balls=balls)
    answer = judge(typed, h="1/60", bodies=bodies, mass_ratio=ratio, load="gravity")
    assert abs(run[-1].sum()) == pytest.approx(answer.sag, rel=0.01)
