"""Table 3, Fig. 4, Eqs 3 to 9 and 18 to 23: the mechanism, the printed equations against the scene's, the start."""

from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

from bezstab.mechanism import (
    Scene,
    accelerations,
    compiled_mechanism,
    constraint_errors,
    initial_state,
    load_scene,
)
from bezstab.paper.experiments import DURATION, STEP, experiment, largest
from bezstab.paper.printed import LOST, NOT_HERE, TABLE_3
from bezstab.paper.reports import Finding, Progress, Report, captioned_table
from bezstab.show import formatted, plot, styled
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

ENTERING = ("J1", "m2", "J2", "m3")
"""Of Table 3's masses and moments of inertia, those that enter the equations."""


def report(_progress: Progress) -> Report:
    """Return Fig. 4 and Table 3, what the equations come to, and what of the whole paper cannot be tested."""
    caption = (
        "Table 3: the slider-crank. m1 and J3 do not enter: the crank turns about its pivot, the slider not at all."
    )
    missing = [("Introduction", name, f"“{sentence}”", "not in bezstab: nothing to run") for name, sentence in NOT_HERE]
    untested = [Finding(*claim, holds=[]) for claim in (*LOST, *missing)]
    return Report(
        tables={"table3": captioned_table(caption, body_rows(load_scene("slider_crank")))},
        figures={"fig4": mechanism_figure},
        findings=[*findings(compared_terms()), *untested],
    )


def mechanism_figure() -> Figure:
    """Return Fig. 4: the slider-crank in its initial position."""
    scene = load_scene("slider_crank")
    q, _ = initial_state(compiled_mechanism(scene))
    with styled():
        figure = plot.mechanism(scene, q)[0].figure
    assert isinstance(figure, Figure)
    return figure


def body_rows(scene: Scene) -> list[dict[str, str]]:
    """Return each body's length between its joints (m), mass (kg) and moment of inertia (kg m²).

    A dash where a body has none, or where it does not enter.
    """
    joints_along = {body.name: [0.0] for body in scene.bodies}
    for name, (x, _) in scene.attachments:
        joints_along.setdefault(name, []).append(x)
    return [
        {
            "body": body.name,
            "length (m)": formatted(max(joints_along[body.name]) - min(joints_along[body.name]) or None, "g"),
            "mass (kg)": formatted(body.mass or None, "g"),
            "moment of inertia (kg m²)": formatted(body.inertia or None, "g"),
        }
        for body in scene.bodies
    ]


