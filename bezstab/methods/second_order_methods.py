"""Built-in methods that step positions and velocities differently, as recipes: h = 1, a sum of terms in each line.

    x0, v0, a0    position, velocity, acceleration at the start of the step
    x1, v1, a1    at its end
    any other     a helper

An acceleration that no line of the step gives (a0, where the step ends with a1) is the one stored in the step before.
"""

from fractions import Fraction

from bezstab.methods.algebraic_numbers import DIGITS, decimal_root
from bezstab.methods.recipes import recipe
from bezstab.methods.schemes import Method
from bezstab.methods.second_order import SecondOrder
from bezstab.rationals import ONE

HALF = Fraction(1, 2)

# Velocity Verlet: where a force depends on the velocity, which velocity does it see?

VERLET = "Swope, Andersen, Berens & Wilson, J. Chem. Phys. 76, 1982 (velocity Verlet; feedback sees {})"


def verlet_half() -> Method:
    """Return velocity Verlet whose feedback sees the half-step velocity: the poles of symplectic Euler."""
    scheme = recipe({
        "x1": "x0 + v0 + 1/2 a0",
        "vh": "v0 + 1/2 a0",
        "a1": "acceleration(x1, vh)",
        "v1": "vh + 1/2 a1",
    })  # fmt: skip
    return Method("verlet-half", scheme, VERLET.format("the half-step velocity"))


def verlet_predicted() -> Method:
    """Return velocity Verlet whose feedback sees v + h a, corrected with the stored acceleration."""
    scheme = recipe({
        "x1": "x0 + v0 + 1/2 a0",
        "vp": "v0 + a0",
        "a1": "acceleration(x1, vp)",
        "v1": "v0 + 1/2 a0 + 1/2 a1",
    })  # fmt: skip
    return Method("verlet-predicted", scheme, VERLET.format("the predicted velocity v + h a"))


def verlet_old() -> Method:
    """Return velocity Verlet whose feedback sees the old velocity: Chrono's leapfrog."""
    scheme = recipe({
        "x1": "x0 + v0 + 1/2 a0",
        "a1": "acceleration(x1, v0)",
        "v1": "v0 + 1/2 a0 + 1/2 a1",
    })  # fmt: skip
    return Method("verlet-old", scheme, VERLET.format("the old velocity"))


def verlet_implicit() -> Method:
    """Return velocity Verlet whose feedback sees the new velocity, which it helps to make; newmark(0,1/2)."""
    scheme = recipe({
        "x1": "x0 + v0 + 1/2 a0",
        "a1": "acceleration(x1, v1)",
        "v1": "v0 + 1/2 a0 + 1/2 a1",
    })  # fmt: skip
    return Method("verlet-implicit", scheme, VERLET.format("the new velocity, by iteration"))


def verlet_kdk() -> Method:
    """Return kick-drift-kick with an acceleration for each kick: at its start with v, at its end with v_half."""
    scheme = recipe({
        "a_start": "acceleration(x0, v0)",
        "vh": "v0 + 1/2 a_start",
        "x1": "x0 + vh",
        "a_end": "acceleration(x1, vh)",
        "v1": "vh + 1/2 a_end",
    })  # fmt: skip
    source = "Hairer, Lubich & Wanner, Acta Numerica 12, 2003 (Verlet; kick, drift, kick, an acceleration for each)"
    return Method("verlet-kdk", scheme, source)


# Newmark's family and its descendants


def newmark(beta: Fraction, gamma: Fraction, name: str) -> Method:
    """Return Newmark's method: the acceleration within the step has the mean weights beta (for x) and gamma (for v).

    beta = 1/4: constant average acceleration; 1/6: linear; 1/12: Fox & Goodwin; 0: central differences.
    """
    scheme = recipe(_newmark_updates(beta, gamma) | {"a1": "acceleration(x1, v1)"})
    return Method(name, scheme, f"Newmark, J. Eng. Mech. Div. ASCE 85, 1959 (beta = {beta}, gamma = {gamma})")


def _newmark_updates(beta: Fraction, gamma: Fraction) -> dict[str, str]:
    return {
        "x1": f"x0 + v0 + ({HALF - beta} a0) + ({beta} a1)",
        "v1": f"v0 + ({1 - gamma} a0) + ({gamma} a1)",
    }  # fmt: skip


def hht(alpha: Fraction, name: str) -> Method:
    """Return the method of Hilber, Hughes and Taylor, alpha from -1/3 (most damping) to 0: forces at t_{1 + alpha}."""
    source = f"Hilber, Hughes & Taylor, Earthq. Eng. Struct. Dyn. 5, 1977 (alpha = {alpha})"
    scheme = _alpha_scheme(
        alpha_m=Fraction(0),
        alpha_f=-alpha,
        beta=(1 - alpha) ** 2 / 4,
        gamma=HALF - alpha,
    )
    return Method(name, scheme, source)


def generalized_alpha(spectral_radius: Fraction, name: str) -> Method:
    """Return the generalised-alpha method by rho_inf, its |z| where alpha_hat, beta_hat are infinite: 0 to 1."""
    r = spectral_radius
    source = f"Chung & Hulbert, J. Appl. Mech. 60, 1993 (generalised alpha, rho_inf = {r})"
    scheme = _alpha_scheme(
        alpha_m=(2 * r - 1) / (r + 1),
        alpha_f=r / (r + 1),
        beta=1 / (1 + r) ** 2,
        gamma=(3 - r) / (2 * (1 + r)),
    )
    return Method(name, scheme, source)


