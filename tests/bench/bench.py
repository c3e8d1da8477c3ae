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
import tracemalloc
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from bezstab.mechanism.equations import Mechanism, T, compiled_mechanism
from bezstab.mechanism.motions import motion
from bezstab.mechanism.programs import even_steps
from bezstab.mechanism.runner import march, simulate
from bezstab.mechanism.scene_files import load_scene
from bezstab.mechanism.start import initial_state
from bezstab.methods.multistep_methods import bezier
from bezstab.methods.recipes import recipe
from bezstab.methods.registry import lookup
from bezstab.methods.schemes import LinearMultistep, Method, RungeKutta, steps
from bezstab.runs.exact_rates import exact_rates
from bezstab.runs.verdict_maps import MapRows, map_rows, simulated_verdicts
from bezstab.stability.arrays import FloatArray
from bezstab.stability.closed_loop import spectral_radius
from bezstab.stability.regions import region, window

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE.parent.parent))  # run as a script, the tests are no package yet

from tests.bench.timing import interleaved  # noqa: E402
from tests.mechanism.four_bar_chains import four_bars  # noqa: E402
from tests.reference.companion_poles import radius  # noqa: E402
from tests.reference.fifty_digit_poles import modulus_from_p  # noqa: E402
from tests.reference.literal_equation_9 import literal_equation_9  # noqa: E402
from tests.reference.perturbed_revolutions import runner_motion  # noqa: E402
from tests.reference.second_order_methods import RECIPES, second_order  # noqa: E402
from tests.runs.mujoco_witness import model_xml  # noqa: E402

BASELINE, REPORT = HERE / "bench.json", HERE.parent.parent / "figures" / "bench.md"
FALLEN = 2 / 3  # of the ratio in BASELINE

POINTS = 1000  # per axis
FEWER_POINTS = 500  # per axis where numpy takes minutes for the larger map, or where many methods are compared
CLOSE = 1e-12  # the promised agreement with 50 digits at ordinary points
OFF_AXIS = 1e-7  # companions of a step without solution, which lie on straight lines, have no eigenvalues
REFERENCES = 200  # ordinary points compared with 50 digits
SAMPLED = 2000  # points for which NodePy is timed; it takes them one by one
MEMORY = 50.0  # MB, the promise beyond the result

STEP, GAINS = 1e-3, (500.0, 1e5)  # s; 2 alpha, beta^2 in 1/s, 1/s^2: alpha_hat = 0.5, beta_hat = 0.1
STEPS = 200  # of a run
INSTANCES = 10_000
SAME = 1e-12  # SI units: rounding; less, even 0, where h times a slope's rounding is under half a digit of the state
FLOQUET_POINTS = (200, 50)
STEPS_A_TURN = 200
COMPILED_STEPS = 100_000  # of a run that pays for compiling
COMPILED_CELLS = 44  # per axis of a map of verdicts: as many as one batch of numpy takes
MUJOCO = {"SYM": "Euler", "RK4": "RK4"}
ENGINE_STEPS = 20_000  # of a run of MuJoCo, of Exudyn and of ours beside them


@dataclass(frozen=True)
class Line:
    """What was compared, how many times faster we are, what is promised (None: nothing), and a remark."""

    section: str
    what: str
    ratio: float
    promise: float | None
    note: str

    @property
    def name(self) -> str:
        """What it is called in bench.json: two sections may compare with the same."""
        return f"{self.section}: {self.what}"


