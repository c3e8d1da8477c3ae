"""Runs against independent references: one-coordinate motion by quadrature, forces by Newton and Euler, counts, causes.

A mechanism of one degree of freedom that keeps its energy moves by dt = sqrt(J/2 / (E - V)) dangle: its angle at any
time comes from an integral and Newton's method, to as many digits as asked for and without any time stepping.
"""

import math
import re
from collections.abc import Callable, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import cache
from itertools import islice
from typing import Any

import mpmath as mp
import numpy as np
import pytest
import sympy as sp

from bezstab.mechanism import (
    Mechanism,
    Start,
    compiled_mechanism,
    compiled_source,
    load_scene,
    observe,
    simulate,
    stepper_code,
)
from bezstab.methods import REGISTRY, Method, accuracy, evaluations, lookup, steps

H = 1e-3
DIGITS = 30  # of the references: eighth-order errors of 1e-17 and less are to be told from rounding
SHARED = 10  # times, evenly spread over a run, at which it is compared with the reference
ANGLE = sp.Symbol("theta")


def slider_crank() -> sp.Matrix:
    """Return q of the paper's slider-crank as a function of the crank's angle."""
    l1, l2 = sp.Rational("0.2"), sp.Rational("0.35")
    rod = -sp.asin(l1 * sp.sin(ANGLE) / l2)
    across, along = l1 * sp.cos(ANGLE), l2 * sp.cos(rod)
    return sp.Matrix([ANGLE, across + along / 2, l1 * sp.sin(ANGLE) / 2, rod, across + along])


def slider_crank_energies(inertia: str) -> tuple[sp.Expr, sp.Expr]:
    """Return J and V, so that the energy is J theta'^2 / 2 + V, for a crank's inertia (kg m2)."""
    masses = sp.Matrix([sp.Rational(m) for m in (inertia, "3.5", "3.5", "3.5", "2.5")])
    q = slider_crank()
    return masses.dot(q.diff(ANGLE).applyfunc(lambda rate: rate**2)), masses[1] * sp.Rational("9.81") * q[2]


def chain_energies(count: int) -> tuple[sp.Expr, sp.Expr]:
    """Return J and V of N parallel four-bars with rods of 1 m and 1 kg: N + 1 rods turn alike, N couplers translate."""
    reduced = sp.Rational(count + 1, 3) + count
    return reduced, (sp.Rational(count + 1, 2) + count) * sp.Rational("9.81") * sp.sin(ANGLE)


def passage(energies: tuple[sp.Expr, sp.Expr], start: float, rate: float, times: Sequence[Any]) -> dict[Any, Any]:
    """Return the angle and its rate at each time (s), to DIGITS, from those at t = 0; the rate must keep its sign."""
    both = sp.lambdify(ANGLE, energies, "mpmath", cse=True)
    j_0, v_0 = both(mp.mpf(start))
    sign, energy = mp.sign(rate), j_0 * mp.mpf(rate) ** 2 / 2 + v_0

    def speed(angle: Any) -> Any:
        j, v = both(angle)
        return sign * mp.sqrt(2 * (energy - v) / j)

    t, angle, reached = mp.mpf(0), mp.mpf(start), {}
    for time in sorted(times):
        new = angle + (time - t) * speed(angle)
        for _ in range(50):  # Newton's method, quadratic: a handful
            late = mp.quad(lambda a: 1 / speed(a), [angle, new]) - (time - t)
            new -= late * speed(new)
            if abs(late) < mp.mpf(10) ** (4 - DIGITS):
                break
        t, angle = time, new
        reached[time] = (angle, speed(angle))
    return reached


@pytest.fixture(autouse=True)
def digits() -> Any:
    """Give every test here mpmath at DIGITS, and give it back."""
    with mp.workdps(DIGITS):
        yield


def shared_times(duration: float) -> list[Any]:
    return [duration * mp.mpf(k) / SHARED for k in range(SHARED + 1)]


@cache
def crank_angles(inertia: str, rate: float, duration: float) -> list[Any]:
    """Return the slider-crank's angle at the shared times, from 45 degrees."""
    reached = passage(slider_crank_energies(inertia), np.pi / 4, rate, shared_times(duration))
    return [angle for angle, _ in reached.values()]


def distance(angles: Sequence[Any], reference: Sequence[Any]) -> float:
    """Return the root of the mean square difference at the shared times, which changes sign nowhere as h shrinks."""
    stride = (len(angles) - 1) // SHARED
    return math.sqrt(sum(float(a - b) ** 2 for a, b in zip(angles[::stride], reference, strict=True)))


