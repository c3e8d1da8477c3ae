"""Figs. 1 to 3, and what sections 5.1 and 6 say of the regions in the plane of the dimensionless parameters."""

from collections.abc import Callable, Mapping, Sequence
from functools import partial

import numpy as np
from matplotlib.figure import Figure

from bezstab.methods import Method, evaluations, lookup
from bezstab.paper.experiments import STEP
from bezstab.paper.printed import COMPARED, FASTER_LEVEL, LEAST_Z_ABS, TABLE_5, PrintedCase
from bezstab.paper.reports import Finding, Outcome, Progress, Report
from bezstab.questions import MapAnswer, MapQuestion
from bezstab.rationals import exact
from bezstab.show import comparison_figure, map_figure
from bezstab.stability import best_point, dominant_pole, region, spectral_radius, verdict, window

GRID = 200  # points per axis, where one counterexample is looked for
MODEST = 0.1  # of the area: a region that has lost less has shrunk "slightly"
LAST_DIGIT = 1e-3  # a pole that is this near is the printed one, rounded or cut off after three decimals

Point = tuple[float, float]

WHERE_METHODS_DIFFER: Point = (1.01, 0.26)  # inside the region of B4, far outside that of AB4


def report(_progress: Progress) -> Report:
    """Return Figs. 1 (in three parts), 2 and 3, and what they and Table 5's name for a method come to."""
    drawings: dict[str, Callable[[], Figure]] = {
        f"fig1{panel}": partial(faster_region_figure, name) for panel, name in zip("abc", FASTER_LEVEL, strict=True)
    }
    drawings["fig2"] = partial(compared_regions_figure, ("B3", "B4", "AB3", "AB4"))
    drawings["fig3"] = partial(compared_regions_figure, ("B4", "AB4", "RK4@5"), h=STEP)
    claims = (
        faster_regions_exist,
        least_moduli,
        bezier_shrinks_slightly,
        bezier_is_larger_than_adams,
        adams_loses_more,
        evaluations_a_step,
        at_equal_cost,
        at_true_cost,
        unstable_with_adams,
        unstable_with_runge_kutta,
        integrator_decides,
        widest_at_its_cost,
        adams_moulton,
        what_semi_implicit_euler_is,
    )
    return Report(figures=drawings, findings=[claim() for claim in claims])


def faster_region_figure(name: str) -> Figure:
    """Return a panel of Fig. 1: one method's map of |z_p|, its region S and the faster region H."""
    question = MapQuestion(methods=(lookup(name),), levels=(exact(FASTER_LEVEL[name]),))
    answer = MapAnswer(question, lookup(name))
    return map_figure(answer, np.array(list(answer.dominant_poles())))


def compared_regions_figure(names: Sequence[str], h: float | None = None) -> Figure:
    """Return Fig. 2 or, in 2 alpha and beta^2 for a step of h (s), Fig. 3: the boundaries of several methods."""
    methods = tuple(map(lookup, names))
    return comparison_figure(MapQuestion(methods=methods, h=None if h is None else exact(h), compare=True))


def faster_regions_exist() -> Finding:
    """Return how much of each region lies below the level of Fig. 1."""
    parts = {name: _area(name, level) / _area(name) for name, level in FASTER_LEVEL.items()}
    here = ", ".join(f"{name}: {100 * part:.1f} % of the area" for name, part in parts.items())
    return Finding(
        "Fig. 1",
        "|z_p| below 0.65, 0.70, 0.75 in regions H",
        "“The magnitudes of |z_p| for regions H are smaller than 0.65, 0.70, and 0.75 for the second, third, and "
        "fourth order”",
        here,
        [all(part > 0 for part in parts.values())],
    )


def least_moduli() -> Finding:
    """Return the exact least |z_p| beside what the paper found, which agrees if it rounds to the printed digits."""
    least = []
    for name in LEAST_Z_ABS:
        best = best_point(lookup(name))
        assert best is not None
        least.append(best.z_abs)
    agree = [round(modulus, 2) == printed for modulus, printed in zip(least, LEAST_Z_ABS.values(), strict=True)]
    return Finding(
        "Section 5.1",
        "smallest |z_p| of B2, B3, B4",
        "“the smallest |z_p| that can be found are 0.58, 0.62, and 0.65”",
        ", ".join(f"{modulus:.5f}" for modulus in least),
        [all(agree), any(agree)],
    )


def bezier_shrinks_slightly() -> Finding:
    """Return by what the area of the Bézier regions shrinks from order to order."""
    to_b3, to_b4 = _area("B3") / _area("B2"), _area("B4") / _area("B3")
    return Finding(
        "Section 5.1",
        "Bézier regions shrink slightly with order",
        "“the stability regions of the Bézier method slightly decrease as the order of the method increases”",
        f"area B2 to B3 times {to_b3:.3f}, B3 to B4 times {to_b4:.3f}",
        [all(1 - MODEST < ratio < 1 for ratio in (to_b3, to_b4)), to_b4 < 1],
    )


