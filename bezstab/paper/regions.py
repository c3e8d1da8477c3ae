"""Figs. 1 to 3, and what sections 5.1 and 6 say of the regions in the plane of the dimensionless parameters."""

from collections.abc import Callable, Sequence
from functools import partial

import numpy as np
from matplotlib.figure import Figure

from bezstab.methods import Method, evaluations, lookup
from bezstab.paper import comparison
from bezstab.paper.experiments import STEP
from bezstab.paper.printed import COMPARED, FASTER_LEVEL, LEAST_Z_ABS
from bezstab.paper.reports import Finding, Progress, Report
from bezstab.questions import MapAnswer, MapQuestion
from bezstab.rationals import exact
from bezstab.show import comparison_figure, map_figure
from bezstab.stability import best_point, region, spectral_radius, verdict, window

GRID = 200  # points per axis, where one counterexample is looked for
MODEST = 0.1  # of the area: a region that has lost less has shrunk "slightly"

Point = tuple[float, float]

WHERE_METHODS_DIFFER: Point = (1.01, 0.26)  # inside the region of B4, far outside that of AB4


def report(_progress: Progress) -> Report:
    """Return Figs. 1 (in three parts), 2 and 3, and what they and Table 5's name for a method come to."""
    drawings: dict[str, Callable[[], Figure]] = {
        f"fig1{panel}": partial(faster_region_figure, name) for panel, name in zip("abc", FASTER_LEVEL, strict=True)
    }
    drawings["fig2"] = partial(compared_regions_figure, ("B3", "B4", "AB3", "AB4"))
    drawings["fig3"] = partial(compared_regions_figure, ("B4", "AB4", "RK4@5"), h=STEP)
    # what "Euler semi-implicit" is follows from its poles alone, as all of this does: no run is needed
    return Report(figures=drawings, findings=[*findings(), comparison.what_semi_implicit_euler_is()])


def faster_region_figure(name: str) -> Figure:
    """Return a panel of Fig. 1: one method's map of |z_p|, its region S and the faster region H."""
    question = MapQuestion(methods=(lookup(name),), levels=(exact(FASTER_LEVEL[name]),))
    answer = MapAnswer(question, lookup(name))
    return map_figure(answer, np.array(list(answer.dominant_poles())))


def compared_regions_figure(names: Sequence[str], h: float | None = None) -> Figure:
    """Return Fig. 2 or, in 2 alpha and beta^2 for a step of h (s), Fig. 3: the boundaries of several methods."""
    methods = tuple(map(lookup, names))
    return comparison_figure(MapQuestion(methods=methods, h=None if h is None else exact(h), compare=True))


def findings() -> list[Finding]:
    """Return what section 5.1 says of Figs. 1 to 3, and section 6 of it."""
    return [
        faster_regions_exist(),
        least_moduli(),
        bezier_shrinks_slightly(),
        bezier_is_larger_than_adams(),
        adams_loses_more(),
        evaluations_a_step(),
        at_equal_cost(),
        at_true_cost(),
        stable_where_another_is_not(
            "AB4",
            "“for certain values of Baumgarte parameters, the Adams–Bashforth method became unstable while the Bézier "
            "method remained stable”",
        ),
        stable_where_another_is_not(
            "RK4@5", "“The same observation can be shown for the comparison of the Runge–Kutta and Bézier methods”"
        ),
        integrator_decides(),
        widest_at_its_cost(),
        adams_moulton(),
    ]


def faster_regions_exist() -> Finding:
    """Return how much of each region lies below the level of Fig. 1."""
    parts = {name: _area(name, level) / _area(name) for name, level in FASTER_LEVEL.items()}
    return Finding(
        where="Fig. 1",
        claim="|z_p| below 0.65, 0.70, 0.75 in regions H",
        paper="“The magnitudes of |z_p| for regions H are smaller than 0.65, 0.70, and 0.75 for the second, third, and "
        "fourth order”",
        here=", ".join(f"{name}: {100 * part:.1f} % of the area" for name, part in parts.items()),
        holds=[all(part > 0 for part in parts.values())],
    )


