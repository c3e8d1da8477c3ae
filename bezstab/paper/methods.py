"""Tables 1 and 2, and what the equations of sections 3 and 4 come to: the Bézier methods themselves."""

from collections.abc import Callable, Mapping
from fractions import Fraction
from itertools import product

from bezstab.methods import (
    Method,
    accuracy,
    characteristic_text,
    closed_loop_at,
    evaluations,
    lookup,
    mapping_text,
    recursion_text,
    steps,
)
from bezstab.paper.reports import Finding, Progress, Report, captioned_table
from bezstab.stability import verdict
from bezstab.units import to_dimensionless

TABULATED = ("B2", "B3", "B4")

SAMPLES = [Fraction("-3/2"), Fraction(0), Fraction("1/7"), Fraction(1), Fraction("5/3")]
"""Values of each parameter at which polynomials are compared: more than the degree in it of any of them."""


def report(_progress: Progress) -> Report:
    """Return Tables 1 and 2, and what the equations come to."""
    claims = (
        weights_of_b2,
        mapping_of_b2,
        polynomial_of_b2,
        step_enters_with_parameters,
        feedback_is_stable_in_time,
        no_feedback_is_unstable,
        positive_parameters_are_not_enough,
        second_order_is_one_method,
        orders_of_accuracy,
        kinds_of_methods,
    )
    return Report(
        tables={
            "table1": method_table(
                "Table 1: the Bézier methods and their s→z mappings.",
                {"step": recursion_text, "s→z mapping": mapping_text},
            ),
            "table2": method_table(
                "Table 2: their characteristic polynomials.", {"characteristic polynomial": characteristic_text}
            ),
        },
        findings=[claim() for claim in claims],
    )


def method_table(caption: str, texts: Mapping[str, Callable[[Method, bool], str]]) -> str:
    """Return a table of the Bézier methods as Markdown, with a column for each text about a method."""
    rows = [
        {"method": name, **{heading: text(lookup(name), False) for heading, text in texts.items()}}
        for name in TABULATED
    ]
    return captioned_table(caption, rows)


def weights_of_b2() -> Finding:
    """Return whether Eq. 12 has the weights that follow from the Bernstein curve."""
    weights = _rho_and_sigma("B2")[1][1:]
    return Finding(
        "Eq. 12",
        "B2: y' = y + h/2 (3 f - f')",
        "3/2, -1/2",
        ", ".join(map(str, weights)),
        [weights == (Fraction(3, 2), Fraction(-1, 2))],
    )


def mapping_of_b2() -> Finding:
    """Return whether Eq. 14 has the ρ and σ of B2."""
    rho, sigma = _rho_and_sigma("B2")
    rho_agrees = rho == (Fraction(1), Fraction(-1), Fraction(0))
    sigma_agrees = sigma[0] == 0 and sigma[1] == -3 * sigma[2]
    here = f"ρ = [{', '.join(map(str, rho))}], σ = [{', '.join(map(str, sigma))}]"
    return Finding(
        "Eq. 14",
        "B2: s = (2/h) z (z - 1) / (3 z - 1)",
        "ρ = z² - z, σ = (3 z - 1)/2",
        here,
        [rho_agrees and sigma_agrees],
    )


def polynomial_of_b2() -> Finding:
    """Return at how many rational points the printed characteristic polynomial is ours, up to a factor."""
    agree = []
    for alpha_hat, beta_hat in product(SAMPLES, SAMPLES):
        ours = closed_loop_at(lookup("B2"), alpha_hat, beta_hat)[::-1]
        printed = printed_polynomial_of_b2(alpha_hat, beta_hat)
        agree.append([c / ours[0] for c in ours] == [c / printed[0] for c in printed])
    return Finding(
        "Eq. 17",
        "characteristic polynomial of B2",
        "4 z⁴ + (-8 + 6 α̂) z³ + …",
        f"the same at {sum(agree)} of {len(agree)} rational points",
        [all(agree)],
    )


def printed_polynomial_of_b2(alpha_hat: Fraction, beta_hat: Fraction) -> list[Fraction]:
    """Return the coefficients of Eq. 17, highest power of z first."""
    return [
        Fraction(4),
        -8 + 6 * alpha_hat,
        4 - 8 * alpha_hat + 9 * beta_hat,
        2 * alpha_hat - 6 * beta_hat,
        beta_hat,
    ]


def step_enters_with_parameters() -> Finding:
    """Return whether Eq. 15 is Eq. 17 with Eq. 16 put in, for steps that differ by a thousand."""
    agree = []
    for alpha, beta, h in product(SAMPLES, SAMPLES, [Fraction(1), Fraction("1/1000")]):
        by_step = printed_polynomial_of_b2_by_step(alpha, beta, h)
        agree.append(by_step == printed_polynomial_of_b2(*to_dimensionless(alpha, beta, h)))
    return Finding(
        "Eqs 15, 16",
        "the step enters with the parameters alone",
        "“In order to avoid the dependence on step size, two dimensionless parameters must be established”: "
        "α̂ = 2αh, β̂ = β²h²",
        f"Eq. 15 is Eq. 17 at {sum(agree)} of {len(agree)} rational points",
        [all(agree)],
    )


