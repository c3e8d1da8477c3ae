"""The motion that a question is about: how fast it is, and how the constraints of a scene turn with it."""

from dataclasses import dataclass
from fractions import Fraction

from bezstab.errors import InputError
from bezstab.mechanism.constraint_normals import constraint_motion, turning_normals
from bezstab.mechanism.equations import Mechanism, compiled_mechanism
from bezstab.mechanism.scene_files import scene as scene_named
from bezstab.mechanism.scenes import Scene
from bezstab.rationals import exact, typed_number
from bezstab.stability.forced_errors import OMEGA_H, check_omega_h
from bezstab.stability.turning import LAW_HOLDS

DURATION = 1.0
"""s: for so long a motion is followed that no driver closes, of a scene that says nothing."""


@dataclass(frozen=True)
class ReferenceMotion:
    """The motion on which errors are told: it turns by omega_h rad in a step, as `words` say.

    `omega_h_max` is the same at the longest step that may occur. `amplitude` is that of a scene's motion (m or rad).
    `assumed` is whether nobody said how fast it is.
    """

    omega_h: Fraction
    omega_h_max: Fraction
    words: str
    amplitude: float | None = None
    assumed: bool = False


def motion_of(
    omega: Fraction | None,
    mechanism: Mechanism | None,
    h: Fraction | None,
    h_max: Fraction | None = None,
    duration: Fraction | None = None,
    omega_h: Fraction | None = None,
) -> ReferenceMotion:
    """Return the motion of rate omega (1/s) or omega_h (rad a step of h_max), else a mechanism's, else a usual one.

    h and h_max in s; without h_max every step is h. A motion that does not repeat itself is followed for a `duration`
    (s), by default the scene's own. InputError for omega or a mechanism without h, both omega and omega_h, a mechanism
    at rest, and unless 1e-6 <= omega h < 1.
    """
    if omega is not None and omega_h is not None:
        raise InputError("the motion is given as omega= in 1/s with h= in s, or as omega_h= in rad a step, not as both")
    assumed = omega is None and omega_h is None and mechanism is None
    longer, amplitude = h_max / h if h and h_max else Fraction(1), None
    if assumed or omega_h is not None:
        of_longest = OMEGA_H if omega_h is None else omega_h
        turned, given, words = of_longest / longer, "--omega-h", f"one with ωh = {float(of_longest):.3g}"
        if assumed:
            given, says = "--h and --h-max", "--omega says" if h else "--omega and --h say"
            words += f"{'' if longer == 1 else ' at --h-max'} ({says} how fast yours is)"
    elif h is None:
        raise InputError("--omega needs --h: the step in s, to make ωh of it")
    else:
        if omega is not None:
            whose, given = "one", f"--omega {typed_number(omega)}"
        else:
            assert mechanism
            name = mechanism.scene.name
            try:
                of_scene = constraint_motion(mechanism, float(duration or mechanism.scene.duration or DURATION))
            except InputError as error:
                raise InputError(f"--scene: {error}; --omega gives one") from None
            omega, amplitude = exact(of_scene.omega), of_scene.amplitude
            whose, given = f"that of {name}", f"--scene: {name} moves with ω = {of_scene.omega:.3g} 1/s"
        turned = omega * h
    try:
        check_omega_h(turned)
        check_omega_h(turned * longer)
    except InputError as error:
        raise InputError(f"{given}: {error}") from None
    if omega is not None:
        words = f"{whose} with ω = {float(omega):.3g} 1/s, ωh = {float(turned):.3g}"
    return ReferenceMotion(turned, turned * longer, words, amplitude, assumed)


def check_speed(scene: str | Scene | None, speed: Fraction) -> None:
    """Raise InputError for a speed without a scene."""
    if scene is None and speed != 1:
        raise InputError("--speed needs --scene: it says how fast that mechanism moves")


def mechanism_of(scene: str | Scene | None, speed: Fraction, h: Fraction | None) -> Mechanism | None:
    """Return the mechanism of a scene that moves so many times as fast; None without a scene.

    InputError for a scene without a step (h in s), or a speed without a scene; else errors as `scene`.
    """
    check_speed(scene, speed)
    if scene is None:
        return None
    if h is None:
        raise InputError("--scene needs --h: how far the mechanism moves in a step depends on it")
    return compiled_mechanism(scene_named(scene, speed))


def turning_rate(mechanism: Mechanism) -> float:
    """Return how fast its constraints turn at most as it moves (1/s); errors as `turning_normals`."""
    return turning_normals(mechanism, mechanism.scene.duration or DURATION).kappa


def turn_too_far(mechanism: Mechanism, h: Fraction) -> list[str]:
    """Return a warning if a mechanism turns too far in a step (h in s) for first order to say much."""
    kappa_h = turning_rate(mechanism) * float(h)
    if kappa_h <= LAW_HOLDS:
        return []
    return [
        f"constraints of {mechanism.scene.name} turn by κh = {kappa_h:.2g} a step: beyond {LAW_HOLDS:g} nothing is "
        "settled"
    ]
