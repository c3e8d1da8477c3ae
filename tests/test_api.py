import ast
import doctest
import inspect
import json
from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest

import bezstab
from bezstab.drives import columns as drives
from bezstab.errors import InputError
from bezstab.feedback.columns import CHECKED, CHOSEN
from bezstab.show.columns import Column, row_of
from bezstab.show.tables import for_programs
from tests.cli.running import DATA, rows, run

TESTS = Path(__file__).parent


@pytest.mark.parametrize(
    "page", ["../README.md", "../bezstab/README.md", "../bezstab/probes/README.md", "mistakes_in_python.md"]
)
def test_what_a_page_shows_of_python_is_what_python_prints(page: str) -> None:
    found = doctest.testfile(str(TESTS / page), module_relative=False, optionflags=doctest.ELLIPSIS, encoding="utf-8")
    assert (found.attempted > 1, found.failed) == (True, 0)


def test_what_is_public_is_listed_once_and_found() -> None:
    package = ast.parse(Path(bezstab.__file__).read_text("utf-8"))
    typed = [node.name for node in ast.walk(package) if isinstance(node, ast.alias) and node.asname]
    assert dir(bezstab) == sorted(typed)
    assert all(getattr(bezstab, name) for name in bezstab.__all__)
    with pytest.raises(AttributeError, match="no attribute 'rational'"):
        _ = bezstab.rational
    assert sorted(bezstab.plot.__all__) == dir(bezstab.plot)


PUBLIC = [name for name in bezstab.__all__ if inspect.isfunction(getattr(bezstab, name))]


@pytest.mark.parametrize("name", PUBLIC)
def test_help_says_of_every_parameter_what_it_is(name: str) -> None:
    function = getattr(bezstab, name)
    summary, after = (inspect.getdoc(function) or "").split("\n\nParameters\n----------\n")
    parameters, returns = after.split("\n\nReturns\n-------\n")
    named = [
        line.partition(" :")[0].split(", ") for line in parameters.splitlines() if not line.startswith((" ", "**"))
    ]
    assert {each for names in named for each in names} == set(inspect.signature(function).parameters)
    assert summary.endswith(".")
    assert returns


def test_both_ways_to_give_a_point_and_a_motion_agree() -> None:
    direct = bezstab.poles("B3", alpha_hat=0.2, beta_hat=0.01)
    assert bezstab.poles("B3", alpha=50, beta=50, h=0.002) == pytest.approx(direct, rel=1e-14)  # a few roundings
    assert bezstab.verdict("SYM", alpha="250", beta=Fraction(250), h=0.002) == "converges"
    in_seconds = bezstab.feedback_cost("RK4", alpha=400, beta=500, h=0.002, omega=5)
    assert in_seconds == bezstab.feedback_cost("RK4", alpha_hat="1.6", beta_hat=1, omega_h="1/100")
    assert in_seconds == bezstab.feedback_cost("RK4", alpha_hat=1.6, beta_hat=1)  # as usual
    chosen = bezstab.choose("RK4", h=0.002, omega=10)
    assert chosen.point == bezstab.choose("RK4", goal="accurate", omega_h=0.02).point


@pytest.mark.parametrize(
    ("typed", "columns", "asked"),
    [
        ("check --engine mujoco=0.0001,1 --h 0.002", CHECKED, {"engine": "mujoco=0.0001,1", "h": 0.002}),
        (
            "check --method SYM --alpha 1 --beta 0.5 --h 0.01 --scene driven_four_bar --speed 2",
            CHECKED,
            {"method": "SYM", "alpha_hat": 1, "beta_hat": 0.5, "h": 0.01, "scene": "driven_four_bar", "speed": 2},
        ),
        (
            "choose --method SYM --h 0.01 --goal robust --h-max 0.02",
            CHOSEN,
            {"method": "SYM", "h": 0.01, "goal": "robust", "h_max": 0.02},
        ),
        (
            "drive --kp 200 --kd 5 --inertia 0.1 --h 0.002 --every 4 --late 1 --filter 0.01 --method SYM",
            drives.COLUMNS,
            {"kp": 200, "kd": 5, "inertia": "0.1", "h": 0.002, "every": 4, "late": 1, "filter_seconds": "0.01"},
        ),
    ],
)
@pytest.mark.slow
def test_python_answers_what_the_command_line_answers(
    typed: str, columns: Sequence[Column[Any]], asked: dict[str, Any]
) -> None:
    answer = getattr(bezstab, typed.split(maxsplit=1)[0])(**asked)
    assert (
        json.loads(run(typed, "--format json").stdout)[0]
        == json.loads(for_programs([row_of(columns, answer)], "json"))[0]
    )


def test_of_several_answers_the_first_that_is_not_safe_is_returned() -> None:
    """What solimp makes of large errors is a second point of these values."""
    answer = bezstab.check(engine="mujoco=-135000,-920", h=0.002)
    assert answer.goal != "as given"  # which is safe, and comes first
    assert answer.verdict == "diverges"


def test_poles_are_measured_at_each_of_the_points() -> None:
    found = bezstab.verify("pendulum", "SYM", h=0.001, alpha_hat=[0.5, 1.0], beta_hat=[0.1, 0.5])
    assert [(each.alpha_hat, each.beta_hat) for each in found] == [(0.5, 0.1), (1.0, 0.5)]
    for each in found:
        assert each.measured == pytest.approx(each.predicted, abs=1e-3)


def test_a_mujoco_model_is_judged_as_on_the_command_line_from_a_path_or_loaded() -> None:
    mujoco = pytest.importorskip("mujoco")
    path = DATA / "legs.xml"
    typed, *_ = rows("lint", str(path), "--pd hip.*=200,5 --every 4 --late 1")
    for model in (path, mujoco.MjModel.from_xml_path(str(path))):
        linted = bezstab.lint(model, pd={"hip.*": (200, 5)}, every=4, late=1)
        assert (linted.worst.kind, linted.worst.z_abs) == ("decays", typed["z_abs"])
    with pytest.raises(InputError, match=r"^pd knee: matches no motor"):
        bezstab.lint(path, pd={"knee": (1, 1)})
