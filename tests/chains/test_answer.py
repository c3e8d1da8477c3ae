"""Answers about chains: loops over links that know no matrices, the number of sweeps, what to set."""

import re
from fractions import Fraction
from math import log, pi
from typing import Any

import numpy as np
import pytest

from bezstab.chains.answer import SPREAD, chain, judge_chain
from bezstab.chains.links import Links, links
from bezstab.engines.engine_list import ENGINES, engine_and_values
from bezstab.errors import InputError
from bezstab.stability.arrays import FloatArray
from bezstab.stability.rest_offsets import offset_at_rest
from tests.reference.swept_chains import arm_step, at_rest, columns, hard_step

H = Fraction(1, 60)


def test_a_chain_decides_whether_an_answer_is_safe() -> None:
    unsafe, safe = (chain("chipmunk", h=H, bodies=10, mass_ratio=10, iterations=sweeps) for sweeps in (None, 12))
    assert (unsafe.safe, unsafe.stable_iterations, safe.safe, unsafe.iterations) == (False, 12, True, 10)
    assert unsafe.z_abs == pytest.approx(1.00494, abs=1e-5)  # as pymunk's own
    assert unsafe.alone_z_abs == pytest.approx(0.9)
    assert "multiplies the error by 1.005, most at link 1 from the world." in unsafe.sentence  # as in pymunk's own run
    assert unsafe.growing[:9] == pytest.approx((1, 0.983, 0.958, 0.925, 0.885, 0.838, 0.784, 0.723, 0.658), abs=5e-4)
    assert unsafe.tenth_steps is None
    assert safe.tenth_steps == pytest.approx(log(0.1) / log(safe.z_abs), abs=1)
    assert repr(safe).startswith("chipmunk, a chain of 10 with the last body 10 times as heavy, 12 sweeps: safe.")


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
    stronger = point[0], point[1] * Fraction(1 + SPREAD * (1 - 1e-6))  # at SPREAD it is marginal
    try:
        pushed = tuple(map(Fraction, engine.values(stronger, H)))
    except InputError:  # it has no words for so strong a feedback
        pushed = (*written, *values[len(written) :])
    assert judge_chain(engine, pushed, H, links(6, Fraction(20))).safe


@pytest.mark.parametrize("masses", [(1, 1, 1), (1, 1, 5), (2, 1, 7, 1, 3, 1), (3, 1, 20), (1,) * 9 + (10,)])
@pytest.mark.parametrize("sweeps", [1, 2, 3, 8, 10])
def test_a_chain_between_two_walls_is_what_loops_over_its_links_do(masses: tuple[int, ...], sweeps: int) -> None:
    """Of the loops one eigenvalue is 1: the tension that pulls at both walls, which no motion changes."""
    engine, count = ENGINES["chipmunk"], len(masses)
    chained = Links(tuple(map(Fraction, masses)), both_ends=True)
    answer = judge_chain(engine, (Fraction("0.9") ** 60,), H, chained, sweeps)
    inverse = [*(1 / mass for mass in masses), 0.0]  # the second wall is a body that nothing moves
    matrix: FloatArray = np.array(columns(hard_step(inverse, sweeps, 0.1), count + 1)).T
    wall = [count, 2 * count + 1]
    values, vectors = np.linalg.eig(np.delete(np.delete(matrix, wall, axis=0), wall, axis=1))
    moduli = np.abs(values)
    moduli[np.argmin(np.abs(values - 1))] = 0
    assert answer.z_abs == pytest.approx(moduli.max(), abs=1e-6)
    errors = np.abs(np.diff(np.concatenate([[0], vectors[:count, np.argmax(moduli)], [0]])))
    if answer.z_abs > 0.9 + 1e-3:  # else it is the share, of which there are several
        assert answer.growing == pytest.approx(errors / errors.max(), abs=1e-6)


@pytest.mark.parametrize("engine", ["rapier=10,1", "ode=0.3,0.02", "physx"])
def test_one_body_rests_where_a_constraint_alone_does(engine: str) -> None:
    """Where that is: tests/stability/test_rest_offsets.py."""
    c = offset_at_rest(*engine_and_values(engine), H, Fraction("9.81"))
    answer = chain(engine, h=H, bodies=1, load="gravity")
    assert answer.sag == pytest.approx(c, rel=1e-6, abs=1e-9)
    assert (f"sags by {1e3 * c:.3g} mm" if answer.sag else "does not sag") in answer.sentence


