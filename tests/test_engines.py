import math
import re
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bezstab.engines import ENGINES
from bezstab.errors import InputError
from bezstab.methods import lookup
from bezstab.stability import poles, spectral_radius


def values(text: str) -> tuple[Fraction, ...]:
    """Return the numbers in a line to paste."""
    return tuple(Fraction(number) for number in re.findall(r"(?<!\w)-?\d+(?:\.\d+)?(?:e[-+]\d+)?", text))


@pytest.mark.parametrize("name", ENGINES)
@given(st.floats(0.01, 0.9), st.floats(0.01, 1.0), st.floats(1e-4, 0.1))
def test_what_an_engine_is_told_it_reads_back(name: str, a: float, share: float, step: float) -> None:
    engine, h = ENGINES[name], Fraction(step)
    alpha_hat = 1.0 if engine.parameters == ("ERP",) else a
    point = Fraction(alpha_hat), Fraction(share * a)
    back = engine.point(values(engine.write(point, h)), h)
    assert tuple(map(float, back)) == pytest.approx(tuple(map(float, point)), rel=1e-7)  # nine digits, squared


PRESETS = {  # shared facts about engines: spectral radii of preset points
    (2, 2): (2.4142, 1.0, 0, 0.4714, 0.3727, 1.6801, 2.5147, 3.3330),
    (2, 1): (1.6180, 0, 0.5, 0.3333, 0.3750, 1.0, 1.7910, 2.5283),
    (1, 0.25): (0.75, 0.5, 0.625, 0.6042, 0.6068, 0.6404, 0.9239, 1.4373),
    (1, 0.2): (0.8, 0.7236, 0.7618, 0.7583, 0.7585, 0.7659, 1.3041, 1.9231),
    (0.2, 0.01): (0.9270, 0.9, 0.9050, 0.9048, 0.9048, 0.9052, 0.9048, 0.9048),
    (0.01, 2.5e-5): (0.9953, 0.9950, 0.9950, 0.9950, 0.9950, 0.9950, 0.9950, 0.9950),
}


@pytest.mark.parametrize("point", PRESETS)
def test_preset_points(point: tuple[float, float]) -> None:
    names = ("SYM", "RK1", "RK2", "RK3", "RK4", "AB2", "AB3", "AB4")
    assert [spectral_radius(lookup(name), *point) for name in names] == pytest.approx(PRESETS[point], abs=5.1e-5)


def test_rules_of_thumb_are_where_they_are_known_to_be() -> None:
    h = Fraction(2, 1000)
    marks = {label: point(h) for engine in ENGINES.values() for label, point in engine.marks}
    assert marks["MuJoCo: timeconst = 2h"] == (Fraction(1), Fraction(1, 4))
    assert ENGINES["mujoco"].point((2 * h, Fraction(1)), h) == (Fraction(1), Fraction(1, 4))
    assert marks["MuJoCo: solref = 0.02 1"] == (Fraction(1, 5), Fraction(1, 100))
    assert marks["bullet: ERP = 0.2"] == marks["ode: ERP = 0.2"] == (Fraction(1), Fraction(1, 5))
    a, b = map(float, ENGINES["box2d"].point((Fraction(60), Fraction(2)), Fraction(1, 240)))
    assert (a, b) == pytest.approx((0.897, 0.253), abs=5e-4)


@given(st.floats(1, 200), st.floats(0, 10), st.floats(1e-3, 0.05))
def test_box2ds_soft_constraint_is_symplectic_euler_at_its_point(hertz: float, zeta: float, h: float) -> None:
    omega = 2 * math.pi * hertz
    scale = h * omega * (2 * zeta + h * omega)
    bias_rate, mass_scale = omega / (2 * zeta + h * omega), scale / (1 + scale)
    # v' = v - mass_scale (v + bias_rate c), c' = c + h v', as its solver has it for one constraint of unit mass
    kick = np.array([[1, 0], [-mass_scale * bias_rate, 1 - mass_scale]])
    step = np.array([[1, h], [0, 1]]) @ kick
    a, b = map(float, ENGINES["box2d"].point((Fraction(hertz), Fraction(zeta)), Fraction(h)))
    theirs = np.poly(step)
    assert np.poly(poles(lookup("SYM"), a, b)).real == pytest.approx(theirs, abs=1e-9)


@given(st.floats(0.01, 1.99))
def test_an_erp_is_symplectic_euler_at_alpha_hat_one(erp: float) -> None:
    a, b = map(float, ENGINES["bullet"].point((Fraction(erp),), Fraction(1, 60)))
    assert sorted(np.abs(poles(lookup("SYM"), a, b))) == pytest.approx([0, abs(1 - erp)], abs=1e-12)


@pytest.mark.parametrize(
    ("name", "given_values"), [("mujoco", (1, -1)), ("mujoco", (1,)), ("bullet", (1, 2)), ("box2d", ())]
)
def test_values_that_mean_nothing_are_refused(name: str, given_values: tuple[int, ...]) -> None:
    with pytest.raises(InputError, match=f"--engine {name}"):
        ENGINES[name].point(tuple(map(Fraction, given_values)), Fraction(1, 100))


def test_a_point_that_an_engine_cannot_reach_is_refused() -> None:
    for name, point in (("bullet", (Fraction(1, 2), Fraction(1, 2))), ("box2d", (Fraction(1), Fraction(1, 5)))):
        with pytest.raises(InputError, match="α̂"):
            ENGINES[name].setting(point, Fraction(1, 100))


@pytest.mark.parametrize("name", ENGINES)
@given(st.floats(-1e300, 1e300), st.floats(-1e300, 1e300), st.sampled_from(["1e-100", "0.01", "1e100"]))
def test_every_point_has_a_setting_or_is_refused(name: str, a: float, b: float, step: str) -> None:
    try:
        setting = ENGINES[name].setting((Fraction(a), Fraction(b)), Fraction(step))
    except InputError:
        return
    assert min(a, b) >= 0
    assert all(abs(float(value)) < math.inf for value in values(setting))
