"""Speed as ratios measured in one run: `make bench` writes figures/bench.md.

Promises are ratios of times; a ratio below its promise fails the run.
"""

import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from itertools import chain
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from bezstab.mechanism.equations import Mechanism, compiled_mechanism
from bezstab.mechanism.motions import motion
from bezstab.mechanism.programs import even_steps
from bezstab.mechanism.runner import march, simulate
from bezstab.mechanism.scene_files import load_scene
from bezstab.mechanism.start import initial_state
from bezstab.methods.registry import lookup
from bezstab.methods.schemes import Method
from bezstab.runs.exact_rates import exact_rates
from bezstab.stability.arrays import FloatArray
from bezstab.stability.closed_loop import spectral_radius
from bezstab.stability.regions import region, window
from tests.reference.companion_poles import radius
from tests.reference.literal_equation_9 import literal_equation_9
from tests.reference.perturbed_revolutions import runner_motion
from tests.reference.second_order_methods import second_order
from tests.runs.mujoco_witness import model_xml

REPORT = Path(__file__).parents[2] / "figures" / "bench.md"

TURN = 0.2  # s: a call that is shorter is repeated in its turn
POINTS = 500  # per axis
OFF_AXIS = 1e-7  # companions of a step without solution, which lie on straight lines, have no eigenvalues

STEP, GAINS = 1e-3, (500.0, 1e5)  # s; 2 alpha, beta^2 in 1/s, 1/s^2: alpha_hat = 0.5, beta_hat = 0.1
STEPS = 200  # of a run
INSTANCES = 10_000
SAME = 1e-12  # SI units: rounding; less, even 0, where h times a slope's rounding is under half a digit of the state
RATES = 200  # in a batch
STEPS_A_TURN = 200
COMPILED_STEPS = 100_000  # of a run that pays for compiling
MUJOCO = {"SYM": "Euler", "RK4": "RK4"}
ENGINE_STEPS = 20_000  # of a run of MuJoCo


class Line(NamedTuple):
    """What was compared, how many times faster we are, what is promised, and a remark."""

    section: str
    what: str
    ratio: float
    promise: float
    note: str


def interleaved(*calls: Callable[[], Any], rounds: int = 3) -> list[tuple[float, Any]]:
    """Return the shortest time of each of several calls (s) and its last result; what disturbs a call only slows it.

    They take turns, `rounds` times, and a call is repeated until its turn is over: a busy moment seldom lasts so long.
    """
    found: list[tuple[float, Any]] = [(float("inf"), None) for _ in calls]
    for _ in range(rounds):
        for number, call in enumerate(calls):
            end = time.perf_counter() + TURN
            while (start := time.perf_counter()) < end:
                result = call()
                found[number] = min(found[number][0], time.perf_counter() - start), result
    return found


def maps() -> Iterator[Line]:
    """Yield the comparisons of the |z_p| map, for one method at least of each kind."""
    multistep = ("B4", "AB4", "B8", "AB8", "B12", "bdf2", "bdf3", "am4", "bdf4")
    promised = {lookup(name): 18.0 for name in (*multistep, "verlet-half", "verlet-kdk", "hht")}
    promised |= {lookup(name): 9.0 for name in ("heun", "dopri5", "tsit5", "sdirk2", "radau3")}
    # of a recipe's P, which has real coefficients, roots meet along curves: next to them all are solved for
    promised |= {second_order(name): 5.0 for name in ("beeman", "B2 and B3", "AB3 and B3")}
    for method, promise in promised.items():
        a, b = (np.linspace(*ends, POINTS) + OFF_AXIS for ends in window(region(method)))
        (ours, z_abs), (theirs, by_companion) = interleaved(
            partial(spectral_radius, method, a, b[:, np.newaxis]),
            partial(radius, method, *np.meshgrid(a, b)),
            rounds=2,  # the second takes long
        )
        off = np.quantile(np.abs(z_abs - by_companion), 0.99)  # near double roots eigenvalues keep half the digits
        note = f"{ours:.3f} s; 99 of 100 points differ by less than {off:.0e}"
        yield Line("map", f"{method.name}: batched eigenvalues, one core", theirs / ours, promise, note)


