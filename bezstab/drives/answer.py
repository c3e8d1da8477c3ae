"""Is a drive safe, and which gains give a bandwidth?

kp, kd, inertia, h, method, timing          →   judge_drive   →   DriveAnswer
inertia, h, methods, timing, bandwidth      →   gains_for            →   Drive
"""

import cmath
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from typing import Any, Literal

import numpy as np

from bezstab.arguments import Number, exact_number, exact_or_none, in_keywords, whole_number
from bezstab.drives.held_torque import dominant_pole, verdict
from bezstab.drives.limits import Limits, Stretch, limits
from bezstab.engines.drives import DRIVE_METHODS, FRESH, Drive, Timing, timing_of
from bezstab.errors import InputError
from bezstab.methods.registry import lookup
from bezstab.methods.schemes import Method
from bezstab.methods.schur import Verdict
from bezstab.rationals import exact, rounded_down, rounded_up
from bezstab.stability.choices import TENTH, steps_to_settle
from bezstab.stability.searches import first_where
from bezstab.units import check_step
from bezstab.words import as_sentence, change_words, counted, gains_words, seconds_words

UsedUp = Literal["gains", "rate", "delay", "rate and delay", "kp", "kd", "too little kd", "ki"]
"""Why a drive is unstable; for a stable one, which of its numbers is nearest to its limit."""

CAUSES: Mapping[UsedUp, str] = {
    "gains": "These gains are not stable even if each step computes and applies its torque.",
    "rate": "The torque is held too long: the same gains are stable if each step computes it.",
    "delay": "The torque comes too late: the same gains are stable without the delay.",
    "rate and delay": "The torque is held too long and comes too late.",
}

NEAREST: Mapping[UsedUp, str] = {
    "kp": "kp is nearest to its limit",
    "kd": "kd is nearest to its limit",
    "too little kd": "kd is nearest to its limit, the lower one",
    "ki": "ki is nearest to its limit",
    "rate": "the time between two torques is nearest to its limit",
    "delay": "the delay is nearest to its limit",
}


GAINS = ("kp", "kd", "inertia", "ki")


@dataclass(frozen=True, repr=False)
class DriveAnswer:
    """All that is known of a drive (SI units) whose torque a method applies, fresh, held or late.

    `verdict` is proven: what errors do, without kp those of the velocity. `z_abs` is the factor by which each step
    multiplies them; `fresh_z_abs` the same if each step computed the torque and applied it. `damping_ratio` is that of
    an oscillator that decays as errors do: without kd what the integrator alone adds, negative where it drives.
    `tenth_steps` and `settle_steps`: steps until an error is a tenth, a thousandth; None where it does not fall.
    `sag`: how far from its target it rests under a `load`, in rad (or m), 0 with ki; None without a load. `applied`:
    what this way of applying a drive is called, None for a method that engines do not apply drives with. `sentence`:
    the answer in words.
    """

    drive: Drive
    h: Fraction
    method: Method
    timing: Timing
    applied: str | None
    verdict: Verdict
    z_abs: float
    fresh_z_abs: float
    damping_ratio: float | None
    tenth_steps: int | None
    settle_steps: int | None
    load: Fraction | None
    sag: float | None
    limits: Limits
    used_up: UsedUp | None
    sentence: str = field(compare=False)

    def __repr__(self) -> str:
        return f"{self.sentence} [{self.method.name}, |z_p| = {self.z_abs:.6g}]"

    def __bool__(self) -> bool:
        return self.safe

    @property
    def safe(self) -> bool:
        """Whether errors are proven to shrink."""
        return self.verdict == "converges"


