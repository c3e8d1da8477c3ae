"""Answers about drives: the number that is nearest to its limit, and gains to write."""

import re
from dataclasses import replace
from fractions import Fraction
from math import atan, log, pi

import pytest

from bezstab.drives.answer import DriveAnswer, drive, gains_for, judge_drive
from bezstab.drives.held_torque import verdict
from bezstab.engines.drives import Drive, Timing
from bezstab.errors import InputError
from bezstab.methods.registry import lookup

H = Fraction("0.002")
INERTIA = Fraction("0.1")
SYM = lookup("SYM")


def explicit(kp: str, kd: str, timing: Timing) -> DriveAnswer:
    return judge_drive(Drive(Fraction(kp), Fraction(kd), INERTIA), H, SYM, timing)


def gains(timing: Timing, **wanted: Fraction) -> Drive:
    return gains_for(INERTIA, H, [SYM], timing, **wanted)


@pytest.mark.parametrize(
    ("kp", "kd", "timing", "used_up"),
    [
        # unstable: what it would be stable without
        ("200", "120", Timing(2), "gains"),  # 2 a = 4.8 is too much even if it is fresh
        ("200", "0.6", Timing(every=4), "rate"),  # held needs a > b (N - 1) / 2, which is 0.012 = a
        ("200", "0.3", Timing(late=Fraction(2)), "delay"),
        ("200", "1.1", Timing(every=4, late=Fraction(2)), "delay"),
        # stable: the number nearest to its end; held for two steps for 2 A + B / 2 < 4 and A > B / 4, A = 2 a, B = 4 b
        ("200", "45", Timing(2), "kd"),  # a = 0.9, where it may be 0.996
        ("200", "0.21", Timing(2), "too little kd"),  # a = 0.0042, where b = 0.008 needs more than 0.004
    ],
)
def test_the_number_that_decides_is_named(kp: str, kd: str, timing: Timing, used_up: str) -> None:
    assert explicit(kp, kd, timing).used_up == used_up


def test_limits_are_in_units_of_the_gains() -> None:
    assert explicit("200", "0.21", Timing(2)).limits.kd == pytest.approx((0.2, 49.8), rel=1e-9)  # N m s/rad
    assert explicit("200", "5", Timing(4)).fresh_z_abs == pytest.approx(0.9**0.5)  # the pair's product is 1 - a


@pytest.mark.parametrize(
    ("timing", "wanted", "omega"),
    [
        (Timing(4, Fraction(1)), {"bandwidth": Fraction(5)}, 10 * pi),
        (Timing(late=Fraction(5, 2)), {"settle": Fraction("0.5")}, 9.233 / 0.5),  # (1 + x) e^-x = 1/1000 at x = 9.233
    ],
)
def test_gains_are_critically_damped_and_safe(timing: Timing, wanted: dict[str, Fraction], omega: float) -> None:
    drive = gains(timing, **wanted)
    assert (drive.kp, drive.kd) == pytest.approx((0.1 * omega**2, 0.2 * omega), rel=5e-3)  # three digits
    assert judge_drive(drive, H, SYM, timing).safe


@pytest.mark.slow
def test_what_cannot_be_reached_is_refused_with_what_can_and_a_margin() -> None:
    timing = Timing(4, Fraction(1))
    with pytest.raises(InputError, match=r"--bandwidth 50 Hz: unstable .* Largest safe bandwidth: (\S+) Hz") as refused:
        gains(timing, bandwidth=Fraction(50))
    reach = str(refused.value).split()[-2]
    drive, more = gains(timing, bandwidth=Fraction(reach)), Fraction(5, 4)
    for stronger in (replace(drive, kp=more * drive.kp), replace(drive, kd=more * drive.kd)):
        assert judge_drive(stronger, H, SYM, timing).safe
    with pytest.raises(InputError):
        gains(timing, bandwidth=Fraction(reach) * Fraction("1.02"))
    with pytest.raises(InputError, match=r"--settle 0\.01 s: unstable .* Shortest safe time: \S+ s"):
        gains(timing, settle=Fraction("0.01"))


@pytest.mark.parametrize(
    ("kp", "kd", "load", "part"),
    [
        (500, 5, 2, "rests 0.229° (of a slider 4 mm) from its target"),  # 2 / 500 rad
        (1000, 0, None, "a spring, and the integrator neither damps nor drives it"),
        (0, 1, None, "nothing holds the position, so the velocity is judged"),
    ],
)
def test_the_sentence_says_what_is_special(kp: int, kd: int, load: int | None, part: str) -> None:
    assert part in drive(kp, kd, 0.1, h=0.001, load=load, method="SYM").sentence


def test_an_undamped_spring_shows_what_the_integrator_adds() -> None:
    """Implicit Euler, 5 Hz at 60 Hz: z = 1 / (1 - i omega h)."""
    omega, h = 2 * pi * 5, 1 / 60
    answer = drive(omega**2, 0, 1, h="1/60", method="implicit-euler")
    exponent = complex(log(1 + (omega * h) ** 2) / 2, atan(omega * h))
    assert answer.damping_ratio == pytest.approx(exponent.real / abs(exponent), rel=1e-9)
    assert f"nothing but the integrator damps: its damping ratio is {answer.damping_ratio:.4g}" in answer.sentence


@pytest.mark.slow
def test_the_largest_integral_gain_is_where_the_verdict_turns() -> None:
    """And with one there is no sag."""
    answer = drive(200, 5, "0.1", ki=1000, h="0.002", load=2)
    assert answer.safe
    assert answer.sag == 0
    assert answer.limits.ki
    for factor, expected in (("0.999", "converges"), ("1.001", "diverges")):
        ki = Fraction(answer.limits.ki[1]) * Fraction(factor)
        assert verdict(Drive(Fraction(200), Fraction(5), INERTIA, ki), H, SYM, Timing()) == expected


@pytest.mark.parametrize(("kp", "kd", "inertia", "h"), [(20, 5, "0.001", "0.002"), (1000, 80, "0.1", "1/240")])
def test_what_is_to_be_changed_is_stable_as_it_is_printed(kp: int, kd: int, inertia: str, h: str) -> None:
    """Explicit: 2 kd h / inertia + kp h^2 / inertia < 4; an armature adds to the inertia."""
    sentence, own, step = drive(kp, kd, inertia, h=h).sentence, Fraction(inertia), Fraction(h)
    lowered = Fraction(re.findall(r"kd lowered to ([\d.]+)", sentence)[0])
    raised, armature = map(Fraction, re.findall(r"inertia raised to ([\d.]+) \(armature ([\d.]+)\)", sentence)[0])
    least, most = (2 * kd * step + kp * step**2) / 4, (4 * own - kp * step**2) / (2 * step)
    for change in (raised / least, (own + armature) / least, most / lowered):
        assert 1 < change < Fraction(101, 100)
