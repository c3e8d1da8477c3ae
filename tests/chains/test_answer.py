"""Answers about chains: loops over links that know no matrices, the number of sweeps, what to set."""

import re
from fractions import Fraction
from math import log, pi

import numpy as np
import pytest

from bezstab.chains.answer import SPREAD, Links, chain, judge_chain, links
from bezstab.engines.engine_list import ENGINES, engine_and_values
from bezstab.errors import InputError
from bezstab.stability.arrays import FloatArray
from tests.reference.engine_steps import STEPS

H = Fraction(1, 60)


def test_a_chain_decides_whether_an_answer_is_safe() -> None:
    unsafe, safe = (chain("chipmunk", h=H, bodies=10, mass_ratio=10, iterations=sweeps) for sweeps in (None, 12))
    assert (unsafe.safe, unsafe.stable_iterations, safe.safe) == (False, 12, True)
    assert unsafe.z_abs == pytest.approx(1.00494, abs=1e-5)  # as pymunk's own
    assert unsafe.alone_z_abs == pytest.approx(0.9)
    assert "multiplies the error by 1.005, most at link 1 from the world." in unsafe.sentence  # as in pymunk's own run
    assert unsafe.growing[:9] == pytest.approx((1, 0.983, 0.958, 0.925, 0.885, 0.838, 0.784, 0.723, 0.658), abs=5e-4)
    assert unsafe.tenth_steps is None
    assert safe.tenth_steps == pytest.approx(log(0.1) / log(safe.z_abs), abs=1)
    assert repr(safe).startswith("chipmunk, a chain of 10 with the last body 10 times as heavy, 12 sweeps: safe.")


def test_the_engines_own_sweeps_are_taken_unless_others_are_asked_about() -> None:
    answer = chain("ode=0.2", h=H, bodies=2)
    assert answer.iterations == 20
    assert answer.alone_z_abs == pytest.approx(0.8, abs=1e-9)


@pytest.mark.slow
def test_a_chain_that_settles_slowly_is_said_to() -> None:
    """A hundred times the mass at the end of six bodies in Jolt: minutes."""
    answer = chain("jolt=0.2", h=H, bodies=6, mass_ratio=100)
    assert answer.safe
    seconds = log(1e-3) / log(answer.z_abs) / 60
    assert f"An error falls slowly: to a thousandth in {seconds:.3g} s (" in answer.sentence
    assert seconds > 200


@pytest.mark.parametrize("name", [name for name, each in ENGINES.items() if each.sweeping and each.defaults])
def test_its_setting_is_stable_also_if_it_were_a_tenth_stronger(name: str) -> None:
    """And stronger by a fifth it is not, unless it is all that the engine can express."""
    engine, values = engine_and_values(name)
    answer = judge_chain(engine, values, H, links(6, Fraction(20)))
    if not engine.parameters or answer.setting is None:
        return
    assert engine.curve
    numbers = re.findall(r"(?<![\w.])\d+(?:\.\d+)?(?:e[-+]?\d+)?", answer.setting)
    written = tuple(map(Fraction, numbers))
    point = engine.applied((*written, *values[len(written) :]), H).point
    stronger = point[0], point[1] * Fraction(1 + SPREAD)
    try:
        pushed = tuple(map(Fraction, engine.values(stronger, H)))
    except InputError:  # it has no words for so strong a feedback
        pushed = (*written, *values[len(written) :])
    assert judge_chain(engine, pushed, H, links(6, Fraction(20))).safe


def loops(masses: tuple[float, ...], sweeps: int, share: float) -> FloatArray:
    """Return the matrix of a step of hard sweeps with warm start over a chain between two walls, link by link."""
    count = len(masses)
    ends = [(link - 1, link) for link in range(count)] + [(count - 1, None)]

    def error(values: FloatArray, link: int) -> float:
        before, after = ends[link]
        return float((values[after] if after is not None else 0.0) - (values[before] if before >= 0 else 0.0))

    def push(values: FloatArray, link: int, impulse: float) -> None:
        before, after = ends[link]
        if after is not None:
            values[after] += impulse / masses[after]
        if before >= 0:
            values[before] -= impulse / masses[before]

    def step(state: FloatArray) -> FloatArray:
        x, v, impulses = state[:count].copy(), state[count : 2 * count].copy(), state[2 * count :].copy()
        for link in range(count + 1):
            push(v, link, impulses[link])
        for _ in range(sweeps):
            for link, (before, after) in enumerate(ends):
                inverse = sum(1 / masses[end] for end in (before, after) if end is not None and end >= 0)
                impulse = -(error(v, link) + share * error(x, link)) / inverse
                push(v, link, impulse)
                impulses[link] += impulse
        return np.concatenate([x + v, v, impulses])

    return np.array([step(column) for column in np.eye(3 * count + 1)]).T


