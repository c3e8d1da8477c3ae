"""Every engine of the list: its steps, its words there and back, its defaults, and who witnessed it."""

import math
import re
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bezstab.engines.conversions import Engine
from bezstab.engines.engine_list import ENGINES, WITNESSES, engine_and_values
from bezstab.errors import InputError
from bezstab.methods.registry import lookup
from bezstab.stability.closed_loop import poles, spectral_radius
from tests.reference.engine_steps import STEPS, matrix

LIKELY = {  # ranges of what people set, by unit: wide, but within what a line of nine digits keeps
    "s": (1e-3, 1.0),
    "1/s": (0.1, 300.0),
    "1/s^2": (1.0, 1e4),
    "Hz": (0.5, 300.0),
    "N/m": (10.0, 1e5),
    "N s/m": (0.1, 100.0),
    "m/N": (1e-7, 1e-2),
    "kg": (0.1, 10.0),
    "1/kg": (0.1, 10.0),
    "s/kg": (1e-6, 1e-2),
    "- (per second)": (1e-3, 0.9),
    "-": (0.05, 1.5),
}
H = st.floats(1 / 1000, 1 / 30)


def values(text: str) -> tuple[Fraction, ...]:
    """Return the numbers in a line to paste."""
    return tuple(Fraction(number) for number in re.findall(r"(?<![\w.])-?\d+(?:\.\d+)?(?:e[-+]?\d+)?", text))


@st.composite
def likely_values(draw: st.DrawFn, engine: Engine) -> tuple[Fraction, ...]:
    """Draw values that an engine takes: those needed, and sometimes those that may follow."""
    if engine.name == "mujoco":
        direct = draw(st.booleans())
        solref = (
            (-draw(st.floats(1, 1e5)), -draw(st.floats(1, 1e3)))
            if direct
            else (draw(st.floats(1e-3, 0.1)), draw(st.floats(0.1, 2)))
        )
        numbers = [*solref, draw(st.floats(0.5, 0.99)), draw(st.floats(0.5, 0.99))][: draw(st.sampled_from([2, 4]))]
    elif engine.name in ("jolt", "pbd", "matter.js"):
        numbers = [draw(st.floats(0.05, 1.0)), draw(st.integers(1, 4))][: draw(st.integers(1, 2))]
    else:
        count = len(engine.parameters) + draw(st.sampled_from([0, len(engine.optional)]))
        numbers = [draw(st.floats(*LIKELY[unit])) for unit in list(engine.units.values())[:count]]
    return tuple(map(Fraction, numbers))


def integrator(engine: Engine) -> str:
    """Return the method whose steps the reference takes for an engine: its own, else symplectic Euler."""
    return engine.method if engine.method and engine.level != "acceleration" else "SYM"


@pytest.mark.parametrize("name", ENGINES)
@settings(max_examples=12, deadline=None)
@given(st.data())
def test_an_engines_step_has_the_poles_of_its_point(name: str, data: st.DataObject) -> None:
    engine, h = ENGINES[name], Fraction(data.draw(H))
    numbers = data.draw(likely_values(engine))
    alpha_hat, beta_hat = map(float, engine.applied(numbers, h).point)
    theirs = np.poly(matrix(STEPS[name], float(h), *map(float, numbers)))
    of_point = poles(lookup(integrator(engine)), alpha_hat, beta_hat)
    if len(theirs) > len(of_point) + 1:  # matter.js has a third pole: the largest of all is that of its point
        assert np.polyval(theirs, of_point[0]) == pytest.approx(0, abs=1e-9)
        assert np.abs(of_point).max() == pytest.approx(np.abs(np.roots(theirs)).max(), rel=1e-6, abs=1e-7)
        return
    ours = np.poly(of_point).real
    assert ours == pytest.approx(theirs, rel=1e-7, abs=1e-7 * max(1, np.abs(theirs).max()))  # a double pole: half


