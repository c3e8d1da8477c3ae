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
from bezstab.engines.engine_list import ENGINES
from bezstab.methods.registry import lookup
from bezstab.motion.spinning_bodies import spin_change
from bezstab.stability.closed_loop import spectral_radius
from bezstab.stability.rest_offsets import offset_at_rest
from bezstab.stability.sweeps import chain, swept_growth
from tests.witnesses.growths import growth

SCRIPT = Path(__file__).with_name("javascript_runs.js")
PACKAGES = os.environ.get("NODE_PATH") or str(Path(sys.prefix) / "javascript" / "node_modules")
PACKAGE = {"matter.js": "matter-js", "cannon-es": "cannon-es", "p2": "p2"}


START = 1e-4
ROUNDED, TOO_FAR = 1e-11, 0.5
"""Of errors of a link of 1 m: below, rounding shows; above, its other end may come between."""


def links(engine: str, steps: int, **settings: Any) -> np.ndarray:
    """Return by how much each link is too long before and after each of so many steps; shape (steps + 1, bodies)."""
    node = shutil.which("node")
    if node is None or not (Path(PACKAGES) / PACKAGE[engine]).exists():
        pytest.skip(f"no node with {PACKAGE[engine]}")
    asked = json.dumps({"engine": engine, "steps": steps, **settings})
    environment = {**os.environ, "NODE_PATH": PACKAGES}
    run = subprocess.run([node, SCRIPT], input=asked, capture_output=True, text=True, check=True, env=environment)
    return np.array(json.loads(run.stdout))


def recursion_radius(errors: np.ndarray, order: int) -> float:
    """Return the largest pole of the linear recursion of that order which a run of one link follows."""
    rows = np.array([errors[start : start + order + 1] for start in range(len(errors) - order)])
    largest = np.abs(rows).max(axis=1)
    rows = rows[(largest > ROUNDED) & (largest < TOO_FAR)]
    rows /= np.abs(rows).max(axis=1, keepdims=True)
    coefficients, *_ = np.linalg.lstsq(rows[:, :-1], rows[:, -1], rcond=None)
    return float(np.abs(np.roots([1, *-coefficients[::-1]])).max())


def predicted(engine: str, h: str, *values: float) -> float:
    """Return |z_p| of the row."""
    alpha_hat, beta_hat = ENGINES[engine].applied(tuple(map(Fraction, values)), Fraction(h)).point
    return float(spectral_radius(lookup("SYM"), float(alpha_hat), float(beta_hat)))


ALONE = {"places": [1 + START], "velocities": [5 * START], "masses": [2], "iterations": 10}
DEFAULT_OF = {"p2": 1e6, "cannon-es": 1e7}


@pytest.mark.parametrize("h", ["1/60", "1/240", "1/20"])
@pytest.mark.parametrize(("stiffness", "relaxation"), [(None, 4), (1e4, 4), (1e7, 1), (1e5, 0.1), (200, 2)])
def test_p2_grows_as_its_spook_says(h: str, stiffness: float | None, relaxation: float) -> None:
    run = links("p2", 12, h=float(Fraction(h)), stiffness=stiffness, relaxation=relaxation, **ALONE)
    of_row = predicted("p2", h, stiffness or DEFAULT_OF["p2"], relaxation, 2)
    assert recursion_radius(run[:, 0], 2) == pytest.approx(of_row, abs=1e-4)
    assert of_row < 1


@pytest.mark.parametrize("h", ["1/60", "1/240", "1/20", "1/5"])
@pytest.mark.parametrize(
    ("stiffness", "relaxation", "time_step"), [(None, 4, "1/60"), (1e4, 4, "1/60"), (1e5, 2, "1/120"), (200, 1, "1/5")]
)
def test_cannon_es_grows_as_its_spook_says(h: str, stiffness: float | None, relaxation: float, time_step: str) -> None:
    """Made for steps of 1/60 s it grows in steps of 1/5 s: its numbers stay what they were."""
    made_for = float(Fraction(time_step))
    settings = {"stiffness": stiffness, "relaxation": relaxation, "timeStep": made_for}
    run = links("cannon-es", 12, h=float(Fraction(h)), **settings, **ALONE)
    of_row = predicted("cannon-es", h, stiffness or DEFAULT_OF["cannon-es"], relaxation, made_for, 2)
    assert recursion_radius(run[:, 0], 2) == pytest.approx(of_row, abs=1e-4)
    assert (of_row > 1) is (h == "1/5" and time_step != h)


@pytest.mark.parametrize("h", ["1/60", "1/100"])
@pytest.mark.parametrize(
    ("stiffness", "iterations"), [(0.05, 2), (0.3, 2), (0.7, 2), (0.2, 1), (0.4, 4), (1.3, 1), (1.7, 1), (1.9, 2)]
)
def test_matter_js_grows_as_its_stiffness_says(h: str, stiffness: float, iterations: int) -> None:
    run = links("matter.js", 14, h=float(Fraction(h)), stiffness=stiffness, iterations=iterations, places=[1 + START])
    of_row = predicted("matter.js", h, stiffness, iterations)
    assert recursion_radius(run[:, 0], 3) == pytest.approx(of_row, abs=1e-4)
    assert (of_row > 1) is (stiffness == 1.7 and h == "1/60")