@dataclass(frozen=True)
class Growth:
    """The exponent of the power law that the cost of something follows in a size, and where it was fitted."""

    what: str
    exponent: float
    sizes: str


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
    """Yield the comparisons of the |z_p| map."""
    random = np.random.default_rng(1)
    for name, promise in (("B4", 18.0), ("AB4", 18.0), ("B8", 18.0), ("AB8", 18.0)):
        with_others = name in ("B4", "AB4")
        method, (a, b) = lookup(name), axes(lookup(name), POINTS if with_others else FEWER_POINTS)
        grid = np.meshgrid(a, b)
        calls: list[Callable[[], NDArray[np.generic]]] = [
            partial(rows_of, method, a, b),
            partial(radius, method, *grid),
        ]
        if with_others:
            some = random.choice(POINTS**2, SAMPLED)
            at_some = (part.ravel()[some] for part in grid)
            calls += [partial(by_two_processes, method, a, b), partial(by_nodepy, method, *at_some)]
        (ours, z_abs), (theirs, _), *others = interleaved(*calls, rounds=2)  # the second takes long
        tracemalloc.start()
        spectral_radius(method, a, b[:, np.newaxis])
        memory = (tracemalloc.get_traced_memory()[1] - z_abs.nbytes) / 1e6
        tracemalloc.stop()
        chosen = random.choice(z_abs.size, REFERENCES, replace=False)  # none is near a multiple root by chance
        points = [grid[0].ravel()[chosen], grid[1].ravel()[chosen]]
        exact = np.array([modulus_from_p(method, x, y) for x, y in zip(*points, strict=True)])
        error = float(np.abs(z_abs.ravel()[chosen] - exact).max())
        kept = error < CLOSE and memory < MEMORY
        note = f"{ours:.2f} s; error {error:.0e} at {REFERENCES} points; {memory:.0f} MB beyond the result"
        shown = note if kept else f"BROKEN: {CLOSE:g}, {MEMORY:g} MB: {note}"
        yield Line("map", f"{name}: batched eigenvalues, one core", theirs / ours, promise if kept else np.inf, shown)
        if others:
            (both, same), (slow, _) = others
            assert np.allclose(same, z_abs, rtol=1e-12, atol=0)  # other neighbours are followed, so rounding differs
            yield Line(
                "map",
                f"{name}: batched eigenvalues, two processes",
                theirs / both,
                30.0,
                f"{both:.2f} s, their start included",
            )
            ratio = slow / SAMPLED * POINTS**2 / ours
            yield Line("map", f"{name}: NodePy 1.1.1", ratio, 200.0, f"NodePy timed at {SAMPLED} of the points")


def maps_of_other_kinds() -> Iterator[Line]:
    """Yield the comparison of the |z_p| map for one method of each other kind."""
    kinds = {
        lookup("heun"): "explicit Runge-Kutta",
        lookup("dopri5"): "explicit Runge-Kutta, seven stages",
        lookup("tsit5"): "explicit Runge-Kutta, seven stages",
        lookup("B12"): "twelve steps",
        lookup("bdf2"): "implicit multistep, two steps",
        lookup("bdf3"): "implicit multistep, three steps",
        lookup("am4"): "implicit multistep, three steps",
        lookup("bdf4"): "implicit multistep, four steps",
        lookup("sdirk2"): "diagonally implicit Runge-Kutta",
        lookup("radau3"): "fully implicit Runge-Kutta",
        lookup("verlet-half"): "second order, two roots",
        lookup("verlet-kdk"): "second order, two evaluations",
        lookup("hht"): "second order, three roots",
        Method("Beeman", recipe(RECIPES["beeman"]), "Beeman, J. Comput. Phys. 20, 1976"): "a recipe, four roots",
        second_order("B2 and B3"): "a recipe, five roots",
        second_order("AB3 and B3"): "a recipe, six roots",
        Method("B4 recipe", lookup("B4").scheme.second_order, "B4 in x, v, a"): "a recipe that spells out B4",
    }
    for method, kind in kinds.items():
        name, (a, b) = method.name, axes(method, FEWER_POINTS)
        a, b = a + OFF_AXIS, b + OFF_AXIS
        (ours, z_abs), (theirs, by_companion) = interleaved(
            partial(rows_of, method, a, b), partial(radius, method, *np.meshgrid(a, b)), rounds=2
        )
        off = float(
            np.quantile(np.abs(z_abs - by_companion), 0.99)
        )  # near double roots eigenvalues keep half the digits
        note = f"{ours:.3f} s, {kind}; 99 of 100 points differ by less than {off:.0e}"
        # of a recipe's P, which has real coefficients, roots meet along curves: next to them all are solved for
        promise = 9.0 if "Runge-Kutta" in kind else 5.0 if "recipe" in kind else 18.0
        yield Line("map", f"{name}: batched eigenvalues, one core", theirs / ours, promise, note)


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
        points = random.uniform(low, high, (500 * max(FLOQUET_POINTS), 2)).T
        stable = points[:, spectral_radius(method, *points) < 1]
        one = float(stable[0, 0]), float(stable[1, 0])
        batches = [
            partial(exact_rates, mechanism, method, h, stable[0, :count], stable[1, :count], 1.0)
            for count in FLOQUET_POINTS
        ]
        (theirs, found), *times = interleaved(partial(runner_motion, mechanism, method, STEPS_A_TURN, *one), *batches)
        assert found
        for count, (ours, _) in zip(FLOQUET_POINTS, times, strict=True):
            each = ours / count
            note = f"{1e3 * each:.2f} ms a point, {STEPS_A_TURN} steps a revolution"
            yield Line("moving", f"{name}: {count} exact rates by the runner", theirs / each, 1.0, note)


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


