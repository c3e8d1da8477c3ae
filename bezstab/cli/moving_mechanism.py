"""What poles, choose, check and region share when they are asked about a mechanism that moves: --scene and --speed."""

from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import TYPE_CHECKING

import click

from bezstab.cli.options import SPEED, Decorator, scene_option
from bezstab.cli.output import progress, say
from bezstab.show import Column, Row, column, formatted

if TYPE_CHECKING:
    from bezstab.mechanism import TurningNormals
    from bezstab.methods import Method
    from bezstab.stability import Modulus

moving_speed_option = click.option(
    "--speed", type=SPEED, default="1", help="With --scene: times the scene's own, its drivers' and its start's."
)


def moving_scene_option(help_text: str) -> Decorator:
    """Return the option --scene of a command that also works without one."""
    return scene_option(None, help_text)


def turning_of(scene: str | None, speed: Fraction, h: Fraction | None) -> "TurningNormals | None":
    """Return how the normals of the scene's constraints turn; None without a scene.

    UsageError for a scene without a step (h in s), or a speed without a scene; else errors as `load_scene` and
    `regular_motion`.
    """
    if scene is None:
        if speed != 1:
            raise click.UsageError("--speed goes with --scene: it is the mechanism that is so many times as fast")
        return None
    if h is None:
        raise click.UsageError("--scene needs --h: how far the mechanism moves in a step depends on it")
    from bezstab.mechanism import at_speed, compiled_mechanism, load_scene, regular_motion, turning_normals

    moving = at_speed(load_scene(scene), float(speed))
    stages: Sequence[Callable[[], object]] = (  # each keeps what it finds for the next
        lambda: compiled_mechanism(moving),
        lambda: regular_motion(compiled_mechanism(moving), moving.duration),
        lambda: turning_normals(compiled_mechanism(moving), moving.duration),
    )
    for stage in progress(stages, moving.name):
        stage()
    return turning_normals(compiled_mechanism(moving), moving.duration)


def say_if_it_turns_too_far(
    turning: "TurningNormals | None", scene: str | None, speed: Fraction, h: Fraction | None
) -> None:
    """Say on standard error, if so, that a scene's constraints turn too far in a step (s) for the first-order law."""
    if turning is None or scene is None or h is None:
        return
    from bezstab.evidence import LAW_HOLDS
    from bezstab.mechanism import at_speed, load_scene

    turned = turning.kappa * float(h)
    if turned > LAW_HOLDS:
        name = at_speed(load_scene(scene), float(speed)).name
        say(f"bezstab: constraints of {name} turn by κh = {turned:.2g} a step: beyond {LAW_HOLDS:g} the law fails")


def modulus_as_it_moves(method: "Method", turning: "TurningNormals | None", h: Fraction | None) -> "Modulus | None":
    """Return |z_p| over the motion at steps of h (s), for `choose` to take in place of that at rest; None without."""
    if turning is None or h is None:
        return None
    from bezstab.evidence import moving_modulus

    return moving_modulus(method, turning, float(h))


def moving_rows(
    rows: Sequence[Row],
    methods: Sequence["Method"],
    points: Sequence[tuple[float, float]],
    turning: "TurningNormals | None",
    h: Fraction | None,
) -> list[Row]:
    """Return rows with what the motion does to each one's method at its point, in the same order."""
    if turning is None or h is None:
        return list(rows)
    from bezstab.evidence import moving_pole
    from bezstab.show import moving_row

    return [
        _safe_as_it_moves({**row, **moving_row(moving_pole(method, turning, float(h), *point))})
        for row, method, point in zip(rows, methods, points, strict=True)
    ]


def _safe_as_it_moves(row: Row) -> Row:
    """Return the row, safe only if errors shrink over the motion as well."""
    return {**row, "safe": row["safe"] and row["moving_verdict"] == "converges"}


def moving_columns(turning: "TurningNormals | None") -> list[Column]:
    """Return the columns that moving_rows adds; none without a scene."""
    if turning is None:
        return []
    return [
        column("κ (1/s)", "kappa", ".4g"),
        column("|χ|", "chi_abs", ".3f"),
        column("|z| moving", "z_abs_moving", ".6f"),
        column("|z| at worst", "z_abs_worst", ".6f"),
        column("moving verdict", "moving_verdict"),
        Column("safe to speed", _safe_speed),
    ]


def _safe_speed(row: Row) -> str:
    speed = row["safe_speed"]
    return "any" if speed is None and row["moving_verdict"] == "converges" else formatted(speed, ".3g")
