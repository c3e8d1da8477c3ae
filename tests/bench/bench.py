"""Speed as ratios measured in one run: `make bench` writes figures/bench.md.

Promises are ratios of times. A ratio below its promise, or below two thirds of the one in bench.json, fails the run;
 `--accept` makes the measured ratios the new ones to compare with.
"""

import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import partial
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from bezstab.mechanism.equations import Mechanism, compiled_mechanism
from bezstab.mechanism.motions import motion
from bezstab.mechanism.programs import even_steps
from bezstab.mechanism.runner import march, simulate
from bezstab.mechanism.scene_files import load_scene
from bezstab.mechanism.start import initial_state
from bezstab.methods.registry import lookup
from bezstab.methods.schemes import LinearMultistep, Method
from bezstab.runs.exact_rates import exact_rates
from bezstab.stability.arrays import FloatArray
from bezstab.stability.closed_loop import spectral_radius
from bezstab.stability.regions import region, window

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE.parent.parent))  # run as a script, the tests are no package yet

from tests.reference.companion_poles import radius  # noqa: E402
from tests.reference.literal_equation_9 import literal_equation_9  # noqa: E402
from tests.reference.perturbed_revolutions import runner_motion  # noqa: E402
from tests.reference.second_order_methods import second_order  # noqa: E402
from tests.runs.mujoco_witness import model_xml  # noqa: E402

BASELINE, REPORT = HERE / "bench.json", HERE.parent.parent / "figures" / "bench.md"
FALLEN = 2 / 3  # of the ratio in BASELINE

TURN = 0.2  # s: a call that is shorter is repeated in its turn
POINTS = 1000  # per axis
FEWER_POINTS = 500  # per axis where numpy takes minutes for the larger map, or where many methods are compared
OFF_AXIS = 1e-7  # companions of a step without solution, which lie on straight lines, have no eigenvalues
SAMPLED = 2000  # points for which NodePy is timed; it takes them one by one

STEP, GAINS = 1e-3, (500.0, 1e5)  # s; 2 alpha, beta^2 in 1/s, 1/s^2: alpha_hat = 0.5, beta_hat = 0.1
STEPS = 200  # of a run
INSTANCES = 10_000
SAME = 1e-12  # SI units: rounding; less, even 0, where h times a slope's rounding is under half a digit of the state
RATES = 200  # in a batch
STEPS_A_TURN = 200
COMPILED_STEPS = 100_000  # of a run that pays for compiling
MUJOCO = {"SYM": "Euler", "RK4": "RK4"}
ENGINE_STEPS = 20_000  # of a run of MuJoCo, of Exudyn and of ours beside them


@dataclass(frozen=True)
class Line:
    """What was compared, how many times faster we are, what is promised, and a remark."""

    section: str
    what: str
    ratio: float
    promise: float
    note: str

    @property
    def name(self) -> str:
        """What it is called in bench.json: two sections may compare with the same."""
        return f"{self.section}: {self.what}"


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


def axes(method: Method, points: int) -> tuple[FloatArray, FloatArray]:
    """Return both axes of the window that shows the region."""
    alpha_hat, beta_hat = (np.linspace(low, high, points) for low, high in window(region(method)))
    return alpha_hat, beta_hat


def rows_of(method: Method, alpha_hat: FloatArray, beta_hat: FloatArray) -> FloatArray:
    """Return |z_p| over some rows of the map: what one process does."""
    return spectral_radius(method, alpha_hat, beta_hat[:, np.newaxis])


def by_two_processes(method: Method, alpha_hat: FloatArray, beta_hat: FloatArray) -> FloatArray:
    """Return the map from two processes, their start included."""
    with ProcessPoolExecutor(2) as pool:
        return np.concatenate(list(pool.map(partial(rows_of, method, alpha_hat), np.array_split(beta_hat, 2))))