def starts() -> Iterator[Line]:
    """Yield how far start-up is from that of the packages it cannot do without: 1 / 1.5 at least.

    `poles` also searches, for each of eight methods, where the forced error is least: 0.14 s each.
    """
    yield beside_imports("start-up", "bezstab --help", ["--help"], "numpy, click", 1.5, 15)
    poles = ["poles", "--alpha", "0.5", "--beta", "0.1"]
    yield beside_imports("start-up", "bezstab poles", poles, "numpy, click, sympy", 4.0, 15)


def waiting() -> Iterator[Line]:
    """Yield how far what people wait for is from the imports it needs."""
    without_figure = "numpy, click, sympy"
    with_figure = f"{without_figure}, matplotlib.figure, matplotlib.backends.backend_svg"
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


def tuned_slope(mechanism: Mechanism) -> Slope:
    """Return the same with what helps: one function for all parts, M kept, the matrix filled in place."""
    n, m = mechanism.size, len(mechanism.constraints)
    columns = (mechanism.constraints, mechanism.constraints_t, mechanism.gamma, mechanism.forces)
    parts = [mechanism.jacobian, *(column.T for column in columns)]
    evaluated = sp.lambdify((T, mechanism.q, mechanism.v), parts, "numpy", cse=True)
    matrix, right = np.zeros((n + m, n + m)), np.empty(n + m)
    matrix[:n, :n] = np.diag(mechanism.mass)

    def slope(t: float, y: FloatArray) -> FloatArray:
        v = y[n:]
        jacobian, (c,), (c_t,), (gamma,), (forces,) = evaluated(t, y[:n].tolist(), v.tolist())
        matrix[n:, :n], matrix[:n, n:] = jacobian, jacobian.T
        right[:n], right[n:] = forces, gamma - GAINS[0] * (jacobian @ v + c_t) - GAINS[1] * c
        return np.concatenate((v, np.linalg.solve(matrix, right)[:n]))

    return slope