def least_moduli() -> Finding:
    """Return the exact least |z_p| beside what the paper found, which agrees if it rounds to the printed digits."""
    least = {}
    for name in LEAST_Z_ABS:
        best = best_point(lookup(name))
        assert best is not None
        least[name] = best.z_abs
    agree = [round(least[name], 2) == printed for name, printed in LEAST_Z_ABS.items()]
    return Finding(
        where="Section 5.1",
        claim="smallest |z_p| of B2, B3, B4",
        paper="“the smallest |z_p| that can be found are 0.58, 0.62, and 0.65”",
        here=", ".join(f"{modulus:.5f}" for modulus in least.values()),
        holds=[all(agree), any(agree)],
    )


def bezier_shrinks_slightly() -> Finding:
    """Return by what the area of the Bézier regions shrinks from order to order."""
    to_b3, to_b4 = _area("B3") / _area("B2"), _area("B4") / _area("B3")
    return Finding(
        where="Section 5.1",
        claim="Bézier regions shrink slightly with order",
        paper="“the stability regions of the Bézier method slightly decrease as the order of the method increases”",
        here=f"area B2 to B3 times {to_b3:.3f}, B3 to B4 times {to_b4:.3f}",
        holds=[all(1 - MODEST < ratio < 1 for ratio in (to_b3, to_b4)), to_b4 < 1],
    )


def bezier_is_larger_than_adams() -> Finding:
    """Return how many times larger the Bézier regions are than those of Adams and Bashforth."""
    of_order_3, of_order_4 = _area("B3") / _area("AB3"), _area("B4") / _area("AB4")
    return Finding(
        where="Fig. 2",
        claim="B3 and B4 have larger regions than AB3 and AB4",
        paper="“the Bézier stability regions for both the 3rd and 4th orders are larger than those of the "
        "Adams–Bashforth”",
        here=f"{of_order_3:.2f} and {of_order_4:.2f} times",
        holds=[of_order_3 > 1 and of_order_4 > 1],
    )


def adams_loses_more() -> Finding:
    """Return how much of their area both families keep from order 3 to 4."""
    adams, bezier = _area("AB4") / _area("AB3"), _area("B4") / _area("B3")
    return Finding(
        where="Fig. 2, section 6",
        claim="from order 3 to 4 AB loses more than Bézier",
        paper="“the percentage of reducing the size of stability regions from 3rd order to 4th order of "
        "Adams–Bashforth is considerably higher than that of the presented Bézier technique”",
        here=f"AB3 to AB4 keeps {100 * adams:.0f} %, B3 to B4 {100 * bezier:.0f} %",
        holds=[adams < bezier],
    )


def evaluations_a_step() -> Finding:
    """Return what a step of RK4 and of AB4 costs, in steps of B4."""
    runge_kutta, adams = (evaluations(lookup(name)) / evaluations(lookup("B4")) for name in ("RK4", "AB4"))
    return Finding(
        where="Section 5.1",
        claim="RK4 costs 5 times, AB4 as much as B4",
        paper="“the computational costs of the 4th order Bézier and Adams–Bashforth are quite similar … the "
        "computational cost of the Runge–Kutta method for the same order is about 5 times higher”",
        here=f"evaluations: {runge_kutta:g} and {adams:g} times",
        holds=[runge_kutta == 5, adams == 1],
    )


def at_equal_cost() -> Finding:
    """Return the areas of Fig. 3, where RK4 takes steps of 5h."""
    bezier, runge_kutta, adams = (_area(name) for name in ("B4", "RK4@5", "AB4"))
    return Finding(
        where="Fig. 3",
        claim="at equal cost (RK4 at 5h) B4 has the largest region, AB4 the smallest",
        paper="“considering similar computational costs, the Bézier method provides the largest stability region, … "
        "while Adams–Bashforth exhibits the smallest region”",
        here=f"B4 {bezier:.4f}, RK4@5 {runge_kutta:.4f}, AB4 {adams:.4f}",
        holds=[bezier > runge_kutta > adams],
    )


def at_true_cost() -> Finding:
    """Return the same with RK4 at 4h, since it evaluates four times a step."""
    bezier, runge_kutta, adams = (_area(name) for name in ("B4", "RK4@4", "AB4"))
    return Finding(
        where="Fig. 3",
        claim="the same with RK4 at 4h, its true cost",
        paper="(not said)",
        here=f"RK4@4 {runge_kutta:.4f}",
        holds=[bezier > runge_kutta > adams],
    )


