"""Table 3 and Fig. 4, and what Eqs 18 to 23 come to: the mechanism, the printed equations against the scene's."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from bezstab.mechanism import Scene, compiled_mechanism, equations_of_motion, initial_state, load_scene
from bezstab.paper import lost
from bezstab.paper.findings import Finding, finding
from bezstab.paper.printed import TABLE_3
from bezstab.paper.reports import Progress, Report, captioned_table
from bezstab.show import Row, column, scene_figure
from bezstab.stability import FloatArray

SAME = 1e-12  # SI: rounding of sums of a few terms near one
GRAVITY = 9.81  # m/s2; the paper gives no number

# The state at which the equations are compared. A consistent one would not do: there c = 0, and 0 agrees with -0.
DISPLACED = np.array([0.1, 0.2, 0.3, 0.4, 0.5])  # rad, m, m, rad, m: off the constraints, each coordinate differently
FASTER = 0.3  # rad/s and m/s, added to every rate: no longer tangent to the constraints either

BODIES = [
    column("body", "body"),
    column("length (m)", "length", "g"),
    column("mass (kg)", "mass", "g"),
    column("moment of inertia (kg m²)", "inertia", "g"),
]


def report(_progress: Progress) -> Report:
    """Return Fig. 4 and Table 3, what the equations come to, and what of the whole paper cannot be tested."""
    return Report(
        tables={"table3": body_table(load_scene("slider_crank"))},
        figures={"fig4": mechanism_figure},
        findings=[*findings(), *lost.findings()],
    )


def mechanism_figure() -> Figure:
    """Return Fig. 4: the slider-crank in its initial position."""
    scene = load_scene("slider_crank")
    q, _ = initial_state(compiled_mechanism(scene))
    return scene_figure(scene, q)


def body_table(scene: Scene) -> str:
    """Return Table 3 as Markdown."""
    caption = (
        "Table 3: the slider-crank. m1 and J3 do not enter: the crank turns about its pivot, the slider not at all."
    )
    return captioned_table(caption, body_rows(scene), BODIES)


def body_rows(scene: Scene) -> list[Row]:
    """Return each body's length between its joints (m), mass (kg) and moment of inertia (kg m²).

    None where a body has none, or where it does not enter.
    """
    joints_along = {body.name: [0.0] for body in scene.bodies}
    for name, (x, _) in scene.attachments:
        joints_along.setdefault(name, []).append(x)
    return [
        {
            "body": body.name,
            "length": max(joints_along[body.name]) - min(joints_along[body.name]) or None,
            "mass": body.mass or None,
            "inertia": body.inertia or None,
        }
        for body in scene.bodies
    ]


def printed_constraints(q: FloatArray) -> FloatArray:
    """Return c (m, shape (4,)) of Eq. 19 at q = [θ₁, x₂, y₂, θ₂, x₃] (rad, m; Eq. 18)."""
    theta_1, x_2, y_2, theta_2, x_3 = q
    length, half = TABLE_3["l1"], TABLE_3["l2"] / 2
    return np.array(
        [
            length * np.cos(theta_1) + half * np.cos(theta_2) - x_2,
            length * np.sin(theta_1) + half * np.sin(theta_2) - y_2,
            x_2 + half * np.cos(theta_2) - x_3,
            y_2 + half * np.sin(theta_2),
        ]
    )


def printed_jacobian(q: FloatArray) -> FloatArray:
    """Return C_q (shape (4, 5)) of Eq. 21."""
    theta_1, _, _, theta_2, _ = q
    length, half = TABLE_3["l1"], TABLE_3["l2"] / 2
    return np.array(
        [
            [-length * np.sin(theta_1), -1, 0, -half * np.sin(theta_2), 0],
            [length * np.cos(theta_1), 0, -1, half * np.cos(theta_2), 0],
            [0, 1, 0, -half * np.sin(theta_2), -1],
            [0, 0, 1, half * np.cos(theta_2), 0],
        ]
    )


def printed_gamma(q: FloatArray, v: FloatArray) -> FloatArray:
    """Return γ (m/s², shape (4,)) of Eq. 22 at q and its rates v."""
    theta_1, _, _, theta_2, _ = q
    rate_1, _, _, rate_2, _ = v
    length, half = TABLE_3["l1"], TABLE_3["l2"] / 2
    return np.array(
        [
            length * np.cos(theta_1) * rate_1**2 + half * np.cos(theta_2) * rate_2**2,
            length * np.sin(theta_1) * rate_1**2 + half * np.sin(theta_2) * rate_2**2,
            half * np.cos(theta_2) * rate_2**2,
            half * np.sin(theta_2) * rate_2**2,
        ]
    )


@dataclass(frozen=True)
class Terms:
    """What the scene's equations of motion are made of, at one state; SI units."""

    constraints: FloatArray
    jacobian: FloatArray
    gamma: FloatArray
    forces: FloatArray
    mass: list[float]


