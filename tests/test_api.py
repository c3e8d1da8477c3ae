import doctest
import inspect
import json
import re
import subprocess
import sys
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest

import bezstab
from bezstab.errors import InputError
from bezstab.lazy import imported_for_types
from bezstab.show import answer_row, render
from tests.cli.running import rows, run

PAGE = Path(__file__).parent.parent / "bezstab" / "README.md"
FUNCTIONS = sorted(set(bezstab.__all__) - {"plot"})
PLOTS = sorted(
    name for name, value in vars(bezstab.plot).items() if inspect.isfunction(value) and name in bezstab.plot.__all__
)
UNITS = ("dimensionless", "1/s", "SI", " s)", "(s)", "rad")


def test_the_page_of_examples_is_true() -> None:
    found = doctest.testfile(str(PAGE), module_relative=False, encoding="utf-8")
    assert found.attempted > 15
    assert found.failed == 0


def test_a_public_name_says_what_it_returns_in_which_unit_and_what_it_raises() -> None:
    for name in FUNCTIONS:
        function = getattr(bezstab, name)
        text = inspect.getdoc(function) or ""
        first, _, rest = text.partition("\n")
        assert (first[:7], first[-1:]) == ("Return ", "."), name  # in a list of names the first line stands alone
        assert "Return" in rest, name
        assert any(unit in text for unit in UNITS), name
        assert "Error" in text, name
        signature = inspect.signature(function)
        assert signature.return_annotation is not inspect.Signature.empty, name
        for parameter in signature.parameters.values():
            assert parameter.annotation is not inspect.Parameter.empty, name
            assert len(str(parameter)) < 60, name  # an alias such as ArrayLike, not the page of types it stands for


def test_a_plot_takes_an_axes_and_says_what_it_draws() -> None:
    for name in PLOTS:
        function = getattr(bezstab.plot, name)
        assert "axes" in inspect.signature(function).parameters, name
        assert (inspect.getdoc(function) or "").startswith(("Draw", "Cross", "Ring")), name


def test_what_is_public_is_listed_once_and_found() -> None:
    assert sorted(bezstab.__all__) == dir(bezstab)
    assert sorted(imported_for_types("bezstab")) == sorted(bezstab.__all__)
    with pytest.raises(AttributeError, match="no attribute 'pole'"):
        _ = bezstab.pole


@pytest.mark.slow
def test_importing_everything_by_star_works() -> None:
    code = "from bezstab import *; print(method('B4').name)"
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout == "B4\n"


def test_both_ways_to_give_a_point_agree() -> None:
    direct = bezstab.poles("B3", alpha_hat=0.2, beta_hat=0.01)
    assert bezstab.poles("B3", alpha=50, beta=50, h=0.002) == pytest.approx(direct, rel=1e-14)  # a few roundings
    assert bezstab.verdict("SYM", alpha="250", beta=Fraction(250), h=0.002) == "converges"


@pytest.mark.parametrize(
    "point",
    [
        {"alpha_hat": 1.0},
        {"alpha_hat": 1.0, "beta": 1.0},
        {"alpha": 1.0, "beta": 1.0},
        {"alpha_hat": 1.0, "beta_hat": 1.0, "alpha": 1.0, "beta": 1.0, "h": 0.1},
        {},
    ],
)
def test_a_point_is_never_guessed(point: dict[str, Any]) -> None:
    for function in (bezstab.poles, bezstab.dominant_pole, bezstab.spectral_radius, bezstab.verdict, bezstab.check):
        with pytest.raises(InputError, match=r"h=? in s"):
            function("B4", **point)


def test_a_motion_is_the_same_in_both_ways_and_the_command_line_has_the_same_cost() -> None:
    in_seconds = bezstab.feedback_cost("RK4", alpha=400, beta=500, h=0.002, omega=5)
    assert in_seconds == bezstab.feedback_cost("RK4", alpha_hat="1.6", beta_hat=1, omega_h="1/100")
    assert in_seconds == bezstab.feedback_cost("RK4", alpha_hat=1.6, beta_hat=1)  # as usual
    asked = ("check", "--method", "RK4", "--alpha", "400", "--beta", "500", "--h", "0.002", "--physical")
    given = rows(*asked, "--omega", "5")[0]
    for name in ("omega_h", "forced_error", "total_error", "velocity_error", "order_left", "times_least"):
        assert given[name] == getattr(in_seconds, name)