def by_nodepy(method: Method, alpha_hat: FloatArray, beta_hat: FloatArray) -> FloatArray:
    """Return |z_p| of a row of points from NodePy's characteristic polynomials, whose roots it takes point by point."""
    from nodepy.linear_multistep_method import LinearMultistepMethod

    scheme = method.scheme
    assert isinstance(scheme, LinearMultistep)
    ascending = (
        np.array([sp.Rational(c.numerator, c.denominator) for c in part[::-1]]) for part in (scheme.rho, scheme.sigma)
    )
    rho, sigma = LinearMultistepMethod(*ascending).__num__().characteristic_polynomials()
    discriminant = np.emath.sqrt(alpha_hat**2 / 4 - beta_hat)
    pairs = np.stack([-alpha_hat / 2 + discriminant, -alpha_hat / 2 - discriminant], axis=-1)
    return np.array([max(float(np.abs((rho - mu * sigma).roots).max()) for mu in pair) for pair in pairs])


def maps() -> Iterator[Line]:
    """Yield the comparisons of the |z_p| map, for one method at least of each kind."""
    multistep = ("B4", "AB4", "B8", "AB8", "B12", "bdf2", "bdf3", "am4", "bdf4")
    promised = {lookup(name): 18.0 for name in (*multistep, "verlet-half", "verlet-kdk", "hht")}
    promised |= {lookup(name): 9.0 for name in ("heun", "dopri5", "tsit5", "sdirk2", "radau3")}
    # of a recipe's P, which has real coefficients, roots meet along curves: next to them all are solved for
    promised |= {second_order(name): 5.0 for name in ("beeman", "B2 and B3", "AB3 and B3")}
    for method, promise in promised.items():
        with_others = method.name in ("B4", "AB4")
        points = POINTS if with_others else FEWER_POINTS
        a, b = (axis + OFF_AXIS for axis in axes(method, points))
        grid = np.meshgrid(a, b)
        calls: list[Callable[[], NDArray[np.generic]]] = [
            partial(rows_of, method, a, b),
            partial(radius, method, *grid),
        ]
        if with_others:
            some = np.random.default_rng(1).choice(POINTS**2, SAMPLED)
            at_some = (part.ravel()[some] for part in grid)
            calls += [partial(by_two_processes, method, a, b), partial(by_nodepy, method, *at_some)]
        (ours, z_abs), (theirs, by_companion), *others = interleaved(*calls, rounds=2)  # the second takes long
        off = float(
            np.quantile(np.abs(z_abs - by_companion), 0.99)
        )  # near double roots eigenvalues keep half the digits
        note = f"{ours:.3f} s; 99 of 100 points differ by less than {off:.0e}"
        yield Line("map", f"{method.name}: batched eigenvalues, one core", theirs / ours, promise, note)
        if others:
            (both, _), (slow, _) = others
            note = f"{both:.2f} s, their start included"
            yield Line("map", f"{method.name}: batched eigenvalues, two processes", theirs / both, 30.0, note)
            ratio = slow / SAMPLED * POINTS**2 / ours
            yield Line("map", f"{method.name}: NodePy 1.1.1", ratio, 200.0, f"NodePy timed at {SAMPLED} of the points")


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


def literal_slope(mechanism: Mechanism) -> Slope:
    """Return (q, v)' at a time by the paper's Eq. 9 as it stands: its matrices evaluated, put together and solved."""
    literal, n = literal_equation_9(mechanism, *GAINS), mechanism.size

    def slope(t: float, y: FloatArray) -> FloatArray:
        return np.concatenate((y[n:], literal(t, y[:n], y[n:]).accelerations))

    return slope


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


def batch_run(method: Method, moving: Mechanism) -> FloatArray:
    """Return the states (INSTANCES, 2n) after STEPS steps of mechanisms that start alike and differ in their gains."""
    spread = np.linspace(1, 0.5, INSTANCES)  # the first has GAINS themselves
    gains = (GAINS[0] * spread, GAINS[1] * spread)
    state = tuple(np.full(INSTANCES, x) for x in np.concatenate(initial_state(moving)))
    *_, block = march(moving, method, even_steps(STEP, STEPS, gains, (INSTANCES,)), state)
    return np.asarray(block.states[-1].T)


def alone(
    moving: Mechanism,
    method: Method,
    state: tuple[FloatArray, FloatArray],
    count: int = STEPS,
    compiled: bool = False,
) -> FloatArray:
    """Return the states (count + 1, 2n) of our run of `count` steps, compiled or not."""
    run = simulate(moving, method, STEP, count * STEP, GAINS, state, compiled=compiled)
    return np.hstack((run.q, run.v))