@pytest.mark.parametrize("name", ENGINES)
@settings(max_examples=12, deadline=None)
@given(st.data())
def test_a_point_written_in_an_engines_words_is_read_back(name: str, data: st.DataObject) -> None:
    engine, h = ENGINES[name], Fraction(data.draw(H))
    point = engine.applied(data.draw(likely_values(engine)), h).point
    line = engine.setting(point, h)
    back = engine.applied(values(line) if "inf" not in line and engine.units else (), h)
    assert not back.notes
    assert not back.also
    assert tuple(map(float, back.point)) == pytest.approx(tuple(map(float, point)), rel=1e-6)  # nine digits


DEFAULTS: dict[str, tuple[str, Fraction, float]] = {
    "box2d": ("Box2D joints: 60 Hz, 2", Fraction(1, 240), 0.746948),  # measured on a compiled Box2D
    "rapier": ("Rapier joints: 1e6 Hz, 1", Fraction(1, 240), 1 - 0.99992),
    "jolt": ("Jolt: 0.2, 2 position steps", Fraction(1, 60), 0.64),  # measured
    "brax-positional": ("Brax positional: 0.5", Fraction(1, 100), math.sqrt(0.5)),
    "bullet": ("bullet: ERP = 0.2", Fraction(1, 240), 0.8),
    "chipmunk": ("Chipmunk: errorBias = 0.9^60", Fraction(1, 60), 0.9),
    "drake-sap": ("Drake SAP: near rigid", Fraction(1, 100), 0.49987),
    "mujoco": ("MuJoCo: timeconst = 2h", Fraction(1, 500), 0.75),
    "pbd": ("PBD: stiffness 1", Fraction(1, 60), 0.0),
}
"""What an engine does unless told otherwise: its setting, a step (s), and |z_p|, known from its source or a run."""


@pytest.mark.parametrize("name", DEFAULTS)
def test_the_pole_of_an_engines_defaults_is_the_known_one(name: str) -> None:
    (label, h, z_abs), engine = DEFAULTS[name], ENGINES[name]
    assert engine.method
    points = [engine.marked(h)[label]]
    if engine.parameters and name not in ("mujoco", "pbd"):  # whose mark is another setting
        _, values = engine_and_values({"chipmunk": "pymunk", "bullet": "PyBullet"}.get(name, name))
        points.append(engine.applied(values, h).point)
    for point in points:
        assert spectral_radius(lookup(engine.method), *map(float, point)) == pytest.approx(z_abs, abs=5e-6)


def test_mujocos_defaults_are_its_solref_and_solimp() -> None:
    engine, values = engine_and_values("mujoco")
    typed = engine_and_values("mujoco=0.02,1")
    assert typed[0] == engine
    assert engine.applied(values, Fraction(1, 500)) == engine.applied(typed[1], Fraction(1, 500))


def test_who_is_said_to_be_witnessed_has_a_test_that_exists() -> None:
    root = Path(__file__).parents[2]
    assert set(WITNESSES) <= set(ENGINES)
    for witness in WITNESSES.values():
        path, _, test = witness.partition("::")
        text = (root / path).read_text(encoding="utf-8")
        assert re.search(rf"^def {test}\(", text, re.MULTILINE)
        assert "importorskip(" in text or "pytest.skip(" in text


@pytest.mark.parametrize("name", ENGINES)
@settings(max_examples=12, deadline=None)
@given(st.floats(-1e300, 1e300), st.floats(-1e300, 1e300), st.sampled_from(["1e-100", "0.01", "1e100"]))
def test_every_point_has_a_setting_or_is_refused(name: str, a: float, b: float, step: str) -> None:
    try:
        setting = ENGINES[name].setting((Fraction(a), Fraction(b)), Fraction(step))
    except InputError:
        return
    assert min(a, b) >= 0
    assert all(abs(float(value)) < math.inf for value in values(setting))