def test_a_choice_is_accurate_unless_told_otherwise_and_takes_the_motion_in_both_ways() -> None:
    chosen = bezstab.choose("RK4", h=0.002, omega=10)
    assert chosen.goal == "accurate"
    assert chosen == bezstab.choose("RK4", goal="accurate", omega_h=0.02)
    of_longest = bezstab.choose("RK4", h=0.001, h_max=0.002, omega=10)
    assert of_longest.alpha_hat == pytest.approx(chosen.alpha_hat / 2)
    assert bezstab.choose("RK4").alpha_hat == pytest.approx(chosen.alpha_hat / 2, rel=1e-3)  # omega h = 0.01


@pytest.mark.parametrize(
    ("typed", "asked"),
    [
        ("--engine mujoco=0.0001,1 --h 0.002", {"engine": "mujoco=0.0001,1", "h": 0.002}),
        ("--pd 1000,80,0.1 --h 1/240 --method stable-pd", {"pd": (1000, 80, 0.1), "h": "1/240", "method": "stable-pd"}),
        (
            "--method SYM --alpha 2 --beta 100 --physical --h-min 0.00917 --h-max 1/60",
            {"method": "SYM", "alpha": 2, "beta": 100, "h_min": 0.00917, "h_max": "1/60"},
        ),
        pytest.param(
            "--method SYM --alpha 1 --beta 0.5 --h 0.01 --scene driven_four_bar --speed 2",
            {"method": "SYM", "alpha_hat": 1, "beta_hat": 0.5, "h": 0.01, "scene": "driven_four_bar", "speed": 2},
            marks=pytest.mark.slow,
        ),
    ],
)
def test_check_answers_what_the_command_line_answers(typed: str, asked: dict[str, Any]) -> None:
    printed = json.loads(run("check", *typed.split(), "--format", "json").stdout)
    answer = bezstab.check(**asked)
    for row, found in ((printed[0], answer), (printed[-1], answer.instead)):
        assert row == json.loads(render([answer_row(found)], [], "json"))[0]


@pytest.mark.parametrize(
    ("typed", "asked"),
    [
        ("--engine bullet --h 1/240", {"engine": "bullet", "h": "1/240"}),
        ("--pd 1000,80,0.1 --method SYM --h 1/240", {"pd": (1000, 80, 0.1), "method": "SYM", "h": "1/240"}),
        (
            "--method SYM --h 0.01 --goal fastest --h-min 0.005",
            {"method": "SYM", "h": 0.01, "goal": "fastest", "h_min": 0.005},
        ),
    ],
)
def test_choose_answers_what_the_command_line_answers(typed: str, asked: dict[str, Any]) -> None:
    (printed,) = json.loads(run("choose", *typed.split(), "--format", "json").stdout)
    assert printed == json.loads(render([answer_row(bezstab.choose(**asked))], [], "json"))[0]


def test_units_go_there_and_back() -> None:
    alpha, beta = np.array([10.0, 50.0]), np.array([20.0, 0.0])
    there = bezstab.to_dimensionless(alpha, beta, 0.002)
    back = bezstab.from_dimensionless(*there, 0.002)
    assert back[0] == pytest.approx(alpha, rel=1e-15)  # one rounding each way
    assert back[1] == pytest.approx(beta, rel=1e-15)