def moving_mechanisms() -> Iterator[Line]:
    """Yield how much faster exact rates come in batch than by the runner, which finds a motion of its own first.

    The runner takes all its shifted runs side by side: it must not be the faster one. Changes of all that a method
    carries are lanes, so that one that carries much gains least: B8 and AB8, with 80 numbers on this mechanism.
    """
    random = np.random.default_rng(1)
    mechanism = compiled_mechanism(load_scene("driven_slider_crank"))
    h = motion(mechanism, 1.0).duration / STEPS_A_TURN
    for name in ("B4", "AB4", "AB2", "B8", "AB8"):
        method = lookup(name)
        low, high = np.transpose(window(region(method)))
        points = random.uniform(low, high, (500 * RATES, 2)).T
        stable = points[:, spectral_radius(method, *points) < 1]
        one = float(stable[0, 0]), float(stable[1, 0])
        batch = partial(exact_rates, mechanism, method, h, stable[0, :RATES], stable[1, :RATES], 1.0)
        (theirs, found), (ours, _) = interleaved(partial(runner_motion, mechanism, method, STEPS_A_TURN, *one), batch)
        assert found
        note = f"{1e3 * ours / RATES:.2f} ms a point, {STEPS_A_TURN} steps a revolution"
        yield Line("moving", f"{name}: {RATES} exact rates by the runner", theirs / (ours / RATES), 1.0, note)


def beside_imports(section: str, what: str, command: Sequence[str], packages: str, promise: float, rounds: int) -> Line:
    """Return how far a command's processor time is from that of importing the packages it needs; `promise`: at most.

    The least of both over some rounds, taken in turn, in a folder of its own for what it writes.
    """
    python, least = sys.executable, [np.inf, np.inf]
    with tempfile.TemporaryDirectory() as folder:
        for _ in range(rounds):
            for k, each in enumerate(([python, "-c", f"import {packages}"], [python, "-m", "bezstab", *command])):
                before = os.times()
                subprocess.run(each, check=True, capture_output=True, cwd=folder)
                after = os.times()
                spent = after.children_user + after.children_system
                least[k] = min(least[k], spent - before.children_user - before.children_system)
    note = f"{least[1]:.2f} s, {least[1] / least[0]:.2f} times as long"
    return Line(section, f"{what}: import {packages}", least[0] / least[1], 1 / promise, note)


def commands() -> Iterator[Line]:
    """Yield how far what people wait for is from the imports that it cannot do without.

    `poles` also searches, for each of eight methods, where the forced error is least: 0.14 s each.
    """
    without_figure = "numpy, click, sympy"
    with_figure = f"{without_figure}, matplotlib.figure, matplotlib.backends.backend_svg"
    yield beside_imports("start-up", "bezstab --help", ["--help"], "numpy, click", 1.5, 15)
    poles = ["poles", "--alpha", "0.5", "--beta", "0.1"]
    yield beside_imports("start-up", "bezstab poles", poles, without_figure, 4.0, 15)
    for name, promise in (("B4", 2.5), ("AB8", 5.0), ("B12", 5.0)):
        step = ["--method", name, "--h", "0.001"]
        yield beside_imports("waiting", f"choose, {name}", ["choose", *step], without_figure, promise, 5)
        check = ["check", *step, "--alpha", "5", "--beta", "5", "--physical"]
        yield beside_imports("waiting", f"check, {name}", check, without_figure, promise, 5)
    yield beside_imports("waiting", "region, B4", ["region", "--method", "B4"], with_figure, 2.5, 5)


Slope = Callable[[float, FloatArray], FloatArray]


def literal_run(slope: Slope, y: FloatArray) -> FloatArray:
    """Return the state after STEPS steps of RK4."""
    for k in range(STEPS):
        t = k * STEP
        first = slope(t, y)
        second = slope(t + STEP / 2, y + STEP / 2 * first)
        third = slope(t + STEP / 2, y + STEP / 2 * second)
        fourth = slope(t + STEP, y + STEP * third)
        y = y + STEP / 6 * (first + 2 * second + 2 * third + fourth)
    return y


def alone(moving: Mechanism, method: Method, count: int = STEPS, compiled: bool = False) -> FloatArray:
    """Return the states (count + 1, 2n) of our run of `count` steps, compiled or not."""
    run = simulate(moving, method, STEP, count * STEP, GAINS, compiled=compiled)
    return np.hstack((run.q, run.v))