def test_matter_js_leaves_no_error_of_a_stiffness_of_one() -> None:
    run = links("matter.js", 3, h=1 / 60, stiffness=1, iterations=2, places=[1.1])
    assert np.abs(run[1:]).max() < 1e-12
    assert predicted("matter.js", "1/60", 1) < 1e-6


@pytest.mark.parametrize("h", ["1/60", "1/120"])
@pytest.mark.parametrize(("stiffness", "iterations"), [(0.7, 2), (0.2, 1), (0.05, 4), (1, 2)])
def test_matter_js_sags_as_predicted(h: str, stiffness: float, iterations: int) -> None:
    """To a hundredth; with a stiffness of one not at all."""
    settings = {"stiffness": stiffness, "iterations": iterations, "gravity": 9.81}
    run = links("matter.js", 2000, h=float(Fraction(h)), places=[1], **settings)
    values = Fraction(str(stiffness)), Fraction(iterations)
    offset = offset_at_rest(ENGINES["matter.js"], values, Fraction(h), Fraction("9.81"))
    assert run[-1, 0] == pytest.approx(offset, rel=0.01, abs=1e-12)


def test_matter_js_brakes_what_goes_round_as_its_class_of_energy_says() -> None:
    """To a hundredth of what is left of the rate, from the tenth step on: ten seconds at 6 rad/s lose 88 % of it."""
    h, start, steps = 1 / 60, 10, 600
    run = links("matter.js", steps, h=h, stiffness=1, iterations=2, places=[1], spin=6)
    rates = np.diff(np.unwrap(run[:, 0]))[start:] / h
    expected = rates[0]
    for _ in rates[1:]:
        expected *= 1 + spin_change("projected", 1, 1, expected * h)
    assert rates[-1] == pytest.approx(expected, rel=0.01)
    assert (rates[-1] / rates[0]) ** 2 < 0.15
    assert ENGINES["matter.js"].energy_class == "projected"


@pytest.mark.parametrize("engine", ["p2", "cannon-es"])
@pytest.mark.parametrize(
    ("bodies", "ratio", "sweeps", "relaxation"), [(5, 1, 10, 4), (10, 1, 10, 4), (10, 10, 4, 1), (10, 100, 10, 4)]
)
def test_chains_in_spook_engines_settle_as_predicted(
    engine: str, bodies: int, ratio: float, sweeps: int, relaxation: float
) -> None:
    """To 2e-3 of the factor a step."""
    h, stiffness = Fraction(1, 60), DEFAULT_OF[engine]
    sweeping = ENGINES[engine].sweeping
    assert sweeping
    of_row = swept_growth(chain(bodies, ratio), sweeping.step(sweeps, h, Fraction(stiffness), Fraction(relaxation)))
    velocities = list(0.1 * np.random.default_rng(1).standard_normal(bodies))
    settings = {"stiffness": stiffness, "relaxation": relaxation, "timeStep": float(h), "iterations": sweeps}
    masses, places = [1] * (bodies - 1) + [ratio], list(range(1, bodies + 1))
    run = links(engine, 2000, h=float(h), masses=masses, places=places, velocities=velocities, **settings)
    errors = np.abs(run).max(axis=1)[1:]
    assert growth(list(errors[errors > 1e-12]), 10) == pytest.approx(of_row.factor, abs=2e-3)


@pytest.mark.parametrize("engine", ["p2", "cannon-es"])
@pytest.mark.parametrize(("bodies", "ratio", "stiffness"), [(1, 1, 1e4), (5, 1, 1e7), (10, 4, 1e7)])
def test_hanging_chains_in_spook_engines_sag_as_predicted(
    engine: str, bodies: int, ratio: float, stiffness: float
) -> None:
    """To a hundredth, after half a minute."""
    settings = {"stiffness": stiffness, "relaxation": 4, "timeStep": 1 / 60, "iterations": 10, "gravity": 9.81}
    masses, places = [1] * (bodies - 1) + [ratio], list(range(1, bodies + 1))
    run = links(engine, 1800, h=1 / 60, masses=masses, places=places, velocities=[0] * bodies, **settings)
    answer = judge(f"{engine}={stiffness},4", h="1/60", bodies=bodies, mass_ratio=ratio, load="gravity")
    assert run[-1].sum() == pytest.approx(answer.sag, rel=0.01)


@pytest.mark.parametrize(("bodies", "ratio"), [(5, 1), (10, 1), (5, 10), (10, 10)])
def test_balls_that_stand_on_each_other_sag_as_a_chain_that_hangs(bodies: int, ratio: float) -> None:
    """cannon-es' contacts are its constraints, with a relaxation of 3: to a hundredth. Stacks of boxes tumble there."""
    masses = [1] * (bodies - 1) + [ratio]
    settings = {"masses": masses, "velocities": [0] * bodies, "iterations": 10, "gravity": 9.81, "balls": True}
    run = links("cannon-es", 3000, h=1 / 60, **settings)
    answer = judge("cannon-es=1e7,3", h="1/60", bodies=bodies, mass_ratio=ratio, load="gravity")
    assert -run[-1].sum() == pytest.approx(answer.sag, rel=0.01)