def _alpha_scheme(alpha_m: Fraction, alpha_f: Fraction, beta: Fraction, gamma: Fraction) -> SecondOrder:
    """Return Newmark's updates with (1 - alpha_m) a1 + alpha_m a0 = the acceleration at alpha_f of the way back."""
    return recipe(
        _newmark_updates(beta, gamma)
        | {
            "force": f"acceleration({1 - alpha_f} x1 + {alpha_f} x0, {1 - alpha_f} v1 + {alpha_f} v0)",
            "a1": f"({1 / (1 - alpha_m)} force) + ({-alpha_m / (1 - alpha_m)} a0)",
        }
    )


# One velocity, then one position, as physics engines do


def imex_euler() -> Method:
    """Return Euler's method implicit in the velocity and explicit in the position: MuJoCo's implicitfast on drives."""
    scheme = recipe({
        "a1": "acceleration(x0, v1)",
        "v1": "v0 + a1",
        "x1": "x0 + v1",
    })  # fmt: skip
    source = "Ascher, Ruuth & Wetton, SIAM J. Numer. Anal. 32, 1995 (forward-backward Euler; MuJoCo's implicitfast)"
    return Method("imex-euler", scheme, source)


def stable_pd() -> Method:
    """Return stable proportional-derivative control: the feedback sees where x and v would be after the step."""
    scheme = recipe({
        "a0": "acceleration(x0 + v0, v0 + a0)",
        "v1": "v0 + a0",
        "x1": "x0 + v1",
    })  # fmt: skip
    return Method("stable-pd", scheme, "Tan, Liu & Turk, IEEE Comput. Graph. Appl. 31, 2011 (stable PD)")


# Compositions of kicks and drifts. Each kick sees the velocity before it: no more than order one where a force depends
# on the velocity, whatever their order without.


def ruth3() -> Method:
    """Return Ruth's symplectic method: three kicks, order three for forces of position."""
    scheme = recipe({
        "a_1": "acceleration(x0, v0)",
        "v_1": "v0 + 7/24 a_1",
        "x_1": "x0 + 2/3 v_1",
        "a_2": "acceleration(x_1, v_1)",
        "v_2": "v_1 + 3/4 a_2",
        "x_2": "x_1 - 2/3 v_2",
        "a_3": "acceleration(x_2, v_2)",
        "v1": "v_2 - 1/24 a_3",
        "x1": "x_2 + v1",
    })  # fmt: skip
    return Method("ruth3", scheme, "Ruth, IEEE Trans. Nucl. Sci. 30, 1983 (order 3 for forces of position)")


def _triple_jump() -> Fraction:
    """Return theta = 1 / (2 - 2^(1/3)): in steps of theta, 1 - 2 theta and theta the errors of order three cancel."""
    return decimal_root(lambda theta: 2 * theta**3 + (1 - 2 * theta) ** 3, ONE, Fraction(2))


def forest_ruth() -> Method:
    """Return Forest and Ruth's symplectic method: three kicks between drifts, order four for forces of position."""
    theta = _triple_jump()
    outer, inner = theta / 2, (1 - theta) / 2
    scheme = recipe({
        "x_1": f"x0 + {outer} v0",
        "a_1": "acceleration(x_1, v0)",
        "v_1": f"v0 + {theta} a_1",
        "x_2": f"x_1 + ({inner} v_1)",
        "a_2": "acceleration(x_2, v_1)",
        "v_2": f"v_1 + ({1 - 2 * theta} a_2)",
        "x_3": f"x_2 + ({inner} v_2)",
        "a_3": "acceleration(x_3, v_2)",
        "v1": f"v_2 + {theta} a_3",
        "x1": f"x_3 + {outer} v1",
    })  # fmt: skip
    source = "Forest & Ruth, Physica D 43, 1990 (drift first, order 4 for forces of position)"
    return Method("forest-ruth", scheme, source, digits=DIGITS)


def yoshida4() -> Method:
    """Return Yoshida's composition of three velocity Verlet steps: four kicks, order four for forces of position."""
    theta = _triple_jump()
    outer, inner = theta / 2, (1 - theta) / 2
    scheme = recipe({
        "a_1": "acceleration(x0, v0)",
        "v_1": f"v0 + {outer} a_1",
        "x_1": f"x0 + {theta} v_1",
        "a_2": "acceleration(x_1, v_1)",
        "v_2": f"v_1 + ({inner} a_2)",
        "x_2": f"x_1 + ({1 - 2 * theta} v_2)",
        "a_3": "acceleration(x_2, v_2)",
        "v_3": f"v_2 + ({inner} a_3)",
        "x1": f"x_2 + {theta} v_3",
        "a_4": "acceleration(x1, v_3)",
        "v1": f"v_3 + {outer} a_4",
    })  # fmt: skip
    return Method(
        "yoshida4",
        scheme,
        "Yoshida, Phys. Lett. A 150, 1990 (kick first, order 4 for forces of position)",
        digits=DIGITS,
    )


def rkn4() -> Method:
    """Return Nystroem's method of four stages and order four, for forces of position and velocity."""
    scheme = recipe({
        "a_1": "acceleration(x0, v0)",
        "a_2": "acceleration(x0 + 1/2 v0 + 1/8 a_1, v0 + 1/2 a_1)",
        "a_3": "acceleration(x0 + 1/2 v0 + 1/8 a_1, v0 + 1/2 a_2)",
        "a_4": "acceleration(x0 + v0 + 1/2 a_3, v0 + a_3)",
        "x1": "x0 + v0 + 1/6 a_1 + 1/6 a_2 + 1/6 a_3",
        "v1": "v0 + 1/6 a_1 + 1/3 a_2 + 1/3 a_3 + 1/6 a_4",
    })  # fmt: skip
    return Method("rkn4", scheme, "Nystroem, Acta Soc. Sci. Fenn. 50, 1925 (order 4)")
