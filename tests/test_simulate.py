from functools import cache
from math import log2

import numpy as np
import pytest
import sympy as sp

from bezstab.derivation import accuracy
from bezstab.mechanism import mechanism, observe
from bezstab.methods import REGISTRY, evaluations, lookup, steps
from bezstab.scene import load
from bezstab.simulate import Start, simulate

H = 1e-3


@cache
def crank_angle(inertia: float, omega: float, duration: float) -> float:
    """Return theta_1(duration) of the slider-crank from J theta'' + J' theta'^2/2 + V' = 0, its one-coordinate form."""
    theta, l1, l2, m2, j2, m3 = sp.Symbol("theta"), 0.2, 0.35, 3.5, 3.5, 2.5
    rod = -sp.asin(l1 * sp.sin(theta) / l2)
    x2 = l1 * sp.cos(theta) + l2 / 2 * sp.cos(rod)
    y2, x3 = l1 * sp.sin(theta) / 2, l1 * sp.cos(theta) + l2 * sp.cos(rod)
    reduced = inertia + m2 * (x2.diff() ** 2 + y2.diff() ** 2) + j2 * rod.diff() ** 2 + m3 * x3.diff() ** 2
    slope = -(reduced.diff() * sp.Symbol("w") ** 2 / 2 + (m2 * 9.81 * y2).diff()) / reduced
    f = sp.lambdify((theta, sp.Symbol("w")), slope, "math", cse=True)
    count = int(duration * 20000)
    h, a, w = duration / count, np.pi / 4, omega
    for _ in range(count):  # RK4 at 50 microseconds: its error is rounding
        k1, l_1 = w, f(a, w)
        k2, l_2 = w + h / 2 * l_1, f(a + h / 2 * k1, w + h / 2 * l_1)
        k3, l_3 = w + h / 2 * l_2, f(a + h / 2 * k2, w + h / 2 * l_2)
        k4, l_4 = w + h * l_3, f(a + h * k3, w + h * l_3)
        a, w = a + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4), w + h / 6 * (l_1 + 2 * l_2 + 2 * l_3 + l_4)
    return float(a)


def test_the_reference_agrees_with_the_published_angles() -> None:
    for duration, angle in ((1.0, 1.822086334469), (2.0, 2.872938352485)):
        assert crank_angle(45.0, np.pi / 3, duration) == pytest.approx(angle, abs=1e-11)


@pytest.mark.parametrize("name", REGISTRY)
def test_with_alpha_and_beta_fixed_a_method_keeps_its_order(name: str) -> None:
    method, moving = lookup(name), mechanism(load("slider_crank_light"))
    order, _ = accuracy(method)
    exact = crank_angle(0.05, np.pi / 3, 0.25)
    # steps coarse enough that the error stays above rounding, fine enough for the stiffest of the methods
    h = {1: 2.5e-4, 2: 5e-4, 3: 1e-3, 4: 1e-3}.get(order, 1e-3)
    errors = [abs(simulate(moving, method, step, 0.25, (10.0, 25.0)).q[-1, 0] - exact) for step in (h, h / 2)]
    if errors[1] > 1e-12:  # else rounding
        # 0.2: h times the next term; above order 4 the RK4 start gives one step's error of order 5
        assert log2(errors[0] / errors[1]) == pytest.approx(min(order, 5), abs=0.2 if order < 4 else 0.7)


def test_table_5_case_3_diverges_for_adams_bashforth_only() -> None:
    moving, gains = mechanism(load("slider_crank")), (0.5 / H, 0.101 / H**2)
    last = {}
    for name in ("B4", "AB4", "RK4@5", "SIE"):
        run = simulate(moving, lookup(name), H, 10.0, gains)
        c = observe(moving, run.t, run.q, run.v, *gains).c[:, 0]
        half = len(c) // 2
        last[name] = np.abs(c[half:]).max() / np.abs(c[half // 2 : half]).max()
    assert last["AB4"] > 10  # 1.0014 to the power of 2500 is 35
    assert all(last[name] < 2 for name in ("B4", "RK4@5", "SIE"))


def test_energy_is_conserved_at_small_steps() -> None:
    for name in ("pendulum", "four_bar", "n_four_bar"):
        moving = mechanism(load(name))
        run = simulate(moving, lookup("RK4"), 2e-4, 1.0, (20.0, 100.0))
        energy = observe(moving, run.t, run.q, run.v, 20.0, 100.0).energy
        assert np.ptp(energy) < 1e-6 * (1 + np.ptp(run.v) ** 2)  # fourth order in the step


@pytest.mark.parametrize("name", ["B4", "AB4", "ABM4", "RK4", "SYM", "RK4@5"])
def test_the_pendulum_keeps_time(name: str) -> None:
    order, _ = accuracy(lookup(name))
    run = simulate(mechanism(load("pendulum")), lookup(name), 1e-3, 1.5, (20.0, 100.0))
    quarter = 9.81**-0.5 * float(sp.elliptic_k(sp.Rational(1, 2)).evalf())  # released from the horizontal
    below = float(np.interp(0, -run.q[:, 0], run.t))  # x falls from 1 through 0 to -1
    assert below == pytest.approx(quarter, abs=2e-3 if order == 1 else 2e-5)  # h, and h^2 for the slope's bend


def test_a_blow_up_ends_the_run_with_time_and_cause() -> None:
    run = simulate(mechanism(load("slider_crank")), lookup("B4"), H, 5.0, (1.7 / H, 0.8 / H**2))
    assert run.failure
    assert run.failure.startswith(f"at t = {run.t[-1] + H:.6g} s: ")
    assert np.isfinite(run.q).all()
    assert len(run.t) == len(run.q) == len(run.v)


def test_a_singular_configuration_is_named() -> None:
    moving = mechanism(load("slider_crank_equal"))
    flat = (np.array([np.pi / 2, 0.175 * 0, 0.35 - 0.175, -np.pi / 2, 0.0]), np.zeros(5))
    run = simulate(moving, lookup("RK1"), H, 0.1, (0.0, 0.0), flat)
    assert run.failure
    assert "singular" in run.failure
    assert len(run.t) == 1


@pytest.mark.parametrize("start", ["rk4", "ramp", "euler"])
def test_the_start_provides_the_first_values(start: str) -> None:
    method = lookup("B4")
    run = simulate(mechanism(load("slider_crank")), method, H, 0.01, (0.0, 0.0), start=start)  # type: ignore[arg-type]
    first = {"rk4": 4, "ramp": 1, "euler": 1}[start] * (steps(method) - 1)
    assert run.evaluations == first + (10 - (steps(method) - 1)) * evaluations(method)
    assert len(run.t) == 11


def test_a_low_order_start_spoils_adams_bashforth() -> None:
    moving, errors = mechanism(load("slider_crank")), {}
    starts: tuple[Start, ...] = ("rk4", "euler")
    for start in starts:
        run = simulate(moving, lookup("AB4"), H, 1.0, (0.0, 0.0), start=start)
        errors[start] = np.abs(observe(moving, run.t, run.q, run.v, 0.0, 0.0).c[-1, 0])
    assert errors["euler"] > 100 * errors["rk4"]
