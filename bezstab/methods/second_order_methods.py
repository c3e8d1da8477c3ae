"""Built-in methods that step positions and velocities differently, as recipes: h = 1, a sum of terms in each line.

    x0, v0, a0    position, velocity, acceleration at the start of the step
    x1, v1, a1    at its end
    any other     a helper

An acceleration that no line of the step gives (a0, where the step ends with a1) is the one stored in the step before.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import partial

from bezstab.methods.algebraic_numbers import DIGITS, decimal_root
from bezstab.methods.schemes import Method, MethodGroup
from bezstab.rationals import ONE, ZERO

HALF = Fraction(1, 2)
VERLET = "Swope, Andersen, Berens & Wilson, J. Chem. Phys. 76, 1982 (velocity Verlet; feedback sees {})"

THETA = decimal_root(lambda theta: 2 * theta**3 + (1 - 2 * theta) ** 3, ONE, Fraction(2))
"""1 / (2 - 2^(1/3)), to 40 digits: in steps of theta, 1 - 2 theta and theta the errors of order three cancel."""

BACK, OUTER, INNER = 1 - 2 * THETA, THETA / 2, (1 - THETA) / 2

RECIPES: dict[str, tuple[str, str]] = {
    # what most engines call semi-implicit Euler
    "SYM": (
        "Hairer, Lubich & Wanner, Eq. I.1.9",
        """
        a0 = acceleration(x0, v0)
        v1 = v0 + a0
        x1 = x0 + v1
        """,
    ),
    # Compositions of kicks and drifts. Each kick sees the velocity before it: no more than order one where a force
    # depends on the velocity, whatever their order without.
    "ruth3": (
        "Ruth, IEEE Trans. Nucl. Sci. 30, 1983 (order 3 for forces of position)",
        """
        a_1 = acceleration(x0, v0)
        v_1 = v0 + 7/24 a_1
        x_1 = x0 + 2/3 v_1
        a_2 = acceleration(x_1, v_1)
        v_2 = v_1 + 3/4 a_2
        x_2 = x_1 - 2/3 v_2
        a_3 = acceleration(x_2, v_2)
        v1 = v_2 - 1/24 a_3
        x1 = x_2 + v1
        """,
    ),
    "forest-ruth": (
        "Forest & Ruth, Physica D 43, 1990 (drift first, order 4 for forces of position)",
        f"""
        x_1 = x0 + {OUTER} v0
        a_1 = acceleration(x_1, v0)
        v_1 = v0 + {THETA} a_1
        x_2 = x_1 + ({INNER} v_1)
        a_2 = acceleration(x_2, v_1)
        v_2 = v_1 + ({BACK} a_2)
        x_3 = x_2 + ({INNER} v_2)
        a_3 = acceleration(x_3, v_2)
        v1 = v_2 + {THETA} a_3
        x1 = x_3 + {OUTER} v1
        """,
    ),
    "yoshida4": (
        "Yoshida, Phys. Lett. A 150, 1990 (kick first, order 4 for forces of position)",
        f"""
        a_1 = acceleration(x0, v0)
        v_1 = v0 + {OUTER} a_1
        x_1 = x0 + {THETA} v_1
        a_2 = acceleration(x_1, v_1)
        v_2 = v_1 + ({INNER} a_2)
        x_2 = x_1 + ({BACK} v_2)
        a_3 = acceleration(x_2, v_2)
        v_3 = v_2 + ({INNER} a_3)
        x1 = x_2 + {THETA} v_3
        a_4 = acceleration(x1, v_3)
        v1 = v_3 + {OUTER} a_4
        """,
    ),
    "rkn4": (
        "Nystroem, Acta Soc. Sci. Fenn. 50, 1925 (order 4)",
        """
        a_1 = acceleration(x0, v0)
        a_2 = acceleration(x0 + 1/2 v0 + 1/8 a_1, v0 + 1/2 a_1)
        a_3 = acceleration(x0 + 1/2 v0 + 1/8 a_1, v0 + 1/2 a_2)
        a_4 = acceleration(x0 + v0 + 1/2 a_3, v0 + a_3)
        x1 = x0 + v0 + 1/6 a_1 + 1/6 a_2 + 1/6 a_3
        v1 = v0 + 1/6 a_1 + 1/3 a_2 + 1/3 a_3 + 1/6 a_4
        """,
    ),
    # Velocity Verlet: where a force depends on the velocity, which velocity does it see?
    "verlet-half": (
        VERLET.format("the half-step velocity"),
        """
        x1 = x0 + v0 + 1/2 a0
        vh = v0 + 1/2 a0
        a1 = acceleration(x1, vh)
        v1 = vh + 1/2 a1
        """,
    ),
    "verlet-predicted": (
        VERLET.format("the predicted velocity v + h a"),
        """
        x1 = x0 + v0 + 1/2 a0
        vp = v0 + a0
        a1 = acceleration(x1, vp)
        v1 = v0 + 1/2 a0 + 1/2 a1
        """,
    ),
    # Chrono's leapfrog
    "verlet-old": (
        VERLET.format("the old velocity"),
        """
        x1 = x0 + v0 + 1/2 a0
        a1 = acceleration(x1, v0)
        v1 = v0 + 1/2 a0 + 1/2 a1
        """,
    ),
    # newmark(0,1/2)
    "verlet-implicit": (
        VERLET.format("the new velocity, by iteration"),
        """
        x1 = x0 + v0 + 1/2 a0
        a1 = acceleration(x1, v1)
        v1 = v0 + 1/2 a0 + 1/2 a1
        """,
    ),
    "verlet-kdk": (
        "Hairer, Lubich & Wanner, Acta Numerica 12, 2003 (Verlet; kick, drift, kick, an acceleration for each)",
        """
        a_start = acceleration(x0, v0)
        vh = v0 + 1/2 a_start
        x1 = x0 + vh
        a_end = acceleration(x1, vh)
        v1 = vh + 1/2 a_end
        """,
    ),
    # One velocity, then one position, as physics engines do
    "imex-euler": (
        "Ascher, Ruuth & Wetton, SIAM J. Numer. Anal. 32, 1995 (forward-backward Euler; MuJoCo's implicitfast)",
        """
        a1 = acceleration(x0, v1)
        v1 = v0 + a1
        x1 = x0 + v1
        """,
    ),
    # the feedback sees where x and v would be after the step
    "stable-pd": (
        "Tan, Liu & Turk, IEEE Comput. Graph. Appl. 31, 2011 (stable PD)",
        """
        a0 = acceleration(x0 + v0, v0 + a0)
        v1 = v0 + a0
        x1 = x0 + v1
        """,
    ),
}
"""Methods by name: the source, and the equations of a step."""


def built_in(name: str) -> Method:
    """Return a method by its name in RECIPES."""
    source, equations = RECIPES[name]
    return _method(name, source, equations, digits=DIGITS if name in ("forest-ruth", "yoshida4") else None)


def _method(name: str, source: str, equations: str, digits: int | None = None) -> Method:
    from bezstab.methods.recipes import recipe  # loads sympy

    by_result = dict(line.strip().split(" = ") for line in equations.splitlines() if line.strip())
    return Method(name, recipe(by_result), source, digits=digits)


# Newmark's family and its descendants


def newmark(beta: Fraction, gamma: Fraction, name: str) -> Method:
    """Return Newmark's method: the acceleration within the step has the mean weights beta (for x) and gamma (for v).

    beta = 1/4: constant average acceleration; 1/6: linear; 1/12: Fox & Goodwin; 0: central differences.
    """
    source = f"Newmark, J. Eng. Mech. Div. ASCE 85, 1959 (beta = {beta}, gamma = {gamma})"
    return _method(name, source, _newmark_updates(beta, gamma) + "a1 = acceleration(x1, v1)")


def _newmark_updates(beta: Fraction, gamma: Fraction) -> str:
    return f"""
    x1 = x0 + v0 + ({HALF - beta} a0) + ({beta} a1)
    v1 = v0 + ({1 - gamma} a0) + ({gamma} a1)
    """


def hht(alpha: Fraction, name: str) -> Method:
    """Return the method of Hilber, Hughes and Taylor, alpha from -1/3 (most damping) to 0: forces at t_{1 + alpha}."""
    equations = _alpha_equations(
        alpha_m=ZERO,
        alpha_f=-alpha,
        beta=(1 - alpha) ** 2 / 4,
        gamma=HALF - alpha,
    )
    return _method(name, f"Hilber, Hughes & Taylor, Earthq. Eng. Struct. Dyn. 5, 1977 (alpha = {alpha})", equations)


def generalized_alpha(spectral_radius: Fraction, name: str) -> Method:
    """Return the generalised-alpha method by rho_inf, its |z| where alpha_hat, beta_hat are infinite: 0 to 1."""
    r = spectral_radius
    equations = _alpha_equations(
        alpha_m=(2 * r - 1) / (r + 1),
        alpha_f=r / (r + 1),
        beta=1 / (1 + r) ** 2,
        gamma=(3 - r) / (2 * (1 + r)),
    )
    return _method(name, f"Chung & Hulbert, J. Appl. Mech. 60, 1993 (generalised alpha, rho_inf = {r})", equations)


def _alpha_equations(alpha_m: Fraction, alpha_f: Fraction, beta: Fraction, gamma: Fraction) -> str:
    """Return Newmark's updates with (1 - alpha_m) a1 + alpha_m a0 = the acceleration at alpha_f of the way back."""
    return f"""{_newmark_updates(beta, gamma)}
    force = acceleration({1 - alpha_f} x1 + {alpha_f} x0, {1 - alpha_f} v1 + {alpha_f} v0)
    a1 = ({1 / (1 - alpha_m)} force) + ({-alpha_m / (1 - alpha_m)} a0)
    """