@pytest.mark.parametrize(("load", "pull"), [("gravity", [9.81] * 5), (50, [0, 0, 0, 0, 50 / 4])])
def test_a_chain_without_kept_impulses_sags_as_loops_over_its_links_do(load: str | int, pull: list[float]) -> None:
    """Bullet's joints start each step with no impulse: few sweeps do not hold the chain."""
    masses, sweeps = (1, 2, 1, 1, 4), 3
    step = hard_step([1 / mass for mass in masses], sweeps, 0.2, kept=0, pull=[each / 60**2 for each in pull])
    sag = at_rest(step, 5)[4]
    answer = chain("bullet=0.2", h=H, masses=masses, iterations=sweeps, load=load)
    assert answer.sag == pytest.approx(sag, rel=1e-6)
    assert sag > 0.01
    under = "gravity" if load == "gravity" else "50 N at its end"
    assert f"Under {under} along it, it sags by {1e3 * sag:.3g} mm" in repr(answer)


def motor_numbers(hertz: float, damping_ratio: float) -> tuple[float, float]:
    """Return share and softness of a spring and damper that an implicit step solves: Catto's soft constraint."""
    omega = 2 * pi * hertz
    stiffness, damping, h = omega**2, 2 * damping_ratio * omega, 1 / 60  # of an inertia of one
    return h * stiffness / (h * stiffness + damping), 1 / (h * (h * stiffness + damping))


ARMS = [
    ("chipmunk", "angle", {"share": 0.1}, (0.1, 0.0)),
    ("chipmunk", "rate", {"share": 0.1}, (0.0, 0.0)),
    ("box2d-v2", "rate", {"share": 0.0, "positions": 3}, (0.0, 0.0)),
    ("box2d-v2", "5,0.7", {"share": 0.0, "positions": 3}, motor_numbers(5, 0.7)),
    ("ode=0.3", "20,1", {"share": 0.3, "kept": 0.0, "relaxation": 1.3}, motor_numbers(20, 1)),
]
MASSES = (1, 2, 1, 3)


@pytest.mark.parametrize(("engine", "motor", "settings", "of_motor"), ARMS)
def test_an_arm_grows_as_loops_over_its_pins_and_motors_do(
    engine: str, motor: str, settings: dict[str, Any], of_motor: tuple[float, float]
) -> None:
    """Angles that no motor holds are left out. Along its own line it is the chain without motors."""
    step = arm_step(MASSES, 4, motor=of_motor, **settings)
    values = np.abs(np.linalg.eigvals(columns(step, 2 * len(MASSES))))
    along = chain(engine, h=H, masses=MASSES, iterations=4).z_abs
    largest = sorted(values)[-1 - len(MASSES) * (motor == "rate")]
    answer = chain(engine, h=H, masses=MASSES, iterations=4, motor=motor)
    assert answer.z_abs == pytest.approx(max(along, largest), abs=1e-6)


@pytest.mark.parametrize(("load", "pull"), [("gravity", (9.81 / 60**2, 0.0)), (7, (0.0, 7 / 60**2))])
@pytest.mark.parametrize(("engine", "motor", "settings", "of_motor"), ARMS[-2:])
def test_an_arm_droops_as_loops_over_its_pins_and_motors_do(
    engine: str,
    motor: str,
    settings: dict[str, Any],
    of_motor: tuple[float, float],
    load: str | int,
    pull: tuple[float, float],
) -> None:
    state = at_rest(arm_step(MASSES, 40, motor=of_motor, pull=pull, **settings), 2 * len(MASSES))
    answer = chain(engine, h=H, masses=MASSES, iterations=40, motor=motor, load=load)
    assert answer.sag == pytest.approx(state[3] + 2.0 / 2 * state[7], rel=1e-7)


@pytest.mark.parametrize(
    ("bodies", "ratio", "sweeps", "measured"),
    [(10, 10, 10, 0.00337), (10, 20, 10, 0.00852), (6, 20, 4, 0.0333), (12, 1, 3, 0.00777)],
)
def test_a_hanging_chain_jitters_as_far_as_in_pymunk(bodies: int, ratio: int, sweeps: int, measured: float) -> None:
    """Within a factor of three, over a decade; measured (m) in runs of pymunk, which tests/witnesses has others of."""
    answer = chain("chipmunk", h=H, bodies=bodies, mass_ratio=ratio, iterations=sweeps, load="gravity")
    assert answer.jitter
    assert (answer.safe, answer.sag) == (False, None)
    assert 1 / 3 < measured / answer.jitter < 3
    assert f"joints are off by about {1e3 * answer.jitter:.2g} mm" in answer.sentence


def test_only_a_chain_that_swings_ever_further_jitters() -> None:
    for engine, motor in (("chipmunk", None), ("bullet=2.1", None), ("chipmunk", "angle")):
        assert chain(engine, h=H, bodies=5, motor=motor).jitter is None