def printed_equations(q: FloatArray, v: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return c (m, shape (4,)) of Eq. 19, C_q (4, 5) of Eq. 21 and γ (m/s², (4,)) of Eq. 22.

    They are taken at q = [θ₁, x₂, y₂, θ₂, x₃] (rad, m; Eq. 18) and its rates v.
    """
    theta_1, x_2, y_2, theta_2, x_3 = q
    rate_1, _, _, rate_2, _ = v
    # along the crank, and along half of the rod
    x_l, y_l = TABLE_3["l1"] * np.cos(theta_1), TABLE_3["l1"] * np.sin(theta_1)
    x_h, y_h = TABLE_3["l2"] / 2 * np.cos(theta_2), TABLE_3["l2"] / 2 * np.sin(theta_2)
    return (
        np.array([x_l + x_h - x_2, y_l + y_h - y_2, x_2 + x_h - x_3, y_2 + y_h]),
        np.array([[-y_l, -1, 0, -y_h, 0], [x_l, 0, -1, x_h, 0], [0, 1, 0, -y_h, -1], [0, 0, 1, x_h, 0]]),
        np.array(
            [
                x_l * rate_1**2 + x_h * rate_2**2,
                y_l * rate_1**2 + y_h * rate_2**2,
                x_h * rate_2**2,
                y_h * rate_2**2,
            ]
        ),
    )


@dataclass(frozen=True)
class Terms:
    """What the scene's equations of motion are made of, at one state q, v; SI units."""

    q: FloatArray
    v: FloatArray
    mass: list[float]
    constraints: FloatArray
    jacobian: FloatArray
    gamma: FloatArray
    forces: FloatArray


def scene_terms(q: FloatArray, v: FloatArray) -> Terms:
    """Return the scene's diagonal of M (5,), c (4,), C_q (4, 5), γ (4,) and g (5,), at q and v of shape (5,)."""
    symbolic = compiled_mechanism(load_scene("slider_crank"))
    values = dict(zip((*symbolic.q, *symbolic.v), (*q, *v), strict=True))
    c, jacobian, gamma, forces = (
        np.array(matrix.subs(values), float)
        for matrix in (symbolic.constraints, symbolic.jacobian, symbolic.gamma, symbolic.forces)
    )
    return Terms(q, v, symbolic.mass.tolist(), c[:, 0], jacobian, gamma[:, 0], forces[:, 0])


def compared_terms() -> Terms:
    """Return the terms at a state that is off the constraints in every coordinate and rate."""
    q, v = initial_state(compiled_mechanism(load_scene("slider_crank")))
    return scene_terms(q + DISPLACED, v + FASTER)


def findings(terms: Terms) -> list[Finding]:
    """Return what came of every claim; the terms are those at one state."""
    return [
        body_data(),
        mass_matrix(terms),
        *equations_as_printed(terms),
        generalised_forces(terms),
        unique_accelerations(terms),
        constraint_accelerations(terms),
        derivatives_of_the_constraints(),
        consistent_start(),
        inconsistent_start(),
    ]


def body_data() -> Finding:
    """Return whether the scene has the masses and moments of inertia of Table 3."""
    crank, rod, slider = load_scene("slider_crank").bodies
    ours = crank.inertia, rod.mass, rod.inertia, slider.mass
    here = ", ".join(f"{value:g}" for value in ours) + "; m1 and J3 do not enter"
    return Finding(
        "Table 3",
        ", ".join(ENTERING),
        ", ".join(f"{TABLE_3[name]:g}" for name in ENTERING),
        here,
        [ours == tuple(TABLE_3[name] for name in ENTERING)],
    )


def mass_matrix(terms: Terms) -> Finding:
    """Return whether the scene's mass matrix is that of Eq. 20."""
    printed = [TABLE_3[name] for name in ("J1", "m2", "m2", "J2", "m3")]
    return Finding(
        "Eq. 20",
        "M = diag(J1, m2, m2, J2, m3)",
        "diagonal",
        ", ".join(f"{entry:g}" for entry in terms.mass),
        [terms.mass == printed],
    )


def equations_as_printed(terms: Terms) -> list[Finding]:
    """Return whether Eqs 19, 21 and 22 are the scene's.

    c = 0 and -c = 0 say the same, so a row of Eq. 19 may have either sign; but then the same row of Eqs 21 and 22,
    its derivatives, must have that sign too.
    """
    names = {"Eq. 19": "constraints c", "Eq. 21": "Jacobian C_q", "Eq. 22": "vector γ"}
    ours, printed = (terms.constraints, terms.jacobian, terms.gamma), printed_equations(terms.q, terms.v)
    signs = np.where(ours[0] * printed[0] < 0, -1.0, 1.0)
    found = []
    for (where, name), here, there in zip(names.items(), ours, printed, strict=True):
        same = bool(np.abs(here.T - signs * there.T).max() < SAME)
        outcome = "same to rounding" if same else "differs"
        found.append(Finding(where, f"{name} of the slider-crank", "as printed", outcome, [same]))
    return found


def generalised_forces(terms: Terms) -> Finding:
    """Return whether g is as printed in Eq. 23; corrected, the weight of the rod acts on y₂ alone, and downwards."""
    weight_of_the_rod = np.array([0, 0, TABLE_3["m2"] * GRAVITY, 0, 0])
    as_printed = bool(np.abs(terms.forces - weight_of_the_rod).max() < SAME)
    corrected = bool(np.abs(terms.forces + weight_of_the_rod).max() < SAME)
    entries = ", ".join(f"{force:g}" for force in terms.forces)
    sign = "minus" if terms.forces[2] < 0 else "plus"
    return Finding(
        "Eq. 23", "g = [0 0 m2 g 0 0]", "plus sign", f"[{entries}]: {sign} with y up", [as_printed, corrected]
    )


def unique_accelerations(terms: Terms) -> Finding:
    """Return the rank of the matrix of Eq. 5, as the mechanism has it and with its last constraint written twice."""
    texts, full = [], []
    for jacobian in (terms.jacobian, np.vstack([terms.jacobian, terms.jacobian[-1]])):
        zero = np.zeros((len(jacobian), len(jacobian)))
        matrix = np.block([[np.diag(terms.mass), jacobian.T], [jacobian, zero]])
        rank = np.linalg.matrix_rank(matrix)
        texts.append(f"{rank} of {len(matrix)}")
        full.append(bool(rank == len(matrix)))
    here = f"slider-crank: rank {texts[0]}; with a constraint written twice {texts[1]}"
    return Finding(
        "Section 2",
        "accelerations and multipliers are unique",
        "“Assuming that the mass matrix is positive definite and the Jacobian matrix has a full row rank, a unique "
        "solution for accelerations q̈ and Lagrange multipliers λ will be obtained”",
        here,
        [full == [True, False]],
    )


def constraint_accelerations(terms: Terms) -> Finding:
    """Return what c̈ = C_q q̈ - γ is at a state off the constraints: with no gains 0, with some what Eq. 6 asks for."""
    mechanism = compiled_mechanism(load_scene("slider_crank"))
    holds = []
    for two_alpha, beta_squared in ((0.0, 0.0), GAINS):
        asked = -two_alpha * (terms.jacobian @ terms.v) - beta_squared * terms.constraints
        qddot = accelerations(mechanism, 0.0, two_alpha, beta_squared, terms.q, terms.v)
        largest_term = max(1.0, np.abs(asked).max(), np.abs(qddot).max())
        holds.append(bool(np.abs(terms.jacobian @ qddot - terms.gamma - asked).max() < SAME * largest_term))
    free, stabilised = ("holds to rounding" if same else "does not hold" for same in holds)
    return Finding(
        "Eqs 5, 6, 8, 9",
        "the accelerations keep c̈ = 0, or c̈ + 2αċ + β²c = 0",
        "“it is guaranteed that the constraint equations at the acceleration level, c̈ = 0, are satisfied at every "
        "integration step”",
        f"at a state far off the constraints: Eq. 5 {free}, Eq. 9 {stabilised}",
        holds,
    )


def derivatives_of_the_constraints() -> Finding:
    """Return whether c of a driven mechanism, which has all terms of Eqs 3 and 4, has the second derivative of Eq. 9.

    The second difference of c along q + v t + q̈ t²/2 is c̈, whatever formulas q̈ comes from.
    """
    mechanism = compiled_mechanism(load_scene("driven_four_bar"))
    q, v = initial_state(mechanism)
    qddot = accelerations(mechanism, 0.0, 0.0, 0.0, q, v)
    before, now, after = (
        constraint_errors(mechanism, t, list(q + v * t + qddot * t**2 / 2)) for t in (-DIFFERENCE, 0.0, DIFFERENCE)
    )
    cddot = (after - 2 * now + before) / DIFFERENCE**2
    error = float(np.abs(cddot).max() / np.abs(qddot).max())
    is_zero = error < SEEN_BY_DIFFERENCES
    found = "c̈ = 0 by differences of c" if is_zero else f"c̈ is not 0 by differences of c, but {error:.0e} of q̈"
    return Finding("Eqs 3, 4", "derivatives of c(q, t)", "as printed", f"a driven four-bar: {found}", [is_zero])


def consistent_start() -> Finding:
    """Return whether c and ċ are zero in the scene's initial state."""
    started = experiment("B4", duration=STEP)
    consistent = bool(max(np.abs(started.c[0]).max(), np.abs(started.cdot[0]).max()) < SAME)
    return Finding(
        "Section 5.2",
        "the initial state is consistent",
        "“The initial conditions at the position and velocity levels are consistent with the physics of the problem, "
        "in order to prevent violation of constraints at the initial instant”",
        "c = 0 and ċ = 0 to rounding" if consistent else "c or ċ is not 0",
        [consistent],
    )


def inconsistent_start() -> Finding:
    """Return what becomes of 1 mm in c_1 at the start, without feedback: of c_1 itself, and of the crank's angle."""
    right, wrong = (experiment("AB4", kick=kick) for kick in (0.0, KICK))
    left = largest(wrong, 0.9 * DURATION, DURATION)
    angle = abs(float(wrong.q[-1, 0] - right.q[-1, 0]))
    return Finding(
        "Section 5.2",
        "an inconsistent one leads to errors",
        "“violation of constraints at the initial instant of analysis, which, eventually, can lead to erroneous "
        "results”",
        f"c_1 = {1e3 * KICK:g} mm at the start, no feedback: {1e3 * left:.2f} mm after {DURATION:g} s, the crank off "
        f"by {angle:.0e} rad; consistent: below 1e-10 m",
        [left > 0.5 * KICK and largest(right, 0, DURATION) < 1e-10],
    )