def scene_terms(scene: Scene, q: FloatArray, v: FloatArray) -> Terms:
    """Return the scene's c (4,), C_q (4, 5), γ (4,), g (5,) and the diagonal of M (5,), at q and v of shape (5,)."""
    symbolic = equations_of_motion(scene)
    values = dict(zip((*symbolic.q, *symbolic.v), (*q, *v), strict=True))

    def numbers(matrix: Any) -> FloatArray:
        return np.array(matrix.subs(values).tolist(), float)

    return Terms(
        constraints=numbers(symbolic.constraints)[:, 0],
        jacobian=numbers(symbolic.jacobian),
        gamma=numbers(symbolic.gamma)[:, 0],
        forces=numbers(symbolic.forces)[:, 0],
        mass=[float(entry) for entry in symbolic.mass],
    )


def findings() -> list[Finding]:
    """Return what Table 3 and Eqs 18 to 23 come to."""
    scene = load_scene("slider_crank")
    q, v = initial_state(compiled_mechanism(scene))
    q, v = q + DISPLACED, v + FASTER
    terms = scene_terms(scene, q, v)
    return [
        body_data(scene),
        mass_matrix(terms.mass),
        *equations_up_to_row_signs(terms, q, v),
        generalised_forces(terms.forces),
    ]


def body_data(scene: Scene) -> Finding:
    """Return whether the scene has the masses and moments of inertia of Table 3."""
    bodies = {body.name: body for body in scene.bodies}
    ours = {
        "J1": bodies["crank"].inertia,
        "m2": bodies["rod"].mass,
        "J2": bodies["rod"].inertia,
        "m3": bodies["slider"].mass,
    }
    return finding(
        where="Table 3",
        claim="J1, m2, J2, m3",
        paper=", ".join(f"{TABLE_3[name]:g}" for name in ours),
        here=", ".join(f"{value:g}" for value in ours.values()) + "; m1 and J3 do not enter",
        holds=[all(ours[name] == TABLE_3[name] for name in ours)],
    )


def mass_matrix(diagonal: list[float]) -> Finding:
    """Return whether the scene's mass matrix is that of Eq. 20."""
    return finding(
        where="Eq. 20",
        claim="M = diag(J1, m2, m2, J2, m3)",
        paper="diagonal",
        here=", ".join(f"{entry:g}" for entry in diagonal),
        holds=[diagonal == [TABLE_3[name] for name in ("J1", "m2", "m2", "J2", "m3")]],
    )


def equations_up_to_row_signs(terms: Terms, q: FloatArray, v: FloatArray) -> list[Finding]:
    """Return whether Eqs 19, 21 and 22 are the scene's, each row perhaps negated.

    c = 0 and -c = 0 say the same, so a row of Eq. 19 may have either sign; but then the same row of Eqs 21 and 22,
    its derivatives, must have that sign too.
    """
    printed_c = printed_constraints(q)
    signs = np.where(terms.constraints * printed_c < 0, -1.0, 1.0)
    return [
        _printed_equation("19", "constraints c", terms.constraints, signs * printed_c),
        _printed_equation("21", "Jacobian C_q", terms.jacobian, signs[:, np.newaxis] * printed_jacobian(q)),
        _printed_equation("22", "vector γ", terms.gamma, signs * printed_gamma(q, v)),
    ]


def _printed_equation(number: str, name: str, ours: FloatArray, printed: FloatArray) -> Finding:
    same = bool(np.abs(ours - printed).max() < SAME)
    return finding(
        where=f"Eq. {number}",
        claim=f"{name} of the slider-crank",
        paper="as printed",
        here="same to rounding" if same else "differs",
        holds=[same],
    )


def generalised_forces(forces: FloatArray) -> Finding:
    """Return whether g is as printed in Eq. 23; corrected, the weight of the rod acts on y₂ alone, and downwards."""
    weight_of_the_rod = np.array([0, 0, TABLE_3["m2"] * GRAVITY, 0, 0])
    as_printed = bool(np.abs(forces - weight_of_the_rod).max() < SAME)
    corrected = bool(np.abs(forces + weight_of_the_rod).max() < SAME)
    entries = ", ".join(f"{force:g}" for force in forces)
    sign = "minus" if forces[2] < 0 else "plus"
    return finding(
        where="Eq. 23",
        claim="g = [0 0 m2 g 0 0]",
        paper="plus sign",
        here=f"[{entries}]: {sign} with y up",
        holds=[as_printed, corrected],
    )