def bezier_is_larger_than_adams() -> Finding:
    """Return how many times larger the Bézier regions are than those of Adams and Bashforth."""
    of_order_3, of_order_4 = _area("B3") / _area("AB3"), _area("B4") / _area("AB4")
    return Finding(
        "Fig. 2",
        "B3 and B4 have larger regions than AB3 and AB4",
        "“the Bézier stability regions for both the 3rd and 4th orders are larger than those of the Adams–Bashforth”",
        f"{of_order_3:.2f} and {of_order_4:.2f} times",
        [of_order_3 > 1 and of_order_4 > 1],
    )


def adams_loses_more() -> Finding:
    """Return how much of their area both families keep from order 3 to 4."""
    adams, bezier = _area("AB4") / _area("AB3"), _area("B4") / _area("B3")
    return Finding(
        "Fig. 2, section 6",
        "from order 3 to 4 AB loses more than Bézier",
        "“the percentage of reducing the size of stability regions from 3rd order to 4th order of Adams–Bashforth is "
        "considerably higher than that of the presented Bézier technique”",
        f"AB3 to AB4 keeps {100 * adams:.0f} %, B3 to B4 {100 * bezier:.0f} %",
        [adams < bezier],
    )


def evaluations_a_step() -> Finding:
    """Return what a step of RK4 and of AB4 costs, in steps of B4."""
    runge_kutta, adams = (evaluations(lookup(name)) / evaluations(lookup("B4")) for name in ("RK4", "AB4"))
    return Finding(
        "Section 5.1",
        "RK4 costs 5 times, AB4 as much as B4",
        "“the computational costs of the 4th order Bézier and Adams–Bashforth are quite similar … the computational "
        "cost of the Runge–Kutta method for the same order is about 5 times higher”",
        f"evaluations: {runge_kutta:g} and {adams:g} times",
        [runge_kutta == 5, adams == 1],
    )


def at_equal_cost() -> Finding:
    """Return the areas of Fig. 3, where RK4 takes steps of 5h."""
    bezier, runge_kutta, adams = (_area(name) for name in ("B4", "RK4@5", "AB4"))
    return Finding(
        "Fig. 3",
        "at equal cost (RK4 at 5h) B4 has the largest region, AB4 the smallest",
        "“considering similar computational costs, the Bézier method provides the largest stability region, … while "
        "Adams–Bashforth exhibits the smallest region”",
        f"B4 {bezier:.4f}, RK4@5 {runge_kutta:.4f}, AB4 {adams:.4f}",
        [bezier > runge_kutta > adams],
    )


def at_true_cost() -> Finding:
    """Return the same with RK4 at 4h, since it evaluates four times a step."""
    bezier, runge_kutta, adams = (_area(name) for name in ("B4", "RK4@4", "AB4"))
    return Finding(
        "Fig. 3",
        "the same with RK4 at 4h, its true cost",
        "(not said)",
        f"RK4@4 {runge_kutta:.4f}",
        [bezier > runge_kutta > adams],
    )


def unstable_with_adams() -> Finding:
    """Return where one of B4 and AB4 is stable and the other is not."""
    return Finding(
        "Section 6",
        "for certain parameters AB4 is unstable and B4 stable",
        "“for certain values of Baumgarte parameters, the Adams–Bashforth method became unstable while the Bézier "
        "method remained stable”",
        *stable_where_another_is_not("AB4"),
    )


def unstable_with_runge_kutta() -> Finding:
    """Return where one of B4 and RK4, with steps of 5 h, is stable and the other is not."""
    return Finding(
        "Section 6",
        "for certain parameters RK4@5 is unstable and B4 stable",
        "“The same observation can be shown for the comparison of the Runge–Kutta and Bézier methods”",
        *stable_where_another_is_not("RK4@5"),
    )


def stable_where_another_is_not(other: str) -> Outcome:
    """Return a point where B4 is stable and the other method is not, and one the other way round."""
    for_b4 = counterexample(stable=lookup("B4"), unstable=lookup(other))
    against_b4 = counterexample(stable=lookup(other), unstable=lookup("B4"))
    return (
        f"{_shown(for_b4)}; but the other way round at {_shown(against_b4)}",
        [for_b4 is not None and against_b4 is None, for_b4 is not None],
    )


