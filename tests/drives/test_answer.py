"""Answers about drives: the number that is nearest to its limit, and gains to write."""

import re
from fractions import Fraction
from math import atan, inf, log, pi

import pytest

from bezstab.drives.answer import DriveAnswer, drive, gains_for, judge_drive
from bezstab.drives.columns import ways_words
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
        ("200", "120", Timing(2), "gains"),  # 2 a = 4.8 is too much even if it is fresh
        ("200", "0.6", Timing(every=4), "rate"),  # held needs a > b (N - 1) / 2, which is 0.012 = a
        ("200", "0.3", Timing(late=Fraction(2)), "delay"),
        ("200", "1.1", Timing(every=4, late=Fraction(2)), "delay"),
    ],
)
def test_of_an_unstable_drive_what_it_would_be_stable_without_is_used_up(
    kp: str, kd: str, timing: Timing, used_up: str
) -> None:
    answer = explicit(kp, kd, timing)
    assert not answer.safe
    assert answer.used_up == used_up


def test_of_a_stable_drive_the_number_nearest_to_its_end_is_used_up() -> None:
    """Held for two steps it is stable for 2 A + B / 2 < 4 and A > B / 4, with A = 2 a and B = 4 b."""
    assert explicit("200", "45", Timing(2)).used_up == "kd"  # a = 0.9, where it may be 0.996
    weak = explicit("200", "0.21", Timing(2))  # a = 0.0042, where b = 0.008 needs more than 0.004
    assert weak.used_up == "too little kd"
    assert weak.limits.kd == pytest.approx((0.2, 49.8), rel=1e-9)  # N m s/rad
    assert explicit("200", "5", Timing(4)).fresh_z_abs == pytest.approx(0.9**0.5)  # the pair's product is 1 - a


@pytest.mark.parametrize("timing", [Timing(), Timing(4), Timing(4, Fraction(1)), Timing(late=Fraction(5, 2))])
def test_gains_for_a_bandwidth_are_critically_damped_and_safe_with_a_margin(timing: Timing) -> None:
    drive = gains(timing, bandwidth=Fraction(5))
    assert float(drive.kd) == pytest.approx(2 * float(drive.kp * INERTIA) ** 0.5, rel=1e-2)  # three digits
    assert float(drive.kp) == pytest.approx(0.1 * (2 * 3.14159265 * 5) ** 2, rel=5e-3)
    for factor in (Fraction(1), Fraction(5, 4)):
        for kp, kd in ((factor * drive.kp, drive.kd), (drive.kp, factor * drive.kd)):
            assert verdict(Drive(kp, kd, INERTIA), H, SYM, timing) == "converges"


def test_a_time_to_settle_is_a_bandwidth() -> None:
    drive = gains(Timing(4), settle=Fraction("0.5"))
    omega = float(drive.kp / INERTIA) ** 0.5
    assert (1 + omega * 0.5) * 2.718281828459045 ** (-omega * 0.5) == pytest.approx(1e-3, rel=0.02)


@pytest.mark.slow
def test_what_cannot_be_reached_is_refused_with_what_can() -> None:
    timing = Timing(4, Fraction(1))
    with pytest.raises(InputError, match=r"--bandwidth 50 Hz: unstable .* Largest safe bandwidth: (\S+) Hz") as refused:
        gains(timing, bandwidth=Fraction(50))
    reach = str(refused.value).split()[-2]
    gains(timing, bandwidth=Fraction(reach))
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


LIMITS = [
    ("SYM", "1", "1/4", 2 - 1 / 8, 2),  # 2 kd + kp < 4
    ("SYM", "1/10", "3", 1 / 2, 4 - 1 / 5),
    ("SYM", "19/10", "1/2", 7 / 4, 1 / 5),  # unstable: each is lowered until it is stable
    ("SYM", "3", "1/4", 2 - 1 / 8, None),  # where one alone is too much the other does not help
    ("SYM", "1/10", "5", None, 4 - 1 / 5),
    ("SYM", "0", "1/100", 2 - 1 / 200, None),  # rounding on the circle is no decay: only more kd helps
    ("SYM", "1", "0", 2, 2),  # a damper: its velocity is judged
    ("imex-euler", "1", "8", inf, 6),
    ("implicit-euler", "1", "1", inf, inf),
]


