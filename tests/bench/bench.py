"""Speed as ratios measured in one run: `make bench` writes figures/bench.md.

Promises are ratios of times; a ratio below its promise fails the run. That both do the same the tests say.
"""

import os
import subprocess
import sys
import tempfile
from collections import deque
from collections.abc import Callable, Iterator
from functools import partial
from itertools import chain
from pathlib import Path
from timeit import Timer
from typing import Any, NamedTuple

import numpy as np

from bezstab.mechanism.equations import compiled_mechanism
from bezstab.mechanism.programs import even_steps
from bezstab.mechanism.runner import march, simulate
from bezstab.mechanism.scene_files import load_scene
from bezstab.mechanism.start import initial_state
from bezstab.methods.registry import lookup
from bezstab.methods.schemes import Method
from bezstab.stability.closed_loop import spectral_radius
from bezstab.stability.regions import region, window
from tests.reference.companion_poles import radius
from tests.reference.literal_equation_9 import literal_equation_9
from tests.runs.mujoco_witness import four_bar_xml

REPORT = Path(__file__).parents[2] / "figures" / "bench.md"
HEAD = """# Speed

Written by `make bench`, from one run: how many times as fast as something else bezstab is, and must be.

"""
TURNS = 3
POINTS = 500  # per axis
OFF_AXIS = 1e-7  # companions of a step without solution, which lie on straight lines, have no eigenvalues
MECHANISM = compiled_mechanism(load_scene("four_bar"))
STEP, GAINS = 1e-3, (500.0, 1e5)  # s; 2 alpha, beta^2 in 1/s, 1/s^2: alpha_hat = 0.5, beta_hat = 0.1
STEPS = 200  # of a run
WAITED_FOR = ("choose", "check --alpha 5 --beta 5 --physical")
INSTANCES = 10_000
COMPILED_STEPS = 100_000  # of a run that pays for compiling


class Line(NamedTuple):
    """What is compared with what, how many times as fast we are by what was run, and what is promised of each."""

    what: str
    ratios: dict[str, float]
    promise: float


def times_as_fast(ours: Callable[[], Any], theirs: Callable[[], Any]) -> float:
    """Return the ratio of their shortest times over three turns, each of at least 0.2 s: what disturbs only slows."""
    timers = Timer(ours), Timer(theirs)
    turns = [[seconds / count for count, seconds in (timer.autorange() for timer in timers)] for _ in range(TURNS)]
    mine, other = np.min(turns, axis=0)
    return float(other / mine)


def maps() -> Iterator[Line]:
    """Yield the comparisons of the |z_p| map, for one method at least of each kind."""
    multistep = ("B4", "AB4", "B8", "AB8", "B12", "bdf2", "bdf3", "am4", "bdf4")
    for methods, promise in (
        (map(lookup, (*multistep, "verlet-half", "verlet-kdk", "hht")), 18),
        (map(lookup, ("heun", "dopri5", "tsit5", "sdirk2", "radau3")), 9),
        # of a P, which has real coefficients, roots meet along curves: next to them all are solved for
        ((Method(name, lookup(name).scheme.second_order, "") for name in ("AB3", "ABM3")), 5),
    ):
        ratios = {}
        for method in methods:
            a, b = (np.linspace(*ends, POINTS) + OFF_AXIS for ends in window(region(method)))
            ours = partial(spectral_radius, method, a, b[:, np.newaxis])
            ratios[method.name] = times_as_fast(ours, partial(radius, method, *np.meshgrid(a, b)))
        yield Line("maps, beside batched eigenvalues", ratios, promise)