def integrator_decides() -> Finding:
    """Return what each of the paper's methods does at one point, as proven, with its |z_p|; RK4 with steps of 5 h."""
    shown, verdicts = [], set()
    for name in ("B2", "B3", "B4", "AB2", "AB3", *COMPARED[1:]):
        proven = verdict(lookup(name), *map(exact, WHERE_METHODS_DIFFER))
        verdicts.add(proven)
        shown.append(f"{name} {proven} ({float(spectral_radius(lookup(name), *WHERE_METHODS_DIFFER)):.3f})")
    return Finding(
        "Abstract, section 4",
        "which parameters are right depends on the integrator",
        "“the proper identification and selection of Baumgarte parameters is highly dependent on the integration "
        "scheme utilized”",
        f"at {_shown(WHERE_METHODS_DIFFER)}, with |z_p|: {', '.join(shown)}",
        [verdicts == {"converges", "diverges"}],
    )


def widest_at_its_cost() -> Finding:
    """Return the area of B4 and of others with as many evaluations in the same time, whether the paper has them or not.

    A method that evaluates m times a step takes steps of m h.
    """
    rivals = {name: _area(name) for name in ("AB4", "RK4@4", "SIE@2")}
    bezier, not_compared = _area("B4"), _area("SYM")
    listed = ", ".join(f"{name} {area:.3f}" for name, area in rivals.items())
    return Finding(
        "Abstract",
        "Bézier has the wider region at the same cost",
        "“the Bézier method provides substantially wider region of stability for the same level of computational "
        "effort”",
        f"areas: B4 {bezier:.3f}, {listed}; but symplectic Euler, which costs as much as B4, {not_compared:.3f}",
        [bezier > max(rivals.values()), bezier > not_compared],
    )


def adams_moulton() -> Finding:
    """Return the areas of Adams–Moulton's methods beside those of the Bézier methods called of the same order.

    Also, as in practice, with an Adams–Bashforth step as predictor and one correction: two evaluations, so steps of 2h.
    """
    b3, am3, b4, am4 = (_area(name) for name in ("B3", "AM3", "B4", "AM4"))
    corrected = ", ".join(f"{name} {_area(name):.3f}" for name in ("ABM3@2", "ABM4@2"))
    return Finding(
        "Introduction",
        "Bézier is more stable than Adams–Moulton",
        "“the stability of the Bézier based solution is enhanced when comparing with other well-known methods, namely "
        "the well-established Adams–Moulton approach”",
        f"the reverse, areas: B3 {b3:.3f}, AM3 {am3:.2f}; B4 {b4:.3f}, AM4 {am4:.2f}. Only corrected once instead of "
        f"solved they are smaller: {corrected}",
        [b3 > am3, b4 > am4],
    )


def what_semi_implicit_euler_is(table_5: Mapping[int, PrintedCase] = TABLE_5) -> Finding:
    """Return which method's poles are those that Table 5 prints for "Euler semi-implicit".

    The claim holds as it stands if they are those of symplectic Euler (SYM), which everybody else calls so; with a
    correction if they are those of an explicit Euler step, corrected once (SIE).
    """
    sie_matches, sym_matches = matching_poles("SIE", table_5), matching_poles("SYM", table_5)
    is_symplectic, is_corrected_once = (matches == len(table_5) for matches in (sym_matches, sie_matches))
    return Finding(
        "Table 5",
        "a method called “Euler semi-implicit”",
        "“Euler's semi-implicit scheme”",
        f"1 + μ + μ² (Euler, corrected once): {sie_matches} of 3 poles; symplectic Euler: {sym_matches} of 3",
        [is_symplectic, is_symplectic or is_corrected_once],
    )


def matching_poles(name: str, table_5: Mapping[int, PrintedCase]) -> int:
    """Return how many of the poles printed for "Euler semi-implicit" are those of a method."""
    matches = 0
    for case in table_5.values():
        real, _, modulus, _ = map(float, case.poles["SIE"])
        pole = complex(dominant_pole(lookup(name), *case.point))
        matches += abs(abs(pole) - modulus) < LAST_DIGIT and abs(pole.real - real) < LAST_DIGIT
    return matches


def counterexample(*, stable: Method, unstable: Method) -> Point | None:
    """Return a point (alpha_hat, beta_hat) where one method converges and the other diverges, both proven.

    It is the point of a grid, to two decimals, that is farthest within both; None if the grid has none.
    """
    alpha_hat, beta_hat = (np.linspace(low, high, GRID) for low, high in window(region(stable)))
    plane = alpha_hat, beta_hat[:, np.newaxis]
    gap = np.minimum(1 - spectral_radius(stable, *plane), spectral_radius(unstable, *plane) - 1)
    row, column = np.unravel_index(np.argmax(gap), gap.shape)
    point = round(float(alpha_hat[column]), 2), round(float(beta_hat[row]), 2)
    at = exact(point[0]), exact(point[1])
    proven = verdict(stable, *at) == "converges" and verdict(unstable, *at) == "diverges"
    return point if proven else None


def _area(name: str, level: float = 1.0) -> float:
    area = region(lookup(name), level).area
    assert area is not None  # these regions are all bounded
    return area


def _shown(point: Point | None) -> str:
    return "nowhere" if point is None else f"({point[0]:g}, {point[1]:g})"