def literal_run(method: Method, slope: Slope, y: FloatArray) -> FloatArray:
    """Return the state after STEPS steps of RK4, or of a multistep method with rho = z^n - z^(n-1) that RK4 starts."""
    rk4 = lookup("RK4").scheme
    assert isinstance(rk4, RungeKutta)
    tableau, weights = np.array(rk4.tableau, float), np.array(rk4.weights, float)
    sigma = np.array(method.scheme.sigma[1:], float) if isinstance(method.scheme, LinearMultistep) else None
    slopes: list[FloatArray] = []  # newest first
    for k in range(STEPS):
        t = k * STEP
        slopes = [slope(t, y), *slopes[: steps(method) - 1]]
        if sigma is not None and len(slopes) == steps(method):
            y = y + STEP * (sigma @ np.array(slopes))
            continue
        stages = np.zeros((len(weights), len(y)))
        stages[0] = slopes[0]
        for s in range(1, len(weights)):
            stages[s] = slope(t + tableau[s].sum() * STEP, y + STEP * (tableau[s] @ stages))
        y = y + STEP * (weights @ stages)
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
    moving = compiled_mechanism(load_scene("slider_crank"))
    state, literal, tuned = initial_state(moving), literal_slope(moving), tuned_slope(moving)
    for name in ("B4", "RK4"):
        method = lookup(name)
        by_hand = [partial(literal_run, method, slope, np.concatenate(state)) for slope in (literal, tuned)]
        (ours, end), *others, (together, ends) = interleaved(
            partial(alone, moving, method, state), *by_hand, partial(batch_run, method, moving)
        )
        kinds = (("literal Eq. 9", 2.0), ("Eq. 9 tuned by hand", None))
        for (kind, promise), (theirs, other) in zip(kinds, others, strict=True):
            assert np.abs(other - end[-1]).max() < SAME
            yield Line(
                "run",
                f"{name}: {kind}",
                theirs / ours,
                promise,
                f"{STEPS / ours:.0f} steps/s against {STEPS / theirs:.0f}",
            )
        assert np.abs(ends[0] - end[-1]).max() < SAME
        each = together / INSTANCES
        note = f"{1e9 * each / STEPS:.0f} ns a step and instance"
        yield Line("run", f"{name}: one run alone, an instance of {INSTANCES}", ours / each, 10.0, note)
        yield Line("run", f"{name}: literal Eq. 9, an instance of {INSTANCES}", others[0][0] / each, None, "")


def engines() -> Iterator[Line]:
    """Yield the comparisons with other engines on the same slider-crank, all stepping inside one call."""
    moving = compiled_mechanism(load_scene("slider_crank"))
    state = initial_state(moving)
    for name, integrator in MUJOCO.items():
        (ours, end), (theirs, angles) = interleaved(
            partial(alone, moving, lookup(name), state, ENGINE_STEPS), mujocos_run(moving, integrator, state), rounds=2
        )
        assert abs(angles[0] - end[-1, 0]) < 0.1  # rad, after 20 s: the same mechanism; MuJoCo's constraints are soft
        note = f"{ENGINE_STEPS / ours:.1e} steps/s against {ENGINE_STEPS / theirs:.1e}, in C"
        yield Line("engine", f"{name}: MuJoCo's {integrator}", theirs / ours, None, note)
    (ours, end), (theirs, angles) = interleaved(
        partial(alone, moving, lookup("B4"), state, ENGINE_STEPS), by_exudyn, rounds=2
    )
    assert abs(angles[2] - end[-1, 0]) < 1e-2
    note = f"{ENGINE_STEPS / ours:.1e} steps/s against {ENGINE_STEPS / theirs:.1e}, in C++"
    yield Line("engine", "B4: Exudyn's generalized-alpha (implicit)", theirs / ours, None, note)


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
        begin = time.process_time()
        alone(moving, method, state, 10, compiled=True)
        compiling = time.process_time() - begin
        # the first method compiles the scene for all that follow, or loads what is kept from before
        note = f"{compiling:.2f} s of processor time"
        yield Line("compiled", f"{name}: 3 s, compiling or loading", 3 / compiling, None, note)
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
    with ProcessPoolExecutor(2) as pool:
        for name in ("B4", "RK4"):
            rows = map_rows(moving.scene, lookup(name), STEP, COMPILED_CELLS)
            halves = [replace(rows[0], beta_hat=half) for half in np.array_split(rows[0].beta_hat, 2)]
            maps_of_verdicts = [
                partial(judged_by, pool, [replace(half, compiled=compiled) for half in halves])
                for compiled in (False, True)
            ]
            maps_of_verdicts[1]()  # so that both processes have compiled
            (slow, by_numpy), (ours, by_numba) = interleaved(*maps_of_verdicts, rounds=2)
            differing = [(a["diverges"] != b["diverges"]).mean() for a, b in zip(by_numpy, by_numba, strict=True)]
            assert max(differing) < 0.01  # cells at which rounding decides
            note = f"{COMPILED_CELLS**2} runs in {ours:.2f} s by two processes that have compiled"
            # steps are compiled, what becomes of the kicks is found by numpy in either: four fifths of the time
            yield Line("compiled", f"{name}: a map of verdicts by numpy", slow / ours, 1.0, note)


