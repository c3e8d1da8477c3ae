"""Each solref as Baumgarte's point: what MuJoCo makes of it, and exact verdicts."""

from typing import Any

import pytest

from bezstab.mujoco.solrefs import Feedback, feedbacks
from tests.mujoco.models import FLAT, UNSAFE, mjcf
from tests.mujoco.test_steps import model_of

mujoco: Any = pytest.importorskip("mujoco")

H = 0.004
SLIDE = '<body><joint name="x" type="slide" {}/><geom size=".1" mass="2" contype="0" conaffinity="0"/></body>'


def found(joint: str = "", more: str = "", flags: str = "", *, deep: bool = False) -> list[Feedback]:
    return list(feedbacks(mujoco, model_of(mjcf(SLIDE.format(joint), more, h=H, flags=flags)), deep=deep))


def held(solref: str, solimp: str = FLAT) -> str:
    return f'<equality><joint joint1="x" solref="{solref}" {solimp}/></equality>'


@pytest.mark.parametrize(
    ("solref", "flags", "point", "notes"),
    [
        ("0.02 1", "", (0.4 / 0.9 * 0.9, 0.04), ""),
        ("0.002 1", "", (1, 0.25), "refsafe raises 0.002 s to 2h"),
        ("0.002 1", UNSAFE, (4, 4), 'write solref="0.008 1"'),
        ("0.02 -1", "", (0.4, 0.04), "the signs differ: MuJoCo takes 0.02 1"),
        ("-9000 -150", "", (0.6, 0.144), ""),
    ],
)
def test_a_setting_is_its_point(solref: str, flags: str, point: tuple[float, float], notes: str) -> None:
    (row,) = found(more=held(solref), flags=flags)
    assert (row.alpha_hat, row.beta_hat) == pytest.approx(point)
    assert row.notes == notes
    assert row.unsafe is (2 * point[0] + point[1] >= 4)


def test_kinds_with_the_same_setting_are_one_row_and_what_is_switched_off_is_none() -> None:
    limited = 'limited="true" range="-1 1" frictionloss="1"'
    default = held("0.02 1", "")
    kinds = {each.kinds: each.count for each in found(limited, default)}
    assert kinds == {"equality, joint limit": 2, "joint friction": 1}
    assert [each.kinds for each in found(limited, default, 'limit="disable" frictionloss="disable"')] == ["equality"]
    assert not found(limited, default, 'constraint="disable"')


def test_past_its_width_a_setting_is_judged_if_asked() -> None:
    """Past solimp's width r = 1: b = 2.2 at a = 1 is outside, 0.947 of it inside."""
    setting = held(f"{-2.2 / H**2!r} {-1.0 / H!r}", "")
    (near,) = found(more=setting)
    assert not near.unsafe
    near, far = found(more=setting, deep=True)
    assert (far.alpha_hat, far.beta_hat) == pytest.approx((1, 2.2))
    assert (near.unsafe, far.unsafe) == (False, True)


def test_friction_has_a_velocity_alone() -> None:
    (row,) = found('frictionloss="1" solreffriction="0.02 1"')
    assert row.beta_hat == 0
    assert row.z_abs == pytest.approx(1 - float(row.alpha_hat or 0))
    assert row.verdict == "converges"
