"""Motors with a controller outside the model: what lint says of them is what MuJoCo's own runs do."""

from fractions import Fraction
from math import ceil
from typing import Any

import numpy as np
import pytest

from bezstab.errors import InputError
from bezstab.evidence import MotorGains, linted_model, model_data
from bezstab.evidence.mujoco_lint import Linted
from bezstab.stability import Timing

mujoco: Any = pytest.importorskip("mujoco")

H = 0.002
ARM = """<mujoco><option timestep="{h!r}" integrator="{integrator}" gravity="0 0 0"/><compiler angle="radian"/>
<worldbody><body><joint name="hip" axis="0 1 0" damping="{damping}"/>
  <geom type="capsule" fromto="0 0 0 .3 0 0" size=".03" contype="0" conaffinity="0"/>
  <body pos=".3 0 0"><joint name="knee" axis="0 1 0"/>
    <geom type="capsule" fromto="0 0 0 .3 0 0" size=".02" contype="0" conaffinity="0"/></body></body></worldbody>
<actuator><motor name="hip_motor" joint="hip" gear="2"/><motor name="knee_motor" joint="knee" {delay}/></actuator>
</mujoco>"""


def arm(integrator: str = "Euler", damping: float = 0.0, delay: str = "") -> Any:
    return mujoco.MjModel.from_xml_string(ARM.format(integrator=integrator, h=H, damping=damping, delay=delay))


def lint(model: Any, *gains: tuple[str, str, str], timing: Timing = Timing()) -> list[Linted]:  # noqa: B008
    typed = [MotorGains(pattern, Fraction(kp), Fraction(kd)) for pattern, kp, kd in gains]
    return list(linted_model(model_data(mujoco, model), typed, timing))


def modulus(model: Any, kp: list[float], kd: list[float], timing: Timing) -> float:
    """Return |z| a step of MuJoCo's own steps under a controller written as one would write it, by differences.

    From one computation of the controls to the next: of positions, velocities and the controls still to be applied.
    """
    data = mujoco.MjData(model)
    late, every = int(timing.late), timing.every
    pending = ceil(late / every)

    def advanced(state: Any) -> Any:
        mujoco.mj_resetData(model, data)
        data.qpos[:], data.qvel[:] = state[: model.nv], state[model.nv : 2 * model.nv]
        mujoco.mj_forward(model, data)
        now = -np.array(kp) * data.actuator_length - np.array(kd) * data.actuator_velocity
        computed = [now, *state[2 * model.nv :].reshape(pending, model.nu)]  # latest first
        for step in range(every):
            age = max(0, ceil((late - step) / every))  # how many computations ago
            data.ctrl[:] = computed[age]
            mujoco.mj_step(model, data)
        return np.concatenate([data.qpos, data.qvel, *computed[:pending]])

    size, small = 2 * model.nv + pending * model.nu, 1e-6
    changes = [advanced(small * unit) - advanced(-small * unit) for unit in np.eye(size)]
    z = np.linalg.eigvals(np.array(changes).T / (2 * small))
    return float(np.abs(z[np.abs(z - 1) > 1e-4]).max() ** (1 / every))


@pytest.mark.parametrize("integrator", ["Euler", "RK4", "implicitfast"])
@pytest.mark.parametrize("timing", [Timing(), Timing(4), Timing(1, Fraction(1)), Timing(4, Fraction(2))], ids=str)
@pytest.mark.slow
def test_the_last_row_is_mujocos_own_step(integrator: str, timing: Timing) -> None:
    model = arm(integrator, damping=0.02)
    *_, together = lint(model, (".*", "10", "0.05"), timing=timing)
    assert together.kind == "together"
    found = modulus(model, [10, 10], [0.05, 0.05], timing)
    assert together.z_abs == pytest.approx(found, abs=1e-6)  # differences keep nine digits


def test_a_motor_alone_is_a_held_drive_on_its_own_inertia() -> None:
    """The other joint is free; inside and outside of the limit of its rate. Without kp the velocity is judged."""
    timing = Timing(10, Fraction(3))
    for kp, kd, verdict in ((2, "0.1", "converges"), (2, "0.01", "diverges"), (0, "0.01", "converges")):
        row, *_ = lint(arm(), ("hip.*", str(kp), kd), timing=timing)
        assert (row.kind, row.verdict) == ("motor", verdict)
        assert row.z_abs == pytest.approx(modulus(arm(), [kp, 0], [float(kd), 0], timing), abs=1e-6)


def test_a_motor_without_gains_is_named_and_not_judged() -> None:
    rows = lint(arm())
    for row, name in zip(rows, ("hip_motor", "knee_motor"), strict=True):
        assert (row.element, row.kind, row.verdict, row.unsafe) == (f"actuator '{name}'", "motor", None, False)
        assert f"--pd '{name}=KP,KD' judges it" in row.advice


def test_an_actuator_that_moves_nothing_is_named_and_not_judged() -> None:
    """Alone it has no inertia at all."""
    model = mujoco.MjModel.from_xml_string(
        ARM.format(integrator="Euler", h=H, damping=0, delay="").replace('gear="2"', 'gear="0"')
    )
    *_, still = lint(model, ("knee.*", "10", "0.05"))
    assert (still.element, still.verdict) == ("actuator 'hip_motor'", None)
    assert still.advice == "not judged: it moves nothing at qpos0"


def test_gains_are_for_the_motors_whose_whole_name_matches_and_the_last_decide() -> None:
    """Gains are the actuator's own, its gear is in the inertia; MuJoCo's own delay adds to what is late."""
    delayed = hasattr(mujoco.MjModel, "actuator_delay")
    model = arm(delay=f'delay="{3 * H}" nsample="10"' if delayed else "")
    hip, knee, _ = lint(model, (".*", "10", "0.2"), ("knee.*", "1", "0.02"), timing=Timing(1, Fraction(1)))
    assert hip.setting == "kp 10, kd 0.2, every 1, late 1"
    assert knee.setting == f"kp 1, kd 0.02, every 1, late {4 if delayed else 1}"


def test_gains_for_no_motor_are_refused_with_the_names_there_are() -> None:
    with pytest.raises(InputError, match="--pd elbow: matches no motor; the model's motors: hip_motor, knee_motor"):
        lint(arm(), ("elbow", "1", "1"))
    with pytest.raises(InputError, match="no regular expression"):
        MotorGains("hip[", Fraction(1), Fraction(1))