def shown_order(errors: Sequence[float]) -> float:
    """Return the order that two errors show when the second is that of half the step."""
    return math.log2(errors[0] / errors[1])


def test_the_reference_agrees_with_the_published_angles() -> None:
    reached = passage(slider_crank_energies("45"), np.pi / 4, np.pi / 3, [1, 2])
    assert [float(angle) for angle, _ in reached.values()] == pytest.approx([1.822086334469, 2.872938352485], abs=5e-13)


def test_the_reference_has_the_digits_it_is_asked_for() -> None:
    arguments = slider_crank_energies("45"), np.pi / 4, 10 * np.pi, [mp.mpf(1) / 25]
    usual = passage(*arguments)
    with mp.workdps(DIGITS + 15):
        finer = passage(*arguments)
    for time in usual:
        assert abs(usual[time][0] - finer[time][0]) < mp.mpf(10) ** (4 - DIGITS)  # Newton's last step


def precise_run(mechanism: Mechanism, method: Method, h: Any, gains: tuple[int, int], states: Sequence[Any]) -> Any:
    """Return the generated code's iterator of states after the given ones, equally spaced, in 30 digits.

    Each literal stands for the simplest fraction that rounds to it, as 0.3333333333333333 does for 1/3.
    """

    def exact(literal: re.Match[str]) -> str:
        simplest = Fraction(literal[0]).limit_denominator(10**7)
        value = simplest if float(simplest) == float(literal[0]) else Fraction(literal[0])
        return f"ratio({value.numerator}, {value.denominator})"

    def stepper(method: Method) -> Any:
        namespace = compiled_source(re.sub(r"\d+\.\d+(e-?\d+)?", exact, stepper_code(mechanism, method)), mp)
        namespace["ratio"] = cache(lambda p, q: mp.mpf(p) / q)
        return namespace["run"]

    euler = stepper(lookup("RK1"))
    past = [(state, next(euler(0, h, *gains, state, []))[1]) for state in states[-2::-1]]
    return (state for state, _, _ in stepper(method)(0, h, *gains, states[-1], past))


@cache
def exact_states(rate: float, duration: float, counts: tuple[int, ...]) -> tuple[list[Any], dict[int, list[Any]]]:
    """Return the angles at the shared times and, for each number of steps, the states at the first twelve of them."""
    first = {count: [duration * mp.mpf(k) / count for k in range(12)] for count in counts}
    times = {*shared_times(duration), *(time for several in first.values() for time in several)}
    reached = passage(slider_crank_energies("45"), np.pi / 4, rate, list(times))
    q = slider_crank()
    whole = sp.lambdify((ANGLE, sp.Symbol("w")), (*q, *(q.diff(ANGLE) * sp.Symbol("w"))), "mpmath", cse=True)
    states = {count: [whole(*reached[time]) for time in several] for count, several in first.items()}
    return [reached[time][0] for time in shared_times(duration)], states


@pytest.mark.parametrize("name", REGISTRY)
def test_with_alpha_and_beta_fixed_a_method_keeps_its_order(name: str) -> None:
    """All from exact first values and in 30 digits: float64 ends the descent of AB7 and AB8 before 0.1 is reached."""
    method, moving = lookup(name), compiled_mechanism(load_scene("slider_crank_300rpm"))
    duration, counts = 0.04, (100, 200)  # a fifth of a turn; twelve steps of 100 are already short
    reference, states = exact_states(moving.scene.velocity["crank.theta"], duration, counts)
    errors = []
    for count in counts:
        first = states[count][: steps(method)]
        later = precise_run(moving, method, mp.mpf(duration) / count, (20, 100), first)
        errors.append(distance([state[0] for state in [*first, *islice(later, count + 1 - len(first))]], reference))
    # 0.1 is the promise; the next term of the error moves the measured order by 0.07 at most (B12, AB7)
    assert shown_order(errors) == pytest.approx(accuracy(method)[0], abs=0.1)


def measured_order(name: str, count: int, gains: Callable[[float], tuple[float, float]]) -> float:
    """Return the order that `simulate` shows from count to 2 count steps over 0.2 s, the light crank at 60 rpm."""
    scene, duration = load_scene("slider_crank_light"), 0.2
    moving = compiled_mechanism(replace(scene, velocity={"crank.theta": 2 * np.pi}))
    reference, errors = crank_angles("0.05", 2 * np.pi, duration), []
    for steps_taken in (count, 2 * count):
        h = duration / steps_taken
        run = simulate(moving, lookup(name), h, duration, gains(h))
        assert not run.failure
        errors.append(distance(run.q[:, 0].tolist(), reference))
    return shown_order(errors)


