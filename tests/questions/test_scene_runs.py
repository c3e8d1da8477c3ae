"""A scene that is run before it is called safe: what the run shows, beside what `simulate` shows."""

from fractions import Fraction

import pytest

from bezstab.errors import InputError
from bezstab.mechanism import compiled_mechanism, load_scene, simulated
from bezstab.mechanism.scene_files import parse_scene
from bezstab.methods import lookup
from bezstab.questions.scene_runs import SceneRun, run_time, scene_run
from tests.mechanism.test_scenes import pendulum


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
    assert found.culprit == "method"
    assert found.breakdown == pytest.approx(27.84, rel=0.05)


def test_multipliers_that_pump_a_four_bar_are_seen() -> None:
    found = run_of("four_bar", "SYM", "0.001", 50, 50)
    assert not found.sound
    assert found.gained > 10
    assert found.culprit == "multipliers"


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
    rk4 = lookup("RK4")
    assert run_time(compiled_mechanism(load_scene("andrews")), rk4, 1e-5) == 0.03
    assert run_time(compiled_mechanism(load_scene("pendulum")), rk4, 0.01) == 10
    assert run_time(compiled_mechanism(load_scene("pendulum")), rk4, 1e-4) == pytest.approx(1)
    assert run_time(compiled_mechanism(load_scene("pendulum")), lookup("RK4@5"), 1e-4) == pytest.approx(5)


def test_a_singular_passage_decides_nothing() -> None:
    found = run_of("slider_crank_equal", "RK4", "0.001", 10, 10)
    assert found.passages > 0
    assert not found.decides


def test_a_scene_in_which_nothing_moves_is_refused() -> None:
    still = {"position": {"bob.x": 1.0, "bob.y": 0.0}, "velocity": {"bob.y": 0.0}}
    at_rest = parse_scene(pendulum(gravity=[0, 0], initial=still))
    with pytest.raises(InputError, match="nothing moves within"):
        scene_run(compiled_mechanism(at_rest), lookup("RK4"), Fraction(1, 100), (Fraction(1, 5), Fraction(1, 100)), 0.1)


def test_the_gain_is_that_of_simulate() -> None:
    found = run_of("four_bar", "AB2", "0.002", 30, 30, time=2.0)
    run = simulated(
        compiled_mechanism(load_scene("four_bar")),
        lookup("AB2"),
        h=0.002,
        duration=2.0,
        alpha_hat=0.12,
        beta_hat=0.0036,
    )
    kinetic = run.v**2 @ run.mechanism.mass / 2
    assert found.gained == pytest.approx(run.energy_drift[-1] / (kinetic - run.energy_drift).max(), rel=1e-3)