def commands() -> Iterator[Line]:
    """Yield how far what people wait for is from importing the packages that it cannot do without."""
    python, without_figure = sys.executable, "numpy, click, sympy"
    waits = {name: [f"{asked} --method {name} --h 0.001" for asked in WAITED_FOR] for name in ("B4", "AB8", "B12")}
    with tempfile.TemporaryDirectory() as folder:
        run = partial(partial, subprocess.run, check=True, capture_output=True, cwd=folder)
        for packages, at_most, asked in (
            ("numpy, click", 1.5, ["--help"]),
            (without_figure, 4, ["poles --alpha 0.5 --beta 0.1"]),
            (without_figure, 2.5, waits["B4"]),
            (without_figure, 5, waits["AB8"] + waits["B12"]),
            (f"{without_figure}, matplotlib.figure, matplotlib.backends.backend_svg", 2.5, ["region --method B4"]),
        ):
            imports = run([python, "-c", f"import {packages}"])
            ratios = {each: times_as_fast(run([python, "-m", "bezstab", *each.split()]), imports) for each in asked}
            yield Line(f"commands, beside import {packages}", ratios, 1 / at_most)


def alone(name: str, count: int, compiled: bool = False) -> Callable[[], object]:
    """Return what runs so many steps of a method."""
    return partial(simulate, MECHANISM, lookup(name), STEP, count * STEP, GAINS, compiled=compiled)


def runs() -> Iterator[Line]:
    """Yield the comparisons of a run with the paper's Eq. 9, its matrices put together and solved, and with a batch."""
    literal, (q, v) = literal_equation_9(MECHANISM, *GAINS), initial_state(MECHANISM)
    gains = np.multiply.outer(GAINS, np.linspace(1, 0.5, INSTANCES))
    states = np.repeat(np.concatenate([q, v])[:, np.newaxis], INSTANCES, axis=1)
    one = alone("RK4", STEPS)
    each = times_as_fast(one, partial(literal, 0.0, q, v))
    yield Line("a run, beside Eq. 9 as it stands", {"RK4": 4 * STEPS * each}, 2)

    def batch() -> None:
        deque(march(MECHANISM, lookup("RK4"), even_steps(STEP, STEPS, (gains[0], gains[1]), (INSTANCES,)), states))

    yield Line(f"one of {INSTANCES} runs, beside a run alone", {"RK4": INSTANCES * times_as_fast(batch, one)}, 10)


def mujocos(integrator: str) -> Callable[[], object]:
    """Return what runs COMPILED_STEPS steps of MuJoCo in one call."""
    import mujoco

    model = mujoco.MjModel.from_xml_string(four_bar_xml(integrator, STEP, 0.5, 0.1))
    model.opt.tolerance = 1e-8  # MuJoCo's own: the witness asks for every digit, which costs a hundred iterations
    data = mujoco.MjData(model)
    data.qpos[:], data.qvel[:] = initial_state(MECHANISM)
    return partial(mujoco.mj_step, model, data, nstep=COMPILED_STEPS)


def compiled_runs() -> Iterator[Line]:
    """Yield how much faster compiled runs are than Python's and MuJoCo's."""
    ours = {name: alone(name, COMPILED_STEPS, compiled=True) for name in ("B4", "RK4", "SYM")}
    in_python = {name: times_as_fast(run, alone(name, COMPILED_STEPS)) for name, run in ours.items()}
    yield Line("compiled runs, beside Python's", in_python, 20)
    engines = {name: times_as_fast(ours[name], mujocos(of)) for name, of in (("SYM", "Euler"), ("RK4", "RK4"))}
    yield Line("compiled runs, beside MuJoCo's", engines, 15)


def main() -> int:
    """Measure, print and write everything; return 1 if a promise is broken."""
    items, broken = [], False
    for what, ratios, promise in chain(maps(), commands(), runs(), compiled_runs()):
        shown = ", ".join(f"{name} {ratio:.3g}" for name, ratio in ratios.items())
        items.append(f"- **{what}:** {shown} (promised: {promise:.3g})")
        print(items[-1], flush=True)
        broken |= min(ratios.values()) < promise
    REPORT.write_text(HEAD + "\n".join(items) + "\n", encoding="utf-8")
    return int(broken)


if __name__ == "__main__":
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    sys.exit(main())