@in_keywords()
def drive(
    kp: Number,
    kd: Number,
    inertia: Number,
    *,
    h: Number,
    ki: Number = 0,
    method: str | Method = "SYM",
    every: int = 1,
    late: Number = 0,
    filter_seconds: Number = 0,
    load: Number | None = None,
) -> DriveAnswer:
    """Return whether a joint's drive is stable: torque = -kp (q - target) - kd q' on an inertia, in SI units.

    Parameters
    ----------
    kp, kd : int, float, str or Fraction
        Stiffness (N m/rad or N/m) and damping (N m s/rad or N s/m).
    inertia : int, float, str or Fraction
        Inertia that the drive feels (kg m^2 or kg).
    h : int, float, str or Fraction
        Step of the physics (s).
    ki : int, float, str or Fraction
        Integral gain (N m/(rad s) or N/(m s)); needs kp.
    method : str or Method
        How the torque is applied: "SYM" (explicit), "imex-euler" (implicit in the velocity), "stable-pd",
        "implicit-euler" (fully implicit); any method if the torque is computed in every step and not late.
    every : int
        The torque is computed every so many steps, and held in between; 1 to 100.
    late : int, float, str or Fraction
        The torque is applied so many steps late, or a fraction of them; 0 to 100.
    filter_seconds : int, float, str or Fraction
        Time constant (s) of a first-order filter of the measured velocity; 0 for none.
    load : int, float, str or Fraction, optional
        A steady torque (N m) or force (N); `sag` says how far the joint sags under it.

    Returns
    -------
    DriveAnswer
        True if errors are proven to decay; `sentence` says it in words, `limits` how far each number may change
        alone. Limits of the torque are not judged.

    Raises
    ------
    InputError
        A number is out of range, or the method cannot apply a torque that is held or late.

    References
    ----------
    Gil et al., J. Comput. Inf. Sci. Eng. 9, 011005, 2009.
    """
    step = exact_number(h, "h")
    timing = timing_of(
        step, whole_number(every, "every"), exact_number(late, "late"), exact_number(filter_seconds, "filter_seconds")
    )
    gains = Drive(*(exact_number(gain, name) for gain, name in zip((kp, kd, inertia, ki), GAINS, strict=True)))
    named = method if isinstance(method, Method) else lookup(method)
    return judge_drive(gains, step, named, timing, exact_or_none(load, "load"))


def rates(
    h: Fraction | None, physics: Fraction | None, every: int | None, controller: Fraction | None
) -> tuple[Fraction, int]:
    """Return the step of the physics (s) and how many of them a torque is held, each given so or as a rate (Hz).

    InputError where one is given in two ways or none, and for a controller that does not divide the physics.
    """
    if (h is None) == (physics is None):
        raise InputError("give --h, the step in s, or --physics, its rate in Hz")
    step = h if h is not None else 1 / (physics or Fraction(1))
    if controller is None:
        return step, 1 if every is None else every
    if every is not None:
        raise InputError("give --every or --controller, not both")
    held = 1 / (step * controller)
    if held.denominator != 1:
        hertz = f"{float(1 / step):g} Hz"
        raise InputError(f"--controller {float(controller):g} Hz: the physics, {hertz}, is no multiple of it")
    return step, int(held)


def judge_drive(
    drive: Drive, h: Fraction, method: Method, timing: Timing = FRESH, load: Fraction | None = None
) -> DriveAnswer:
    """Return whether a drive is safe with steps of h (s), and how far each of its numbers may go alone.

    InputError for a step that is not positive, if the method cannot apply a torque that is held or late, and
    for a load without kp.
    """
    check_step(h, "h")
    if load is not None and not drive.kp:
        raise InputError("--load needs --kp: without stiffness nothing holds the load")
    found, pole = verdict(drive, h, method, timing), dominant_pole(drive, h, method, timing)
    z_abs = abs(pole)
    ends = limits(drive, h, method, timing)
    used_up = _nearest_limit(drive, timing, ends) if found == "converges" else _cause(drive, h, method, timing, ends)
    answer = DriveAnswer(
        drive=drive,
        h=h,
        method=method,
        timing=timing,
        applied=DRIVE_METHODS.get(method.name),
        verdict=found,
        z_abs=z_abs,
        fresh_z_abs=abs(dominant_pole(drive, h, method, FRESH)),
        damping_ratio=0.0 if found == "marginal" else damping_ratio(pole),  # proven on the circle
        tenth_steps=steps_to_settle(z_abs, TENTH) if found == "converges" else None,
        settle_steps=steps_to_settle(z_abs) if found == "converges" else None,
        load=load,
        sag=None if load is None else 0.0 if drive.ki else float(load / drive.kp),
        limits=ends,
        used_up=used_up,
        sentence="",
    )
    return replace(answer, sentence=_sentence(answer))


def damping_ratio(pole: complex) -> float | None:
    """Return the damping ratio of an oscillator whose errors a step multiplies by a pole; None for poles 0 and 1."""
    if pole in (0, 1):
        return None
    exponent = cmath.log(pole)
    return -exponent.real / abs(exponent)


def sag_words(sag: float) -> str:
    """Return where a joint rests that is off by so much (rad, or m of a slider)."""
    if not sag:
        return "at its target"
    return f"{math.degrees(sag):.3g}° (of a slider {1000 * sag:.3g} mm) from its target"