def judged_by(pool: ProcessPoolExecutor, chunks: list[MapRows]) -> list[Mapping[str, NDArray[np.generic]]]:
    """Return the verdicts of chunks of a map, from the processes of a pool."""
    return list(pool.map(simulated_verdicts, chunks))


def by_exudyn() -> FloatArray:
    """Return the crank's x, y and angle after ENGINE_STEPS steps of Exudyn, on the paper's slider-crank."""
    import exudyn
    from exudyn import itemInterface as items  # noqa: N813

    system = exudyn.SystemContainer()
    mbs = system.AddSystem()
    q, v = initial_state(compiled_mechanism(load_scene("slider_crank")))
    ground = mbs.AddObject(items.ObjectGround())

    def body(mass: float, inertia: float, at: Iterable[float], rates: Iterable[float]) -> tuple[int, int]:
        node = mbs.AddNode(items.NodeRigidBody2D(initialCoordinates=list(at), initialVelocities=list(rates)))
        number = mbs.AddObject(items.ObjectRigidBody2D(mass=mass, inertia=inertia, nodeNumber=node))
        marker = mbs.AddMarker(items.MarkerBodyMass(bodyNumber=number))
        mbs.AddLoad(items.LoadMassProportional(markerNumber=marker, loadVector=[0, -9.81, 0]))
        return node, number

    crank_node, crank = body(20, 45, (0, 0, q[0]), (0, 0, v[0]))
    _, rod = body(3.5, 3.5, q[1:4], v[1:4])
    slider_node, slider = body(2.5, 0.02, (q[4], 0, 0), (v[4], 0, 0))
    for one, there, other, here in (
        (ground, 0.0, crank, 0.0),
        (crank, 0.2, rod, -0.175),
        (rod, 0.175, slider, 0.0),
    ):
        ends = [
            mbs.AddMarker(items.MarkerBodyRigid(bodyNumber=b, localPosition=[x, 0, 0]))
            for b, x in ((one, there), (other, here))
        ]
        mbs.AddObject(items.ObjectJointRevolute2D(markerNumbers=ends))
    fixed = mbs.AddMarker(items.MarkerNodeCoordinate(nodeNumber=mbs.AddNode(items.NodePointGround()), coordinate=0))
    for coordinate in (1, 2):  # the slider neither rises nor turns
        marker = mbs.AddMarker(items.MarkerNodeCoordinate(nodeNumber=slider_node, coordinate=coordinate))
        mbs.AddObject(items.CoordinateConstraint(markerNumbers=[fixed, marker]))
    mbs.Assemble()
    settings = exudyn.SimulationSettings()
    settings.timeIntegration.numberOfSteps, settings.timeIntegration.endTime = ENGINE_STEPS, ENGINE_STEPS * STEP
    settings.solution.file.write = settings.solution.sensors.active = False
    mbs.SolveDynamic(settings)
    return np.array(mbs.GetNodeOutput(crank_node, exudyn.OutputVariableType.Coordinates))


