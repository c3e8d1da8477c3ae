"""What the paper's equations, tables and sentences about regions come to, computed and compared."""

from collections.abc import Callable, Iterable, Sequence
from fractions import Fraction
from functools import cache
from itertools import product
from typing import Any

import numpy as np

from bezstab.mechanism import compiled_mechanism, equations_of_motion, initial_state, load_scene
from bezstab.methods import LinearMultistep, Method, accuracy, bezier, closed_loop_at, evaluations, lookup
from bezstab.paper.printed import FASTER_LEVEL, LEAST_Z_ABS, TABLE_3, TABLE_5, Finding, finding
from bezstab.stability import FloatArray, best_point, dominant_pole, region, spectral_radius, verdict, window

SAMPLES = tuple(map(Fraction, ("-3/2", "0", "1/7", "1", "5/3")))  # more than the degree of anything compared
GRID = 200  # points per axis, where one counterexample is looked for
SAME = 1e-12  # SI: rounding of sums of a few terms near one
MODEST = 0.1  # of the area: a region that has lost less has shrunk "slightly"


def equation_findings() -> list[Finding]:
    """Return what the equations of sections 3 and 4 and of the appendix come to."""
    b2, ab2 = bezier(2).scheme, lookup("AB2").scheme
    assert isinstance(b2, LinearMultistep)
    points = list(product(SAMPLES, SAMPLES))
    at = [(a, b, closed_loop_at(lookup("B2"), a, b)) for a, b in points]
    printed = [(4, -8 + 6 * a, 4 - 8 * a + 9 * b, 2 * a - 6 * b, b) for a, b in points]
    agree = [[c / p[0] for c in p] == [Fraction(c, 4) for c in q] for (_, _, p), q in zip(at, printed, strict=True)]
    orders = {name: accuracy(lookup(name))[0] for name in ("B2", "B3", "B4", "AB2", "AB3", "AB4")}
    positive = [(name, verdict(lookup(name), Fraction(2), Fraction(2))) for name in ("B2", "B3", "B4", "AB4")]
    still = {verdict(lookup(name), Fraction(0), Fraction(0)) for name in ("B2", "B3", "B4", "AB2", "AB3", "AB4")}
    weights = ", ".join(map(str, b2.sigma[1:]))
    return [
        finding(
            "Eq. 12 | B2: y' = y + h/2 (3 f - f') | 3/2, -1/2",
            weights,
            b2.sigma[1:] == (Fraction(3, 2), Fraction(-1, 2)),
        ),
        finding(
            "Eq. 14 | B2: s = (2/h) z (z - 1) / (3 z - 1) | ρ = z² - z, σ = (3 z - 1)/2",
            f"ρ = {_ints(b2.rho)}, σ = {_ints(b2.sigma)}",
            b2.rho == (Fraction(1), Fraction(-1), Fraction(0)) and b2.sigma[0] == 0 and b2.sigma[1] == -3 * b2.sigma[2],
        ),
        finding(
            "Eqs 15, 17 | characteristic polynomial of B2 | 4 z⁴ + (-8 + 6 α̂) z³ + …",
            f"the same at {sum(agree)} of {len(agree)} rational points",
            all(agree),
        ),
        finding(
            "Section 3 | c̈ = 0 is unstable | does not converge",
            f"at α̂ = β̂ = 0: {', '.join(sorted(still))}",
            still == {"diverges"},
        ),
        finding(
            "Section 4 | positive α and β do not guarantee convergence | integrator decides",
            "at (2, 2): " + ", ".join(f"{name} {v}" for name, v in positive),
            any(v == "diverges" for _, v in positive),
        ),
        finding(
            "Section 5.1 | second order of both families is the same method | same",
            "same weights" if b2 == ab2 else "differ",
            b2 == ab2,
        ),
        finding(
            "Table 1 | “n-th order Bézier” is of order n | 2, 3, 4",
            ", ".join(f"B{n}: {orders[f'B{n}']}" for n in (2, 3, 4)) + "; AB3 and AB4: 3 and 4",
            all(orders[f"B{n}"] == n for n in (2, 3, 4)),
            orders["B2"] == 2,
        ),
    ]