def stable_where_another_is_not(other: str, sentence: str) -> Finding:
    """Return a point where B4 is stable and the other method is not, and one the other way round.

    The sentence is the paper's.
    """
    for_b4 = counterexample(stable=lookup("B4"), unstable=lookup(other))
    against_b4 = counterexample(stable=lookup(other), unstable=lookup("B4"))
    return Finding(
        where="Section 6",
        claim=f"for certain parameters {other} is unstable and B4 stable",
        paper=sentence,
        here=f"{_shown(for_b4)}; but the other way round at {_shown(against_b4)}",
        holds=[for_b4 is not None and against_b4 is None, for_b4 is not None],
    )


def integrator_decides() -> Finding:
    """Return what each of the paper's methods does at one point, as proven, with its |z_p|; RK4 with steps of 5 h."""
    methods = {name: lookup(name) for name in ("B2", "B3", "B4", "AB2", "AB3", *COMPARED[1:])}
    verdicts = {name: verdict(method, *map(exact, WHERE_METHODS_DIFFER)) for name, method in methods.items()}
    moduli = {name: float(spectral_radius(method, *WHERE_METHODS_DIFFER)) for name, method in methods.items()}
    shown = ", ".join(f"{name} {verdicts[name]} ({moduli[name]:.3f})" for name in methods)
    return Finding(
        where="Abstract, section 4",
        claim="which parameters are right depends on the integrator",
        paper="“the proper identification and selection of Baumgarte parameters is highly dependent on the integration "
        "scheme utilized”",
        here=f"at {_shown(WHERE_METHODS_DIFFER)}, with |z_p|: {shown}",
        holds=[set(verdicts.values()) == {"converges", "diverges"}],
    )


def widest_at_its_cost() -> Finding:
    """Return the area of B4 and of others with as many evaluations in the same time, whether the paper has them or not.

    A method that evaluates m times a step takes steps of m h.
    """
    rivals = {name: _area(name) for name in ("AB4", "RK4@4", "SIE@2")}
    not_compared = _area("SYM")
    bezier = _area("B4")
    listed = ", ".join(f"{name} {area:.3f}" for name, area in rivals.items())
    return Finding(
        where="Abstract",
        claim="Bézier has the wider region at the same cost",
        paper="“the Bézier method provides substantially wider region of stability for the same level of computational "
        "effort”",
        here=f"areas: B4 {bezier:.3f}, {listed}; but symplectic Euler, which costs as much as B4, {not_compared:.3f}",
        holds=[bezier > max(rivals.values()), bezier > not_compared],
    )


def adams_moulton() -> Finding:
    """Return the areas of Adams–Moulton's methods beside those of the Bézier methods called of the same order.

    Also, as in practice, with an Adams–Bashforth step as predictor and one correction: two evaluations, so steps of 2h.
    """
    of_order_3, of_order_4 = (_area("B3"), _area("AM3")), (_area("B4"), _area("AM4"))
    corrected = ", ".join(f"{name} {_area(name):.3f}" for name in ("ABM3@2", "ABM4@2"))
    return Finding(
        where="Introduction",
        claim="Bézier is more stable than Adams–Moulton",
        paper="“the stability of the Bézier based solution is enhanced when comparing with other well-known methods, "
        "namely the well-established Adams–Moulton approach”",
        here=f"the reverse, areas: B3 {of_order_3[0]:.3f}, AM3 {of_order_3[1]:.2f}; B4 {of_order_4[0]:.3f}, "
        f"AM4 {of_order_4[1]:.2f}. Only corrected once instead of solved they are smaller: {corrected}",
        holds=[bezier > implicit for bezier, implicit in (of_order_3, of_order_4)],
    )


def counterexample(*, stable: Method, unstable: Method) -> Point | None:
    """Return a point (alpha_hat, beta_hat) where one method converges and the other diverges, both proven.

    It is the point of a grid, to two decimals, that is farthest within both; None if the grid has none.
    """
    alpha_hat, beta_hat = (np.linspace(low, high, GRID) for low, high in window(region(stable)))
    plane = alpha_hat, beta_hat[:, np.newaxis]
    gap = np.minimum(1 - spectral_radius(stable, *plane), spectral_radius(unstable, *plane) - 1)
    row, column = np.unravel_index(np.argmax(gap), gap.shape)
    if gap[row, column] <= 0:
        return None
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
