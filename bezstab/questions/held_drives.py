"""Drives whose torque is held for several steps of the physics, or applied late: are they safe, and with what margin?

gains and inertia, h, timing   →   HeldQuestion   →   held_answers   →   what is used up, and what each may become
HeldQuestion, bandwidth        →   held_gains     →   gains to write
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from typing import Any, Literal

import numpy as np

from bezstab.engines import DRIVE_METHODS, Drive
from bezstab.errors import InputError
from bezstab.methods import Method, Verdict, lookup
from bezstab.rationals import exact, rounded_down
from bezstab.stability import (
    HeldLimits,
    HeldMap,
    Timing,
    first_where,
    held_limits,
    held_map,
    held_spectral_radius,
    held_verdict,
    steps_to_settle,
)
from bezstab.units import check_step
from bezstab.words import change_words, counted, decay_words, gains_words

UsedUp = Literal["gains", "rate", "delay", "rate and delay", "kp", "kd", "too little kd"]
"""Why a drive is unstable; for a stable one, which of its numbers is nearest to its limit."""

DIGITS = 3
"""Of recommended gains."""

MARGIN = 1.25
"""Each recommended gain alone may grow by this factor: a quarter is left for what is not modelled."""

CAUSES = {
    "gains": "These gains are not stable even if each step computes and applies its torque.",
    "rate": "The torque is held too long: the same gains are stable if each step computes it.",
    "delay": "The torque comes too late: the same gains are stable without the delay.",
    "rate and delay": "The torque is held too long and comes too late.",
}
"""Why a drive is unstable, by what is used up."""


NEAREST = {
    "kp": "kp is nearest to its limit",
    "kd": "kd is nearest to its limit",
    "too little kd": "kd is nearest to its limit, the lower one",
    "rate": "the time between two torques is nearest to its limit",
    "delay": "the delay is nearest to its limit",
}
"""Which number of a stable drive may change least, by what is used up."""

OMEGA_H = np.geomspace(1, 3e-6, 260)
"""Radians a step at which the largest bandwidth is looked for: from 1 downwards, 5 % apart."""

SETTLED = 9.2334
"""omega t at which a critically damped error is a thousandth: (1 + omega t) e^(-omega t) = 1/1000."""


@dataclass(frozen=True, kw_only=True)
class HeldQuestion:
    """Is a drive safe whose torque is computed every few steps of h (s), applied late, or of a filtered velocity?

    The torque is computed `every` so many steps and applied so many steps `late`; the time constant of the filter is
    in s. Without `methods` all ways of applying a drive are asked about. InputError as `Timing`, for a step that is not
    positive, and for a method that is no way of applying a drive.
    """

    drive: Drive
    h: Fraction
    methods: tuple[Method, ...] = ()
    every: int = 1
    late: Fraction = Fraction(0)
    filter_seconds: Fraction = Fraction(0)

    def __post_init__(self) -> None:
        check_step(self.h, "h")
        _ = self.timing
        object.__setattr__(self, "methods", self.methods or tuple(map(lookup, DRIVE_METHODS)))
        for method in self.methods:
            if method.name not in DRIVE_METHODS:
                raise InputError(
                    f"--method {method.name}: expected a way of applying a drive, {', '.join(DRIVE_METHODS)}"
                )

    @cached_property
    def timing(self) -> Timing:
        """The same in steps."""
        if self.filter_seconds < 0:
            raise InputError(f"--filter {float(self.filter_seconds):g}: expected 0 s or more")
        return Timing(self.every, self.late, self.filter_seconds / self.h)


@dataclass(frozen=True, repr=False)
class HeldAnswer:
    """The answer for one way of applying a held or late drive: a step of the physics multiplies errors by `z_abs`.

    `verdict` is proven. `fresh_z_abs` is |z_p| of the same gains if each step computed its torque and applied it.
    `limits` and `used_up` are found when first asked for.
    """

    question: HeldQuestion
    method: Method
    verdict: Verdict
    z_abs: float
    fresh_z_abs: float

    def __repr__(self) -> str:
        timing = self.question.timing
        return f"{self.sentence} [every {timing.every}, late {float(timing.late):g}, |z_p| = {self.z_abs:.6g}]"

    def __bool__(self) -> bool:
        return self.safe

    @property
    def sentence(self) -> str:
        """The answer in words: what was judged, whether it is safe, how fast errors fall, what may change."""
        return held_sentence(self)

    @property
    def applied(self) -> str:
        """What this way of applying a drive is called."""
        return DRIVE_METHODS[self.method.name]

    @property
    def safe(self) -> bool:
        """Whether the error is proven to shrink."""
        return self.verdict == "converges"

    @cached_property
    def limits(self) -> HeldLimits:
        """How far gains (SI units), rate and delay (whole steps) may go, each alone."""
        drive, h = self.question.drive, self.question.h
        found = held_limits(self.method.name, *drive.point(h), self.question.timing)
        kp_of_one, kd_of_one = drive.gains(1.0, 1.0, float(h))
        return replace(found, kp=_times(kp_of_one, found.kp), kd=_times(kd_of_one, found.kd))

    @cached_property
    def used_up(self) -> UsedUp | None:
        """Why the drive is unstable; for a stable one the number nearest to its limit. None if none has one."""
        return self._nearest_end() if self.safe else self._cause()

    def map(self, points: int) -> HeldMap:
        """Return |z_p| around this drive, at so many points along each axis."""
        alpha_hat, beta_hat = self.question.drive.point(self.question.h)
        return held_map(self.method.name, self.question.timing, points, (float(alpha_hat), float(beta_hat)))

    def _cause(self) -> UsedUp:
        """Return the cause of instability: the drive would be stable without it."""
        point, timing = self.question.drive.point(self.question.h), self.question.timing

        def stable(**changed: Any) -> bool:
            return held_verdict(self.method.name, *point, replace(timing, **changed)) == "converges"

        if not stable(every=1, late=Fraction(0), filter_steps=Fraction(0)):
            return "gains"
        if stable(late=Fraction(0)):
            return "delay"
        return "rate" if stable(every=1) else "rate and delay"

    def _nearest_end(self) -> UsedUp | None:
        """Return the number of a stable drive with the least factor left to its limit; None if none has a limit."""
        limits, timing = self.limits, self.question.timing
        kp, kd = float(self.question.drive.kp), float(self.question.drive.kd)
        ratios: dict[UsedUp, float] = {}
        if limits.kp and kp > 0:
            ratios["kp"] = limits.kp[1] / kp
        if limits.kd and kd > 0:
            ratios["kd"] = limits.kd[1] / kd
            ratios["too little kd"] = kd / limits.kd[0] if limits.kd[0] else math.inf
        if limits.every:
            ratios["rate"] = (limits.every + 1) / timing.every
        if limits.late is not None and timing.late:
            ratios["delay"] = (limits.late + 1) / float(timing.late)
        nearest = min(ratios, key=lambda name: ratios[name])
        return nearest if math.isfinite(ratios[nearest]) else None


def held_sentence(answer: HeldAnswer) -> str:
    """Return whether a held or late drive is safe, how fast an error falls, why, and what may change.

    kp = 98.7, kd = 6.28 (explicit, inertia 0.1, h = 0.002 s): safe. An error falls to a thousandth in 0.29 s (145
    steps). It stays stable with one of these alone: kp up to 849, kd from 1.03 to 48.4, a torque every 19 steps, at
    most 6 steps late; kp is nearest to its limit.
    """
    drive, h = answer.question.drive, float(answer.question.h)
    judged = gains_words(drive.kp, drive.kd, drive.inertia, h, answer.applied)
    steps = steps_to_settle(answer.z_abs)
    what = "error" if drive.kp else "velocity"
    change = change_words(answer.z_abs, answer.verdict, what)
    if answer.safe and steps:
        change = decay_words(steps, h, what)
    sentence = f"{judged}: {'safe' if answer.safe else 'not safe'}. {change[0].upper()}{change[1:]}."
    changes = ", ".join(_changes(answer))
    if not answer.safe:
        remedy = f"It is stable with one of these alone: {changes}." if changes else "No single change makes it stable."
        return f"{sentence} {CAUSES[answer.used_up or 'gains']} {remedy}"
    nearest = f"; {NEAREST[answer.used_up]}" if answer.used_up else ""
    return f"{sentence} It stays stable with one of these alone: {changes}{nearest}."


def _changes(answer: HeldAnswer) -> list[str]:
    """Return how far each number alone may go with which a drive is stable."""
    limits, drive = answer.limits, answer.question.drive
    changes = []
    if limits.kp and math.isfinite(limits.kp[1]):
        changes.append(f"kp {'lowered' if drive.kp > limits.kp[1] else 'up'} to {limits.kp[1]:.3g}")
    if limits.kd and drive.kd > limits.kd[1]:
        changes.append(f"kd lowered to {limits.kd[1]:.3g}")
    elif limits.kd:
        least, most = limits.kd
        changes.append(f"kd from {least:.3g} {'on' if math.isinf(most) else f'to {most:.3g}'}")
    if limits.every is not None:
        changes.append("a torque every step" if limits.every == 1 else f"a torque every {limits.every} steps")
    if limits.late is not None:
        changes.append(f"at most {counted(limits.late, 'step')} late")
    return changes


def _times(unit: float, stretch: tuple[float, float] | None) -> tuple[float, float] | None:
    return None if stretch is None else (unit * stretch[0], unit * stretch[1])


def held_answers(question: HeldQuestion) -> Iterator[HeldAnswer]:
    """Yield the answer for each way of applying the drive."""
    point = question.drive.point(question.h)
    for method in question.methods:
        yield HeldAnswer(
            question=question,
            method=method,
            verdict=held_verdict(method.name, *point, question.timing),
            z_abs=float(held_spectral_radius(method.name, *point, question.timing)),
            fresh_z_abs=float(held_spectral_radius(method.name, *point, Timing())),
        )


def held_gains(question: HeldQuestion, *, bandwidth: Fraction | None = None, settle: Fraction | None = None) -> Drive:
    """Return critically damped gains for a bandwidth (Hz, the natural frequency) or a time to settle (s), to 3 digits.

        kp = inertia omega^2        kd = 2 inertia omega        omega = 2 pi bandwidth = 9.2334 / settle

    Of the question's drive only the inertia counts. The gains are proven stable in every method, and so is each gain
    alone MARGIN times as large. InputError where they are not, with the largest bandwidth, or the shortest time, for
    which they are.
    """
    if (bandwidth is None) == (settle is None):
        raise InputError("give --bandwidth or --settle, and only one of them")
    if settle is None:
        asked, wanted = f"--bandwidth {float(bandwidth or 0):g} Hz", 2 * math.pi * float(bandwidth or 0)
    else:
        asked, wanted = f"--settle {float(settle):g} s", SETTLED / float(settle) if settle else 0.0
    if not wanted > 0:
        raise InputError(f"{asked}: expected a positive number")

    inertia, h = question.drive.inertia, float(question.h)
    critical = _critical_drive(wanted, inertia)
    if _safe_with_margin(question, critical):
        return critical

    def holds(omega_h: float) -> bool:
        return _safe_with_margin(question, _critical_drive(omega_h / h, inertia))

    found = first_where(np.vectorize(holds, otypes=[bool]), OMEGA_H)
    refused = f"{asked}: not safe with a margin of {MARGIN:g}-fold at this rate and delay"
    if found is None:
        raise InputError(f"{refused}, nor is any that is slower")
    largest = found[1] / h
    hertz = f"up to {rounded_down(largest / (2 * math.pi), DIGITS)} Hz"
    reach = hertz if settle is None else f"from {SETTLED / largest:.3g} s on"
    raise InputError(f"{refused}; {reach} is")


def _critical_drive(omega: float, inertia: Fraction) -> Drive:
    """Return the critically damped gains of a natural frequency (1/s), to DIGITS."""
    kp, kd = (Fraction(f"{float(inertia) * gain:.{DIGITS}g}") for gain in (omega**2, 2 * omega))
    return Drive(kp, kd, inertia)


def _safe_with_margin(question: HeldQuestion, drive: Drive) -> bool:
    """Return whether a drive is proven stable in every method, and with each gain alone MARGIN times as large."""
    more = exact(MARGIN)
    drives = (drive, Drive(more * drive.kp, drive.kd, drive.inertia), Drive(drive.kp, more * drive.kd, drive.inertia))
    return all(
        held_verdict(method.name, *each.point(question.h), question.timing) == "converges"
        for method in question.methods
        for each in drives
    )