@dataclass(frozen=True)
class ParametricMethod:
    """A method whose name has parameters, from the least to the largest value; `make` takes theirs and the name."""

    name: str
    parameters: Mapping[str, tuple[Fraction, Fraction]]
    make: Callable[..., Method]

    def having(self, *values: Fraction) -> Method:
        """Return the method with these parameters, in their order; its name says them: hht(alpha=-1/20)."""
        said = [f"{parameter}={value}" for parameter, value in zip(self.parameters, values, strict=True)]
        return self.make(*values, f"{self.name}({','.join(said)})")


NEWMARK = ParametricMethod("newmark", dict.fromkeys(("beta", "gamma"), (ZERO, Fraction(10))), newmark)
HHT = ParametricMethod("hht", {"alpha": (Fraction(-1, 3), ZERO)}, hht)
GENERALIZED_ALPHA = ParametricMethod("generalized-alpha", {"rho_inf": (ZERO, ONE)}, generalized_alpha)

NEWMARK_BETAS = {
    "average-acceleration": Fraction(1, 4),
    "linear-acceleration": Fraction(1, 6),
    "fox-goodwin": Fraction(1, 12),
    "central-difference": ZERO,
}
"""Of the members of Newmark's family that have a name; their gamma is 1/2."""

PARAMETRIC = {method.name: method for method in (NEWMARK, HHT, GENERALIZED_ALPHA)}
"""Methods with parameters, by name: newmark(1/4,1/2) or newmark(beta=1/4,gamma=1/2)."""


def _group(heading: str, *names: str) -> MethodGroup:
    return MethodGroup(heading, {name: partial(built_in, name) for name in names})


SECOND_ORDER = (
    _group("Symplectic and Nyström", "SYM", "ruth3", "forest-ruth", "yoshida4", "rkn4"),
    _group(
        "Velocity Verlet, by the velocity that the feedback sees",
        *("verlet-half", "verlet-predicted", "verlet-old", "verlet-implicit", "verlet-kdk"),
    ),
    MethodGroup(
        "Newmark and generalised alpha",
        {
            **{name: partial(newmark, beta, HALF, name) for name, beta in NEWMARK_BETAS.items()},
            "hht": partial(HHT.having, Fraction(-1, 20)),
            "generalized-alpha": partial(GENERALIZED_ALPHA.having, Fraction(4, 5)),
        },
        note="(newmark(beta,gamma), hht(alpha=-0.1), generalized-alpha(rho_inf=0.8))",
    ),
    _group("Implicit in the velocity, of physics engines and control", "imex-euler", "stable-pd"),
)
