"""The constraint error that a method forces on a moving mechanism: predicted in metres, none fitted, and measured."""

import pytest

from bezstab.evidence.forced_runs import forced_motions
from bezstab.mechanism import compiled_mechanism, load_scene
from bezstab.methods import lookup
from bezstab.stability import choose


@pytest.mark.parametrize(
    "name",
    [
        *("RK4", "B4", "SYM"),
        *(pytest.param(name, marks=pytest.mark.slow) for name in ("dopri5", "AB4", "verlet-half", "bdf2", "hht")),
    ],
)
def test_measured_over_predicted_is_one_on_a_driven_mechanism(name: str) -> None:
    method = lookup(name)
    robust = choose(method, "robust", margins=False)
    points = [(f * robust.alpha_hat, f * f * robust.beta_hat) for f in (0.2, 0.5, 1.0)]
    for found in forced_motions(compiled_mechanism(load_scene("driven_four_bar")), method, 0.003, points, 1.0):
        assert found.failure is None
        assert found.quotient == pytest.approx(1, abs=0.05)  # beyond the leading order, and the turning of normals