def region_findings() -> list[Finding]:
    """Return what section 5.1 says of Figs 1 to 3, and section 6 of it."""
    area = {name: region(lookup(name)).area for name in ("B2", "B3", "B4", "AB3", "AB4", "RK4@5", "RK4@4")}
    least = {name: best.z_abs for name in LEAST_Z_ABS if (best := best_point(lookup(name)))}
    right = [round(least[name], 2) == printed for name, printed in LEAST_Z_ABS.items()]
    high = {name: region(lookup(name), level).area / area[name] for name, level in FASTER_LEVEL.items()}
    shrink = {
        "B2 to B3": area["B3"] / area["B2"],
        "B3 to B4": area["B4"] / area["B3"],
        "AB3 to AB4": area["AB4"] / area["AB3"],
    }
    others = ("AB4", "RK4@5")
    fails = {name: _counterexample(lookup("B4"), lookup(name)) for name in others}
    reverse = {name: _counterexample(lookup(name), lookup("B4")) for name in others}
    ratio = {name: evaluations(lookup(name)) / evaluations(lookup("B4")) for name in ("AB4", "RK4")}
    return [
        finding(
            "Fig. 1 | |z_p| below 0.65, 0.70, 0.75 in regions H | regions exist",
            ", ".join(f"{name}: {100 * part:.1f} % of the area" for name, part in high.items()),
            all(high.values()),
        ),
        finding(
            f"Section 5.1 | smallest |z_p| of B2, B3, B4 | {', '.join(f'{x:.2f}' for x in LEAST_Z_ABS.values())}",
            ", ".join(f"{x:.5f}" for x in least.values()),
            all(right),
            any(right),
        ),
        finding(
            "Section 5.1 | Bézier regions shrink slightly with order | slightly",
            f"area B2 to B3 times {shrink['B2 to B3']:.3f}, B3 to B4 times {shrink['B3 to B4']:.3f}",
            all(1 - MODEST < shrink[key] < 1 for key in ("B2 to B3", "B3 to B4")),
            shrink["B3 to B4"] < 1,
        ),
        finding(
            "Fig. 2 | B3 and B4 have larger regions than AB3 and AB4 | larger",
            f"{area['B3'] / area['AB3']:.2f} and {area['B4'] / area['AB4']:.2f} times",
            area["B3"] > area["AB3"] and area["B4"] > area["AB4"],
        ),
        finding(
            "Fig. 2, section 6 | from order 3 to 4 AB loses more than Bézier | considerably more",
            f"AB3 to AB4 keeps {100 * shrink['AB3 to AB4']:.0f} %, B3 to B4 {100 * shrink['B3 to B4']:.0f} %",
            shrink["AB3 to AB4"] < shrink["B3 to B4"],
        ),
        finding(
            "Section 5.1 | RK4 costs 5 times, AB4 as much as B4 | about 5, 1",
            f"evaluations: {ratio['RK4']:g} and {ratio['AB4']:g} times",
            ratio["RK4"] == 5,
            ratio["AB4"] == 1,
        ),
        finding(
            "Fig. 3 | at equal cost (RK4 at 5h) B4 has the largest region, AB4 the smallest | B4 > RK4 > AB4",
            f"B4 {area['B4']:.4f}, RK4@5 {area['RK4@5']:.4f}, AB4 {area['AB4']:.4f}",
            area["B4"] > area["RK4@5"] > area["AB4"],
        ),
        finding(
            "Fig. 3 | the same with RK4 at 4h, its true cost | (not said)",
            f"RK4@4 {area['RK4@4']:.4f}",
            area["B4"] > area["RK4@4"] > area["AB4"],
        ),
        *(
            finding(
                f"Section 6 | for certain parameters {name} is unstable and B4 stable | such parameters exist",
                f"{_point(fails[name])}; but the other way round at {_point(reverse[name])}",
                fails[name] is not None and reverse[name] is None,
                fails[name] is not None,
            )
            for name in others
        ),
        _what_sie_is(),
    ]