def test_a_region_knows_what_it_contains() -> None:
    stable = bezstab.region("B4")
    a, b = np.meshgrid(np.linspace(-0.2, 1.8, 41), np.linspace(-0.1, 0.9, 31))
    assert (stable.contains(a, b) == (bezstab.spectral_radius("B4", alpha_hat=a, beta_hat=b) < 1)).all()


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        (lambda: bezstab.region("B4", level=2.0), "level 2: expected above 0 and at most 1"),
        (lambda: bezstab.region("B4", level=float("nan")), "level nan: expected above 0 and at most 1"),
        (
            lambda: bezstab.choose("B4", goal=cast(Any, "quick")),
            "goal 'quick': expected accurate, robust, fastest, critical, gentle",
        ),
        (lambda: bezstab.choose("B4", goal="gentle"), "goal gentle needs settle: the time in s"),
        (lambda: bezstab.choose("B4", settle=1), "settle, engine and pd need h: the step in s"),
        (lambda: bezstab.choose("B4", omega=5), "omega needs h: the step in s"),
        (lambda: bezstab.choose("B4", omega=500, h=0.01), "omega h = 5 rad a step: expected 1e-06 to 1"),
        (lambda: bezstab.choose("B4", omega=0, h=0.01), "omega h = 0 rad a step: expected 1e-06 to 1"),
        (
            lambda: bezstab.feedback_cost("B4", alpha_hat=0.5, beta_hat=0.1, omega=5, omega_h=0.1),
            "as omega= in 1/s with h= in s, or as omega_h= in rad a step, not as both",
        ),
        (lambda: bezstab.feedback_cost("B4", alpha=1, beta=1, omega_h=0.1), "alpha and beta in 1/s need the step h"),
        (lambda: bezstab.choose("B4", spread=-0.5), "spread -0.5: expected a share from 0 to 1"),
        (lambda: bezstab.choose("B4", h=-1), "h = -1 s: expected 1e-100 to"),
        (lambda: bezstab.choose("B4", goal="gentle", h=0.001, settle=-1), "settle -1 s: expected a positive time"),
        (lambda: bezstab.check("B4", alpha_hat=0.5, beta_hat=0.1, spread=1), "spread 1: expected a share from 0 to 1"),
        (lambda: bezstab.verdict("B4", alpha_hat=float("nan"), beta_hat=0.1), "nan is not a finite number"),
        (lambda: bezstab.poles("B4", alpha=1.0, beta=1.0, h=0.0), "h = 0 s: expected 1e-100 to"),
        (lambda: bezstab.verify("pendulum", "B4", h=-1.0, alpha_hat=0.5, beta_hat=0.1), "h = -1 s: expected"),
    ],
)
def test_a_mistake_is_refused_by_name_and_value(wrong: Callable[[], object], message: str) -> None:
    with pytest.raises(InputError, match=re.escape(message)):
        wrong()


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"h": 0.0}, "h = 0 s: expected 1e-100 to"),
        ({"duration": 1e-4}, "duration 0.0001 s: expected at least one step of 0.001 s"),
        ({"h": 1e-12, "duration": 1e6}, "duration 1e+06 s: expected at most 1e+08 steps of 1e-12 s"),
        ({"duration": float("inf")}, "duration inf s: expected at least one step"),
        ({"start": "heun"}, "start 'heun': expected rk4, ramp, euler"),
    ],
)
def test_a_run_that_cannot_be_is_refused_by_name_and_value(wrong: dict[str, Any], message: str) -> None:
    run: dict[str, Any] = {"h": 0.001, "duration": 0.1, "alpha_hat": 0.5, "beta_hat": 0.1}
    with pytest.raises(InputError, match=re.escape(message)):
        bezstab.simulate("pendulum", "AB3", **{**run, **wrong})


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        (
            lambda: bezstab.verdict("B4", alpha_hat=cast(Any, [0.5, 1]), beta_hat=0.1),
            "alpha_hat = [0.5, 1]: expected one",
        ),
        (lambda: bezstab.check("B4", alpha=1, beta=cast(Any, 1j), h=0.1), "beta = 1j: expected one real number"),
        (lambda: bezstab.verdict("B4", alpha_hat="0.5", beta_hat=True), "beta_hat = True: expected one real number"),
        (lambda: bezstab.verdict("B4", alpha_hat=10**400, beta_hat=1), "alpha_hat is outside the range of float64"),
        (lambda: bezstab.region(cast(Any, ["B4", "AB4"])), "method ['B4', 'AB4']: expected one name"),
        (
            lambda: bezstab.simulate("pendulum", "B4", h=0.1, duration=1, alpha_hat=cast(Any, [0.5]), beta_hat=0.1),
            "alpha_hat = [0.5]: expected one real number",
        ),
        (lambda: bezstab.scene(cast(Any, ["pendulum"])), "scene ['pendulum']: expected one name"),
        (
            lambda: bezstab.from_dimensionless(cast(Any, [1, 2]), cast(Any, [1, 2]), 0.1),
            "alpha_hat = [1, 2]: expected a",
        ),
        (lambda: bezstab.to_dimensionless(1.0, 2.0, cast(Any, [0.1])), "h = [0.1]: expected one number"),
        (lambda: bezstab.plot.region(cast(Any, "B4")), "'B4': expected a Region, as bezstab.region makes it"),
        (lambda: bezstab.plot.history(cast(Any, 3)), "3: expected a Simulation, as bezstab.simulate makes it"),
        (lambda: bezstab.poles("B4", alpha_hat=1j, beta_hat=0.1), "alpha_hat = 1j: expected real numbers"),
        (lambda: bezstab.poles("B4", alpha_hat=[1, 2], beta_hat=[1, 2, 3]), "shapes (2,) and (3,)"),
        (lambda: bezstab.region("B4").contains(np.ma.masked_array([1.0]), 0.1), "alpha_hat is a masked array"),
        (lambda: bezstab.probe(np.ones(50) + 1j), "c = array"),
        (lambda: bezstab.probe([1, 2, 3], methods="B4"), "methods = 'B4': expected a list of methods"),
        (lambda: bezstab.choose("B4", spread=cast(Any, [0.1])), "spread = [0.1]: expected one real number"),
    ],
)
def test_lists_arrays_and_wrong_types_are_refused_in_the_callers_words(
    wrong: Callable[[], object], message: str
) -> None:
    with pytest.raises(InputError, match=re.escape(message)) as caught:
        wrong()
    assert len(str(caught.value).splitlines()) == 1