def printed_polynomial_of_b2_by_step(alpha: Fraction, beta: Fraction, h: Fraction) -> list[Fraction]:
    """Return the coefficients of Eq. 15 for alpha and beta (1/s) and a step of h (s), highest power of z first."""
    return [
        Fraction(4),
        -8 + 12 * alpha * h,
        4 - 16 * alpha * h + 9 * beta**2 * h**2,
        4 * alpha * h - 6 * beta**2 * h**2,
        beta**2 * h**2,
    ]


def feedback_is_stable_in_time() -> Finding:
    """Return whether Eq. 7 has both roots in the left half plane at positive rational points.

    They are there if and only if their sum, -2 alpha, is negative and their product, beta^2, positive: exact numbers.
    """
    positive = [value for value in SAMPLES if value > 0]
    holds = [-2 * alpha < 0 < beta**2 for alpha, beta in product(positive, positive)]
    return Finding(
        "Eq. 7",
        "before it is discretised, the feedback is stable",
        "“with α and β greater than zero, Eq. (7) is stable and, consequently, c and ċ will converge to zero”",
        f"sum of the roots -2α < 0, product β² > 0 at {sum(holds)} of {len(holds)} points",
        [all(holds)],
    )


def no_feedback_is_unstable() -> Finding:
    """Return what every method of the paper does with c̈ = 0."""
    names = ("B2", "B3", "B4", "AB2", "AB3", "AB4")
    verdicts = {verdict(lookup(name), Fraction(0), Fraction(0)) for name in names}
    return Finding(
        "Section 3",
        "c̈ = 0 is unstable",
        "“the equation c̈ = 0 represents an unstable system, therefore c and ċ will not converge to zero if any "
        "perturbation occurs”",
        f"at α̂ = β̂ = 0: {', '.join(sorted(verdicts))}",
        [verdicts == {"diverges"}],
    )


def positive_parameters_are_not_enough() -> Finding:
    """Return whether some method diverges at a point with both parameters positive."""
    verdicts = {name: verdict(lookup(name), Fraction(2), Fraction(2)) for name in ("B2", "B3", "B4", "AB4")}
    here = "at (2, 2): " + ", ".join(f"{name} {found}" for name, found in verdicts.items())
    return Finding(
        "Section 4",
        "positive α and β do not guarantee convergence",
        "“positive values for α and β parameters does not guarantee the convergence of c and ċ”",
        here,
        ["diverges" in verdicts.values()],
    )


def second_order_is_one_method() -> Finding:
    """Return whether B2 and AB2 have the same coefficients."""
    same = lookup("B2").scheme.mu_table == lookup("AB2").scheme.mu_table
    return Finding(
        "Section 5.1",
        "second order of both families is the same method",
        "“formulations for the second order of both methods are the same and, therefore, they exhibit similar "
        "stability regions”",
        "same weights" if same else "differ",
        [same],
    )


def orders_of_accuracy() -> Finding:
    """Return whether an n-th order Bézier method is of order n; the name is the paper's, the order is Taylor's."""
    orders = {name: accuracy(lookup(name))[0] for name in (*TABULATED, "AB3", "AB4")}
    bezier_orders = ", ".join(f"{name}: {orders[name]}" for name in TABULATED)
    return Finding(
        "Table 1",
        "“n-th order Bézier” is of order n",
        "“the second to the fourth order of the Bézier method”",
        f"{bezier_orders}; AB3 and AB4: {orders['AB3']} and {orders['AB4']}",
        [[orders[name] for name in TABULATED] == [2, 3, 4], orders["B2"] == 2],
    )


def kinds_of_methods() -> Finding:
    """Return how many past points and how many evaluations a step of each method takes."""
    needs = {name: (steps(lookup(name)), evaluations(lookup(name))) for name in ("B4", "AB4", "RK4")}
    shown = ", ".join(f"{name} {past} and {evaluated}" for name, (past, evaluated) in needs.items())
    return Finding(
        "Section 5.2.3",
        "multistep, and single-step of several stages",
        "“the Bézier and Adams–Bashforth methods are multi-step numerical integration algorithms, while the "
        "Runge–Kutta method is a single-step multistage numerical integration procedure”",
        f"points and evaluations of a step: {shown}",
        [needs == {"B4": (4, 1), "AB4": (4, 1), "RK4": (1, 4)}],
    )


def _rho_and_sigma(name: str) -> tuple[tuple[Fraction, ...], tuple[Fraction, ...]]:
    """Return the coefficients of rho and of sigma, highest power of z first."""
    rho, minus_sigma = zip(*reversed(lookup(name).scheme.mu_table), strict=True)
    return rho, tuple(-c for c in minus_sigma)