def mechanism_findings() -> list[Finding]:
    """Return what Table 3 and Eqs 18 to 23 come to: the scene's equations against the printed ones."""
    scene = load_scene("slider_crank")
    bodies = {body.name: body for body in scene.bodies}
    crank, rod, slider = (bodies[name] for name in ("crank", "rod", "slider"))
    data = (crank.inertia, rod.mass, rod.inertia, slider.mass)
    symbolic, (q, v) = equations_of_motion(scene), initial_state(compiled_mechanism(scene))
    values = dict(zip((*symbolic.q, *symbolic.v), (*q, *(v + 0.3)), strict=True))  # rates that do not keep c = 0 either

    def here(matrix: Any) -> FloatArray:
        return np.array(matrix.subs(values).tolist(), float)

    theta_1, x_2, y_2, theta_2, x_3 = q
    rate_1, rate_2 = v[0] + 0.3, v[3] + 0.3
    a, b = TABLE_3["l1"], TABLE_3["l2"] / 2
    (s1, c1), (s2, c2) = ((np.sin(x), np.cos(x)) for x in (theta_1, theta_2))
    c = np.array([a * c1 + b * c2 - x_2, a * s1 + b * s2 - y_2, x_2 + b * c2 - x_3, y_2 + b * s2])
    jacobian = np.array(
        [[-a * s1, -1, 0, -b * s2, 0], [a * c1, 0, -1, b * c2, 0], [0, 1, 0, -b * s2, -1], [0, 0, 1, b * c2, 0]]
    )
    gamma = np.array(
        [
            a * c1 * rate_1**2 + b * c2 * rate_2**2,
            a * s1 * rate_1**2 + b * s2 * rate_2**2,
            b * c2 * rate_2**2,
            b * s2 * rate_2**2,
        ]
    )
    forces = here(symbolic.forces)[:, 0]
    mass = [float(m) for m in symbolic.mass]
    expected_mass = [TABLE_3[key] for key in ("J1", "m2", "m2", "J2", "m3")]
    sign = -np.sign(here(symbolic.constraints)[0, 0] or 1)  # Eq. 19's rows may be written with either sign
    rows = {
        "19": (here(symbolic.constraints)[:, 0], c),
        "21": (here(symbolic.jacobian), jacobian),
        "22": (here(symbolic.gamma)[:, 0], gamma),
    }
    same = {key: _up_to_row_signs(ours, theirs) for key, (ours, theirs) in rows.items()}
    found = [f"{x:g}" for x in forces]
    return [
        finding(
            f"Table 3 | J1, m2, J2, m3 | {', '.join(f'{TABLE_3[k]:g}' for k in ('J1', 'm2', 'J2', 'm3'))}",
            ", ".join(f"{x:g}" for x in data) + "; m1 and J3 do not enter",
            data == tuple(TABLE_3[k] for k in ("J1", "m2", "J2", "m3")),
        ),
        finding(
            "Eq. 20 | M = diag(J1, m2, m2, J2, m3) | diagonal", ", ".join(f"{m:g}" for m in mass), mass == expected_mass
        ),
        *(
            finding(
                f"Eq. {key} | {what} of the slider-crank | as printed",
                "same to rounding" if same[key] else "differs",
                same[key],
            )
            for key, what in (("19", "constraints c"), ("21", "Jacobian C_q"), ("22", "vector γ"))
        ),
        finding(
            "Eq. 23 | g = [0 0 m2 g 0 0] | six entries, plus sign",
            f"[{', '.join(found)}]: five entries, minus with y up",
            len(found) == 6 and forces[2] > 0,
            abs(abs(forces[2]) - TABLE_3["m2"] * 9.81) < SAME and sign != 0,
        ),
    ]


def lost_findings() -> list[Finding]:
    """Return what cannot be tested, and why."""
    return [
        finding("Table 6 | seconds of processor time | 8.34 to 8.63 s", "machine and program are not known"),
        finding("Table 4 | the six parameters and their poles | lost in the scan", "ours fit what the text says"),
        finding("Figs 1 to 3, 5 to 9 | the curves themselves | lost in the scan", "only sentences about them remain"),
        finding("Section 5.2 | initial angle of the crank | not stated", "45 degrees here"),
    ]


def _what_sie_is() -> Finding:
    """Count which method's poles round to those that Table 5 prints for "Euler semi-implicit"."""
    matches = {}
    for name in ("SIE", "SYM"):
        poles = [
            (complex(dominant_pole(lookup(name), float(a), float(b))), row["SIE"]) for (a, b), row in TABLE_5.items()
        ]
        close = (
            abs(abs(z) - float(printed[2])) < 1e-3 and abs(z.real - float(printed[0])) < 1e-3 for z, printed in poles
        )
        matches[name] = sum(close)
    seen = f"1 + μ + μ² (Euler, corrected once): {matches['SIE']} of 3 poles; symplectic Euler: {matches['SYM']} of 3"
    fits = matches["SIE"] == len(TABLE_5)
    return finding(
        "Table 5 | a method called “Euler semi-implicit” | semi-implicit Euler",
        seen,
        fits and matches["SYM"] == fits,
        fits,
    )


@cache
def _counterexample(stable: Method, unstable: Method) -> tuple[float, float] | None:
    """Return a point where one method converges and the other diverges, both proven; None if a grid has none."""
    a, b = (np.linspace(low, high, GRID) for low, high in window(region(stable)))
    grid = a, b[:, np.newaxis]
    gap = np.minimum(1 - spectral_radius(stable, *grid), spectral_radius(unstable, *grid) - 1)
    row, column = np.unravel_index(np.argmax(gap), gap.shape)
    if gap[row, column] <= 0:
        return None
    point = round(float(a[column]), 2), round(float(b[row]), 2)
    exact = [Fraction(repr(x)) for x in point]
    proven = (verdict(stable, *exact), verdict(unstable, *exact)) == ("converges", "diverges")
    return point if proven else None


def _point(point: tuple[float, float] | None) -> str:
    return "nowhere" if point is None else f"({point[0]:g}, {point[1]:g})"


def _up_to_row_signs(ours: FloatArray, theirs: FloatArray) -> bool:
    """Return whether each row agrees or is its negative: c = 0 and -c = 0 say the same."""
    pairs: Iterable[Any] = zip(ours, theirs, strict=True)
    return all(min(np.abs(x - y).max(), np.abs(x + y).max()) < SAME for x, y in pairs)


def _ints(coefficients: Sequence[Fraction]) -> str:
    return f"[{', '.join(map(str, coefficients))}]"


FINDINGS: tuple[Callable[[], list[Finding]], ...] = (
    equation_findings,
    region_findings,
    mechanism_findings,
    lost_findings,
)
"""What needs no simulation."""