def test_the_public_plots_are_those_that_dir_shows() -> None:
    assert dir(bezstab.plot) == sorted(bezstab.plot.__all__)


@pytest.mark.slow
def test_results_have_short_names_for_themselves() -> None:
    run = bezstab.simulate("pendulum", "SYM", alpha_hat=1.0, beta_hat=0.2, h=0.001, duration=0.1)
    error = np.round(1e-4 * (bezstab.dominant_pole("B4", alpha_hat=0.5, beta_hat=0.1) ** np.arange(150)).real, 13)
    found = bezstab.probe(error, differenced=True, methods=["B4"], alpha_hat=0.5, beta_hat=0.1)
    placed = bezstab.probe(error, differenced=True, methods=["B4"])
    (measured,) = bezstab.verify("pendulum", "SYM", alpha_hat=1.0, beta_hat=0.2, h=0.001)
    for result in (
        found,
        found.likenesses[0],
        placed.points[0],
        bezstab.probe(error[:3]),
        measured,
        bezstab.region("B4"),
        bezstab.best_point("B4"),
        bezstab.check("B4", alpha_hat=0.5, beta_hat=0.1),
        bezstab.check_drive((200, 5, 0.1), h=0.002, every=4, late=1),
        bezstab.feedback_cost("RK4", alpha=400, beta=500, h=0.002, omega=10),
        run,
    ):
        assert repr(result).startswith(f"{type(result).__name__}(")
        assert len(repr(result)) < 160
        assert "array" not in repr(result)


def test_a_held_drive_is_checked_as_on_the_command_line() -> None:
    answer = bezstab.check_drive((200, 5, "0.1"), h=0.002, every=4, late=1, filter_seconds="0.01", method="SYM")
    (row,) = rows(
        *("check", "--pd", "200,5,0.1", "--h", "0.002", "--every", "4", "--late", "1", "--filter", "0.01"),
        *("--method", "SYM"),
    )
    assert (answer.verdict, answer.z_abs, answer.used_up) == (row["verdict"], row["z_abs"], row["held_by"])
    assert answer.limits.late == row["late_max"]
    assert answer.limits.kd == (row["kd_min"], row["kd_max"])
    assert not bezstab.check_drive((200, 0.5, 0.1), h=0.002, every=4).safe
    with pytest.raises(InputError, match="every 0: expected"):
        bezstab.check_drive((200, 5, 0.1), h=0.002, every=0)