def _cause(drive: Drive, h: Fraction, method: Method, timing: Timing, ends: Limits) -> UsedUp:
    """Return the cause of instability: the drive would be stable without it, or with another number in its place."""

    def stable(**changed: Any) -> bool:
        return verdict(drive, h, method, replace(timing, **changed)) == "converges"

    if timing == FRESH:
        if ends.kd:
            return "kd" if drive.kd > ends.kd[0] else "too little kd"
        if ends.ki and drive.ki > ends.ki[1]:
            return "ki"
        return "kp" if ends.kp else "gains"
    if not stable(every=1, late=Fraction(0), filter_steps=Fraction(0)):
        return "gains"
    if stable(late=Fraction(0)):
        return "delay"
    return "rate" if stable(every=1) else "rate and delay"


def _nearest_limit(drive: Drive, timing: Timing, ends: Limits) -> UsedUp | None:
    """Return the number of a stable drive with the least factor left to its limit; None if none has a limit."""
    kp, kd = float(drive.kp), float(drive.kd)
    ratios: dict[UsedUp, float] = {}
    if ends.kp and kp > 0:
        ratios["kp"] = ends.kp[1] / kp
    if ends.kd and kd > 0:
        ratios["kd"] = ends.kd[1] / kd
        ratios["too little kd"] = kd / ends.kd[0] if ends.kd[0] else math.inf
    if ends.ki and drive.ki:
        ratios["ki"] = ends.ki[1] / float(drive.ki)
    if ends.every and timing != FRESH:
        ratios["rate"] = (ends.every + 1) / timing.every
    if ends.late is not None and timing.late:
        ratios["delay"] = (ends.late + 1) / float(timing.late)
    nearest = min(ratios, key=lambda name: ratios[name], default=None)
    return nearest if nearest and math.isfinite(ratios[nearest]) else None


def _sentence(answer: DriveAnswer) -> str:
    """Return whether a drive is safe, how fast an error falls, why not, and what may change.

    kp = 98.7, kd = 6.28 (explicit, inertia 0.1, h = 0.002 s): safe. An error falls to a thousandth in 0.29 s (145
    steps). It stays stable with one of these alone: kp up to 849, kd from 1.03 to 48.4, inertia from 0.0129 on, a
    torque every 19 steps, at most 6 steps late; kp is nearest to its limit.
    """
    drive, h = answer.drive, float(answer.h)
    judged = gains_words(drive.kp, drive.kd, drive.ki, drive.inertia, h, answer.applied or answer.method.name)
    what = "error" if drive.kp else "velocity"
    change = change_words(answer.z_abs, answer.verdict, answer.settle_steps, h, what)
    sentence = f"{judged}: {'safe' if answer.safe else 'not safe'}. {as_sentence(change)}{_one_gain(answer)}"
    if answer.sag is not None and answer.safe:
        sentence += f" Under {float(answer.load or 0):.4g} N m it rests {sag_words(answer.sag)}."
    changes = ", ".join(_changes(answer))
    if not answer.safe:
        remedy = f"It is stable with one of these alone: {changes}." if changes else "No single change makes it stable."
        cause = "" if answer.timing == FRESH else f" {CAUSES[answer.used_up or 'gains']}"
        return f"{sentence}{cause} {remedy}"
    if not changes:
        return f"{sentence} No single number has a limit."
    nearest = f"; {NEAREST[answer.used_up]}" if answer.used_up else ""
    return f"{sentence} It stays stable with one of these alone: {changes}{nearest}."


def _one_gain(answer: DriveAnswer) -> str:
    """Return what is to be known of a drive that has one gain alone; nothing of another one."""
    drive = answer.drive
    if not (drive.kp or drive.kd):
        return " Without kp and kd nothing is driven."
    if not drive.kp:
        return " Without kp this is a damper: nothing holds the position, so the velocity is judged."
    if drive.kd:
        return ""
    if answer.verdict == "marginal":
        return " Without kd this is a spring, and the integrator neither damps nor drives it."
    added = "" if answer.damping_ratio is None else f": its damping ratio is {answer.damping_ratio:.4g}"
    return f" Without kd this is a spring: nothing but the integrator damps{added}."