@pytest.mark.parametrize("name", [name for name in REGISTRY if accuracy(lookup(name))[0] <= 4])
def test_a_run_keeps_its_methods_order_up_to_that_of_its_start(name: str) -> None:
    # RK4's first steps, each with an error of order 5, decide the rest. The next term moves the order by 0.05 at most
    order, _ = accuracy(lookup(name))
    assert measured_order(name, 400, lambda _: (20.0, 100.0)) == pytest.approx(order, abs=0.1)


@pytest.mark.parametrize(
    ("name", "order"),
    [
        *((name, accuracy(lookup(name))[0]) for name in ("B1", "B2", "B3", "B4", "AB2", "AB3", "AB4", "ABM2", "ABM3")),
        *(("RK2", 1), ("RK3", 2), ("RK4", 2), ("SIE", 1)),
    ],
)
def test_with_alpha_hat_and_beta_hat_fixed_runge_kutta_methods_lose_order(name: str, order: int) -> None:
    """The feedback grows as h shrinks, and with it the push that stages get which leave the constraints."""
    count = 3200 if name == "RK2" else 800  # the order of RK2 falls from 2 slowly: 1.27 at 400, 1.08 at 1600
    assert measured_order(name, count, lambda h: (0.5 / h, 0.1 / h**2)) == pytest.approx(order, abs=0.1)


@pytest.mark.parametrize("name", ["RK4", "AB4", "AB3", "B4", "SYM"])
def test_the_parallel_four_bars_move_as_one_coordinate(name: str) -> None:
    moving, duration = compiled_mechanism(load_scene("n_four_bar")), 0.5
    reached = passage(chain_energies(3), np.pi / 2, -1.0, shared_times(duration))
    reference, errors = [angle for angle, _ in reached.values()], []
    assert reference[-1] > 0.3  # well above the ground, where the rods lie in line and the motion branches
    for count in (400, 800):
        run = simulate(moving, lookup(name), duration / count, duration, (20.0, 100.0))
        rods = run.q[:, :4]
        assert np.ptp(rods, axis=1).max() < 1e-13  # rad: equal but for the rounding of 800 steps
        errors.append(distance(rods[:, 0].tolist(), reference))
    assert shown_order(errors) == pytest.approx(accuracy(lookup(name))[0], abs=0.1)


def test_multipliers_are_the_joint_forces_of_newton_and_euler() -> None:
    moving, gains, rate = compiled_mechanism(load_scene("slider_crank_light")), (20.0, 100.0), sp.Symbol("w")
    run = simulate(moving, lookup("RK4"), 2e-4, 2.0, gains)
    q, (j, v) = slider_crank(), slider_crank_energies("0.05")
    turning = -(j.diff(ANGLE) * rate**2 / 2 + v.diff(ANGLE)) / j  # Lagrange's equation of the crank's angle
    accelerations = q.diff(ANGLE, 2) * rate**2 + q.diff(ANGLE) * turning
    evaluated = sp.lambdify((ANGLE, rate), (*q, *accelerations), "numpy", cse=True)(run.q[:, 0], run.v[:, 0])
    crank, _, _, rod, _, crank_a, x_a, y_a, rod_a, slider_a = evaluated
    # forces on the rod: at the slider b, at the crank a; its balances of force and, with half its length, of moment
    b_x = -2.5 * slider_a
    a_x = 3.5 * x_a - b_x
    total, difference = 3.5 * (y_a + 9.81), (3.5 * rod_a / 0.175 + np.sin(rod) * (b_x - a_x)) / np.cos(rod)
    a_y, b_y = (total - difference) / 2, (total + difference) / 2
    # the crank's balance of moment was not used: it checks these forces, to rounding at 400 N
    assert 0.05 * crank_a == pytest.approx(0.2 * (np.sin(crank) * a_x - np.cos(crank) * a_y), abs=1e-12)
    seen = observe(moving, run.t, run.q, run.v, *gains)
    # the run's cdot, 3e-13 m/s, is multiplied by 2 alpha and at most J2 / 0.175^2 = 114 kg
    assert seen.multipliers == pytest.approx(np.stack([a_x, a_y, -b_x, -b_y], axis=1), abs=1e-9)


