"""Tables 1 to 6 as Markdown."""

import json
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import numpy as np

from bezstab.mechanism.scene_files import load_scene
from bezstab.mechanism.simulation import Simulation
from bezstab.methods.formulas import characteristic_text, mapping_text, recursion_text
from bezstab.methods.registry import lookup
from bezstab.paper.experiments import KICK, KICKS, STEP, TABLE_4, compared_runs, kicked_runs, largest, pole
from bezstab.paper.printed import FASTER_LEVEL, TABLE_5, TABLE_6
from bezstab.show.cells import Row, formatted, pole_words
from bezstab.show.tables import table

ROUNDED = 1e-13  # m: below, c_1 is rounding amplified by beta^2 h^2 / |1 - z|, and differs between machines
HALF_A_DIGIT = 0.5001  # of the last place: what rounding may take, and a little for the float64 that is rounded
DECAYED = 1e-6  # of the kick: what a run does below it is no longer counted

RECORDED = Path(__file__).parent / "table6_times.json"
"""What `make times` measured once, as no two runs share their times."""


def captioned_table(caption: str, rows: Sequence[Row]) -> str:
    """Return rows, their values by heading, as Markdown below a caption."""
    lines = [list(rows[0]), *(list(map(formatted, row.values())) for row in rows)]
    return f"{caption}\n\n{table(lines, 'markdown')}\n"


def steps_table() -> str:
    """Return Table 1."""
    methods = {name: lookup(name) for name in FASTER_LEVEL}
    rows = [
        {"method": name, "step": recursion_text(method, False), "s→z mapping": mapping_text(method, False)}
        for name, method in methods.items()
    ]
    return captioned_table("Table 1: the Bézier methods and their s→z mappings.", rows)


def polynomials_table() -> str:
    """Return Table 2."""
    rows = [
        {"method": name, "characteristic polynomial": characteristic_text(lookup(name), False)} for name in FASTER_LEVEL
    ]
    return captioned_table("Table 2: their characteristic polynomials.", rows)


def bodies_table() -> str:
    """Return Table 3: each body's length between its joints; a dash where a body has none, or it does not enter."""
    scene = load_scene("slider_crank")
    joints_along = {body.name: [0.0] for body in scene.bodies}
    for name, (x, _) in scene.attachments:
        joints_along.setdefault(name, []).append(x)
    rows = [
        {
            "body": body.name,
            "length (m)": formatted(max(joints_along[body.name]) - min(joints_along[body.name]) or None, "g"),
            "mass (kg)": formatted(body.mass or None, "g"),
            "moment of inertia (kg m²)": formatted(body.inertia or None, "g"),
        }
        for body in scene.bodies
    ]
    caption = "m1 and J3 do not enter: the crank turns about its pivot, the slider not at all."
    return captioned_table(f"Table 3: the slider-crank. {caption}", rows)


def behaviour(run: Simulation) -> tuple[float, int]:
    """Return by what c_1 of a kicked run changes a step, from its first half to its second, and its zero crossings.

    Both as long as it is above a millionth of the kick.
    """
    c = run.c[:, 0]
    followed = int(np.flatnonzero(np.abs(c) > DECAYED * KICK)[-1])  # there is one: it begins with the kick
    c, half = c[: followed + 1], (followed + 1) // 2
    rate = (np.abs(c[half:]).max() / np.abs(c[:half]).max()) ** (1 / half)
    return float(rate), int(np.count_nonzero(np.diff(np.sign(c))))


def cases_table() -> str:
    """Return Table 4."""
    rows = []
    for number, ((described, alpha_hat, beta_hat), run) in enumerate(zip(TABLE_4, kicked_runs(), strict=True), start=1):
        z, (rate, crossings) = pole(run), behaviour(run)
        rows.append(
            {
                "case": f"{number}",
                "described as": described,
                "α̂": f"{alpha_hat:g}",
                "β̂": f"{beta_hat:g}",
                "|z_p|": f"{abs(z):.4f}",
                "∠z_p (deg)": f"{np.degrees(np.angle(z)):.2f}",
                "seen: |z|": f"{rate:.4f}",
                "zero crossings of c₁": f"{crossings}",
            }
        )
    caption = (
        f"Table 4: B4 at h = {1e3 * STEP:g} ms, c₁ kicked by {1e3 * KICK:g} mm. The points are ours: "
        "they fit what the paper says of each case."
    )
    return captioned_table(caption, rows)


def poles_table() -> str:
    """Return Table 5: predicted poles, the paper's beside them, and how large c_1 still is, 0 if that is rounding."""
    rows, right = [], []
    for ((alpha_hat, beta_hat), name), run in compared_runs().items():
        z = pole(run)
        numbers = z.real, z.imag, abs(z), float(np.degrees(np.angle(z)))
        printed = TABLE_5[alpha_hat, beta_hat][name].split()
        matches = [is_printed(text, number) for text, number in zip(printed, numbers, strict=True)]
        right += matches
        before, after = (left if left > ROUNDED else 0.0 for left in (largest(run, 6, 8), largest(run, 8, 10)))
        rows.append(
            {
                "α̂": alpha_hat,
                "β̂": beta_hat,
                "method": name,
                "dominant pole": pole_words(complex(z)),
                "as printed (*: not ours)": " ".join(
                    text if match else f"{text}*" for text, match in zip(printed, matches, strict=True)
                ),
                "largest |c₁| of 6 to 8 s, of 8 to 10 s (m)": f"{before:.0e}, {after:.0e}",
            }
        )
    caption = (
        f"Table 5: dominant poles, with Re z, Im z, |z| and ∠z as the paper prints them ({sum(right)} of {len(right)} "
        "numbers match), and what is left of c₁ in the simulation (h = 1 ms, RK4 at 5 ms), kicked by 0, "
        f"{KICKS[1]:g} and {KICKS[2]:g} m at the three points. 0: below 1e-13 m, which is rounding."
    )
    return captioned_table(caption, rows)


def is_printed(text: str, number: float) -> bool:
    """Return whether a printed number is this one, rounded to as many digits."""
    decimals = len(text.partition(".")[2])
    return abs(float(text) - number) <= HALF_A_DIGIT * 10.0**-decimals


def costs_table() -> str:
    """Return Table 6, with the times recorded once: the same on every machine."""
    recorded = json.loads(RECORDED.read_text(encoding="utf-8"))
    rows = [
        {
            "method": cost["method"],
            "evaluations of f in 10 s": f"{cost['evaluations']}",
            "paper (s)": TABLE_6[cost["method"]],
            "recorded (s)": f"{cost['seconds']:.3f}",
            "recorded / B4's": f"{cost['seconds'] / recorded[0]['seconds']:.2f}",
        }
        for cost in recorded
    ]
    caption = (
        "Table 6: what 10 s of simulation cost (h = 1 ms, RK4 at 5 ms). The paper's times are of its three cases; ours "
        "were recorded once (processor time, one core, not compiled)."
    )
    return captioned_table(caption, rows)


TABLES: Mapping[str, Callable[[], str]] = {
    "table1": steps_table,
    "table2": polynomials_table,
    "table3": bodies_table,
    "table4": cases_table,
    "table5": poles_table,
    "table6": costs_table,
}
