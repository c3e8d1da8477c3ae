"""A scene that is run before it is called safe: what the run shows, beside what `simulate` shows."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

import bezstab
from bezstab.mechanism.equations import compiled_mechanism
from bezstab.mechanism.scene_files import load_scene
from bezstab.methods.registry import lookup
from bezstab.questions.scene_runs import SceneRun, scene_run


def run_of(scene: str, name: str, h: str, alpha: float, beta: float, time: float | None = None) -> SceneRun:
    step = Fraction(h)
    point = (2 * Fraction(alpha) * step, (Fraction(beta) * step) ** 2)
    return scene_run(compiled_mechanism(load_scene(scene)), lookup(name), step, point, time)


def test_stages_that_pump_a_pendulum_are_seen_and_their_end_is_foretold() -> None:
    """`simulate` of the same breaks down after 27.84 s; the run that decides ends after 10."""
    found = run_of("pendulum", "RK2", "0.01", 100, 100)
    assert not found.sound
    assert found.duration == pytest.approx(10)
    assert found.failure is None
    assert found.gained > 0.1
    assert not found.by_feedback
    assert found.breakdown == pytest.approx(27.84, rel=0.05)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("scene", "name", "h", "gain"),
    [
        ("pendulum", "SIE", "0.002", 300),
        ("slider_crank_light", "RK2", "0.01", 100),
        ("slider_crank_light", "RK2", "0.005", 200),
        ("slider_crank_300rpm", "SIE", "0.002", 300),
        ("four_bar", "RK2", "0.002", 300),
    ],
)
def test_a_breakdown_is_foretold_beyond_the_run(scene: str, name: str, h: str, gain: float) -> None:
    found = run_of(scene, name, h, gain, gain)
    run = bezstab.simulate(scene, name, h=float(h), duration=60, alpha=gain, beta=gain)
    assert run.failure
    assert found.failure is None
    assert found.breakdown == pytest.approx(float(run.t[-1]), rel=0.05)


def test_no_breakdown_is_foretold_of_a_mechanism_whose_driver_keeps_the_rate() -> None:
    found = run_of("driven_four_bar", "RK2", "0.005", 300, 300, time=2.0)
    assert found.gained > 1
    assert found.breakdown is None


def test_an_explosion_on_the_way_is_seen_though_its_energy_is_lost_again() -> None:
    """At 4.4 s the four-bar has 235 times its largest kinetic energy; after ten it has lost a sixth."""
    found = run_of("four_bar", "SYM", "0.002", 100, 100)
    assert not found.sound
    assert found.gained > 100
    assert found.by_feedback


def test_heun_with_the_same_feedback_is_sound() -> None:
    found = run_of("pendulum", "heun", "0.01", 100, 100)
    assert found.sound
    assert found.decides
    assert abs(found.gained) < 0.01


def test_a_constraint_that_does_not_hold_is_seen() -> None:
    """AB4 diverges at (0.5, 0.101), by 1.0014 a step; the energy of a driven mechanism is its drivers'."""
    found = run_of("driven_slider_crank", "AB4", "0.001", 250, 318)
    assert found.grown
    assert not found.sound


def test_a_run_is_as_long_as_the_file_says_else_ten_seconds_or_ten_thousand_steps() -> None:
    assert run_of("andrews", "RK4", "0.0003", 10, 10).duration == pytest.approx(0.03)
    a_second = compiled_mechanism(replace(load_scene("pendulum"), duration=1.0))
    assert scene_run(a_second, lookup("RK4"), Fraction(1, 100), (Fraction(1), Fraction(1))).duration == pytest.approx(1)
    assert run_of("pendulum", "RK4", "0.01", 10, 10).duration == pytest.approx(10)
    assert run_of("pendulum", "SYM", "1e-6", 10, 10).duration == pytest.approx(0.01)
    assert run_of("pendulum", "SYM@5", "1e-6", 10, 10).duration == pytest.approx(0.05)


def test_a_singular_passage_decides_nothing() -> None:
    found = run_of("slider_crank_equal", "RK4", "0.001", 10, 10)
    assert not found.decides


def test_the_gain_is_that_of_simulate() -> None:
    found = run_of("four_bar", "AB2", "0.002", 30, 30, time=2.0)
    run = bezstab.simulate("four_bar", "AB2", h=0.002, duration=2.0, alpha=30, beta=30)
    kinetic = run.v**2 @ run.mechanism.mass / 2
    assert found.gained == pytest.approx(run.energy_drift[-1] / (kinetic - run.energy_drift).max(), rel=1e-3)


SAMPLED = [
    "andrews",
    "driven_four_bar",
    "driven_slider_crank",
    "four_bar",
    "pendulum",
    "slider_crank_300rpm",
    "slider_crank_light",
]
METHODS = ["SYM", "verlet-half", "SIE", "RK2", "heun", "bs3", "RK4", "dopri5", "AB2", "AB4", "ABM4", "B4"]


@pytest.mark.slow
def test_what_is_called_safe_no_run_of_that_time_contradicts() -> None:
    """Sixty points, critically damped: a run fails, or gains a tenth of its largest kinetic energy, of none."""
    rng, safe = np.random.default_rng(48), 0
    for _ in range(60):
        scene, name = rng.choice(SAMPLED), rng.choice(METHODS)
        h = rng.choice(["1e-5", "5e-5"] if scene == "andrews" else ["0.002", "0.005"])
        gain = int(rng.choice([3, 10, 30, 100, 300])) * (10 if scene == "andrews" else 1)
        answer = bezstab.check(str(name), h=str(h), alpha=gain, beta=gain, scene=str(scene))
        if not answer.safe:
            continue
        safe += 1
        assert answer.run
        run = bezstab.simulate(str(scene), str(name), h=float(h), duration=answer.run.duration, alpha=gain, beta=gain)
        kinetic = run.v**2 @ run.mechanism.mass / 2
        assert not run.failure
        assert run.energy_drift.max() < 0.1 * kinetic.max(), (scene, name, h, gain)
    assert safe > 30