def runs() -> Iterator[Line]:
    """Yield the comparisons of a single run and of a batch with the paper's Eq. 9 on the slider-crank.

    Those of the batch start alike and differ in their gains, of which the first has GAINS themselves.
    """
    moving, method = compiled_mechanism(load_scene("slider_crank")), lookup("RK4")
    literal, n, first = literal_equation_9(moving, *GAINS), moving.size, np.concatenate(initial_state(moving))
    gains = np.multiply.outer(GAINS, np.linspace(1, 0.5, INSTANCES))
    states = np.repeat(first[:, np.newaxis], INSTANCES, axis=1)

    def slope(t: float, y: FloatArray) -> FloatArray:
        """Return (q, v)' by Eq. 9 as it stands: its matrices evaluated, put together and solved."""
        return np.concatenate((y[n:], literal(t, y[:n], y[n:]).accelerations))

    def batch() -> FloatArray:
        *_, block = march(moving, method, even_steps(STEP, STEPS, (gains[0], gains[1]), (INSTANCES,)), states)
        return np.asarray(block.states[-1, :, 0])

    (ours, end), (theirs, other), (together, of_batch) = interleaved(
        partial(alone, moving, method), partial(literal_run, slope, first), batch
    )
    assert max(np.abs(other - end[-1]).max(), np.abs(of_batch - end[-1]).max()) < SAME
    yield Line("run", "RK4: literal Eq. 9", theirs / ours, 2.0, f"{STEPS / ours:.0f} steps/s")
    each = together / INSTANCES
    note = f"{1e9 * each / STEPS:.0f} ns a step and instance"
    yield Line("run", f"RK4: one run alone, an instance of {INSTANCES}", ours / each, 10.0, note)


def mujocos_run(moving: Mechanism, integrator: str) -> Callable[[], object]:
    """Return what runs ENGINE_STEPS steps of MuJoCo in one call."""
    import mujoco

    model = mujoco.MjModel.from_xml_string(model_xml(moving.scene, integrator, STEP, 0.5, 0.1))

    def stepped() -> None:
        data = mujoco.MjData(model)
        data.qpos[:], data.qvel[:] = initial_state(moving)
        mujoco.mj_step(model, data, nstep=ENGINE_STEPS)

    return stepped


def compiled_runs() -> Iterator[Line]:
    """Yield how much faster compiled runs are than Python's and MuJoCo's."""
    moving, count = compiled_mechanism(load_scene("slider_crank")), COMPILED_STEPS
    for name in ("B4", "RK4", "SYM"):
        of_engine = [mujocos_run(moving, MUJOCO[name])] if name in MUJOCO else []
        both: list[Callable[[], Any]] = [
            partial(alone, moving, lookup(name), count, compiled) for compiled in (False, True)
        ]
        (slow, other), (ours, end), *others = interleaved(*both, *of_engine, rounds=2)  # the first takes long
        assert np.allclose(end, other, rtol=1e-9, atol=1e-9)  # m, rad: rounding, over 20 s and more
        note = f"{count / ours:.1e} steps/s against"
        yield Line("compiled", f"{name}: the same run in Python", slow / ours, 20.0, f"{note} {count / slow:.1e}")
        for seconds, _ in others:
            theirs = seconds * count / ENGINE_STEPS
            what = f"{name}: MuJoCo's {MUJOCO[name]}"
            yield Line("compiled", what, theirs / ours, 15.0, f"{note} {count / theirs:.1e}, in C")


def report(lines: Sequence[Line]) -> str:
    """Return the Markdown report: an item for all that is compared with the same and has the same promise.

    Of more than four it names the least.
    """
    items = [
        "# Speed\n",
        "Written by `make bench`, from one run: how many times as fast as something else bezstab is, and must be.\n",
    ]
    beside: dict[tuple[str, str, float], list[Line]] = {}
    for line in lines:
        beside.setdefault((line.section, line.what.partition(": ")[2], line.promise), []).append(line)
    for (section, other, promise), found in beside.items():
        least = min(found, key=lambda line: line.ratio)
        shown, remark = (found, "") if len(found) <= 4 else ([least], f", the least of {len(found)}")
        ratios = ", ".join(f"{line.what.partition(': ')[0]} {line.ratio:.3g}" for line in shown)
        items.append(f"- **{section}**, beside {other}: {ratios}{remark} (promised: {promise:.3g})")
    return "\n".join([*items, ""])


def main() -> int:
    """Measure, print and write everything; return 1 if a promise is broken."""
    lines = []
    for line in chain(maps(), moving_mechanisms(), commands(), runs(), compiled_runs()):
        lines.append(line)
        broken = "  BELOW THE PROMISE" * (line.ratio < line.promise)
        print(f"{line.section:9} {line.what:50} {line.ratio:8.3g}  {line.note}{broken}", flush=True)
    REPORT.write_text(report(lines), encoding="utf-8")
    return int(any(line.ratio < line.promise for line in lines))


if __name__ == "__main__":
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    sys.exit(main())