def _changes(answer: DriveAnswer) -> list[str]:
    """Return how far each number alone may go with which a drive is stable; what is to be changed is stable as printed.

    An armature adds to the inertia.
    """
    ends, drive = answer.limits, answer.drive
    changes = [_upper("kp", ends.kp, drive.kp)]
    if ends.kd and ends.kd[0] and drive.kd <= ends.kd[1]:
        changes.append(
            f"kd from {_digits(ends.kd[0])} {'on' if math.isinf(ends.kd[1]) else f'up to {_digits(ends.kd[1])}'}"
        )
    else:
        changes.append(_upper("kd", ends.kd, drive.kd))
    changes.append(_upper("ki", ends.ki, drive.ki))
    if ends.inertia and drive.inertia < ends.inertia[0]:
        least, armature = (
            rounded_up(each, DIGITS) for each in (ends.inertia[0], ends.inertia[0] - float(drive.inertia))
        )
        changes.append(f"inertia raised to {_digits(float(least))} (armature {_digits(float(armature))})")
    elif ends.inertia and ends.inertia[0]:
        changes.append(f"inertia from {_digits(ends.inertia[0])} on")
    if ends.h and math.isfinite(ends.h[1]):
        lowered = answer.h > ends.h[1]
        most = float(rounded_down(ends.h[1], DIGITS)) if lowered else ends.h[1]
        changes.append(f"a step {'lowered' if lowered else 'up'} to {seconds_words(most)}")
    if answer.timing != FRESH and ends.every is not None:
        changes.append("a torque every step" if ends.every == 1 else f"a torque every {ends.every} steps")
    if answer.timing != FRESH and ends.late is not None:
        changes.append(f"at most {counted(ends.late, 'step')} late")
    return [change for change in changes if change]


def _upper(name: str, ends: Stretch | None, own: Fraction) -> str:
    """Return up to what a gain may go; nothing where it has no limit."""
    if ends is None or math.isinf(ends[1]):
        return ""
    if own > ends[1]:
        return f"{name} lowered to {_digits(float(rounded_down(ends[1], DIGITS)))}"
    return f"{name} up to {_digits(ends[1])}"


def _digits(number: float) -> str:
    """Return a number to three digits, 1020 without a power of ten."""
    return f"{float(f'{number:.3g}'):g}"


DIGITS = 3
"""Of recommended gains."""

MARGIN = 1.25
"""Each recommended gain alone may grow by this factor: a quarter is left for what is not modelled."""

OMEGA_H = np.geomspace(1, 3e-6, 260)
"""Radians a step at which the largest bandwidth is looked for: from 1 downwards, 5 % apart."""

SETTLED = 9.2334
"""omega t at which a critically damped error is a thousandth: (1 + omega t) e^(-omega t) = 1/1000."""


def gains_for(
    inertia: Fraction,
    h: Fraction,
    methods: Sequence[Method],
    timing: Timing = FRESH,
    *,
    bandwidth: Fraction | None = None,
    settle: Fraction | None = None,
) -> Drive:
    """Return critically damped gains for a bandwidth (Hz, the natural frequency) or a time to settle (s), to 3 digits.

        kp = inertia omega^2        kd = 2 inertia omega        omega = 2 pi bandwidth = 9.2334 / settle

    They are proven stable in every method, and so is each gain alone MARGIN times as large. InputError where they are
    not, with the largest bandwidth, or the shortest time, for which they are.
    """
    if (bandwidth is None) == (settle is None):
        raise InputError("give --bandwidth or --settle, and only one of them")
    if settle is None:
        asked, wanted = f"--bandwidth {float(bandwidth or 0):g} Hz", 2 * math.pi * float(bandwidth or 0)
    else:
        asked, wanted = f"--settle {float(settle):g} s", SETTLED / float(settle) if settle else 0.0
    if not wanted > 0:
        raise InputError(f"{asked}: expected a positive number")

    def holds(omega_h: float) -> bool:
        drive = _critically_damped(omega_h / float(h), inertia)
        more = exact(MARGIN)
        stronger = (replace(drive, kp=more * drive.kp), replace(drive, kd=more * drive.kd))
        return all(verdict(each, h, method, timing) == "converges" for method in methods for each in (drive, *stronger))

    if holds(wanted * float(h)):
        return _critically_damped(wanted, inertia)
    found = first_where(np.vectorize(holds, otypes=[bool]), OMEGA_H)
    refused = f"{asked}: unstable with a {MARGIN - 1:.0%} margin at this rate and delay"
    if found is None:
        raise InputError(f"{refused}, and so is any that is slower")
    largest = found[1] / float(h)
    if settle is None:
        raise InputError(f"{refused}. Largest safe bandwidth: {rounded_down(largest / (2 * math.pi), DIGITS)} Hz")
    raise InputError(f"{refused}. Shortest safe time: {SETTLED / largest:.3g} s")


def _critically_damped(omega: float, inertia: Fraction) -> Drive:
    """Return the critically damped gains of a natural frequency (1/s), to DIGITS."""
    kp, kd = (Fraction(f"{float(inertia) * gain:.{DIGITS}g}") for gain in (omega**2, 2 * omega))
    return Drive(kp, kd, inertia)