def runs() -> Iterator[Line]:
    """Yield the comparisons of a single run and of a batch with the paper's Eq. 9 on the slider-crank."""
    moving, method = compiled_mechanism(load_scene("slider_crank")), lookup("RK4")
    state = initial_state(moving)
    (ours, end), (theirs, other), (together, ends) = interleaved(
        partial(alone, moving, method, state),
        partial(literal_run, literal_slope(moving), np.concatenate(state)),
        partial(batch_run, method, moving),
    )
    assert max(np.abs(other - end[-1]).max(), np.abs(ends[0] - end[-1]).max()) < SAME
    yield Line("run", "RK4: literal Eq. 9", theirs / ours, 2.0, f"{STEPS / ours:.0f} steps/s")
    each = together / INSTANCES
    note = f"{1e9 * each / STEPS:.0f} ns a step and instance"
    yield Line("run", f"RK4: one run alone, an instance of {INSTANCES}", ours / each, 10.0, note)


def mujocos_run(moving: Mechanism, integrator: str, state: tuple[FloatArray, FloatArray]) -> Callable[[], FloatArray]:
    """Return what runs ENGINE_STEPS steps of MuJoCo in one call, and returns its angles."""
    import mujoco

    model = mujoco.MjModel.from_xml_string(model_xml(moving.scene, integrator, STEP, 0.5, 0.1))

    def stepped() -> FloatArray:
        data = mujoco.MjData(model)
        data.qpos[:], data.qvel[:] = state
        mujoco.mj_step(model, data, nstep=ENGINE_STEPS)
        return np.array(data.qpos)

    return stepped


def compiled_runs() -> Iterator[Line]:
    """Yield how much faster compiled runs are than Python's and MuJoCo's, and what compiling takes."""
    moving = compiled_mechanism(load_scene("slider_crank"))
    state = initial_state(moving)
    for name in ("B4", "RK4", "SYM"):
        method, count = lookup(name), COMPILED_STEPS
        calls: list[Callable[[], FloatArray]] = [
            partial(alone, moving, method, state, count, compiled) for compiled in (False, True)
        ]
        if name in MUJOCO:
            calls += [mujocos_run(moving, MUJOCO[name], state)]
        (slow, other), (ours, end), *others = interleaved(*calls, rounds=2)  # the first takes long
        assert np.allclose(end, other, rtol=1e-9, atol=1e-9)  # m, rad: rounding, over 20 s and more
        note = f"{count / ours:.1e} steps/s against {count / slow:.1e}"
        yield Line("compiled", f"{name}: the same run in Python", slow / ours, 20.0, note)
        for of_engine, _ in others:
            theirs = of_engine * COMPILED_STEPS / ENGINE_STEPS
            note = f"{COMPILED_STEPS / ours:.1e} steps/s against {COMPILED_STEPS / theirs:.1e}, in C"
            yield Line("compiled", f"{name}: MuJoCo's {MUJOCO[name]}", theirs / ours, 15.0, note)


def report(lines: Sequence[Line]) -> str:
    """Return the Markdown report: an item for all that is compared with the same and has the same promise.

    Of more than four it names the least; bench.json has them all.
    """
    items = [
        "# Speed",
        "",
        "Written by `make bench`, from one run: how many times as fast as something else bezstab is, and must be.",
        "",
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
    """Measure, print and write everything; return 1 if a promise is broken or a ratio has fallen by a third."""
    before: dict[str, float] = json.loads(BASELINE.read_text(encoding="utf-8")) if BASELINE.exists() else {}
    lines = []
    for line in chain(maps(), moving_mechanisms(), commands(), runs(), compiled_runs()):
        lines.append(line)
        print(f"{line.section:9} {line.what:50} {line.ratio:8.3g}  {line.note}", flush=True)
    REPORT.write_text(report(lines), encoding="utf-8")
    if "--accept" in sys.argv:
        ratios = {line.name: round(line.ratio, 3) for line in lines}
        BASELINE.write_text(json.dumps(ratios, indent=1) + "\n", encoding="utf-8")
    broken = [line.what for line in lines if line.ratio < line.promise]
    fallen = [line.name for line in lines if line.ratio < FALLEN * before.get(line.name, 0.0)]
    for what in broken:
        print(f"below the promise: {what}")
    for what in fallen:
        print(f"fallen by a third: {what}")
    return 1 if broken or fallen else 0


if __name__ == "__main__":
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    sys.exit(main())