def growth() -> Iterator[Growth]:
    """Yield how cost grows with the points per axis, the steps of a method, the batch, and the number of bodies."""

    def fitted(what: str, sizes: Sequence[int], cost: Callable[[int], Callable[[], object]], unit: str) -> Growth:
        calls = [cost(size) for size in sizes]
        for call in calls:
            call()
        times = [seconds for seconds, _ in interleaved(*calls)]
        exponent = float(np.polyfit(np.log(sizes), np.log(times), 1)[0])
        return Growth(what, exponent, f"{sizes[0]} to {sizes[-1]} {unit}")

    b4 = lookup("B4")
    moving = compiled_mechanism(load_scene("slider_crank"))

    def map_of(method: Method, points: int = 500) -> Callable[[], object]:
        a, b = axes(method, points)
        return lambda: rows_of(method, a, b)

    def batch_of(size: int) -> Callable[[], object]:
        state = tuple(np.full(size, x) for x in np.concatenate(initial_state(moving)))
        return lambda: list(march(moving, b4, even_steps(STEP, 50, GAINS, (size,)), state))

    def run_of(count: int) -> Callable[[], object]:
        bars = compiled_mechanism(four_bars(count))
        return lambda: simulate(bars, b4, STEP, 100 * STEP, GAINS)

    def derived(count: int) -> Callable[[], object]:
        scene = four_bars(count)
        return lambda: compiled_mechanism.__wrapped__(replace(scene, name="again"))

    yield fitted("map, in points per axis", (500, 1000, 2000), lambda n: map_of(b4, n), "points")
    yield fitted("map, in steps n of B_n", (3, 4, 6, 8, 12), lambda n: map_of(bezier(n)), "steps")
    yield fitted("batch, in instances", (1000, 10_000, 100_000), batch_of, "instances")
    yield fitted("run, in four-bars of a chain", (1, 2, 4, 8, 16), run_of, "four-bars")
    yield fitted("derivation, in four-bars of a chain", (1, 2, 4), derived, "four-bars")


def report(lines: Sequence[Line], grown: Sequence[Growth]) -> str:
    """Return the Markdown report: a row for all that is compared with the same and has the same promise."""
    rows = [
        "# Speed",
        "",
        "Written by `make bench`, from one run: how many times as fast as something else bezstab is.",
        "",
    ]
    rows += ["| | beside | ratio | promised |", "| - | - | - | - |"]
    beside: dict[tuple[str, str, float | None], list[str]] = {}
    for line in lines:
        subject, _, other = line.what.partition(": ")
        beside.setdefault((line.section, other, line.promise), []).append(f"{subject} {line.ratio:.3g}")
    for (section, other, promise), ratios in beside.items():
        rows.append(
            f"| {section} | {other} | {', '.join(ratios)} | {'' if promise is None else format(promise, '.3g')} |"
        )
    rows += ["", "Cost grows as a power of", "", "| cost | exponent | fitted over |", "| - | - | - |"]
    rows += [f"| {each.what} | {each.exponent:.2f} | {each.sizes} |" for each in grown]
    return "\n".join([*rows, ""])


def main() -> int:
    """Measure, print and write everything; return 1 if a promise is broken or a ratio has fallen by a third."""
    before: dict[str, float] = json.loads(BASELINE.read_text(encoding="utf-8")) if BASELINE.exists() else {}
    lines = []
    sections = (
        maps,
        maps_of_other_kinds,
        moving_mechanisms,
        starts,
        waiting,
        runs,
        engines,
        compiled_runs,
    )
    for section in sections:
        for line in section():
            lines.append(line)
            print(f"{line.section:9} {line.what:50} {line.ratio:8.3g}  {line.note}", flush=True)
    grown = list(growth())
    for each in grown:
        print(f"growth    {each.what:50} {each.exponent:8.2f}  {each.sizes}")
    REPORT.write_text(report(lines, grown), encoding="utf-8")
    if "--accept" in sys.argv:
        BASELINE.write_text(
            json.dumps({line.name: round(line.ratio, 3) for line in lines}, indent=1) + "\n", encoding="utf-8"
        )
    broken = [line.what for line in lines if line.promise is not None and line.ratio < line.promise]
    fallen = [line.name for line in lines if line.ratio < FALLEN * before.get(line.name, 0.0)]
    for what in broken:
        print(f"below the promise: {what}")
    for what in fallen:
        print(f"fallen by a third: {what}")
    return 1 if broken or fallen else 0


if __name__ == "__main__":
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    sys.exit(main())