@pytest.mark.parametrize("masses", [("1", "1", "1"), ("1", "1", "5"), ("2", "1", "7", "1", "3", "1")])
@pytest.mark.parametrize("sweeps", [1, 3, 8])
def test_a_chain_between_two_walls_is_what_loops_over_its_links_do(masses: tuple[str, ...], sweeps: int) -> None:
    """Of the loops one eigenvalue is 1: the tension that pulls at both walls, which no motion changes."""
    engine = ENGINES["chipmunk"]
    exact = tuple(map(Fraction, masses))
    share = 0.1
    answer = judge_chain(engine, (Fraction("0.9") ** 60,), H, Links(exact, both_ends=True), sweeps)
    moduli = np.abs(np.linalg.eigvals(loops(tuple(map(float, exact)), sweeps, share)))
    others = np.delete(moduli, np.argmin(np.abs(moduli - 1)))
    assert answer.z_abs == pytest.approx(others.max(), abs=1e-6)


@pytest.mark.parametrize(("masses", "sweeps"), [((1.0,) * 9 + (10.0,), 10), ((3.0, 1.0, 20.0), 2)])
def test_the_links_at_which_errors_grow_are_those_of_the_loops(masses: tuple[float, ...], sweeps: int) -> None:
    """Of errors that grow, not of the tension between the walls: it is one, and held by no body here."""
    engine = ENGINES["chipmunk"]
    chained = Links(tuple(map(Fraction, masses)), both_ends=True)
    answer = judge_chain(engine, (Fraction("0.9") ** 60,), H, chained, sweeps)
    values, vectors = np.linalg.eig(loops(masses, sweeps, 0.1))
    moduli = np.abs(values)
    moduli[np.argmin(np.abs(values - 1))] = 0
    x = vectors[: len(masses), np.argmax(moduli)]
    errors = np.abs(np.diff(np.concatenate([[0], x, [0]])))
    assert answer.growing == pytest.approx(errors / errors.max(), abs=1e-6)


@pytest.mark.parametrize(
    ("engine", "seconds_squared"),
    [
        ("jolt-spring=5,1/2", 1 / (2 * pi * 5) ** 2),  # of a spring g / omega^2
        ("box2d=10,2", 1 / (2 * pi * 10) ** 2),
        ("p2=1e4,4", 1e-4),  # m / k
        ("ode=0.2,0.001", 0.001 / 60 / 0.2),  # h CFM / ERP
        ("pbd=0.8", 0.2 / 0.8 / 60**2),  # what is left of the move of a step
        ("chipmunk", 0),
        ("jolt=0.2", 0),
    ],
)
def test_one_body_rests_where_its_constraint_holds_the_load(engine: str, seconds_squared: float) -> None:
    answer = chain(engine, h=Fraction(1, 60), bodies=1, load=9.81)
    assert answer.sag == pytest.approx(9.81 * seconds_squared, rel=1e-6)
    words = f"sags by {9810 * seconds_squared:.3g} mm" if seconds_squared else "does not sag"
    assert words in answer.sentence


@pytest.mark.parametrize(
    "engine", ["rapier=10,1", "jolt-spring=3,1", "bepu=8,0.3", "box2d=5,1", "ode=0.3,0.02", "pbd=0.6", "physx", "godot"]
)
def test_one_body_rests_where_the_engines_own_step_leaves_it(engine: str) -> None:
    """Forces first change the velocity, then the step of tests/reference/engine_steps.py is taken."""
    named, values = engine_and_values(engine)
    c, v = 0.0, 0.0
    for _ in range(3000):
        c, v = STEPS[named.name](c, v + 9.81 / 60, 1 / 60, *map(float, values))
    assert chain(engine, h=Fraction(1, 60), bodies=1, load=9.81).sag == pytest.approx(c, rel=1e-6, abs=1e-9)


def test_a_chain_without_kept_impulses_sags_as_loops_over_its_links_do() -> None:
    """Bullet's joints start each step with no impulse: few sweeps do not hold the chain."""
    bodies, sweeps, share = 5, 3, 0.2
    x, v = np.zeros(bodies), np.zeros(bodies)
    for _ in range(3000):
        v += 9.81 / 60**2
        for _ in range(sweeps):
            for link in range(bodies):
                before, rate = (x[link - 1], v[link - 1]) if link else (0.0, 0.0)
                impulse = -(v[link] - rate + share * (x[link] - before)) / (2 if link else 1)
                v[link] += impulse
                if link:
                    v[link - 1] -= impulse
        x += v
    answer = chain("bullet=0.2", h=Fraction(1, 60), bodies=bodies, iterations=sweeps, load=9.81)
    assert answer.sag == pytest.approx(x[-1], rel=1e-6)
    assert x[-1] > 0.01


def test_a_chain_that_comes_apart_has_no_place_to_rest() -> None:
    answer = chain("chipmunk", h=Fraction(1, 60), mass_ratio=10, load=9.81)
    assert not answer.safe
    assert answer.sag is None
