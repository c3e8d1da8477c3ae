"""MuJoCo's step confirms the maps: |z| of what its equalities hold is that of Baumgarte's point, under each integrator.

    c'' = -d (b c' + k d c),   b = 2 / (dmax tc),   k = 1 / (dmax tc zeta)^2      (solref = tc, zeta)

so that with r = d / dmax alpha_hat = r 2h / tc and beta_hat = (r h / (tc zeta))^2. That is so where MuJoCo's estimate
of masses is exact, as here. Euler and the two implicit integrators are symplectic Euler for constraints.
"""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from bezstab.engines.engine_list import ENGINES
from bezstab.methods.registry import lookup
from bezstab.rationals import exact
from bezstab.stability.closed_loop import spectral_radius
from tests.mujoco.models import FLAT, INTEGRATORS, UNSAFE, WEIGHTLESS, mjcf
from tests.reference.mujoco_steps import grown, step_moduli

mujoco: Any = pytest.importorskip("mujoco")

H = 0.004
SLIDE = f'<body><joint name="x" type="slide" axis="0 0 1"/><geom size=".1" mass="2" {WEIGHTLESS}/></body>'
FREE = f'<body name="b"><freejoint/><geom size=".1" mass="2" {WEIGHTLESS}/></body>'
TWO = (
    f'<body><joint name="x" type="slide" axis="0 0 1"/><geom size=".1" mass="2" {WEIGHTLESS}/>'
    f'<body><joint name="y" type="slide" axis="1 0 .5"/><geom size=".1" mass="3" {WEIGHTLESS}/></body></body>'
)
TENDON = '<tendon><fixed name="t"><joint joint="x" coef="2"/><joint joint="y" coef="-1"/></fixed></tendon>'
EQUALITIES = {
    "joint": (SLIDE, "", '<joint joint1="x" {}/>'),
    "connect": (FREE, "", '<connect body1="b" anchor="0 0 0" {}/>'),
    "tendon": (TWO, TENDON, '<tendon tendon1="t" {}/>'),
}


def model_of(name: str, integrator: str, solref: tuple[float, float], h: float) -> Any:
    world, more, equality = EQUALITIES[name]
    held = equality.format(f'solref="{solref[0]!r} {solref[1]!r}" {FLAT}')
    text = mjcf(world, f"{more}<equality>{held}</equality>", integrator=integrator, h=h, flags=UNSAFE)
    return mujoco.MjModel.from_xml_string(text)


@pytest.mark.parametrize("integrator", INTEGRATORS)
@pytest.mark.parametrize("name", EQUALITIES)
@pytest.mark.parametrize("solref", [(0.01, 0.7), (-9000.0, -150.0)])
def test_an_equality_is_the_point_of_its_solref(
    name: str, integrator: str, solref: tuple[float, float], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Equal |z| to 1e-6, inside and outside of the limit; a run settles and grows there."""
    version = tuple(map(int, mujoco.__version__.split(".")[:2]))
    if version < (3, 9) and name == "connect" and integrator.startswith("implicit"):
        pytest.skip("this version moves free bodies by the midpoint rule, which is stable further out")
    monkeypatch.chdir(tmp_path)  # MuJoCo writes its warnings into a file of the current directory
    method = lookup("RK4" if integrator == "RK4" else "SYM")
    seen = set()
    for times in (0.5, 1.0, 2.0, 4.0, 8.0):
        model = model_of(name, integrator, solref, times * H)
        alpha_hat, beta_hat = map(float, ENGINES["mujoco"].read(exact(times * H), *map(exact, solref)))
        data = mujoco.MjData(model)
        moduli = step_moduli(mujoco, model, data)
        held = moduli[np.abs(moduli - 1) > 1e-4]  # what nothing holds stays where it is
        assert held[0] == pytest.approx(spectral_radius(method, alpha_hat, beta_hat), rel=1e-6)
        growth = grown(mujoco, model, data, kick=1e-9, steps=100)
        if abs(held[0] - 1) > 0.1:
            assert (not growth < 10) is bool(held[0] > 1)
            seen.add(bool(held[0] > 1))
    assert seen == {True, False}