def test_the_pendulums_multiplier_is_its_tension() -> None:
    moving, gains = compiled_mechanism(load_scene("pendulum")), (20.0, 100.0)
    run = simulate(moving, lookup("RK4"), 2e-4, 2.0, gains)
    tension = (run.v**2).sum(axis=1) - 9.81 * run.q[:, 1]  # m (v^2 / l + g cos), m = l = 1
    # 2 alpha times the run's cdot, 1e-12 m/s
    assert observe(moving, run.t, run.q, run.v, *gains).multipliers[:, 0] == pytest.approx(tension, abs=1e-10)


def test_table_5_case_3_diverges_for_adams_bashforth_only() -> None:
    moving, gains = compiled_mechanism(load_scene("slider_crank")), (0.5 / H, 0.101 / H**2)
    last = {}
    for name in ("B4", "AB4", "RK4@5", "SIE"):
        run = simulate(moving, lookup(name), H, 10.0, gains)
        c = observe(moving, run.t, run.q, run.v, *gains).c[:, 0]
        half = len(c) // 2
        last[name] = np.abs(c[half:]).max() / np.abs(c[half // 2 : half]).max()
    assert last["AB4"] > 10  # 1.0014 to the power of 2500 is 35
    assert all(last[name] < 2 for name in ("B4", "RK4@5", "SIE"))


@pytest.mark.parametrize("scene", ["pendulum", "four_bar", "n_four_bar", "slider_crank_light"])
@pytest.mark.parametrize("name", ["RK4", "AB3", "B4"])
def test_the_energy_drifts_like_a_power_of_the_step(scene: str, name: str) -> None:
    moving, drifts = compiled_mechanism(load_scene(scene)), []
    for h in (2e-3, 1e-3):
        run = simulate(moving, lookup(name), h, 0.5, (20.0, 100.0))
        energy = observe(moving, run.t, run.q, run.v, 20.0, 100.0).energy
        drifts.append(float(np.abs(energy - energy[0]).max()))
    assert shown_order(drifts) == pytest.approx(accuracy(lookup(name))[0], abs=0.1)


@pytest.mark.parametrize("name", ["B4", "AB4", "ABM4", "RK4", "SYM", "RK4@5"])
def test_the_pendulum_keeps_time(name: str) -> None:
    order, _ = accuracy(lookup(name))
    run = simulate(compiled_mechanism(load_scene("pendulum")), lookup(name), 1e-3, 1.5, (20.0, 100.0))
    quarter = 9.81**-0.5 * float(sp.elliptic_k(sp.Rational(1, 2)).evalf())  # released from the horizontal
    below = float(np.interp(0, -run.q[:, 0], run.t))  # x falls from 1 through 0 to -1
    assert below == pytest.approx(quarter, abs=2e-3 if order == 1 else 2e-5)  # h, and h^2 for the slope's bend


def test_a_blow_up_ends_the_run_with_time_and_cause() -> None:
    run = simulate(compiled_mechanism(load_scene("slider_crank")), lookup("B4"), H, 5.0, (1.7 / H, 0.8 / H**2))
    assert run.failure
    assert run.failure.startswith(f"at t = {run.t[-1] + H:.6g} s: ")
    assert np.isfinite(run.q).all()
    assert len(run.t) == len(run.q) == len(run.v)


def test_a_singular_configuration_is_named() -> None:
    moving = compiled_mechanism(load_scene("slider_crank_equal"))
    flat = (np.array([np.pi / 2, 0.175 * 0, 0.35 - 0.175, -np.pi / 2, 0.0]), np.zeros(5))
    run = simulate(moving, lookup("RK1"), H, 0.1, (0.0, 0.0), flat)
    assert run.failure
    assert "singular" in run.failure
    assert len(run.t) == 1


@pytest.mark.parametrize("start", ["rk4", "ramp", "euler"])
def test_the_start_provides_the_first_values(start: str) -> None:
    method = lookup("B4")
    run = simulate(compiled_mechanism(load_scene("slider_crank")), method, H, 0.01, (0.0, 0.0), start=start)  # type: ignore[arg-type]
    first = {"rk4": 4, "ramp": 1, "euler": 1}[start] * (steps(method) - 1)
    assert run.evaluations == first + (10 - (steps(method) - 1)) * evaluations(method)
    assert len(run.t) == 11


def test_a_low_order_start_spoils_adams_bashforth() -> None:
    moving, errors = compiled_mechanism(load_scene("slider_crank")), {}
    starts: tuple[Start, ...] = ("rk4", "euler")
    for start in starts:
        run = simulate(moving, lookup("AB4"), H, 1.0, (0.0, 0.0), start=start)
        errors[start] = np.abs(observe(moving, run.t, run.q, run.v, 0.0, 0.0).c[-1, 0])
    assert errors["euler"] > 100 * errors["rk4"]
