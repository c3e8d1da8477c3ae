"""Table 3, Fig. 4, Eqs 3 to 9 and 18 to 23: the mechanism, the printed equations against the scene's, the start."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from bezstab.mechanism import (
    Scene,
    accelerations,
    compiled_mechanism,
    constraint_errors,
    equations_of_motion,
    initial_state,
    load_scene,
)
from bezstab.paper import lost
from bezstab.paper.experiments import DURATION, STEP, experiment
from bezstab.paper.printed import TABLE_3
from bezstab.paper.reports import Finding, Progress, Report, captioned_table
from bezstab.show import Row, column, plot, styled
from bezstab.stability import FloatArray

SAME = 1e-12  # SI: rounding of sums of a few terms near one
GRAVITY = 9.81  # m/s2; the paper gives no number

# The state at which the equations are compared. A consistent one would not do: there c = 0, and 0 agrees with -0.
DISPLACED = np.array([0.1, 0.2, 0.3, 0.4, 0.5])  # rad, m, m, rad, m: off the constraints, each coordinate differently
FASTER = 0.3  # rad/s and m/s, added to every rate: no longer tangent to the constraints either

GAINS = (100.0, 1e5)  # 2 alpha (1/s) and beta^2 (1/s2): Table 5's first case at 1 ms
DIFFERENCE = 1e-4  # s, between the times of a second difference: its error is about 1e-8 of the terms, as rounding's
SEEN_BY_DIFFERENCES = 1e-6  # of the largest term
KICK = 1e-3  # m

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
    with styled():
        figure = plot.mechanism(scene, q)[0].figure
    assert isinstance(figure, Figure)
    return figure


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
        unique_accelerations(terms),
        constraint_accelerations(terms, q, v),
        derivatives_of_the_constraints(load_scene("driven_four_bar")),
        consistent_start(),
        inconsistent_start(),
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
    return Finding(
        where="Table 3",
        claim="J1, m2, J2, m3",
        paper=", ".join(f"{TABLE_3[name]:g}" for name in ours),
        here=", ".join(f"{value:g}" for value in ours.values()) + "; m1 and J3 do not enter",
        holds=[all(ours[name] == TABLE_3[name] for name in ours)],
    )


def mass_matrix(diagonal: list[float]) -> Finding:
    """Return whether the scene's mass matrix is that of Eq. 20."""
    return Finding(
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
    return Finding(
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
    return Finding(
        where="Eq. 23",
        claim="g = [0 0 m2 g 0 0]",
        paper="plus sign",
        here=f"[{entries}]: {sign} with y up",
        holds=[as_printed, corrected],
    )


def unique_accelerations(terms: Terms) -> Finding:
    """Return the rank of the matrix of Eq. 5, as the mechanism has it and with its last constraint written twice."""
    once, twice = terms.jacobian, np.vstack([terms.jacobian, terms.jacobian[-1]])
    ranks, sizes = [], []
    for jacobian in (once, twice):
        zero = np.zeros((len(jacobian), len(jacobian)))
        matrix = np.block([[np.diag(terms.mass), jacobian.T], [jacobian, zero]])
        ranks.append(int(np.linalg.matrix_rank(matrix)))
        sizes.append(len(matrix))
    return Finding(
        where="Section 2",
        claim="accelerations and multipliers are unique",
        paper="“Assuming that the mass matrix is positive definite and the Jacobian matrix has a full row rank, a "
        "unique solution for accelerations q̈ and Lagrange multipliers λ will be obtained”",
        here=f"slider-crank: rank {ranks[0]} of {sizes[0]}; with a constraint written twice {ranks[1]} of {sizes[1]}",
        holds=[ranks[0] == sizes[0] and ranks[1] < sizes[1]],
    )


def constraint_accelerations(terms: Terms, q: FloatArray, v: FloatArray) -> Finding:
    """Return what c̈ = C_q q̈ - γ is at a state off the constraints: with no gains 0, with some what Eq. 6 asks for."""
    mechanism = compiled_mechanism(load_scene("slider_crank"))
    c, cdot = terms.constraints, terms.jacobian @ v
    errors = []
    for two_alpha, beta_squared in ((0.0, 0.0), GAINS):
        asked = -two_alpha * cdot - beta_squared * c
        qddot = accelerations(mechanism, 0.0, two_alpha, beta_squared, q, v)
        largest_term = max(1.0, np.abs(asked).max(), np.abs(qddot).max())
        errors.append(float(np.abs(terms.jacobian @ qddot - terms.gamma - asked).max() / largest_term))
    free, stabilised = (error < SAME for error in errors)
    return Finding(
        where="Eqs 5, 6, 8, 9",
        claim="the accelerations keep c̈ = 0, or c̈ + 2αċ + β²c = 0",
        paper="“it is guaranteed that the constraint equations at the acceleration level, c̈ = 0, are satisfied at "
        "every integration step”",
        here=f"at a state far off the constraints: Eq. 5 {_to_rounding(free)}, Eq. 9 {_to_rounding(stabilised)}",
        holds=[free, stabilised],
    )


def _to_rounding(same: bool) -> str:
    return "holds to rounding" if same else "does not hold"


def derivatives_of_the_constraints(scene: Scene) -> Finding:
    """Return whether c of a driven mechanism, which has all terms of Eqs 3 and 4, has the second derivative of Eq. 9.

    The second difference of c along q + v t + q̈ t²/2 is c̈, whatever formulas q̈ comes from.
    """
    mechanism = compiled_mechanism(scene)
    q, v = initial_state(mechanism)
    qddot = accelerations(mechanism, 0.0, 0.0, 0.0, q, v)
    before, now, after = (
        constraint_errors(mechanism, t, list(q + v * t + qddot * t**2 / 2)) for t in (-DIFFERENCE, 0.0, DIFFERENCE)
    )
    cddot = (after - 2 * now + before) / DIFFERENCE**2
    error = float(np.abs(cddot).max() / np.abs(qddot).max())
    return Finding(
        where="Eqs 3, 4",
        claim="derivatives of c(q, t)",
        paper="as printed",
        here="a driven four-bar: c̈ = 0 by differences of c"
        if error < SEEN_BY_DIFFERENCES
        else f"a driven four-bar: c̈ is not 0 by differences of c, but {error:.0e} of q̈",
        holds=[error < SEEN_BY_DIFFERENCES],
    )


def consistent_start() -> Finding:
    """Return whether c and ċ are zero in the scene's initial state."""
    started = experiment("B4", duration=STEP).observation
    consistent = max(np.abs(started.c[0]).max(), np.abs(started.cdot[0]).max()) < SAME
    return Finding(
        where="Section 5.2",
        claim="the initial state is consistent",
        paper="“The initial conditions at the position and velocity levels are consistent with the physics of the "
        "problem, in order to prevent violation of constraints at the initial instant”",
        here="c = 0 and ċ = 0 to rounding" if consistent else "c or ċ is not 0",
        holds=[consistent],
    )


def inconsistent_start() -> Finding:
    """Return what becomes of 1 mm in c_1 at the start, without feedback: of c_1 itself, and of the crank's angle."""
    right, wrong = (experiment("AB4", kick=kick) for kick in (0.0, KICK))
    left = wrong.largest(0.9 * DURATION, DURATION)
    angle = abs(float(wrong.trajectory.q[-1, 0] - right.trajectory.q[-1, 0]))
    return Finding(
        where="Section 5.2",
        claim="an inconsistent one leads to errors",
        paper="“violation of constraints at the initial instant of analysis, which, eventually, can lead to erroneous "
        "results”",
        here=f"c_1 = {1e3 * KICK:g} mm at the start, no feedback: {1e3 * left:.2f} mm after {DURATION:g} s, the crank "
        f"off by {angle:.0e} rad; consistent: below 1e-10 m",
        holds=[left > 0.5 * KICK and right.largest(0, DURATION) < 1e-10],
    )
