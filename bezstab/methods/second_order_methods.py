"""Newmark's family and its descendants as recipes, whose names have parameters; other recipes are in built_in.toml."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import partial

from bezstab.methods.schemes import Method, MethodGroup
from bezstab.rationals import ONE, ZERO

HALF = Fraction(1, 2)


def newmark(beta: Fraction, gamma: Fraction, name: str) -> Method:
    """Return Newmark's method: the acceleration within the step has the mean weights beta (for x) and gamma (for v).

    beta = 1/4: constant average acceleration; 1/6: linear; 1/12: Fox & Goodwin; 0: central differences.
    """
    source = f"Newmark, J. Eng. Mech. Div. ASCE 85, 1959 (beta = {beta}, gamma = {gamma})"
    return _method(name, source, _newmark_updates(beta, gamma) | {"a1": "acceleration(x1, v1)"})


def _newmark_updates(beta: Fraction, gamma: Fraction) -> dict[str, str]:
    return {
        "x1": f"x0 + v0 + ({HALF - beta} a0) + ({beta} a1)",
        "v1": f"v0 + ({1 - gamma} a0) + ({gamma} a1)",
    }


def _method(name: str, source: str, equations: dict[str, str]) -> Method:
    from bezstab.methods.recipes import recipe  # loads sympy

    return Method(name, recipe(equations), source)


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


def _alpha_equations(alpha_m: Fraction, alpha_f: Fraction, beta: Fraction, gamma: Fraction) -> dict[str, str]:
    """Return Newmark's updates with (1 - alpha_m) a1 + alpha_m a0 = the acceleration at alpha_f of the way back."""
    return _newmark_updates(beta, gamma) | {
        "force": f"acceleration({1 - alpha_f} x1 + {alpha_f} x0, {1 - alpha_f} v1 + {alpha_f} v0)",
        "a1": f"({1 / (1 - alpha_m)} force) + ({-alpha_m / (1 - alpha_m)} a0)",
    }


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


NEWMARK_AND_ALPHA = MethodGroup(
    "Newmark and generalised alpha",
    {
        **{name: partial(newmark, beta, HALF, name) for name, beta in NEWMARK_BETAS.items()},
        "hht": partial(HHT.having, Fraction(-1, 20)),
        "generalized-alpha": partial(GENERALIZED_ALPHA.having, Fraction(4, 5)),
    },
    note="(newmark(beta,gamma), hht(alpha=-0.1), generalized-alpha(rho_inf=0.8))",
)