@pytest.mark.parametrize(("name", "kd", "kp", "kd_max", "kp_max"), LIMITS)
def test_gains_reach_the_edge_of_what_is_stable(
    name: str, kd: str, kp: str, kd_max: float | None, kp_max: float | None
) -> None:
    """On an inertia of 1, with steps of 1 s, kd is alpha_hat and kp is beta_hat."""
    found = drive(kp, kd, 1, h=1, method=name).limits
    assert (found.kd and found.kd[1], found.kp and found.kp[1]) == pytest.approx((kd_max, kp_max))


def test_an_undamped_spring_shows_what_the_integrator_adds() -> None:
    """Implicit Euler, 5 Hz at 60 Hz: a damping ratio of -omega h / 2 = -0.2618 is neutral."""
    omega, h = 2 * pi * 5, 1 / 60
    answer = drive(omega**2, 0, 1, h="1/60", method="implicit-euler")
    exponent = complex(log(1 + (omega * h) ** 2) / 2, atan(omega * h))  # z = 1 / (1 - i omega h)
    assert answer.damping_ratio == pytest.approx(exponent.real / abs(exponent), rel=1e-9)
    assert f"nothing but the integrator damps: its damping ratio is {answer.damping_ratio:.4g}" in answer.sentence
    assert drive(omega**2, -2 * 0.2617 * omega, 1, h="1/60", method="implicit-euler").safe
    assert not drive(omega**2, -2 * 0.2619 * omega, 1, h="1/60", method="implicit-euler").safe


@pytest.mark.slow
def test_the_largest_integral_gain_is_where_the_verdict_turns() -> None:
    answer = drive(200, 5, "0.1", ki=1000, h="0.002", load=2)
    assert answer.sentence.startswith("kp = 200, kd = 5, ki = 1000 (explicit, inertia 0.1, h = 0.002 s): safe.")
    assert "Under 2 N m it rests at its target." in answer.sentence
    assert answer.limits.ki
    for factor, expected in (("0.999", "converges"), ("1.001", "diverges")):
        ki = Fraction(answer.limits.ki[1]) * Fraction(factor)
        assert verdict(Drive(Fraction(200), Fraction(5), INERTIA, ki), H, SYM, Timing()) == expected


@pytest.mark.parametrize(("kp", "kd", "inertia", "h"), [(20, 5, "0.001", "0.002"), (1000, 80, "0.1", "1/240")])
def test_what_is_to_be_changed_is_stable_as_it_is_printed(kp: int, kd: int, inertia: str, h: str) -> None:
    """Explicit: 2 kd h / inertia + kp h^2 / inertia < 4; an armature adds to the inertia."""
    sentence = drive(kp, kd, inertia, h=h).sentence
    lowered = Fraction(re.findall(r"kd lowered to ([\d.]+)", sentence)[0])
    raised, armature = map(Fraction, re.findall(r"inertia raised to ([\d.]+) \(armature ([\d.]+)\)", sentence)[0])
    own, step = Fraction(inertia), Fraction(h)
    least = (2 * kd * step + kp * step**2) / 4
    assert least < raised < least * Fraction(101, 100)
    assert least < own + armature < own + (least - own) * Fraction(101, 100)
    most = (4 * own - kp * step**2) / (2 * step)
    assert most * Fraction(99, 100) < lowered < most
    assert drive(kp, lowered, inertia, h=h)
    assert drive(kp, kd, raised, h=h)
    assert drive(kp, kd, own + armature, h=h)


def test_the_ways_to_apply_a_torque_are_named_and_other_methods_by_their_names() -> None:
    answers = [drive(100, 0, 1, h="0.01", method=method) for method in ("RK4", "implicit-euler", "AB2")]
    assert "Safe: RK4, fully implicit (implicit-euler); not safe: AB2." in ways_words(answers)
