"""The motion that a question is about: how fast it is, and how the constraints of a scene turn with it."""

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction

from bezstab.errors import InputError
from bezstab.mechanism.constraint_normals import ConstraintMotion, TurningNormals, constraint_motion, turning_normals
from bezstab.mechanism.equations import compiled_mechanism
from bezstab.mechanism.scene_files import load_scene
from bezstab.mechanism.scenes import Scene, at_speed
from bezstab.rationals import exact, typed_number
from bezstab.stability.forced_errors import OMEGA_H, check_omega_h
from bezstab.stability.turning import LAW_HOLDS


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
    scene: str | Scene | None,
    speed: Fraction,
    h: Fraction | None,
    h_max: Fraction | None = None,
    duration: Fraction | None = None,
    omega_h: Fraction | None = None,
) -> ReferenceMotion:
    """Return the motion of rate omega (1/s) or omega_h (rad a step of h_max), else a scene's, else one that is usual.

    h and h_max in s; without h_max every step is h. A scene's motion that does not repeat itself is followed for a
    `duration` (s), by default the scene's own. InputError for a speed without a scene, omega or a scene without h, both
    omega and omega_h, a scene at rest, and unless 1e-6 <= omega h < 1.
    """
    check_speed(scene, speed)
    if omega is not None and omega_h is not None:
        raise InputError("the motion is given as omega= in 1/s with h= in s, or as omega_h= in rad a step, not as both")
    longer, amplitude = h_max / h if h and h_max else Fraction(1), None
    assumed = omega is None and omega_h is None and scene is None
    whose = "one"
    if omega_h is not None:
        turned, given = omega_h / longer, "--omega-h"
    elif assumed:
        turned, given = OMEGA_H / longer, "--h and --h-max"
    elif h is None:
        raise InputError(f"{'--scene' if omega is None else '--omega'} needs --h: the step in s, to make ωh of it")
    else:
        if omega is None:
            assert scene
            of_scene = _motion_of_scene(scene, speed, duration)
            omega, amplitude, whose = exact(of_scene.omega), of_scene.amplitude, f"that of {name_of(scene)}"
            given = f"--scene {name_of(scene)} moves with ω = {float(omega):.3g} 1/s"
        else:
            given = f"--omega {typed_number(omega)}"
        turned = omega * h
    try:
        check_omega_h(turned)
        check_omega_h(turned * longer)
    except InputError as error:
        raise InputError(f"{given}: {error}") from None
    if assumed:
        at_longest = "" if longer == 1 else " at --h-max"
        says = "--omega says" if h else "--omega and --h say"
        words = f"one with ωh = {float(OMEGA_H):g}{at_longest} ({says} how fast yours is)"
    elif omega is None:
        words = f"one with ωh = {float(turned * longer):.3g}"
    else:
        words = f"{whose} with ω = {float(omega):.3g} 1/s, ωh = {float(turned):.3g}"
    return ReferenceMotion(turned, turned * longer, words, amplitude, assumed)


def check_speed(scene: str | Scene | None, speed: Fraction) -> None:
    """Raise InputError for a speed without a scene."""
    if scene is None and speed != 1:
        raise InputError("--speed needs --scene: it says how fast that mechanism moves")


def name_of(scene: str | Scene) -> str:
    """Return what a scene is called where it was given: its name, or the path of its file as typed."""
    return scene if isinstance(scene, str) else scene.name


def scene_at_speed(scene: str | Scene, speed: Fraction) -> Scene:
    """Return a scene, loaded where its name or file is given, so many times as fast; errors as `load_scene`."""
    return at_speed(load_scene(scene) if isinstance(scene, str) else scene, float(speed))


def turning_of(scene: str | Scene | None, speed: Fraction, h: Fraction | None) -> TurningNormals | None:
    """Return how the normals of a scene's constraints turn; None without a scene.

    InputError for a scene without a step (h in s), or a speed without a scene; else errors as `load_scene` and
    `regular_motion`.
    """
    check_speed(scene, speed)
    if scene is None:
        return None
    if h is None:
        raise InputError("--scene needs --h: how far the mechanism moves in a step depends on it")
    moving = scene_at_speed(scene, speed)
    return turning_normals(compiled_mechanism(moving), moving.duration)


def turn_too_far(
    turnings: Mapping[Fraction, TurningNormals | None], scene: str | Scene | None, h: Fraction | None
) -> list[str]:
    """Return a warning for each speed at which a scene turns too far in a step (h in s) for first order to say much."""
    if scene is None or h is None:
        return []
    turned = {speed: turning.kappa * float(h) for speed, turning in turnings.items() if turning}
    return [
        f"constraints of {scene_at_speed(scene, speed).name} turn by κh = {kappa_h:.2g} a step: beyond {LAW_HOLDS:g} "
        "nothing is settled"
        for speed, kappa_h in turned.items()
        if kappa_h > LAW_HOLDS
    ]


def _motion_of_scene(scene: str | Scene, speed: Fraction, duration: Fraction | None) -> ConstraintMotion:
    """Return rate and amplitude of a scene's motion; InputError for one at rest, else as `load_scene` and `motion`."""
    moving = scene_at_speed(scene, speed)
    try:
        return constraint_motion(compiled_mechanism(moving), float(duration or moving.duration))
    except InputError as error:
        raise InputError(f"--scene {name_of(scene)}: {error}; --omega gives one") from None
